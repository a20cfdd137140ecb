#include "core/lab/experiments/oracle_result.hpp"

#include <algorithm>

namespace planescope::lab {

planes::FrameResult oracle_result(const planes::PreparedFrame& prepared,
                                  std::span<const TruePolygon> polygons) {
  std::vector<TruePolygon> in_cloud(polygons.begin(), polygons.end());
  for (TruePolygon& polygon : in_cloud)
    for (Vec3d& corner : polygon.corners)
      corner = prepared.cloud.T_world_sensor * corner - prepared.cloud.origin;

  planes::FrameResult result{prepared, {}, {}};
  planes::Segmentation& found = result.segmentation;
  const std::vector<Vec3f>& points = prepared.voxels.points;
  found.plane_of = oracle_planes(points, in_cloud);
  const int planes =
      found.plane_of.empty() ? 0 : std::max(0, *std::ranges::max_element(found.plane_of));
  std::vector<Moments> moments(static_cast<std::size_t>(planes));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (found.plane_of[i] > 0)
      moments[static_cast<std::size_t>(found.plane_of[i]) - 1].add(points[i].cast<double>());
  for (int id = 1; id <= planes; ++id) {
    planes::PlaneRegion& plane = found.planes.emplace_back();
    plane.id = id;
    plane.fit = fit_plane(moments[static_cast<std::size_t>(id) - 1]);
    plane.points = static_cast<std::uint32_t>(plane.fit.count);
  }
  for (const std::uint32_t voxel : prepared.voxels.voxel_of)
    result.plane_of.push_back(voxel == planes::kNoVoxel ? 0 : found.plane_of[voxel]);
  return result;
}

}  // namespace planescope::lab
