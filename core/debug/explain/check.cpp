#include "core/debug/explain/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace

Check at_most(Check check, double value, double threshold) {
  return answered(std::move(check), value, "≤", threshold, threshold - value);
}

Check at_least(Check check, double value, double threshold) {
  return answered(std::move(check), value, "≥", threshold, value - threshold);
}

Check not_asked(Check check) {
  check.value = std::numeric_limits<double>::quiet_NaN();
  check.verdict = Verdict::not_asked;
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
    if (check.verdict != Verdict::not_asked) least = std::min(least, check.margin);
  return least;
}

Check planarity_check(const std::string& criterion,
                      const planes::SegmentOptions& options,
                      double value,
                      double threshold) {
  if (options.noise.rms_criterion3)
    return at_most(
        {criterion, "Eq. (5)", "RMS", "root mean square distance of the inliers from their plane",
         "m", options.noise.estimate_sigma ? "" : "fixed_rms_m"},
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
               "sine of the direction between the centroids, out of the plane", "", option},
              terms.n1_dmu, most)};
  if (options.criterion4_n2)
    checks.push_back(
        at_most({name, source, "|n₂·Δμ|/‖Δμ‖", "the same out of the candidate", "", option},
                terms.n2_dmu, most));
  if (options.merge_offset_m > 0)
    checks.push_back(
        at_most({name, "paper-closest", "|n₁·Δμ|",
                 "distance of the candidate's centroid from the plane", "m", "merge_offset_m"},
                terms.offset_m, options.merge_offset_m));
  return checks;
}

std::vector<Check> distance_checks(const planes::DistanceTerms& terms) {
  std::vector<Check> checks;
  const auto ask = [&](const char* quantity, const char* meaning, const char* unit, double value,
                       double most) {
    checks.push_back(at_most({"R1", "refined", quantity, meaning, unit}, value, most));
  };
  if (!terms.any_angle)
    ask("angle", "between the normals; more where they are not sure", "deg", terms.angle_deg,
        terms.max_angle_deg);
  ask("gap", "between the regions' boxes; as far as the normals can be trusted", "m", terms.gap_m,
      terms.max_gap_m);
  // Both below are squares in the rule; their roots are what one can picture.
  const double bound = std::sqrt(terms.bound2_m2);
  ask("offset", "distance of the less sure one's centroid from the surer plane", "m",
      std::sqrt(terms.offset2_m2), bound);
  ask("spread", "RMS of the less sure one's points across the surer plane", "m",
      std::sqrt(std::max(0.0, terms.spread2_m2)), bound);
  return checks;
}

std::string distance_text(double metres) {
  return metres < 0.01 ? fmt::format("{:.1f} mm", 1000 * metres)
                       : fmt::format("{:.1f} cm", 100 * metres);
}

}  // namespace planescope::debug
