#include "core/explain/bins.hpp"

#include <algorithm>
#include <cmath>

namespace planescope {
namespace {

constexpr int kBins = 24;
constexpr int kDecades = 8;

/// 1, 2, 2.5 or 5 times a power of ten, not below `value`.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 2.5, 5.0})
    if (step * power >= value * (1 - 1e-9)) return step * power;
  return 10 * power;
}

void count(HistogramBin& bin, Judgement judgement) {
  ++(judgement == Judgement::right   ? bin.right
     : judgement == Judgement::wrong ? bin.wrong
                                     : bin.unknown);
}

/// Bins between the edges; the first and the last one take what lies outside.
std::vector<HistogramBin> fill(const std::vector<double>& edges,
                               const std::vector<Sample>& samples) {
  std::vector<HistogramBin> bins(edges.size() - 1);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].low = edges[i];
    bins[i].high = edges[i + 1];
  }
  for (const Sample& sample : samples) {
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, sample.value);
    count(bins[static_cast<std::size_t>(above - edges.begin() - 1)], sample.judgement);
    bins.back().high = std::max(bins.back().high, sample.value);
  }
  return bins;
}

}  // namespace

std::vector<HistogramBin> linear_bins(const std::vector<Sample>& samples, double most, bool whole) {
  if (samples.empty()) return {};
  double smallest = most, largest = 0;
  for (const Sample& sample : samples) {
    smallest = std::min(smallest, sample.value);
    largest = std::max(largest, sample.value);
  }
  largest = std::min(largest, most);
  if (smallest < largest / 4) smallest = 0;
  double width = largest > smallest ? round_up((largest - smallest) / kBins) : 1;
  if (whole) width = std::ceil(width);
  const double first = std::floor(smallest / width);
  std::vector<double> edges{first * width};
  while (edges.size() < 2 || edges.back() < largest)
    edges.push_back((first + static_cast<double>(edges.size())) * width);
  return fill(edges, samples);
}

std::vector<HistogramBin> logarithmic_bins(const std::vector<Sample>& samples) {
  double smallest = 0, largest = 0;
  for (const Sample& sample : samples) {
    largest = std::max(largest, sample.value);
    if (sample.value > 0 && (smallest == 0 || sample.value < smallest)) smallest = sample.value;
  }
  if (largest <= 0) return linear_bins(samples, 0, false);
  const int top = static_cast<int>(std::ceil(std::log10(largest)));
  const int bottom = std::max(
      top - kDecades, std::min(top - 1, static_cast<int>(std::floor(std::log10(smallest)))));
  std::vector<double> edges;
  for (int decade = bottom; decade < top; ++decade)
    for (const double step : {1.0, 2.0, 5.0}) edges.push_back(step * std::pow(10.0, decade));
  edges.push_back(std::pow(10.0, top));
  return fill(edges, samples);
}

}  // namespace planescope
