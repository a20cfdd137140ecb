#pragma once

// Visibility of the stairs in a synthetic depth frame, and quality of their detection.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/model/json_fields.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// A step is visible if the tread behind its nosing has this many measured pixels, and so does the
/// level before it within one going of the nosing, at the same width.
inline constexpr int kSeenPixels = 500;
/// Above the first limit a step is certainly visible; below the second it is certainly not.
inline constexpr int kSurelySeenPixels = 1000, kBarelySeenPixels = 100;

struct SeenStep {
  int tread_px = 0, before_px = 0;
  int least_px() const { return tread_px < before_px ? tread_px : before_px; }
};

/// Measured pixels of each step of the frame's stairs, within a range.
std::vector<SeenStep> seen_steps(const EvaluationFrame& frame, double max_range_m);

/// The longest sequence of steps with at least `least_px` on both sides.
int steps_in_sequence(const std::vector<SeenStep>& seen, int least_px);

/// The stairs of a set's frame, for JSON.
struct FrameStairs {
  std::string frame;
  TrueStairs stairs;
  std::vector<SeenStep> seen;  // within max_range_m of depth
};
/// schema "planescope.true_stairs/1".
std::string true_stairs_json(const std::string& set,
                             const std::vector<FrameStairs>& frames,
                             double max_range_m);

struct StairsBenchOptions {
  std::uint64_t seed = 1;
  int count = 100;  // frames of each set
  planes::PipelineOptions pipeline;
};

struct StairsFrame {
  std::string name;
  // Visible steps in sequence: with kSeenPixels, kSurelySeenPixels, kBarelySeenPixels.
  int seen = 0, seen_least = 0, seen_most = 0;
  int found = 0;                               // steps of the longest flight
  int flights = 0;                             // found
  double rise_error_m = 0, going_error_m = 0;  // of that flight; NaN without one
  double true_rise_m = 0, true_going_m = 0;
  bool has_stairs = false;  // at least two steps are certainly visible: a flight can be found
  bool right() const {
    const int least = seen_least < 2 ? 0 : seen_least, most = seen_most < 2 ? 0 : seen_most;
    return found >= least && found <= most;
  }
};
void visit_fields(auto& fields, Same<StairsFrame> auto& frame) {
  fields("frame", frame.name);
  fields("seen", frame.seen);
  fields("seen_least", frame.seen_least);
  fields("seen_most", frame.seen_most);
  fields("found", frame.found);
  fields("flights", frame.flights);
  fields("rise_error_m", frame.rise_error_m);
  fields("going_error_m", frame.going_error_m);
  fields("rise_m", frame.true_rise_m);
  fields("going_m", frame.true_going_m);
  fields("has_stairs", frame.has_stairs);
  fields("right", frame.right());
}

struct StairsOfSet {
  std::string set;
  std::vector<StairsFrame> frames;
};

/// Frames of depth_stairs, depth_descent, depth_boxes with the D435's errors. Independent of the
/// number of threads. `progress(done, all)` may be empty and may throw to stop.
std::vector<StairsOfSet> measure_stairs(const StairsBenchOptions& options,
                                        const planes::Classifier& classifier,
                                        const std::function<void(int, int)>& progress = {});

}  // namespace planescope::lab
