#pragma once

// Decisions against ground truth: the one rule that filters, histograms and colours share.

#include <cstdint>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Points of a second true plane, and more of them than Criterion 1 tolerates of a second label.
bool is_mixed_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options);

/// One true plane's, up to what Criterion 1 tolerates of others', and enough for Criterion 2.
bool is_pure_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options);

/// Per event, 1 where it is wrong:
///  - a node of mixed truth is settled as case IV, one pure in truth as I or III;
///  - a plane is founded for a true plane that another one stands for already;
///  - a candidate, or a leftover point, joins a plane that stands for another true plane;
///  - a point of a true plane is dropped.
/// A plane stands for the true plane that most of its points belong to. Empty without truth.
std::vector<std::uint8_t> wrong_decisions(const Run& run);

}  // namespace planescope::debug
