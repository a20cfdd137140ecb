#include "core/explain/histogram.hpp"

#include <cmath>
#include <limits>

#include "core/explain/bins.hpp"
#include "core/replay/state_walk.hpp"
#include "core/segment/choices.hpp"

namespace planescope {
namespace {

constexpr double kVaries = std::numeric_limits<double>::quiet_NaN();
constexpr double kRoom = 4;  // axes end at this many thresholds: that is where decisions are near

Histogram describe(std::string quantity,
                   std::string title,
                   std::string unit,
                   std::string option,
                   double threshold) {
  Histogram h;
  h.quantity = std::move(quantity);
  h.title = std::move(title);
  h.unit = std::move(unit);
  h.option = std::move(option);
  h.threshold = threshold;
  return h;
}

/// Each decision against ground truth.
class Judge {
 public:
  explicit Judge(const Run& run) : wrong_(run.wrong) {}
  /// Of the event that led to the step.
  Judgement at(std::int32_t step) const {
    if (wrong_.empty() || step == kNever) return Judgement::unknown;
    return wrong_[static_cast<std::size_t>(step - 1)] ? Judgement::wrong : Judgement::right;
  }

 private:
  const std::vector<std::uint8_t>& wrong_;
};

/// The terms of nodes, each over the nodes where its criterion was asked.
void append_nodes(const Run& run, const Judge& judge, std::vector<Histogram>& histograms) {
  const SegmentOptions& options = run.segment_options;
  std::vector<Sample> n_out, r_out, n_in, e_n;
  for (std::size_t i = 0; i < run.facts.size(); ++i) {
    const NodeFacts& facts = run.facts[i];
    const Judgement judgement = judge.at(run.timeline.decided_at()[i]);
    n_out.push_back({static_cast<double>(facts.purity.n_out), judgement});
    r_out.push_back({facts.purity.r_out(), judgement});
    if (!is_pure(facts.purity, options)) continue;
    n_in.push_back({static_cast<double>(facts.purity.n_in), judgement});
    if (has_enough_inliers(facts.purity.n_in, options)) e_n.push_back({facts.e_n, judgement});
  }
  Histogram h = describe("n_out", "N_out", "points", "theta_n_out", options.theta_n_out);
  h.bins = linear_bins(n_out, std::max(24.0, kRoom * options.theta_n_out), true);
  histograms.push_back(h);
  h = describe("r_out", "r_out", "", "theta_r_out", options.theta_r_out);
  h.bins = linear_bins(r_out, 0.5, false);
  histograms.push_back(h);
  h = describe("n_in", "N_in", "points", "theta_n_in", options.theta_n_in);
  h.bins = linear_bins(n_in, std::max(24.0, kRoom * options.theta_n_in), true);
  histograms.push_back(h);

  if (options.noise.rms_criterion3)
    h = describe("rms", "RMS", "m", run.segmentation.noise.estimated ? "" : "fixed_rms_m",
                 run.segmentation.noise.by_range ? kVaries : run.segmentation.noise.theta_rms(1));
  else
    h = describe("mse", options.mse_normalization == MseNormalization::mean ? "e_n / N" : "e_n",
                 "m²", "theta_e_n_m2", options.theta_e_n_m2);
  h.logarithmic = !options.noise.rms_criterion3;
  h.bins = h.logarithmic ? logarithmic_bins(e_n) : linear_bins(e_n, 0.05, false);
  histograms.push_back(h);
}

/// The pairs of each candidate with the plane it joined or, where it founded one, with the plane
/// that it came nearest to joining.
struct MergeSamples {
  std::vector<Sample> offset, normals, n1_dmu, n2_dmu, angle;

  void add(const Pair& pair, Judgement judgement) {
    if (const auto* by_distance = std::get_if<DistanceTerms>(&pair.terms)) {
      offset.push_back({std::sqrt(by_distance->offset2_m2), judgement});
      angle.push_back({by_distance->angle_deg, judgement});
    } else {
      const auto& terms = std::get<Coplanarity>(pair.terms);
      offset.push_back({terms.offset_m, judgement});
      normals.push_back({terms.normals, judgement});
      n1_dmu.push_back({terms.n1_dmu, judgement});
      n2_dmu.push_back({terms.n2_dmu, judgement});
    }
  }
};

/// The pair to show for a candidate: with the plane it joined, or the one it came nearest to
/// joining.
std::optional<Pair> pair_of(const SegmentState& state,
                            const TraceEvent& event,
                            const Candidate& candidate) {
  const MeasuredPlane measured = state.measured(candidate);
  if (event.type == EventType::merge) return compare(state, event.plane, candidate, measured);
  std::optional<Pair> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k) {
    const std::optional<Pair> pair = compare(state, k, candidate, measured);
    if (!pair) continue;
    if (const double worst = strain_of(*pair, state.options).worst; worst < least) {
      least = worst;
      nearest = pair;
    }
  }
  return nearest;
}

void append_merges(const Run& run, const Judge& judge, std::vector<Histogram>& histograms) {
  const SegmentOptions& options = run.segment_options;
  MergeSamples samples;
  std::vector<Sample> distances;
  StateWalk walk(run);
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const TraceEvent& event = *run.event_at(step);
    const Judgement judgement = judge.at(step);
    if ((event.type == EventType::assign || event.type == EventType::drop) && event.value >= 0)
      distances.push_back({event.value, judgement});
    if (event.node < 0 || (event.type != EventType::found && event.type != EventType::merge))
      continue;
    const SegmentState& state = walk.advance_to(step - 1);
    Candidate candidate = fit_label(run.octree(), event.node, event.label, options.use_labels);
    candidate.sigma_ang = state.sigma_ang(candidate.fit);
    if (const auto pair = pair_of(state, event, candidate)) samples.add(*pair, judgement);
  }

  const auto append = [&](Histogram h, const std::vector<Sample>& values, double most) {
    h.bins = linear_bins(values, most, false);
    if (!h.bins.empty()) histograms.push_back(std::move(h));
  };
  append(describe("", "|n₁·n₂|", "", "theta_coplane", options.theta_coplane), samples.normals, 1);
  append(describe("", "|n₁·Δμ|/‖Δμ‖", "", "", 1 - options.theta_coplane), samples.n1_dmu, 1);
  append(describe("", "|n₂·Δμ|/‖Δμ‖", "", "", 1 - options.theta_coplane), samples.n2_dmu, 1);
  append(describe("", "angle", "deg", "", kVaries), samples.angle, 45);
  const bool limited = !options.r1_merge_by_distance.on && options.merge_offset_m > 0;
  append(describe("offset", "offset", "m", limited ? "merge_offset_m" : "",
                  limited ? options.merge_offset_m : kVaries),
         samples.offset, 0.2);
  const bool nearest = options.leftover_rule == LeftoverRule::nearest;
  append(describe("distance", "leftover's distance", "m", nearest ? "" : "leftover_distance_m",
                  nearest ? kVaries : options.leftover_distance_m),
         distances, 0.05);
}

}  // namespace

std::vector<Histogram> histograms_of(const Run& run) {
  const Judge judge(run);
  std::vector<Histogram> histograms;
  if (!run.is_ours()) return histograms;
  append_nodes(run, judge, histograms);
  append_merges(run, judge, histograms);
  return histograms;
}

}  // namespace planescope
