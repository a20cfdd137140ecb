#pragma once

// Rows of the inspector. Internal to core/debug/explain.

#include <string>
#include <vector>

#include "core/debug/explain/explain.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::debug {

// The answer to a check that says what is asked.
Check at_most(Check check, double value, double threshold);
Check at_least(Check check, double value, double threshold);
/// What was never computed: no value, no margin.
Check not_asked(Check check);
bool all_pass(const std::vector<Check>& checks);
/// The margin of the check that passes by least, or fails by most.
double least_margin(const std::vector<Check>& checks);

/// Criterion 3 as the options have it: of e_n, or of the RMS. `criterion`: "Criterion 3" or "R4".
Check planarity_check(const std::string& criterion,
                      const planes::SegmentOptions& options,
                      double value,
                      double threshold);
/// Criterion 4, Eq. (6).
std::vector<Check> coplanarity_checks(const planes::Coplanarity& terms,
                                      const planes::SegmentOptions& options);
/// R1, which measures distances instead.
std::vector<Check> distance_checks(const planes::DistanceTerms& terms);

std::string distance_text(double metres);  // for sentences: "4.2 mm", "12.3 cm"

}  // namespace planescope::debug
