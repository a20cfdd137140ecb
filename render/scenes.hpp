#pragma once

// Draw lists of a frame's stages: pure functions over core's results, no GL. Coordinates are the
// cloud's own: world axes (z up), metres, about `Cloud::origin`.
//
// `color_of_plane`: color id of each plane, by plane id - 1 (plane_colors.hpp); empty: the
// plane's own id.

#include <span>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

/// A view of the frame that just holds its kept points (all but the outermost half percent). Depth
/// frames: from behind and above the sensor, looking the way it looks. Clouds: from the -x side.
Camera frame_camera(const planes::PreparedFrame& prepared,
                    const planes::Segmentation& segmentation,
                    double aspect);
inline Camera frame_camera(const planes::FrameResult& result, double aspect) {
  return frame_camera(result, result.segmentation, aspect);
}

DrawList scene_labels(const planes::FrameResult& result);  // cloud by h / v
/// Cloud by how sure the classifier is of h / v: the label's colour where it is, dark where not.
DrawList scene_margins(const planes::FrameResult& result);
/// Octree nodes by case I-IV: voxels in the colour of the node that settled them, in the box of
/// that node's points (never larger than its cell); divided nodes as the faint outline of their
/// cell.
DrawList scene_cases(const planes::FrameResult& result);
/// Voxels in the colours of their planes, with what each covers, its holes, normal and number.
DrawList scene_planes(const Frame& frame,
                      const planes::FrameResult& result,
                      std::span<const int> color_of_plane);
/// Points in no plane, the planes faded.
DrawList scene_leftovers(const planes::FrameResult& result, std::span<const int> color_of_plane);

/// For clouds, what image_overlay and image_depth are for depth frames: every point of the file in
/// its own colour (grey where it has none) with the planes' colours over it, and by height.
DrawList scene_overlay(const Frame& frame,
                       const planes::FrameResult& result,
                       std::span<const int> color_of_plane);
DrawList scene_heights(const planes::FrameResult& result);

/// Image-space pictures of depth frames, enlarged by a whole factor where the sensor's image is
/// small. Planes over the colour image, each depth pixel projected into it where it is not aligned,
/// or over shaded depth where there is no calibrated colour; with outlines and ids.
Image8 image_overlay(const Frame& frame,
                     const planes::FrameResult& result,
                     std::span<const int> color_of_plane);
/// Depth as a ramp with its scale in metres; what was not measured is hatched, what lies beyond
/// `max_range_m` is grey.
Image8 image_depth(const Frame& frame, double max_range_m);

}  // namespace planescope::render
