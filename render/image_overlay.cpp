// Planes over the camera's image.

#include <algorithm>
#include <cmath>
#include <string>

#include "render/paint.hpp"
#include "render/region_image.hpp"
#include "render/renderer.hpp"
#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr double kTint = 0.40;  // share of the plane's colour over the image
constexpr Rgba kOutlineShade{20, 22, 26, 255};

/// The image under the planes, and the planes on its pixels.
struct Backdrop {
  Image8 image;
  RegionImage regions;
};
Backdrop backdrop(const Frame& frame, const planes::FrameResult& result) {
  const bool same_size =
      frame.color.width == frame.depth.width && frame.color.height == frame.depth.height;
  if (!frame.color.empty() && frame.color_aligned && same_size)
    return {frame.color, regions_on_depth(frame, result)};
  if (!frame.color.empty() && !frame.color_aligned && frame.color_intrinsics.fx > 0)
    return {frame.color, regions_on_color(frame, result)};
  return {shaded_depth(frame), regions_on_depth(frame, result)};
}

/// Lines along the inside of each region, `width_px` wide.
void draw_outlines(Image8& image,
                   const RegionImage& regions,
                   int factor,
                   int width_px,
                   std::span<const int> color_of_plane) {
  const auto id_at = [&](int x, int y) {
    x = std::clamp(x, 0, image.width - 1);
    y = std::clamp(y, 0, image.height - 1);
    return regions.at(x / factor, y / factor);
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::int32_t id = id_at(x, y);
      if (id <= 0) continue;
      bool edge = false;
      for (int d = 1; d <= width_px && !edge; ++d)
        edge = id_at(x - d, y) != id || id_at(x + d, y) != id || id_at(x, y - d) != id ||
               id_at(x, y + d) != id;
      if (edge) blend_pixel(image, x, y, mix(color_of(id, color_of_plane), kOutlineShade, 0.2));
    }
  }
}

void draw_ids(Image8& image,
              const RegionImage& regions,
              int factor,
              std::size_t plane_count,
              std::span<const int> color_of_plane) {
  constexpr double kLeastDepth = 9;  // of a region that has room for its id [px of the picture]
  const std::vector<InteriorPoint> points = interior_points(regions, plane_count);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double depth = points[k].depth_px * factor;
    if (depth < kLeastDepth) continue;
    const int id = static_cast<int>(k) + 1;
    const std::string text = std::to_string(id);
    const double size = std::clamp(0.8 * depth, 13.0, 26.0);
    const double x = (points[k].x + 0.5) * factor, y = (points[k].y + 0.5) * factor;
    const double radius = std::max(0.72 * size, 0.5 * text_width(text, size) + 0.28 * size);
    fill_disc(image, x, y, radius + 2, {255, 255, 255, 235});
    fill_disc(image, x, y, radius, mix(color_of(id, color_of_plane), kOutlineShade, 0.45));
    draw_text(image, x - text_width(text, size) / 2, y + 0.36 * size, text, size,
              {255, 255, 255, 255});
  }
}

}  // namespace

Image8 image_overlay(const Frame& frame,
                     const planes::FrameResult& result,
                     std::span<const int> color_of_plane) {
  const Backdrop below = backdrop(frame, result);
  const int factor = enlargement(below.image.width);
  Image8 image = enlarge(below.image, factor);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::int32_t id = below.regions.at(x / factor, y / factor);
      if (id > 0) blend_pixel(image, x, y, color_of(id, color_of_plane), kTint);
    }
  }
  const RegionImage smooth = smooth_regions(below.regions);
  draw_outlines(image, smooth, factor, 2, color_of_plane);
  draw_ids(image, smooth, factor, result.segmentation.planes.size(), color_of_plane);
  return image;
}

}  // namespace planescope::render
