#pragma once

// The points of a picture, drawn on the CPU: with a software GL they are most of a picture's cost,
// and pictures of one frame show the same points in other colours. Same shapes and shading as
// points.vert, points.frag and shade.frag draw in a window, at the same four samples a pixel.

#include <cstdint>
#include <vector>

#include "render/draw_list.hpp"
#include "render/palette.hpp"
#include "render/view.hpp"

namespace planescope::render {

/// Which points are seen where, whatever their colours. Rows from the bottom, as GL counts them.
struct SplatLayer {
  struct Part {
    std::uint32_t point = 0;  // counted through all clouds
    float share = 0;          // of the pixel, less at the splat's darker rim
  };
  int width = 0, height = 0;
  std::vector<float> distances;      // along the view at a pixel's first sample [m]; or infinite
  std::vector<float> light;          // by how much a pixel's neighbours darken it, 1: not at all
  std::vector<std::uint8_t> counts;  // parts of each pixel, 0 to 4
  std::vector<float> bare;           // share of a pixel with parts that no point covers
  std::vector<Part> parts;           // of all pixels
};
/// How far beside a pixel lies what darkens it, here and in shade.frag [px].
float shade_radius_px(const View& view);

SplatLayer splat(const std::vector<DrawPoints>& clouds, const View& view);

/// Their picture on the theme's background: RGBA, opaque, row 0 at the bottom.
Image8 paint(const SplatLayer& layer,
             const std::vector<DrawPoints>& clouds,
             const ThemeColors& theme);

/// Of each pixel as GL has it: from 0 at the near plane to 2^32 - 1 at the far one.
std::vector<std::uint32_t> depths(const SplatLayer& layer, const View& view);

/// Where these are equal, so are the layers.
bool same_shapes(const std::vector<DrawPoints>& a, const std::vector<DrawPoints>& b);

}  // namespace planescope::render
