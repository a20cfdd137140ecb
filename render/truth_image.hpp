#pragma once

// Ground truth, what was found, and where they differ, side by side.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

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
