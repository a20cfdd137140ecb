// Histograms of the values tested by each criterion, split by whether the decision was right.

#include "core/debug/explain/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/debug/replay/steps.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::debug {
namespace {

constexpr double kVaries = std::numeric_limits<double>::quiet_NaN();
constexpr double kRoom = 4;  // axes end at this multiple of the threshold: decisions beyond it are
                             // not close
constexpr int kBins = 24;
constexpr int kDecades = 8;

using Outcome = std::uint32_t HistogramBin::*;  // counter for the evaluation against ground truth

struct Sample {
  double value = 0;
  Outcome outcome = &HistogramBin::unknown;
};
using Samples = std::vector<Sample>;

/// Evaluation of the event that led to the step.
Outcome outcome_at(const Run& run, std::int32_t step) {
  if (run.wrong.empty() || step == planes::kNever) return &HistogramBin::unknown;
  return run.wrong[static_cast<std::size_t>(step - 1)] ? &HistogramBin::wrong
                                                       : &HistogramBin::right;
}

/// 1, 2, 2.5 or 5 times a power of ten, not below `value`.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 2.5, 5.0})
    if (step * power >= value * (1 - 1e-9)) return step * power;
  return 10 * power;
}

/// Fills bins between the edges; the first and last bins include values outside.
std::vector<HistogramBin> fill(const std::vector<double>& edges, const Samples& samples) {
  std::vector<HistogramBin> bins;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) bins.push_back({edges[i], edges[i + 1]});
  for (const Sample& sample : samples) {
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, sample.value);
    ++(bins[static_cast<std::size_t>(above - edges.begin() - 1)].*sample.outcome);
    bins.back().high = std::max(bins.back().high, sample.value);
  }
  return bins;
}

/// About 24 bins of a round width, starting at 0 if the values come near it. The last bin includes
/// values beyond `most`.
std::vector<HistogramBin> linear_bins(const Samples& samples, double most, bool whole = false) {
  if (samples.empty()) return {};
  const auto [low, high] = std::ranges::minmax(samples, {}, &Sample::value);
  const double largest = std::clamp(high.value, 0.0, most);
  double smallest = std::min(low.value, most);
  if (smallest < largest / 4) smallest = 0;
  double width = largest > smallest ? round_up((largest - smallest) / kBins) : 1;
  if (whole) width = std::ceil(width);
  const double first = std::floor(smallest / width);
  std::vector<double> edges{first * width};
  while (edges.size() < 2 || edges.back() < largest)
    edges.push_back((first + static_cast<double>(edges.size())) * width);
  return fill(edges, samples);
}

/// Edges 1, 2, 5, 10 ... over the upper eight decades. The first bin includes smaller values.
std::vector<HistogramBin> logarithmic_bins(const Samples& samples) {
  double smallest = 0, largest = 0;
  for (const Sample& sample : samples) {
    largest = std::max(largest, sample.value);
    if (sample.value > 0 && (smallest == 0 || sample.value < smallest)) smallest = sample.value;
  }
  if (largest <= 0) return linear_bins(samples, 0);
  const int top = static_cast<int>(std::ceil(std::log10(largest)));
  const int bottom = std::max(
      top - kDecades, std::min(top - 1, static_cast<int>(std::floor(std::log10(smallest)))));
  std::vector<double> edges;
  for (int decade = bottom; decade < top; ++decade)
    for (const double step : {1.0, 2.0, 5.0}) edges.push_back(step * std::pow(10.0, decade));
  edges.push_back(std::pow(10.0, top));
  return fill(edges, samples);
}

/// Terms of nodes, each over the nodes whose criterion was evaluated.
void append_nodes(const Run& run, std::vector<Histogram>& histograms) {
  const planes::SegmentOptions& options = run.segment_options;
  Samples n_out, r_out, n_in, e_n;
  for (std::size_t i = 0; i < run.facts.size(); ++i) {
    const NodeFacts& facts = run.facts[i];
    const Outcome outcome = outcome_at(run, run.timeline.decided_at()[i]);
    n_out.push_back({static_cast<double>(facts.purity.n_out), outcome});
    r_out.push_back({facts.purity.r_out(), outcome});
    if (!planes::is_pure(facts.purity, options)) continue;
    n_in.push_back({static_cast<double>(facts.purity.n_in), outcome});
    if (planes::has_enough_inliers(facts.purity.n_in, options)) e_n.push_back({facts.e_n, outcome});
  }
  const auto append_count = [&](const char* quantity, const char* title, const char* option,
                                double threshold, const Samples& samples) {
    histograms.push_back({quantity, title, "points", option, threshold, false,
                          linear_bins(samples, std::max(24.0, kRoom * threshold), true)});
  };
  append_count("n_out", "N_out", "theta_n_out", options.theta_n_out, n_out);
  histograms.push_back(
      {"r_out", "r_out", "", "theta_r_out", options.theta_r_out, false, linear_bins(r_out, 0.5)});
  append_count("n_in", "N_in", "theta_n_in", options.theta_n_in, n_in);

  if (options.by_objective())
    histograms.push_back({"rms", "RMS", "m", "",
                          run.facts.empty() ? kVaries : run.facts[0].theta_e_n, false,
                          linear_bins(e_n, 0.05)});
  else
    histograms.push_back(
        {"mse", options.mse_normalization == planes::MseNormalization::mean ? "e_n / N" : "e_n",
         "m²", "theta_e_n_m2", options.theta_e_n_m2, true, logarithmic_bins(e_n)});
}

/// Criteria 1-3 for the nodes of a depth image, where evaluated, and costs of joins.
void append_image_terms(const Run& run, std::vector<Histogram>& histograms) {
  const planes::ObjectiveOptions& options = run.segment_options.objective;
  Samples filled, two_planes, variance, cost, worth;
  for (std::size_t i = 0; i < run.trace.image_terms.size(); ++i) {
    const planes::ImageTerms& terms = run.trace.image_terms[i];
    const Outcome outcome = outcome_at(run, run.timeline.decided_at()[i]);
    filled.push_back({terms.filled, outcome});
    if (terms.two_planes >= 0 && terms.two_planes < planes::kNotFlat)
      two_planes.push_back({terms.two_planes, outcome});
    if (terms.variance >= 0) variance.push_back({terms.variance, outcome});
  }
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.stage == planes::Stage::join) cost.push_back({event.value, outcome_at(run, step)});
    if (event.stage == planes::Stage::list) worth.push_back({event.value, outcome_at(run, step)});
  }
  const auto append = [&](const char* title, const char* unit, const char* option, double threshold,
                          const Samples& samples, double most) {
    histograms.push_back({"", title, unit, option, threshold, false, linear_bins(samples, most)});
  };
  const double two = options.two_planes * options.merge_cost;
  append("cost of two planes", "", "", two, two_planes, kRoom * two);
  append("filled", "", "filled", options.filled, filled, 1);
  append("variance", "", "flat", options.flat, variance, kRoom * options.flat);
  append("cost of merges", "", "merge_cost", options.merge_cost, cost, options.merge_cost);
  append("worth of dropped planes", "px", "worth_px", options.worth_px, worth, options.worth_px);
}

/// Terms of a candidate with the plane it joined or, if it created one, the plane it came closest
/// to joining.
std::optional<planes::Coplanarity> terms_of(const planes::SegmentState& state,
                                            const planes::TraceEvent& event,
                                            const planes::Candidate& candidate) {
  if (event.type == planes::EventType::merge)
    return planes::coplanarity(state.planes[event.plane].fit, candidate.fit);
  std::vector<planes::Pair> pairs;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(state.planes.size()); ++k)
    if (state.planes[k].alive)
      pairs.push_back({k, planes::coplanarity(state.planes[k].fit, candidate.fit)});
  const planes::Pair* nearest = planes::nearest_pair(pairs, state.options);
  return nearest ? std::optional(nearest->terms) : std::nullopt;
}

/// Terms of merges, and distances of leftovers from planes.
void append_merges(const Run& run, std::vector<Histogram>& histograms) {
  const planes::SegmentOptions& options = run.segment_options;
  Samples offset, normals, n1_dmu, n2_dmu, distance;
  StateWalk walk(run);
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    const Outcome outcome = outcome_at(run, step);
    if ((event.type == planes::EventType::assign || event.type == planes::EventType::drop) &&
        event.value >= 0)
      distance.push_back({event.value, outcome});
    if (event.node < 0 ||
        (event.type != planes::EventType::found && event.type != planes::EventType::merge))
      continue;
    const planes::SegmentState& state = walk.advance_to(step - 1);
    const planes::Candidate candidate =
        planes::fit_label(state.octree, event.node, event.label, options.use_labels);
    const std::optional<planes::Coplanarity> terms = terms_of(state, event, candidate);
    if (!terms) continue;
    offset.push_back({terms->offset_m, outcome});
    normals.push_back({terms->normals, outcome});
    n1_dmu.push_back({terms->n1_dmu, outcome});
    n2_dmu.push_back({terms->n2_dmu, outcome});
  }

  const auto append = [&](Histogram histogram, const Samples& samples, double most) {
    histogram.bins = linear_bins(samples, most);
    if (!samples.empty()) histograms.push_back(std::move(histogram));
  };
  append({"", "|n₁·n₂|", "", "theta_coplane", options.theta_coplane}, normals, 1);
  append({"", "|n₁·Δμ|/‖Δμ‖", "", "", 1 - options.theta_coplane}, n1_dmu, 1);
  append({"", "|n₂·Δμ|/‖Δμ‖", "", "", 1 - options.theta_coplane}, n2_dmu, 1);
  const bool limited = options.merge_offset_m > 0;
  append({"offset", "offset", "m", limited ? "merge_offset_m" : "",
          limited ? options.merge_offset_m : kVaries},
         offset, 0.2);
  append({"distance", "distance of unassigned points", "m", "leftover_distance_m",
          options.leftover_distance_m},
         distance, 0.05);
}

}  // namespace

std::vector<Histogram> histograms_of(const Run& run) {
  std::vector<Histogram> histograms;
  if (!run.is_ours()) return histograms;
  if (run.is_on_image()) {
    append_image_terms(run, histograms);
    return histograms;
  }
  append_nodes(run, histograms);
  append_merges(run, histograms);
  return histograms;
}

}  // namespace planescope::debug
