#include "core/world/tracks/observation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/model/plane.hpp"

namespace planescope::world {
namespace {

constexpr int kLeastPixels = 100;        // for a fit along the rays
constexpr double kLeastIncidence = 0.1;  // cosine: beyond it, a ray hardly meets the plane

Mat3d second_moments(const Moments& m) {
  Mat3d s;
  s << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return s;
}

/// Turns the plane to the fit along the rays, about the point at its middle. A fit to points in
/// space takes some of what stereo errs by for extent, and leans: a riser 15 cm high by a degree at
/// 1.5 m.
void fit_along_rays(ObservedPlane& plane, const InverseSums& rays, const Pose& T_world_camera) {
  if (rays.count < kLeastPixels) return;
  const Vec3d g = T_world_camera.linear() * rays.fit().w_of_ray, normal = g.normalized();
  const Vec3d camera = T_world_camera.translation(), ray = plane.centroid - camera;
  if (!(std::abs(normal.dot(ray)) > kLeastIncidence * ray.norm())) return;
  plane.normal = normal.dot(plane.normal) < 0 ? Vec3d(-normal) : normal;
  plane.centroid = camera + ray / g.dot(ray);
  for (Vec3d& axis : plane.certainty.axes)
    axis = (axis - axis.dot(plane.normal) * plane.normal).normalized();
}

/// The result in which minor planes are planes like the others, after them: of what no other took.
void list_minor(planes::FrameResult& result) {
  planes::Segmentation& all = result.segmentation;
  for (std::size_t k = 0; k < all.minor.size(); ++k) {
    planes::PlaneRegion& plane = all.planes.emplace_back(all.minor[k]);
    plane.id = static_cast<int>(all.planes.size());
    for (const std::uint32_t voxel : all.minor_points[k])
      if (all.plane_of[voxel] == 0) all.plane_of[voxel] = plane.id;
  }
  const std::int32_t first = static_cast<std::int32_t>(all.planes.size() - all.minor.size()) + 1;
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    const std::uint32_t voxel = result.voxels.voxel_of[i];
    if (result.plane_of[i] > 0 || voxel == planes::kNoVoxel) continue;
    if (all.plane_of[voxel] >= first) result.plane_of[i] = all.plane_of[voxel];
  }
}

}  // namespace

Moments moments_of(const PlaneFit& fit, const Vec3d axes[2], const Vec3d& origin) {
  const Vec3d mean = fit.centroid - origin;
  const auto square = [](const Vec3d& v) -> Mat3d { return v * v.transpose(); };
  const Mat3d s = fit.eigenvalues[0] * square(fit.normal) + fit.eigenvalues[1] * square(axes[1]) +
                  fit.eigenvalues[2] * square(axes[0]) + fit.count * square(mean);
  return {fit.count, fit.count * mean, s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
}

Moments moved(const Moments& m, const Pose& T) {
  const Mat3d& R = T.linear();
  const Vec3d t = T.translation(), turned = R * m.sum;
  const Mat3d s = R * second_moments(m) * R.transpose() + turned * t.transpose() +
                  t * turned.transpose() + m.count * t * t.transpose();
  return {m.count, turned + m.count * t, s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
}

Apart apart(const Moments& a, const Moments& b) {
  PlaneFit narrow = fit_plane(a), wide = fit_plane(b);
  const bool is_first = narrow.eigenvalues[1] * wide.count < wide.eigenvalues[1] * narrow.count;
  if (!is_first) std::swap(narrow, wide);
  const Moments& points = is_first ? a : b;
  const double middle = wide.distance_m(narrow.centroid);
  const double across = wide.normal.dot(points.scatter() * wide.normal) - narrow.eigenvalues[0];
  // Of points spread evenly, the rim is sqrt(3) times as far as their RMS.
  return {middle, std::abs(middle) + std::sqrt(3 * std::max(0.0, across) / points.count)};
}

Moments scaled(const Moments& m, double weight) {
  return {m.count * weight, m.sum * weight, m.xx * weight, m.xy * weight,
          m.xz * weight,    m.yy * weight,  m.yz * weight, m.zz * weight};
}

void take_frame(ObservedFrame& seen,
                const Frame& frame,
                const planes::PipelineOptions& options,
                const Pose& T_world_camera,
                int segment) {
  seen.frame = frame.index;
  seen.timestamp_s = frame.timestamp_s;
  seen.segment = segment;
  seen.T_world_camera = T_world_camera;
  if (frame.gravity && frame.gravity->known()) seen.gravity = frame.gravity->direction;
  seen.intrinsics = frame.intrinsics;
  seen.depth = frame.depth;
  seen.depth_unit_m = frame.depth_unit_m;
  seen.max_range_m = options.cloud.max_range_m;
}

ObservedFrame observe(const Frame& frame,
                      planes::FrameResult result,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment) {
  ObservedFrame seen;
  take_frame(seen, frame, options, T_world_camera, segment);
  seen.noise = result.segmentation.noise;
  seen.covered = result.segmentation.covered;
  const auto listed = static_cast<int>(result.segmentation.planes.size());
  const double cell_m = options.cloud.voxel_size_m;
  std::vector<planes::Outline> outlines = planes::outlines_of(frame, result, cell_m);
  std::ranges::move(planes::minor_outlines_of(result, cell_m), std::back_inserter(outlines));
  list_minor(result);

  // A frame's own world is upright about the camera: a turn about z and a shift lead to ours.
  const Pose T_world_local = T_world_camera * result.cloud.T_world_sensor.inverse();
  const std::vector<planes::Certainty> certainties = planes::certainties_of(result);
  for (const planes::PlaneRegion& region : result.segmentation.planes) {
    ObservedPlane& plane = seen.planes.emplace_back();
    plane.id = region.id;
    plane.known = region.known;
    plane.minor = region.id > listed;
    plane.label = region.label;
    plane.normal = T_world_local.linear() * region.fit.normal;
    plane.centroid = T_world_local * (result.cloud.origin + region.fit.centroid);
    plane.rms_m = region.fit.rms_m();
    plane.margin = region.margin;
    plane.undecided = region.undecided;
    plane.certainty = certainties[region.id - 1];
    for (Vec3d& axis : plane.certainty.axes) axis = T_world_local.linear() * axis;
    plane.outline = planes::moved(std::move(outlines[region.id - 1]), T_world_local);
  }
  const Pose T_camera_local = result.cloud.T_world_sensor.inverse();
  std::vector<InverseSums> rays(seen.planes.size());
  seen.plane_of = Image16(frame.depth.width, frame.depth.height);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    if (const std::int32_t id = result.plane_of[i]; id > 0) {
      seen.plane_of.data[result.cloud.source[i]] = static_cast<std::uint16_t>(id);
      ++seen.planes[id - 1].pixels;
      const Vec3d p =
          T_camera_local * (result.cloud.points[i].cast<double>() + result.cloud.origin);
      const double w = 1 / p.z();
      rays[id - 1].add(w * p, w);
    }
  for (ObservedPlane& plane : seen.planes) {
    fit_along_rays(plane, rays[plane.id - 1], T_world_camera);
    PlaneFit fit = result.segmentation.planes[plane.id - 1].fit;
    fit.normal = plane.normal;
    fit.centroid = plane.centroid;
    plane.moments = moments_of(fit, plane.certainty.axes, seen.camera());
  }
  return seen;
}

}  // namespace planescope::world
