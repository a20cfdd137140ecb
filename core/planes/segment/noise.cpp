#include "core/planes/segment/noise.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/plane.hpp"
#include "core/planes/segment/cells.hpp"

namespace planescope::planes {

double NoiseModel::theta_rms(double range) const {
  if (!estimated) return options.fixed_rms_m;
  const double sigmas = of_spreads ? of_spread_options.theta_rms_sigmas : options.theta_rms_sigmas;
  return limited(sigmas * sigma(range), options.theta_rms_min_m, options.theta_rms_max_m, range);
}

void fit_noise(NoiseModel& model, std::vector<NoiseSample> samples, bool by_range) {
  if (samples.empty()) return;
  const double min_range = model.options.sigma_min_range_m;
  const double correlated = model.of_spreads ? 1 : model.options.sigma_correlated;
  model.estimated = true;
  model.by_range = by_range;
  if (by_range)
    for (NoiseSample& s : samples)
      s.sigma_m *= correlated / std::max(s.range_m * s.range_m, min_range * min_range);
  const auto nth =
      samples.begin() + static_cast<std::ptrdiff_t>(model.options.sigma_percentile *
                                                    static_cast<double>(samples.size() - 1));
  std::nth_element(
      samples.begin(), nth, samples.end(),
      [](const NoiseSample& a, const NoiseSample& b) { return a.sigma_m < b.sigma_m; });
  (by_range ? model.growth_per_m : model.constant_m) = nth->sigma_m;
}

NoiseModel measure_noise(const Octree& octree, const Vec3d& sensor, const SegmentOptions& options) {
  NoiseModel model;
  model.options = options.noise;
  model.of_spread_options = options.r8_voxel_spread;
  if (!options.noise.estimate_sigma) return model;
  model.of_spreads = !octree.spreads.empty();
  if (options.noise.sigma_by_range && options.noise.known_growth_per_m > 0) {
    model.estimated = model.by_range = true;
    model.growth_per_m = options.noise.known_growth_per_m;
    return model;
  }

  std::vector<NoiseSample> samples;
  const std::vector<std::uint32_t> starts = cell_starts(octree, options.noise.neighbour_levels);
  for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
    Moments by_label[2];
    for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i)
      octree.add_point(by_label[options.use_labels && octree.labels[i] == Label::h], i);
    for (const Moments& moments : by_label) {
      if (moments.count < options.noise.sigma_min_points) continue;
      const PlaneFit fit = fit_plane(moments);
      samples.push_back(
          {(fit.centroid - sensor).norm(), std::sqrt(fit.eigenvalues[0] / (fit.count - 3))});
    }
  }
  fit_noise(model, std::move(samples), options.noise.sigma_by_range);
  return model;
}

}  // namespace planescope::planes
