#pragma once

// Draw lists of a frame's stages: pure functions over core's results, no GL.

#include <span>
#include <vector>

#include "core/image/image.hpp"
#include "core/pipeline/pipeline.hpp"
#include "render/draw_list.hpp"

namespace planescope {

/// A view of the frame that shows all kept points: from behind and above the sensor, looking the
/// way the sensor looks.
Camera frame_camera(const FrameResult& result, double aspect);

DrawList scene_labels(const FrameResult& result);  // cloud by h / v
DrawList scene_cases(const FrameResult& result);   // octree nodes by case I-IV
DrawList scene_planes(const FrameResult& result, std::span<const int> color_of_plane);
DrawList scene_leftovers(const FrameResult& result);  // points in no plane

/// Image-space pictures, at the size of the depth image (or of the colour image where it is
/// aligned). Planes overlaid on colour (on shaded depth where there is none), with outlines and
/// ids.
Image8 image_overlay(const Frame& frame,
                     const FrameResult& result,
                     std::span<const int> color_of_plane);
Image8 image_depth(const Frame& frame, double max_range_m);

}  // namespace planescope
