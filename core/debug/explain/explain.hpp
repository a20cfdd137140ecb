#pragma once

// Why a decision fell as it did: every criterion as value, operator, threshold and margin, in the
// order in which it was asked, and where asking stopped.

#include <cstdint>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/options.hpp"

namespace planescope::debug {

enum class Verdict : std::uint8_t { pass, fail, not_asked };

/// One comparison: first what is asked, then the answer. margin > 0: passes with that share of
/// the threshold to spare.
struct Check {
  std::string criterion = {};  // "Criterion 1", "join"
  std::string equation = {};   // "Eq. (2)", or "refined"
  std::string quantity = {};   // "N_out", "e_n", "|n1·n2|" (UTF-8)
  std::string meaning = {};    // one phrase
  std::string unit = {};       // "m²", "deg", ""
  std::string option = {};     // name of the option that is the threshold; empty where it follows
                               // from the measured noise
  double value = 0;
  std::string op = {};  // "≤", "≥"
  double threshold = 0;
  Verdict verdict = Verdict::not_asked;
  double margin = 0;
};

struct NodeReport {
  std::int32_t node = -1;
  std::vector<Check> checks;  // in the order asked; what was never computed is not_asked
  std::string stopped;        // "stopped at Criterion 1: no PCA was made" / "all passed"
  std::string outcome;        // "case III: divided into 5", "case IV: candidate merged into P3"
  std::vector<std::int32_t> outcome_steps;  // steps of found / merge / wait events that followed
};
NodeReport explain_node(const Run& run, std::int32_t node);

/// A candidate against one plane of the list as it was when the candidate came.
struct PartnerReport {
  std::int32_t plane = -1;
  std::vector<Check> checks;
  bool coplanar = false;
  bool chosen = false;
  bool never_asked = false;  // a partner had been found before (merge_partner first)
  double cost = 0;           // by which the best was chosen
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
/// Explains a found or merge event, or a join by the objective; for other events the report is
/// empty.
MergeReport explain_merge(const Run& run, std::int32_t step);

/// A leftover point against every plane that was considered for it.
struct LeftoverPlane {
  std::int32_t plane = -1;
  double distance_m = 0;
  double limit_m = 0;      // leftover_distance_m or tau
  bool considered = true;  // false: an earlier one took the point
  bool chosen = false;
  std::string why_not;  // "too far", "an earlier plane took it"
};
struct LeftoverReport {
  std::int32_t step = 0;
  std::int32_t point = -1;
  std::vector<LeftoverPlane> planes;  // nearest first
  std::string outcome;
};
/// Of an assign or drop event; an empty report for others.
LeftoverReport explain_leftover(const Run& run, std::int32_t step);

// The rows that core/debug/explain makes for the inspector.

// These add the answer to a check that says what is asked.
Check at_most(Check check, double value, double threshold);
Check at_least(Check check, double value, double threshold);
/// What was never computed: no value, no margin.
Check not_asked(Check check);
bool all_pass(const std::vector<Check>& checks);
/// The margin of the check that passes by least, or fails by most.
double least_margin(const std::vector<Check>& checks);

/// Criterion 3 as the options have it: of e_n, or of the RMS. `criterion`: "Criterion 3" or "By
/// label".
Check planarity_check(const std::string& criterion,
                      const planes::SegmentOptions& options,
                      double value,
                      double threshold);
/// Criterion 4, Eq. (6).
std::vector<Check> coplanarity_checks(const planes::Coplanarity& terms,
                                      const planes::SegmentOptions& options);
/// Two regions become one, as stage `join` or `hidden`.
bool is_join(const planes::TraceEvent& event);
/// The cost of such a join against what a plane costs.
Check join_check(const Run& run, const planes::TraceEvent& event);

std::string distance_text(double metres);  // for sentences: "4.2 mm", "12.3 cm"

}  // namespace planescope::debug
