// Scores methods on real labeled frames, depth sets and neighboring frames, pixel by pixel.

#include "core/lab/experiments/measure_real.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/lab/rivals/rivals.hpp"
#include "core/model/error.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {
namespace {

/// Ours in these profiles, refined without each term of its objective, and all rivals.
std::vector<CellKey> methods_with(const std::vector<std::string>& profiles) {
  std::vector<CellKey> methods;
  for (const std::string& profile : profiles) methods.push_back(with_ours({}, profile, "gcn"));
  for (const CellKey& key : ablations({}, true)) methods.push_back(key);
  for (const std::string& rival : rival_names(/*images=*/true))
    methods.push_back(with_rival({}, rival));
  return methods;
}

std::vector<planes::Metrics> score_by_pixel(const EvaluationFrame& frame,
                                            std::span<const CellKey> methods,
                                            const Labellers& labellers,
                                            std::optional<double> max_range_m,
                                            const planes::LeastTruePlane& least) {
  const planes::SourceTruth truth = truth_of(frame);
  Contest contest(frame.frame, labellers, &truth, max_range_m);
  std::vector<planes::Metrics> scores;
  for (const CellKey& method : methods)
    scores.push_back(planes::score_frame(contest.run(method), truth, least));
  return scores;
}

std::vector<MethodScores> with_names(const std::vector<CellKey>& methods,
                                     std::vector<std::vector<planes::Metrics>> scores) {
  std::vector<MethodScores> named;
  for (std::size_t m = 0; m < methods.size(); ++m)
    named.push_back({methods[m], std::move(scores[m])});
  return named;
}

/// A method's result for a frame of a recording.
struct Seen {
  PixelPlanes planes;
  FloorPieces floor;
};

}  // namespace

std::vector<CellKey> real_methods() { return methods_with({"refined", "paper", "paper-closest"}); }

EvaluationFrame read_listed(const ListedFrame& listed,
                            const std::filesystem::path& data,
                            const std::filesystem::path& labels) {
  const LabeledName& name = listed.name;
  const auto recording = io::open_recording(data / name.recording, listed.reading.recording);
  if (name.frame >= recording->frame_count())
    throw Error(fmt::format("{}: {} is frame {}, but the recording has {}",
                            (data / name.recording).string(), name.name, name.frame,
                            counted(recording->frame_count(), "frame")));
  EvaluationFrame out;
  out.name = name.name;
  out.frame = recording->frame(name.frame);
  out.frame.gravity = planes::resolve_gravity(out.frame, listed.reading.gravity);
  const std::filesystem::path dir = labels / name.name;
  out.labels = labels::read_frame_labels(dir, name.frame, recording->frame_hash(name.frame));
  if (!out.labels)
    throw Error(fmt::format("{}: no labels for frame {}; expected {:06}.json", dir.string(),
                            name.frame, name.frame));
  return out;
}

std::vector<MethodScores> measure_labeled(std::span<const ListedFrame> listed,
                                          std::span<const EvaluationFrame> frames,
                                          const CellTools& tools,
                                          const std::function<void(int, int)>& progress) {
  const std::vector<CellKey> methods = real_methods();
  const auto measure = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    return score_by_pixel(frames[k], methods, tools, listed[k].reading.max_range_m,
                          {.points = kLeastTruePixels});
  };
  return with_names(methods,
                    of_methods<planes::Metrics>(methods.size(), static_cast<int>(frames.size()),
                                                tools.threads, measure, progress));
}

std::vector<MethodScores> measure_set(const CellKey& set,
                                      int count,
                                      const CellTools& tools,
                                      const std::function<void(int, int)>& progress) {
  const std::vector<CellKey> methods = methods_with({"refined"});
  const int frames = planned_frames({.count = count}, set.set);
  const auto measure = [&](int i) {
    return score_by_pixel(cell_frame(set, i, tools), methods, tools, {},
                          {.voxels = kMinTruthVoxels});
  };
  return with_names(methods, of_methods<planes::Metrics>(methods.size(), frames, tools.threads,
                                                         measure, progress));
}

std::vector<RepeatScores> measure_repeat(const io::Recording& recording,
                                         const Reading& reading,
                                         std::span<const CellKey> methods,
                                         int count,
                                         int step,
                                         const CellTools& tools,
                                         const std::function<void(int, int)>& progress) {
  int frames = recording.frame_count();
  if (count > 0) frames = std::min(frames, count);
  const auto measure = [&](int i) {
    Frame frame = recording.frame(i);
    frame.gravity = planes::resolve_gravity(frame, reading.gravity);
    Contest contest(frame, tools, nullptr, reading.max_range_m);
    const std::vector<std::uint8_t> floor = floor_pixels(contest.prepared("gcn", methods[0]));
    std::vector<Seen> seen;
    for (const CellKey& method : methods) {
      Seen& by_method = seen.emplace_back(Seen{pixel_planes(contest.run(method)), {}});
      by_method.floor = floor_pieces(floor, by_method.planes);
    }
    return seen;
  };
  const auto seen = of_methods<Seen>(methods.size(), frames, tools.threads, measure, progress);
  std::vector<RepeatScores> result;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    RepeatScores& scores = result.emplace_back();
    scores.method = methods[m];
    for (std::size_t i = 0; i + step < seen[m].size(); ++i)
      scores.neighbors.push_back(compare_neighbors(seen[m][i].planes, seen[m][i + step].planes));
    for (const Seen& frame : seen[m]) scores.floor.push_back(frame.floor);
  }
  return result;
}

// ---- From frame to frame ----

namespace {

constexpr double kNearM = 0.03;        // at least
constexpr double kNearPerM2 = 0.01;    // [1/m], times the square of the depth
constexpr double kHeightStepM = 0.01;  // of the histogram of heights
constexpr int kFits = 5;

/// The height [m] below the sensor with the most points within 3 cm. NaN: no points.
double most_common_height(const planes::Cloud& cloud) {
  std::vector<int> bins;  // downwards from the sensor
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double below = -static_cast<double>(cloud.points[i].z());
    if (!cloud.kept[i] || below <= 0) continue;
    const auto bin = static_cast<std::size_t>(below / kHeightStepM);
    if (bin >= bins.size()) bins.resize(bin + 1, 0);
    ++bins[bin];
  }
  const int last = static_cast<int>(bins.size()) - 1;
  const int reach = static_cast<int>(std::lround(kNearM / kHeightStepM));
  int best = -1, most = 0;
  for (int b = 0; b <= last; ++b) {
    int sum = 0;
    for (int near = std::max(0, b - reach); near <= std::min(last, b + reach); ++near)
      sum += bins[static_cast<std::size_t>(near)];
    if (sum > most) {
      most = sum;
      best = b;
    }
  }
  return best < 0 ? std::nan("") : -(best + 0.5) * kHeightStepM;
}

/// The angle between two planes of a frame [rad], and its variance.
struct Between {
  double angle = 0, variance = 0;
};

Between between(const PixelPlanes& frame, int a, int b) {
  const Vec3d& normal_a = frame.fits[a - 1].normal;
  const Vec3d& normal_b = frame.fits[b - 1].normal;
  const double cosine = std::min(1.0, std::abs(normal_a.dot(normal_b)));
  double variance = 0;  // of the cosine
  const auto add = [&](const planes::Certainty& certainty, const Vec3d& other) {
    for (int k = 0; k < 2; ++k)
      variance += std::pow(certainty.sigma_tilt_rad[k] * certainty.axes[k].dot(other), 2);
  };
  add(frame.certainties[a - 1], normal_b);
  add(frame.certainties[b - 1], normal_a);
  return {std::acos(cosine), variance / (1 - cosine * cosine)};
}

double near_m(double depth_m) { return std::max(kNearM, kNearPerM2 * depth_m * depth_m); }

}  // namespace

PixelPlanes pixel_planes(const planes::FrameResult& result) {
  PixelPlanes planes;
  planes.plane_of.assign(result.cloud.counts.pixels, 0);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    planes.plane_of[result.cloud.source[i]] = result.plane_of[i];
  for (const planes::PlaneRegion& plane : result.segmentation.planes)
    planes.fits.push_back(plane.fit);
  planes.certainties = planes::certainties_of(result);
  return planes;
}

Neighbors compare_neighbors(const PixelPlanes& first, const PixelPlanes& next) {
  assert(first.plane_of.size() == next.plane_of.size());
  const planes::TruthOverlap overlap = planes::count_truth_overlap(first.plane_of, next.plane_of);
  const std::vector<int> match = planes::found_of_truth(overlap);
  Neighbors result;
  std::vector<std::pair<int, int>> partners;
  for (int plane = 1; plane <= overlap.truth; ++plane) {
    if (overlap.truth_size[plane] < kLeastRepeatPixels) continue;
    ++result.planes;
    const int partner = match[plane - 1];
    if (partner == 0 || overlap.iou(plane, partner) < kPartnerIou) continue;
    ++result.partners;
    partners.emplace_back(plane, partner);
    const PlaneFit& a = first.fits[plane - 1];
    const PlaneFit& b = next.fits[partner - 1];
    const double cosine = a.normal.dot(b.normal), sign = cosine < 0 ? -1 : 1;
    result.offset_jumps_m.push_back(std::abs(a.offset_m() - sign * b.offset_m()));
    result.normal_jumps_deg.push_back(planes::plane_angle_deg(a.normal, b.normal));
  }
  constexpr double kLeastAngle = std::numbers::pi / 3;
  for (std::size_t i = 0; i < partners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Between then = between(first, partners[i].first, partners[j].first);
      if (then.angle < kLeastAngle) continue;
      const Between now = between(next, partners[i].second, partners[j].second);
      result.angle_jumps_sigmas.push_back((now.angle - then.angle) /
                                          std::sqrt(now.variance + then.variance));
    }
  return result;
}

std::vector<std::uint8_t> floor_pixels(const planes::PreparedFrame& frame) {
  const planes::Cloud& cloud = frame.cloud;
  std::vector<std::uint8_t> floor(cloud.counts.pixels, 0);
  PlaneFit plane;  // level, through its centroid
  plane.centroid.z() = most_common_height(cloud);
  if (std::isnan(plane.centroid.z())) return floor;
  const Vec3d forward = cloud.T_world_sensor.linear().col(2);
  const auto is_near = [&](std::size_t i) {
    const Vec3d p = cloud.points[i].cast<double>();
    return cloud.kept[i] && std::abs(plane.distance_m(p)) <= near_m(forward.dot(p));
  };
  for (int fit = 0; fit < kFits; ++fit) {
    Moments moments;
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
      if (is_near(i)) moments.add(cloud.points[i].cast<double>());
    plane = fit_plane(moments);
  }
  for (std::size_t i = 0; i < cloud.points.size(); ++i) floor[cloud.source[i]] = is_near(i);
  return floor;
}

FloorPieces floor_pieces(std::span<const std::uint8_t> floor, const PixelPlanes& found) {
  const std::size_t planes = found.fits.size();
  std::vector<std::uint64_t> all(planes + 1, 0), on_floor(planes + 1, 0);
  for (std::size_t i = 0; i < floor.size(); ++i) {
    ++all[found.plane_of[i]];
    on_floor[found.plane_of[i]] += floor[i];
  }
  FloorPieces result;
  for (const std::uint64_t pixels : on_floor) result.pixels += pixels;
  std::uint64_t largest = 0;
  for (std::size_t p = 1; p <= planes; ++p) {
    if (on_floor[p] < kLeastRepeatPixels || 2 * on_floor[p] < all[p]) continue;
    ++result.pieces;
    largest = std::max(largest, on_floor[p]);
  }
  const auto percent = [](std::uint64_t part, std::uint64_t whole) {
    return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 0;
  };
  result.largest = percent(largest, result.pixels - on_floor[0]);
  result.missing = percent(on_floor[0], result.pixels);
  return result;
}

}  // namespace planescope::lab
