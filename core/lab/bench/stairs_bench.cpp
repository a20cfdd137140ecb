// Stairs benchmark: detected flights and steps against synthetic truth.

#include "core/lab/bench/stairs_bench.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/model/parallel.hpp"
#include "core/planes/cloud/camera.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::lab {

// ---- Visible part of a frame's stairs ----

namespace {

/// Location of the ground before a nosing.
struct Before {
  Vec3d middle, uphill, across;
  double going_m = 0, half_width_m = 0;

  Before(const TrueStep& step, double going, const Vec3d& up)
      : middle((step.right + step.left) / 2),
        across((step.left - step.right).normalized()),
        going_m(going),
        half_width_m((step.left - step.right).norm() / 2) {
    uphill = across.cross(up);
  }
  bool has(const Vec3d& p) const {
    const double along = uphill.dot(p - middle);
    return along <= 0 && along >= -going_m && std::abs(across.dot(p - middle)) <= half_width_m;
  }
};

}  // namespace

std::vector<SeenStep> seen_steps(const EvaluationFrame& frame, double max_range_m) {
  assert(frame.stairs && frame.labels);
  const TrueStairs& stairs = *frame.stairs;
  const Frame& depth = frame.frame;
  const std::vector<Vec2d> rays = planes::rays_of_pixels(depth.intrinsics);
  std::vector<SeenStep> seen(stairs.steps.size());
  std::vector<Before> before;
  for (const TrueStep& step : stairs.steps)
    before.emplace_back(step, stairs.going_m, -depth.gravity->direction);
  for (std::size_t i = 0; i < depth.depth.data.size(); ++i) {
    const double z = depth.depth.data[i] * depth.depth_unit_m;
    if (z <= 0 || z > max_range_m) continue;
    const int plane = frame.labels->plane.data[i];
    const Vec3d p = z * Vec3d(rays[i].x(), rays[i].y(), 1);
    for (std::size_t s = 0; s < seen.size(); ++s) {
      if (stairs.steps[s].tread == plane) ++seen[s].tread_px;
      if (stairs.steps[s].before == plane && before[s].has(p)) ++seen[s].before_px;
    }
  }
  return seen;
}

int steps_in_sequence(const std::vector<SeenStep>& seen, int least_px) {
  int most = 0, now = 0;
  for (const SeenStep& step : seen) {
    now = step.least_px() >= least_px ? now + 1 : 0;
    most = std::max(most, now);
  }
  return most;
}

std::string true_stairs_json(const std::string& set,
                             const std::vector<FrameStairs>& frames,
                             double max_range_m) {
  using Json = nlohmann::ordered_json;
  Json json = {{"schema", "planescope.true_stairs/1"},
               {"set", set},
               {"max_range_m", max_range_m},
               {"least_px", kSeenPixels},
               {"frames", Json::array()}};
  for (const FrameStairs& found : frames) {
    Json frame = {{"frame", found.frame},
                  {"direction", found.stairs.seen_from_above ? "down" : "up"},
                  {"count", found.stairs.steps.size()},
                  {"seen", steps_in_sequence(found.seen, kSeenPixels)},
                  {"rise_m", found.stairs.rise_m},
                  {"going_m", found.stairs.going_m},
                  {"width_m", found.stairs.width_m},
                  {"steps", Json::array()}};
    for (std::size_t s = 0; s < found.seen.size(); ++s)
      frame["steps"].push_back({{"before", found.stairs.steps[s].before},
                                {"tread", found.stairs.steps[s].tread},
                                {"before_px", found.seen[s].before_px},
                                {"tread_px", found.seen[s].tread_px}});
    json["frames"].push_back(std::move(frame));
  }
  return json.dump(1) + "\n";
}

// ---- Detection ----

namespace {

constexpr const char* kStairsSets[] = {"depth_stairs", "depth_descent", "depth_boxes"};

StairsFrame measure_frame(const EvaluationFrame& made,
                          const planes::PipelineOptions& options,
                          const planes::Classifier& classifier) {
  StairsFrame row;
  row.name = made.name;
  row.rise_error_m = row.going_error_m = std::numeric_limits<double>::quiet_NaN();
  if (made.stairs) {
    const std::vector<SeenStep> seen = seen_steps(made, options.cloud.max_range_m);
    row.seen = steps_in_sequence(seen, kSeenPixels);
    row.seen_least = steps_in_sequence(seen, kSurelySeenPixels);
    row.seen_most = steps_in_sequence(seen, kBarelySeenPixels);
    row.has_stairs = row.seen_least >= 2;
    row.true_rise_m = made.stairs->rise_m;
    row.true_going_m = made.stairs->going_m;
  }
  const planes::Stairs found = planes::analyze(made.frame, options, &classifier).found.stairs;
  row.flights = static_cast<int>(found.flights.size());
  if (found.flights.empty()) return row;
  const planes::Flight& flight = found.flights.front();
  row.found = static_cast<int>(flight.steps.size());
  if (made.stairs) {
    row.rise_error_m = flight.rise_m - made.stairs->rise_m;
    row.going_error_m = flight.going_m - made.stairs->going_m;
  }
  return row;
}

}  // namespace

std::vector<StairsOfSet> measure_stairs(const StairsBenchOptions& options,
                                        const planes::Classifier& classifier,
                                        const std::function<void(int, int)>& progress) {
  std::vector<StairsOfSet> sets;
  for (const char* name : kStairsSets)
    sets.push_back({name, std::vector<StairsFrame>(static_cast<std::size_t>(options.count))});
  planes::PipelineOptions pipeline = options.pipeline;
  pipeline.threads = 1;
  const EvaluationOptions frames{.seed = options.seed, .errors = DepthErrors::d435};
  const auto measure = [&](int i) {
    StairsOfSet& set = sets[static_cast<std::size_t>(i / options.count)];
    const int index = i % options.count;
    set.frames[static_cast<std::size_t>(index)] = measure_frame(
        make_evaluation_frame(find_evaluation_set(set.set), index, frames), pipeline, classifier);
  };
  work_through(options.count * static_cast<int>(sets.size()), options.pipeline.threads, measure,
               progress);
  return sets;
}

}  // namespace planescope::lab
