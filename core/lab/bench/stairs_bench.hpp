#pragma once

// How well stairs are found on synthetic depth frames whose stairs are known.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/lab/synthetic/seen_steps.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// What is asked of the figures of a flight.
inline constexpr double kRiseBarM = 0.005, kGoingBarM = 0.015;

struct StairsBenchOptions {
  std::uint64_t seed = 1;
  int count = 100;  // frames of each set
  planes::PipelineOptions pipeline;
};

struct StairsFrame {
  std::string name;
  // Steps in sequence that are seen: with kSeenPixels, kSurelySeenPixels, kBarelySeenPixels.
  int seen = 0, seen_least = 0, seen_most = 0;
  int found = 0;                               // steps of the flight that has most
  int flights = 0;                             // found
  double rise_error_m = 0, going_error_m = 0;  // of that flight; NaN without one
  double true_rise_m = 0, true_going_m = 0;
  bool has_stairs = false;  // at least two steps are seen for certain: there is a flight to find
  bool right() const {
    const int least = seen_least < 2 ? 0 : seen_least, most = seen_most < 2 ? 0 : seen_most;
    return found >= least && found <= most;
  }
};

struct StairsOfSet {
  std::string set;
  std::vector<StairsFrame> frames;
};

/// Frames of depth_stairs, depth_descent, depth_boxes with the D435's errors. The same for any
/// number of threads. `progress(done, all)` may be empty and may throw to stop.
std::vector<StairsOfSet> measure_stairs(const StairsBenchOptions& options,
                                        const planes::Classifier& classifier,
                                        const std::function<void(int, int)>& progress = {});

std::vector<Table> stairs_tables(const std::vector<StairsOfSet>& sets);

struct StairsRun {
  std::string command;
  StairsBenchOptions options;
  planes::WeightsRecord weights;
  std::vector<StairsOfSet> sets;
};
/// schema "planescope.bench.stairs/1".
std::string stairs_bench_json(const StairsRun& run);

}  // namespace planescope::lab
