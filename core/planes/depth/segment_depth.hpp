#pragma once

// `refined` on a depth image: planes by one objective, in inverse depth. Misfit over the measured
// noise, a cost for each plane and one for each unexplained pixel decide what happens to pixels and
// planes. Nothing depends on gravity, focal length or lengths in meters; gravity only names planes
// h or v.

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
  std::span<const Vec3f> points;           // of its measured pixels, in raster order; local [m]
  std::vector<std::uint32_t> pixel;        // of each point
  ImageSpace space;                        // relates pixels to points
  Vec3d sensor = Vec3d::Zero();            // local
  bool gravity_known = false;              // planes are named h or v
  std::span<const KnownPlane> known = {};  // candidates; they cost nothing
  const GivenPlanes* given = nullptr;      // taken as they are, where there are any
};

/// Segmentation::plane_of is per point; the octree divides (u, v, rho).
Segmentation segment_depth(const DepthInput& input,
                           const SegmentOptions& options,
                           Trace* trace = nullptr);

}  // namespace planescope::planes
