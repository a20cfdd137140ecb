// Measures how times grow with points, planes, voxels, image size and threads.

#include "core/lab/bench/scaling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lab/synthetic/stairs.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {

double fitted_exponent(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x;
    xx += dx * dx;
    xy += dx * (std::log(y[i]) - mean_y);
  }
  // For equal x, rounding errors must not become a slope.
  return xx > 1e-12 ? xy / xx : std::numeric_limits<double>::quiet_NaN();
}

Frame scaled_frame(const Frame& frame, double scale) {
  const auto scaled = [&](int edge) { return std::max(1, static_cast<int>(edge * scale + 0.5)); };
  Frame result = frame;
  result.color = {};
  result.color_aligned = false;
  Intrinsics& camera = result.intrinsics;
  camera.width = scaled(frame.depth.width);
  camera.height = scaled(frame.depth.height);
  const double sx = static_cast<double>(camera.width) / frame.depth.width;
  const double sy = static_cast<double>(camera.height) / frame.depth.height;
  camera.fx *= sx;
  camera.fy *= sy;
  camera.cx = (camera.cx + 0.5) * sx - 0.5;  // pixel centers are whole numbers
  camera.cy = (camera.cy + 0.5) * sy - 0.5;
  result.depth = Image16(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const int from_x = std::min(static_cast<int>((x + 0.5) / sx), frame.depth.width - 1);
      const int from_y = std::min(static_cast<int>((y + 0.5) / sy), frame.depth.height - 1);
      result.depth.at(x, y) = frame.depth.at(from_x, from_y);
    }
  return result;
}

namespace {

using ScalingRuns = std::vector<std::pair<const char*, std::function<void()>>>;

/// Adds an x: runs all curves interleaved, on the scaling's clock.
void add_x(
    Scaling& scaling, double x, const ScalingRuns& runs, int rounds, const SpeedTools& tools) {
  const std::string what = fmt::format("scaling, {} {:.4g}", scaling.x_name, x);
  const auto ms = interleaved_ms(
      runs.size(), rounds, [&] { tools.before(what); },
      [&](std::size_t r, int) { runs[r].second(); }, scaling.clock);
  scaling.x.push_back(x);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (scaling.curves.size() == r) scaling.curves.push_back({runs[r].first, {}, 0});
    scaling.curves[r].ms.push_back(median(ms[r]));
  }
}

Scaling fitted(Scaling scaling) {
  for (ScalingCurve& curve : scaling.curves) curve.exponent = fitted_exponent(scaling.x, curve.ms);
  return scaling;
}

/// Large inputs take long and vary little, so fewer rounds suffice.
int rounds_for(std::size_t points, int rounds) {
  constexpr double kUsualPoints = 50'000;
  const double fewer = rounds * std::min(1.0, kUsualPoints / static_cast<double>(points));
  return std::max(std::min(rounds, 3), static_cast<int>(fewer));
}

planes::PipelineOptions refined_of(const SpeedSubject& subject, int threads) {
  planes::PipelineOptions options = subject.options;
  options.segment = planes::profile_options(planes::Profile::refined);
  options.threads = threads;
  return options;
}

/// Points in the form that methods take.
struct ScalingCloud {
  planes::Cloud cloud;
  std::vector<Label> labels;

  explicit ScalingCloud(const PointsOnPlanes& made) : labels(made.labels) {
    Frame frame;
    frame.cloud.emplace().points = made.points;
    Gravity down;
    down.direction = Vec3d(0, 0, -1);
    cloud = planes::make_cloud(frame, down, {});
  }
  planes::Segmentation segmented(planes::Profile profile, const Vec3d& sensor) const {
    return planes::segment(cloud.points, labels, cloud.cube, sensor,
                           planes::profile_options(profile));
  }
};

Scaling over_points(const SpeedTools& tools) {
  Scaling scaling{.id = "points",
                  .title = "Points",
                  .x_name = "points [thousand]",
                  .note =
                      "A staircase with 2 mm of noise, true labels for the segmentations, each "
                      "of which builds its own octree. One thread."};
  for (const int points : {1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000}) {
    if (points > tools.most_points) break;
    tools.before("scaling, points");
    const ScalingCloud made(scattered_stairs(points));
    const planes::Cloud& cloud = made.cloud;
    const Vec3d origin = Vec3d::Zero();
    const ScalingRuns runs = {
        {"voxel grid, 2 cm", [&] { planes::voxelize(cloud, 0.02); }},
        {"classifier gcn", [&] { tools.gcn->classify(cloud.points, 1); }},
        {"classifier pca", [&] { tools.pca->classify(cloud.points, 1); }},
        {"octree", [&] { planes::build_octree(cloud.points, made.labels, cloud.cube); }},
        {"segmentation paper", [&] { made.segmented(planes::Profile::paper, origin); }},
        {"segmentation refined", [&] { made.segmented(planes::Profile::refined, origin); }},
    };
    add_x(scaling, points / 1000.0, runs,
          rounds_for(static_cast<std::size_t>(points), tools.rounds), tools);
  }
  return fitted(std::move(scaling));
}

Scaling over_planes(const SpeedTools& tools) {
  const int points = std::min(50'000, tools.most_points);
  const Vec3d above(2.5, 2.5, 4);
  Scaling scaling{.id = "planes",
                  .title = "Planes",
                  .x_name = "planes found",
                  .note = fmt::format("{} points on level tiles of different heights, seen from "
                                      "above. Planes are those that profile refined finds. One "
                                      "thread.",
                                      points)};
  for (const int side : {2, 4, 8, 16, 24, 32, 40}) {
    tools.before("scaling, planes");
    const ScalingCloud made(tiles(side, points));
    const auto found =
        static_cast<double>(made.segmented(planes::Profile::refined, above).planes.size());
    if (!scaling.x.empty() && found <= scaling.x.back()) continue;  // tiles have too few points
    const ScalingRuns runs = {
        {"segmentation paper", [&] { made.segmented(planes::Profile::paper, above); }},
        {"segmentation refined", [&] { made.segmented(planes::Profile::refined, above); }},
    };
    add_x(scaling, found, runs, tools.rounds, tools);
  }
  return fitted(std::move(scaling));
}

Scaling over_voxels(const SpeedSubject& subject, const SpeedTools& tools) {
  Scaling scaling{.id = "voxels",
                  .title = "Voxel sizes",
                  .x_name = "voxel edge [mm]",
                  .note =
                      "The first frame of the first recording. Whole frame: from depth to the "
                      "planes of its pixels, classifier gcn, profile paper. One thread."};
  const Frame& frame = subject.frames[0];
  planes::PipelineOptions paper = refined_of(subject, 1);
  paper.segment = planes::profile_options(planes::Profile::paper);
  const planes::PreparedFrame prepared = planes::prepare_frame(frame, paper, tools.gcn.get());
  for (const double edge_mm : {5.0, 10.0, 20.0, 40.0, 80.0}) {
    planes::PipelineOptions options = paper;
    options.cloud.voxel_size_m = edge_mm / 1000;
    const ScalingRuns runs = {
        {"voxel grid", [&] { planes::voxelize(prepared.cloud, options.cloud.voxel_size_m); }},
        {"whole frame", [&] { planes::run_frame(frame, options, tools.gcn.get()); }},
    };
    add_x(scaling, edge_mm, runs, tools.rounds, tools);
  }
  return fitted(std::move(scaling));
}

Scaling over_images(const SpeedSubject& subject, const SpeedTools& tools) {
  Scaling scaling{.id = "images",
                  .title = "Image sizes",
                  .x_name = "pixels [thousand]",
                  .note =
                      "The first frame of the first recording, larger or smaller by the nearest "
                      "pixel, its camera likewise; 2 cm voxels as ever. Whole frames: profile "
                      "and classifier, from depth to the planes of its pixels. One thread."};
  const planes::PipelineOptions refined = refined_of(subject, 1);
  planes::PipelineOptions paper = refined, growing = refined;
  paper.segment = planes::profile_options(planes::Profile::paper);
  growing.method = planes::Method::region_growing;
  for (const double scale : {0.25, 0.5, 1.0, 2.0}) {
    Frame frame = scaled_frame(subject.frames[0], scale);
    // Resolve once: estimation is a separate stage.
    const Gravity gravity = planes::resolve_gravity(subject.frames[0], refined.gravity);
    frame.gravity = gravity;
    const planes::Cloud cloud = planes::make_cloud(frame, gravity, refined.cloud);
    const double voxel_m = refined.cloud.voxel_size_m;
    const ScalingRuns runs = {
        {"cloud", [&] { planes::make_cloud(frame, gravity, refined.cloud); }},
        {"voxel grid", [&] { planes::voxelize(cloud, voxel_m); }},
        {"region growing", [&] { planes::run_frame(frame, growing, nullptr); }},
        {"paper, gcn", [&] { planes::run_frame(frame, paper, tools.gcn.get()); }},
        {"refined, gcn", [&] { planes::run_frame(frame, refined, tools.gcn.get()); }},
    };
    add_x(scaling, static_cast<double>(frame.depth.pixels()) / 1000, runs, tools.rounds, tools);
  }
  return fitted(std::move(scaling));
}

/// 1, 2, 4, ... and the maximum.
std::vector<int> thread_counts(int most) {
  std::vector<int> counts;
  for (int threads = 1; threads < most; threads *= 2) counts.push_back(threads);
  counts.push_back(most);
  return counts;
}

Scaling over_threads(const SpeedSubject& subject, const SpeedTools& tools) {
  Scaling scaling{.id = "threads",
                  .title = "Threads",
                  .x_name = "threads",
                  .note =
                      "Wall clock. Frames side by side: all frames of the first recording, "
                      "each on one thread, as the commands take them; else its first frame on "
                      "several. Ideal is an exponent of -1.",
                  .clock = Clock::wall};
  const Frame& frame = subject.frames[0];
  const planes::PipelineOptions one = refined_of(subject, 1);
  planes::PipelineOptions of_voxels = one;
  of_voxels.segment = planes::profile_options(planes::Profile::paper);
  const planes::PreparedFrame prepared = planes::prepare_frame(frame, of_voxels, tools.gcn.get());
  const std::vector<Vec3f>& points = prepared.voxels.points;
  for (const int threads : thread_counts(tools.threads)) {
    const planes::PipelineOptions several = refined_of(subject, threads);
    const auto side_by_side = [&] {
      work_through(static_cast<int>(subject.frames.size()), threads, [&](int i) {
        planes::run_frame(subject.frames[static_cast<std::size_t>(i)], one, tools.gcn.get());
      });
    };
    const ScalingRuns runs = {
        {"classifier gcn", [&] { tools.gcn->classify(points, threads); }},
        {"classifier pca", [&] { tools.pca->classify(points, threads); }},
        {"whole frame", [&] { planes::run_frame(frame, several, tools.gcn.get()); }},
        {"frames side by side", side_by_side},
    };
    add_x(scaling, threads, runs, tools.rounds, tools);
  }
  return fitted(std::move(scaling));
}

}  // namespace

std::vector<Scaling> measure_scaling(const SpeedSubject& subject, const SpeedTools& tools) {
  std::vector<Scaling> all = {over_points(tools), over_planes(tools), over_voxels(subject, tools)};
  if (!subject.frames[0].is_cloud()) all.push_back(over_images(subject, tools));
  all.push_back(over_threads(subject, tools));
  return all;
}

}  // namespace planescope::lab
