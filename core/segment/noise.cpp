#include "core/segment/noise.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/plane.hpp"
#include "core/segment/cells.hpp"

namespace planescope {
namespace {

constexpr double kMinPoints = 8;  // in a cell, for its residual to mean anything
constexpr double kPercentile = 0.8;
constexpr double kBin = 0.25;          // [m] of range
constexpr std::size_t kMinCells = 12;  // in a bin, for its percentile to mean anything

double percentile(std::vector<NoiseSample>::iterator begin,
                  std::vector<NoiseSample>::iterator end) {
  const auto nth =
      begin + static_cast<std::ptrdiff_t>(kPercentile * static_cast<double>(end - begin - 1));
  std::nth_element(begin, nth, end, [](const NoiseSample& a, const NoiseSample& b) {
    return a.sigma_m < b.sigma_m;
  });
  return nth->sigma_m;
}

/// What the clamps of theta_rms and tau may grow by: stereo noise grows with the square of range.
double range_factor(double range) { return std::max(1.0, range * range); }

}  // namespace

double NoiseModel::sigma(double range) const {
  if (range_m.empty()) return 0;
  const auto above = std::upper_bound(range_m.begin(), range_m.end(), range);
  if (above == range_m.begin()) return sigma_m.front();
  if (above == range_m.end()) return sigma_m.back();
  const auto i = static_cast<std::size_t>(above - range_m.begin());
  const double t = (range - range_m[i - 1]) / (range_m[i] - range_m[i - 1]);
  return sigma_m[i - 1] + t * (sigma_m[i] - sigma_m[i - 1]);
}

double NoiseModel::theta_rms(double range) const {
  if (range_m.empty()) return fixed_rms_m;
  const double most = 0.012 * (range_m.size() > 1 ? range_factor(range) : 1.0);
  return std::clamp(2 * sigma(range), 0.003, most);
}

double NoiseModel::tau(double range) const {
  if (range_m.empty()) return fixed_tau_m;
  const double most = 0.020 * (range_m.size() > 1 ? range_factor(range) : 1.0);
  return std::clamp(3 * sigma(range), 0.008, most);
}

void fit_noise(NoiseModel& model, std::vector<NoiseSample> samples, bool by_range) {
  if (samples.empty()) return;
  if (!by_range) {
    model.range_m = {0};
    model.sigma_m = {percentile(samples.begin(), samples.end())};
    return;
  }

  std::sort(samples.begin(), samples.end(), [](const NoiseSample& a, const NoiseSample& b) {
    return a.range_m < b.range_m || (a.range_m == b.range_m && a.sigma_m < b.sigma_m);
  });
  for (auto begin = samples.begin(); begin != samples.end();) {
    auto end = begin;
    const double limit = begin->range_m + kBin;
    while (end != samples.end() &&
           (end->range_m < limit || static_cast<std::size_t>(end - begin) < kMinCells))
      ++end;
    if (static_cast<std::size_t>(samples.end() - end) < kMinCells) end = samples.end();
    double range = 0;
    for (auto it = begin; it != end; ++it) range += it->range_m;
    model.range_m.push_back(range / static_cast<double>(end - begin));
    model.sigma_m.push_back(percentile(begin, end));
    begin = end;
  }
}

NoiseModel measure_noise(const Octree& octree, const Vec3d& sensor, const SegmentOptions& options) {
  NoiseModel model;
  model.fixed_rms_m = options.fixed_rms_m;
  model.fixed_tau_m = options.fixed_tau_m;
  if (!options.estimate_sigma) return model;

  std::vector<NoiseSample> samples;
  const std::vector<std::uint32_t> starts = cell_starts(octree, kCellLevels);
  for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
    Moments by_label[2];
    for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i)
      by_label[octree.labels[i] == Label::h].add(octree.points[i].cast<double>());
    for (const Moments& moments : by_label) {
      if (moments.count < kMinPoints) continue;
      const PlaneFit fit = fit_plane(moments);
      samples.push_back(
          {(fit.centroid - sensor).norm(), std::sqrt(fit.eigenvalues[0] / (fit.count - 3))});
    }
  }
  fit_noise(model, std::move(samples), options.sigma_by_range);
  return model;
}

}  // namespace planescope
