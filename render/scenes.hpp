#pragma once

// Draw lists of a frame's stages: pure functions over core's results, no GL. Coordinates are the
// cloud's own: world axes (z up), meters, about `Cloud::origin`.
//
// `color_of_plane`: color id of each plane, by plane id - 1 (plane_colors.hpp); empty: the
// plane's own id.

#include <array>
#include <span>
#include <string>

#include "core/model/types.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

DrawList scene_labels(const planes::FrameResult& result);  // cloud by h / v
/// Cloud by how sure the classifier is of h / v: the label's color where it is, dark where not.
DrawList scene_margins(const planes::FrameResult& result);
/// Octree nodes by case I-IV: voxels in the color of the node that settled them, in the box of
/// that node's points (never larger than its cell); divided nodes as the faint outline of their
/// cell.
DrawList scene_cases(const planes::FrameResult& result);
/// Voxels in the colors of their planes, with what each covers, its holes, normal and number.
DrawList scene_planes(const Frame& frame,
                      const planes::FrameResult& result,
                      std::span<const int> color_of_plane);
/// Points in no plane, the planes faded.
DrawList scene_leftovers(const planes::FrameResult& result, std::span<const int> color_of_plane);

/// For clouds, what image_overlay and image_depth are for depth frames: every point of the file in
/// its own color (grey where it has none) with the planes' colors over it, and by height.
DrawList scene_overlay(const Frame& frame,
                       const planes::FrameResult& result,
                       std::span<const int> color_of_plane);
DrawList scene_heights(const planes::FrameResult& result);

/// Image-space pictures of depth frames, enlarged by a whole factor where the sensor's image is
/// small. Planes over the color image, each depth pixel projected into it where it is not aligned,
/// or over shaded depth where there is no calibrated color; with outlines and ids.
Image8 image_overlay(const Frame& frame,
                     const planes::FrameResult& result,
                     std::span<const int> color_of_plane);
/// Depth as a ramp with its scale in meters; what was not measured is hatched, what lies beyond
/// `max_range_m` is grey.
Image8 image_depth(const Frame& frame, double max_range_m);

// ---- Ground truth, what was found, and where they differ, side by side ----

/// "missed 3.1 %, wrong plane 0.4 %" of the points scored, in words; "all right" where nothing is.
std::string errors_text(const planes::JudgedFrame& judged);

/// Labels, result and errors over the relief of a depth frame, with titles and the errors' legend.
Image8 image_truth(const Frame& frame,
                   const planes::FrameResult& result,
                   const planes::JudgedFrame& judged,
                   std::span<const int> color_of_plane);

/// The same three of a cloud, to be drawn one by one and joined.
std::array<DrawList, 3> scenes_truth(const planes::FrameResult& result,
                                     const planes::JudgedFrame& judged,
                                     std::span<const int> color_of_plane);

/// Images of one height in a row, narrow white gaps between them.
Image8 side_by_side(std::span<const Image8> images);

}  // namespace planescope::render
