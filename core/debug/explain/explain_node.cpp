// Explains the case of a node by recomputing Sun et al. 2023, Sec. IV-B.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/debug/explain/explain.hpp"
#include "core/planes/segment/criteria.hpp"

namespace planescope::debug {
namespace {

Check answered(Check check, double value, const char* op, double threshold, double spare) {
  check.value = value;
  check.op = op;
  check.threshold = threshold;
  check.verdict = spare >= 0 ? Verdict::pass : Verdict::fail;
  check.margin = threshold != 0 ? spare / std::abs(threshold) : spare;
  return check;
}

constexpr const char* kByLabel = "By label";

Check enough_points(const std::string& criterion,
                    const planes::Purity& purity,
                    const planes::SegmentOptions& options) {
  return at_least(
      {criterion, "Eq. (3)", "N_in", "points of the majority label", "points", "theta_n_in"},
      purity.n_in, options.theta_n_in);
}

/// Not a comparison: shows the input of Criterion 3.
Check pca(const PlaneFit& fit) {
  Check check{"PCA", "Eq. (4)", "λ₀", "smallest eigenvalue of the inliers' scatter", "m²"};
  check.value = fit.eigenvalues[0];
  check.verdict = Verdict::pass;
  return check;
}

/// Appends the checks of a criterion; stops after the first criterion that fails.
class CheckList {
 public:
  explicit CheckList(std::vector<Check>& into) : into_(into) {}
  bool add(const std::vector<Check>& criterion) {
    for (const Check& check : criterion)
      into_.push_back(evaluating_ ? check : not_evaluated(check));
    evaluating_ = evaluating_ && all_pass(criterion);
    return evaluating_;
  }

 private:
  std::vector<Check>& into_;
  bool evaluating_ = true;
};

/// The objective evaluates Criteria 2 and 3 of an impure node again, for each label separately.
void check_by_label(const Run& run, std::int32_t node, std::vector<Check>& checks) {
  const planes::SegmentOptions& options = run.segment_options;
  const NodeFacts& facts = run.facts[node];
  const planes::Purity& purity = facts.purity;
  CheckList list(checks);
  list.add({enough_points(kByLabel, purity, options)});
  list.add({planarity_check(kByLabel, options, facts.e_n, facts.theta_e_n)});
  if (!planes::has_enough_inliers(purity.n_out, options)) return;  // too few to matter: left over
  const Label other = purity.inlier == Label::h ? Label::v : Label::h;
  const planes::Candidate outliers =
      planes::fit_label(run.octree(), node, other, options.use_labels);
  const planes::Planarity planar = planes::planarity(outliers.fit, run.segmentation.noise, options);
  Check check = planarity_check(kByLabel, options, planar.value, planar.threshold);
  check.quantity += " of the outliers";
  list.add({check});
}

/// Criteria 1-3 on a depth image, in evaluation order.
std::vector<Check> image_checks(const Run& run, std::int32_t index) {
  const planes::ObjectiveOptions& options = run.segment_options.objective;
  const planes::ImageTerms& terms = run.trace.image_terms[index];
  const planes::OctreeNode& node = run.octree().nodes[index];
  const auto answer = [](Check check, double value, double threshold) {
    if (value < 0) return not_evaluated(std::move(check));
    if (value >= planes::kNotFlat) value = std::numeric_limits<double>::infinity();
    return at_most(std::move(check), value, threshold);
  };
  std::vector<Check> checks;
  checks.push_back(at_least(
      {"Criterion 2", "Eq. (3)", "filled", "share of the cell's pixels in the node", "", "filled"},
      terms.filled, options.filled));
  if (node.decided == planes::Case::II) checks.back().verdict = Verdict::fail;  // or too few
  if (node.depth < run.octree().cube.max_depth)
    checks.push_back(answer({"Criterion 1", "Eq. (2)", "cost",
                             "of one plane for both halves of the cell, or of a cell within it; "
                             "infinite if one of these is not flat",
                             "", "two_planes"},
                            terms.two_planes, options.two_planes * options.merge_cost));
  checks.push_back(answer({"Criterion 3", "Eq. (5)", "variance",
                           "about the cell's plane, relative to the expected noise", "", "flat"},
                          terms.variance, options.flat));
  return checks;
}

std::string stopped_on_image(const NodeReport& report) {
  for (const Check& check : report.checks) {
    if (check.verdict != Verdict::fail) continue;
    const std::string consequence = check.option == "filled"       ? "too few of its pixels"
                                    : check.option == "two_planes" ? "more than one plane"
                                                                   : "not flat";
    return fmt::format("Stopped at {}: {}", check.criterion, consequence);
  }
  return "All passed: plane";
}

std::string stopped_at(const NodeReport& report) {
  for (const Check& check : report.checks) {
    if (check.verdict != Verdict::fail || check.criterion[0] != 'C') continue;
    const std::string consequence = check.criterion == "Criterion 3"
                                        ? "the inliers are not on one plane"
                                        : "PCA was not computed";
    return fmt::format("Stopped at {}: {}", check.criterion, consequence);
  }
  return "All passed: plane candidate";
}

/// "h created P9", for each candidate of the node.
std::string fate(const Run& run, const std::vector<std::int32_t>& steps) {
  std::string text;
  for (const std::int32_t step : steps) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (!text.empty()) text += ", ";
    if (run.octree().nodes[event.node].by_label) text += event.label == Label::v ? "v " : "h ";
    if (event.type == planes::EventType::found) text += "created " + plane_name(run, event.plane);
    if (event.type == planes::EventType::merge)
      text += "merged into " + plane_name(run, event.plane);
  }
  return text;
}

std::string outcome_of(const Run& run, std::int32_t index, const std::vector<std::int32_t>& steps) {
  const planes::OctreeNode& node = run.octree().nodes[index];
  const std::string name = fmt::format("case {}", planes::to_string(node.decided));
  if (node.by_label) return name + ", fitted label by label: " + fate(run, steps);
  if (node.decided == planes::Case::IV) {
    const std::uint32_t outliers = run.facts[index].purity.n_out;
    return name + ": candidate " + fate(run, steps) +
           (outliers > 0 ? fmt::format("; {} outliers unassigned", outliers) : "");
  }
  if (node.child_count > 0) return fmt::format("{}: divided into {}", name, node.child_count);
  return fmt::format("{}{}: {} points unassigned", name,
                     node.at_max_depth ? " at the deepest level" : "", node.size());
}

void append_outcome(const Run& run, NodeReport& report) {
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.node == report.node && event.type != planes::EventType::visit &&
        event.type != planes::EventType::decide)
      report.outcome_steps.push_back(step);
  }
  report.outcome = outcome_of(run, report.node, report.outcome_steps);
}

}  // namespace

Check at_most(Check check, double value, double threshold) {
  return answered(std::move(check), value, "≤", threshold, threshold - value);
}

Check at_least(Check check, double value, double threshold) {
  return answered(std::move(check), value, "≥", threshold, value - threshold);
}

Check not_evaluated(Check check) {
  check.value = std::numeric_limits<double>::quiet_NaN();
  check.verdict = Verdict::not_evaluated;
  check.margin = 0;
  return check;
}

bool all_pass(const std::vector<Check>& checks) {
  return std::ranges::all_of(
      checks, [](Verdict v) { return v == Verdict::pass; }, &Check::verdict);
}

double least_margin(const std::vector<Check>& checks) {
  double least = std::numeric_limits<double>::infinity();
  for (const Check& check : checks)
    if (check.verdict != Verdict::not_evaluated) least = std::min(least, check.margin);
  return least;
}

Check planarity_check(const std::string& criterion,
                      const planes::SegmentOptions& options,
                      double value,
                      double threshold) {
  if (options.by_objective())
    return at_most({criterion, "Eq. (5)", "RMS",
                    "root mean square distance of the inliers from their plane", "m"},
                   value, threshold);
  const bool mean = options.mse_normalization == planes::MseNormalization::mean;
  return at_most({criterion, "Eq. (5)", mean ? "e_n / N" : "e_n",
                  mean ? "mean square error along the normal"
                       : "square error along the normal, over all inliers",
                  "m²", "theta_e_n_m2"},
                 value, threshold);
}

std::vector<Check> coplanarity_checks(const planes::Coplanarity& terms,
                                      const planes::SegmentOptions& options) {
  const std::string name = "Criterion 4", source = "Eq. (6)", option = "theta_coplane";
  const double most = 1 - options.theta_coplane;
  std::vector<Check> checks{
      at_least({name, source, "|n₁·n₂|", "cosine between the normals", "", option}, terms.normals,
               options.theta_coplane),
      at_most({name, source, "|n₁·Δμ|/‖Δμ‖",
               "sine of the angle between plane and line of centroids", "", option},
              terms.n1_dmu, most)};
  if (options.criterion4_n2)
    checks.push_back(
        at_most({name, source, "|n₂·Δμ|/‖Δμ‖", "the same for the candidate", "", option},
                terms.n2_dmu, most));
  if (options.merge_offset_m > 0)
    checks.push_back(
        at_most({name, "paper-closest", "|n₁·Δμ|",
                 "distance of the candidate's centroid from the plane", "m", "merge_offset_m"},
                terms.offset_m, options.merge_offset_m));
  return checks;
}

std::string distance_text(double meters) {
  return meters < 0.01 ? fmt::format("{:.1f} mm", 1000 * meters)
                       : fmt::format("{:.1f} cm", 100 * meters);
}

NodeReport explain_node(const Run& run, std::int32_t node) {
  const planes::SegmentOptions& options = run.segment_options;
  const NodeFacts& facts = run.facts[node];
  NodeReport report;
  report.node = node;
  if (run.is_on_image()) {
    report.checks = image_checks(run, node);
    report.stopped = stopped_on_image(report);
    append_outcome(run, report);
    return report;
  }
  CheckList list(report.checks);
  const bool pure = list.add({at_most({"Criterion 1", "Eq. (2)", "N_out",
                                       "points of the minority label", "points", "theta_n_out"},
                                      facts.purity.n_out, options.theta_n_out),
                              at_most({"Criterion 1", "Eq. (2)", "r_out",
                                       "their share of the node's points", "", "theta_r_out"},
                                      facts.purity.r_out(), options.theta_r_out)});
  list.add({enough_points("Criterion 2", facts.purity, options)});
  list.add({pca(facts.fit)});
  list.add({planarity_check("Criterion 3", options, facts.e_n, facts.theta_e_n)});
  report.stopped = stopped_at(report);
  if (!pure && options.by_objective()) check_by_label(run, node, report.checks);
  append_outcome(run, report);
  return report;
}

}  // namespace planescope::debug
