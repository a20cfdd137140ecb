#pragma once

// Our types as Open3D's and back. Whoever calls these includes Open3D's own headers.

#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace open3d::camera {
class PinholeCameraIntrinsic;
}
namespace open3d::geometry {
class LineSet;
class PointCloud;
class RGBDImage;
class TriangleMesh;
}  // namespace open3d::geometry

namespace planescope::open3d {

/// Open3D's camera has no lens distortion: throws Error where ours has some.
::open3d::camera::PinholeCameraIntrinsic to_open3d(const Intrinsics& intrinsics);
Intrinsics from_open3d(const ::open3d::camera::PinholeCameraIntrinsic& camera);

/// Depth as floats [m], 0 where nothing was measured. Colour (RGB, 8 bits) where it lies on the
/// depth pixel by pixel; elsewhere there is none.
::open3d::geometry::RGBDImage to_open3d(const Frame& frame);
/// Depth of floats [m] or of 16-bit counts of `depth_unit_m`, and colour as above. Throws Error for
/// other images, and where depth and camera differ in size.
Frame from_open3d(const ::open3d::geometry::RGBDImage& image,
                  const ::open3d::camera::PinholeCameraIntrinsic& camera,
                  double depth_unit_m = 0.001);

/// All points in their order, with `origin`; those that are no measurement too.
::open3d::geometry::PointCloud to_open3d(const PointSet& set);
PointSet from_open3d(const ::open3d::geometry::PointCloud& cloud);
/// World frame, z up [m].
::open3d::geometry::PointCloud to_open3d(const planes::Cloud& cloud);

/// The points of each plane with its normal, planes[id - 1] of the result. World frame [m].
std::vector<::open3d::geometry::PointCloud> planes_to_open3d(const planes::FrameResult& result);

/// Polygons by their corners, such as planes' convex hulls: as outlines, and as faces, fans of
/// triangles about the first corner that keep the direction in which the corners go round. Fewer
/// than three corners are no polygon.
using Polygon = std::vector<Vec3d>;
::open3d::geometry::LineSet outlines_to_open3d(std::span<const Polygon> polygons);
::open3d::geometry::TriangleMesh faces_to_open3d(std::span<const Polygon> polygons);
/// What planes cover: all rings of their outlines, holes and what is unknown too; and as triangles
/// with the plane's normal. World frame [m].
::open3d::geometry::LineSet outlines_to_open3d(std::span<const planes::Outline> outlines);
::open3d::geometry::TriangleMesh mesh_to_open3d(std::span<const planes::Outline> outlines);
/// The closed outlines of a line set, each from the first of its points.
std::vector<Polygon> outlines_from_open3d(const ::open3d::geometry::LineSet& lines);

}  // namespace planescope::open3d
