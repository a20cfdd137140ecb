#pragma once

// `refined` on a depth image: finds planes in inverse depth by one objective. Pixels and planes are
// assigned by weighing the misfit relative to the measured noise, a cost per plane, and a cost per
// unexplained pixel. Nothing depends on gravity, focal length or metric lengths; gravity only
// labels planes h or v.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/depth/inverse_depth.hpp"
#include "core/planes/segment/octree.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

struct DepthInput {
  DepthImage image;
  std::span<const Vec3f> points;           // measured pixels in raster order; local frame [m]
  std::vector<std::uint32_t> pixel;        // per point
  ImageSpace space;                        // maps pixels to points
  Vec3d sensor = Vec3d::Zero();            // local frame
  bool gravity_known = false;              // whether to label planes h or v
  std::span<const KnownPlane> known = {};  // candidate planes from other frames, free of plane cost
  const GivenPlanes* given = nullptr;      // planes to use unchanged, if any
};

/// Segments one depth image. Segmentation::plane_of is per point; the octree divides (u, v, rho).
Segmentation segment_depth(const DepthInput& input,
                           const SegmentOptions& options,
                           Trace* trace = nullptr);

}  // namespace planescope::planes
