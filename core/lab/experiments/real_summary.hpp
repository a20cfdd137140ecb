#pragma once

// Results of `planescope bench real` summed up: what its tables print and real.json repeats.

#include <string>
#include <vector>

#include "core/lab/bench/statistics.hpp"
#include "core/lab/experiments/real_results.hpp"

namespace planescope::lab {

/// A method on the frames of one half.
struct HalfSummary {
  Half half = Half::tuning;
  CellKey method;
  int frames = 0;
  MeanAndDeviation mean_iou, pq;  // over frames
  planes::Metrics metrics;        // mean_of() the frames: its counts are sums
};
/// By half, then by method. Halves of which no frame was measured are left out.
std::vector<HalfSummary> half_summaries(const LabelledScores& scores);

/// A figure of a seed's frames, of which there are `frames`; `metrics` is their mean_of().
struct SeedFigure {
  const char* name;    // in real.json
  const char* column;  // of the tables
  int digits;
  bool more_is_better;
  double (*value)(const planes::Metrics& metrics, int frames);
};
const std::vector<SeedFigure>& seed_figures();

/// A figure over the seeds.
struct OverSeeds {
  MeanAndDeviation spread;
  double worst = 0;  // seed's value
};

/// A method on a depth set, or on all three.
struct SetSummary {
  std::string set;  // empty: all that were measured, each frame as much as any other
  std::string errors;
  CellKey method;
  int seeds = 0, frames = 0;       // of one seed
  std::vector<OverSeeds> figures;  // as seed_figures()
};
/// By set, with all of them last, by errors, then by method.
std::vector<SetSummary> set_summaries(const std::vector<SetScores>& sets);

/// A method on neighbouring frames of a recording.
struct RepeatSummary {
  CellKey method;
  int planes = 0, partners = 0;  // of all frames but the last
  // Medians over partners, 0 where there are none.
  double offset_jump_m = 0, normal_jump_deg = 0;
  // Means over frames.
  double floor_pieces = 0, floor_largest = 0, floor_missing = 0;
  int frames_of_one_floor = 0;  // whose floor's largest piece has at least kWholeFloor
};
inline constexpr double kWholeFloor = 97;  // %
std::vector<RepeatSummary> repeat_summaries(const RepeatScores& scores);

}  // namespace planescope::lab
