#pragma once

// What people and files are told about each plane of a frame.

#include <cstdint>
#include <span>
#include <vector>

#include "core/pipeline/pipeline.hpp"

namespace planescope {

/// One plane of a frame. World frame: z up, metres (`Cloud::origin` added).
struct PlaneSummary {
  int id = 0;  // 1-based
  Label label = Label::unknown;
  Vec3d normal = Vec3d::UnitZ();
  Vec3d centroid = Vec3d::Zero();
  double offset_m = 0;       // normal . x = offset
  double tilt_deg = 0;       // of the plane against the horizontal: 0 a floor, 90 a wall
  double rms_m = 0;          // of the voxels the plane was fitted to
  std::uint32_t points = 0;  // measurements (pixels, or points of the file)
  std::uint32_t voxels = 0;
  double area_m2 = 0;       // covered by measurements: occupied 2 cm cells of the plane
  std::vector<Vec3d> hull;  // convex outline of the measurements, in the plane, counter-clockwise
};

/// By plane id - 1.
std::vector<PlaneSummary> summarize_planes(const FrameResult& result);

/// The same without a FrameResult: `plane_of` per point, points about `origin`.
std::vector<PlaneSummary> summarize_planes(std::span<const PlaneRegion> planes,
                                           std::span<const Vec3f> points,
                                           std::span<const std::int32_t> plane_of,
                                           const Vec3d& origin);

}  // namespace planescope
