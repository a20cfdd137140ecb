#pragma once

// Explains decisions: every criterion as value, operator, threshold and margin, in evaluation
// order, and the criterion at which evaluation stopped.

#include <cstdint>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::debug {

enum class Verdict : std::uint8_t { pass, fail, not_evaluated };

/// One comparison. margin > 0: passes, with that share of the threshold to spare.
struct Check {
  std::string criterion = {};  // "Criterion 1", "join"
  std::string equation = {};   // "Eq. (2)", or "refined"
  std::string quantity = {};   // "N_out", "e_n", "|n1·n2|" (UTF-8)
  std::string meaning = {};    // one phrase
  std::string unit = {};       // "m²", "deg", ""
  std::string option = {};     // name of the option that sets the threshold; empty if derived from
                               // the measured noise
  double value = 0;
  std::string op = {};  // "≤", "≥"
  double threshold = 0;
  Verdict verdict = Verdict::not_evaluated;
  double margin = 0;
};

struct NodeReport {
  std::int32_t node = -1;
  std::vector<Check> checks;  // in evaluation order; not_evaluated if never computed
  std::string stopped;        // "stopped at Criterion 1: PCA was not computed" / "all passed"
  std::string outcome;        // "case III: divided into 5", "case IV: candidate merged into P3"
  std::vector<std::int32_t> outcome_steps;  // steps of the resulting found / merge / wait events
};
NodeReport explain_node(const Run& run, std::int32_t node);

/// A candidate compared with one plane of the list, at the time of the decision.
struct PartnerReport {
  std::int32_t plane = -1;
  std::vector<Check> checks;
  bool coplanar = false;
  bool chosen = false;
  bool not_evaluated = false;  // an earlier partner was accepted (merge_partner first)
  double cost = 0;             // used to choose the best partner
};
struct MergeReport {
  std::int32_t step = 0;
  std::int32_t node = -1;
  Label label = Label::unknown;
  std::uint32_t points = 0;
  PlaneFit candidate;
  std::vector<PartnerReport> partners;  // the chosen one first, then coplanar ones by cost, then
                                        // the nearest misses
  std::string outcome;                  // "merged into P3, 1.2 cm off it", "founded P9: no partner"
};
/// Explains a found or merge event, or a join by the objective. Empty for other events.
MergeReport explain_merge(const Run& run, std::int32_t step);

/// A leftover point compared with one plane.
struct LeftoverPlane {
  std::int32_t plane = -1;
  double distance_m = 0;
  double limit_m = 0;      // leftover_distance_m or tau
  bool considered = true;  // false: an earlier plane claimed the point
  bool chosen = false;
  std::string why_not;  // "too far", "an earlier plane took it"
};
struct LeftoverReport {
  std::int32_t step = 0;
  std::int32_t point = -1;
  std::vector<LeftoverPlane> planes;  // nearest first
  std::string outcome;
};
/// Explains an assign or drop event. Empty for other events.
LeftoverReport explain_leftover(const Run& run, std::int32_t step);

// Rows for the inspector, built in core/debug/explain.

// Add value, threshold and verdict to a check.
Check at_most(Check check, double value, double threshold);
Check at_least(Check check, double value, double threshold);
/// Marks a check as never computed: no value, no margin.
Check not_evaluated(Check check);
bool all_pass(const std::vector<Check>& checks);
/// Smallest margin of the checks: negative if one fails.
double least_margin(const std::vector<Check>& checks);

/// Criterion 3 according to the options: on e_n, or on the RMS. `criterion`: "Criterion 3" or
/// "By label".
Check planarity_check(const std::string& criterion,
                      const planes::SegmentOptions& options,
                      double value,
                      double threshold);
/// Criterion 4, Eq. (6).
std::vector<Check> coplanarity_checks(const planes::Coplanarity& terms,
                                      const planes::SegmentOptions& options);
/// Whether the event merges two regions, in stage `join` or `hidden`.
bool is_join(const planes::TraceEvent& event);
/// Cost of such a merge, compared with the cost of a plane.
Check join_check(const Run& run, const planes::TraceEvent& event);

std::string distance_text(double meters);  // for sentences: "4.2 mm", "12.3 cm"

}  // namespace planescope::debug
