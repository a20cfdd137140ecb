#pragma once

// Plane ids in image space and what lies under them, for pictures of depth frames (scenes.hpp).

#include <vector>

#include "core/model/types.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::render {

/// Plane id per pixel, 0 none.
using RegionImage = Image<std::int32_t>;

/// Depth as a grey relief lit from the camera, so that surfaces can be told apart without color.
Image8 shaded_depth(const Frame& frame);

/// On the depth image's own pixels.
RegionImage regions_on_depth(const Frame& frame, const planes::FrameResult& result);

/// On the color image of a frame whose color is calibrated but not aligned: each depth pixel is
/// projected into it as a patch wide enough to leave no holes, the nearest surface in front.
RegionImage regions_on_color(const Frame& frame, const planes::FrameResult& result);

/// For drawing outlines: pinholes and specks go to the id that most of their 5x5 neighbors have.
RegionImage smooth_regions(const RegionImage& regions);

/// The pixel deepest inside each region, by plane id - 1; depth_px 0 where the region is absent.
struct InteriorPoint {
  int x = 0, y = 0;
  double depth_px = 0;  // to the nearest pixel of another region
};
std::vector<InteriorPoint> interior_points(const RegionImage& regions, std::size_t plane_count);

}  // namespace planescope::render
