#include "core/planes/foot/certainty.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::planes {
namespace {

// sigma_offset^2 = sigma^2 (kAlike / n + kOffsetBias^2), and of the tilts likewise, each over its
// lever. n voxels are worth n / kAlike independent ones, as stereo errs alike over more than a
// voxel. What all of a plane's voxels have in common does not average away: points that are another
// surface's tilt it, and a floor between two layers of voxels is drawn to the middle of these.
// Measured on synthetic frames with the errors of the D435 (docs/footholds.md).
constexpr double kAlike = 1.44;
constexpr double kTiltBias = 0.07;
constexpr double kOffsetBias = 0.18;

/// Of a plane's voxels, on it.
struct Extent {
  double count = 0;
  Vec2d sum = Vec2d::Zero();
  double xx = 0, xy = 0, yy = 0;

  void add(const Vec2d& p) {
    count += 1;
    sum += p;
    xx += p.x() * p.x();
    xy += p.x() * p.y();
    yy += p.y() * p.y();
  }
};

}  // namespace

Mat3d Certainty::covariance(const Vec3d& centroid) const {
  const Vec3d d_offset(axes[0].dot(centroid), axes[1].dot(centroid), 1);
  const double variances[3] = {sigma_tilt_rad[0] * sigma_tilt_rad[0],
                               sigma_tilt_rad[1] * sigma_tilt_rad[1],
                               sigma_offset_m * sigma_offset_m};
  Mat3d covariance = Mat3d::Zero();
  for (int i = 0; i < 3; ++i) {
    Vec3d effect = Vec3d::Unit(i);
    effect.z() = d_offset[i];
    covariance += variances[i] * effect * effect.transpose();
  }
  return covariance;
}

std::vector<Certainty> certainties_of(const FrameResult& result) {
  const Segmentation& segmentation = result.segmentation;
  const std::size_t n = segmentation.planes.size();
  std::vector<PlaneBasis> bases;
  for (const PlaneRegion& plane : segmentation.planes)
    bases.push_back(plane_basis(plane.fit.normal));
  std::vector<Extent> extents(n);
  for (std::size_t i = 0; i < segmentation.plane_of.size(); ++i) {
    const std::int32_t id = segmentation.plane_of[i];
    if (id <= 0) continue;
    const PlaneBasis& basis = bases[id - 1];
    const Vec3d at =
        result.voxels.points[i].cast<double>() - segmentation.planes[id - 1].fit.centroid;
    extents[id - 1].add({basis.u.dot(at), basis.v.dot(at)});
  }
  std::vector<Certainty> certainties(n);
  for (std::size_t k = 0; k < n; ++k) {
    const PlaneFit& fit = segmentation.planes[k].fit;
    const Extent& extent = extents[k];
    Certainty& certainty = certainties[k];
    certainty.eigenvalues_m2 = fit.eigenvalues;
    const double count = std::max(3.0, fit.count);
    const double own_m = std::sqrt(fit.eigenvalues[0] / std::max(1.0, count - 3));
    certainty.sigma_m =
        std::max(own_m, segmentation.noise.sigma((fit.centroid - result.sensor()).norm()));
    const auto sigma_m = [&](double bias) {
      return certainty.sigma_m * std::sqrt(kAlike / count + bias * bias);
    };
    certainty.sigma_offset_m = sigma_m(kOffsetBias);

    // Mean squares along the two axes, of the voxels about their mean.
    const double size = std::max(1.0, extent.count);
    const Vec2d mean = extent.sum / size;
    const double xx = extent.xx / size - mean.x() * mean.x();
    const double xy = extent.xy / size - mean.x() * mean.y();
    const double yy = extent.yy / size - mean.y() * mean.y();
    const double half_sum = (xx + yy) / 2, half_gap = std::hypot((xx - yy) / 2, xy);
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const double spread_m2[2] = {half_sum + half_gap, half_sum - half_gap};
    certainty.axes[0] = std::cos(angle) * bases[k].u + std::sin(angle) * bases[k].v;
    certainty.axes[1] = -std::sin(angle) * bases[k].u + std::cos(angle) * bases[k].v;
    for (int i = 0; i < 2; ++i)
      certainty.sigma_tilt_rad[i] = sigma_m(kTiltBias) / std::sqrt(std::max(1e-12, spread_m2[i]));
  }
  return certainties;
}

}  // namespace planescope::planes
