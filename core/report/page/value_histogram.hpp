#pragma once

// How near to their thresholds a frame's decisions fell: counts that add up over frames.

#include <cstdint>
#include <string>
#include <vector>

#include "core/planes/segment/segment.hpp"

namespace planescope::report {

struct ValueHistogram {
  std::string name;  // "n_out", "planarity", "merge_angle", "merge_distance"
  double high = 0;   // the bins' end; they begin at 0
  double threshold = 0;
  /// Values of 0, then of each of the bins up to and with its upper edge, at last those above.
  std::vector<std::uint32_t> counts;

  double edge(std::size_t bin) const;  // upper one of counts[bin]
  std::uint64_t total() const;
  bool operator==(const ValueHistogram&) const = default;
};

/// N_out of the nodes visited, and values over their limits (Strains). Those of the same options
/// have the same bins. None where there is no octree.
std::vector<ValueHistogram> decision_histograms(const planes::Segmentation& segmentation,
                                                const planes::Strains& strains,
                                                const planes::SegmentOptions& options);

/// Adds counts; of other bins nothing.
void add_to(ValueHistogram& sum, const ValueHistogram& part);

/// "Outliers per node N_out", for people.
std::string title_of(const ValueHistogram& histogram);

}  // namespace planescope::report
