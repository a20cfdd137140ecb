#pragma once

// What `planescope-lab bench outlines` tells.

#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/measure_outlines.hpp"

namespace planescope::lab {

inline constexpr double kLeastTrueM2 = 0.02;   // smaller true planes count for nothing
inline constexpr double kLeastKnownIou = 0.5;  // certainty: of planes that overlap the truth so far

struct OutlineResults {
  std::string command;  // that measures the same again, without folders and threads
  report::BuildInfo build;
  planes::WeightsRecord weights;
  double foot_radius_m = 0;
  struct OfSet {
    std::string set;
    std::uint64_t seed = 0;
    std::vector<OutlineFrameScore> frames;
  };
  std::vector<OfSet> sets;
};

struct OutlineSummary {
  std::string set;  // "all" of them
  int frames = 0;
  int planes = 0, found = 0;               // true ones of kLeastTrueM2 and more
  double drawn_median = 0, drawn_low = 0;  // of the same planes, from true pixels
  double iou_median = 0, iou_low = 0;      // of the found; the 5th percentile
  int known = 0;                           // planes of which certainty is judged
  std::array<double, 3> within = {};  // their share whose two tilts and offset are within 2 sigma
  double within_all = 0;              // of the three together
  FootScore foot;
};
/// Of each set over all seeds, and of all sets.
std::vector<OutlineSummary> outline_summaries(const OutlineResults& results);
std::vector<Table> outline_tables(const OutlineResults& results);
std::string outline_markdown(const OutlineResults& results);
/// schema "planescope.bench.outlines/1"
std::string outline_json(const OutlineResults& results);

}  // namespace planescope::lab
