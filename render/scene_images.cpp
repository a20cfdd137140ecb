// Image-space pictures of depth frames (scenes.hpp).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "render/paint.hpp"
#include "render/palette.hpp"
#include "render/region_image.hpp"
#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope::render {

// ---- Planes over the camera's image ----

namespace {

constexpr double kTint = 0.40;  // share of the plane's colour over the image
constexpr Rgba kOutlineShade{20, 22, 26, 255};

/// The image under the planes, and the planes on its pixels.
struct Ground {
  Image8 image;
  RegionImage regions;
};
Ground ground_of(const Frame& frame, const planes::FrameResult& result) {
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
  const auto region_at = [&](int x, int y) {
    return regions.at(std::clamp(x, 0, regions.width - 1), std::clamp(y, 0, regions.height - 1));
  };
  // Pixels of the picture look for another region as far as this, in pixels of the regions.
  const int reach = (width_px + factor - 1) / factor;
  const auto is_inside = [&](int column, int row, std::int32_t id) {
    for (int d = 1; d <= reach; ++d)
      if (region_at(column - d, row) != id || region_at(column + d, row) != id ||
          region_at(column, row - d) != id || region_at(column, row + d) != id)
        return false;
    return true;
  };
  const auto is_edge = [&](int x, int y, std::int32_t id) {
    const auto id_at = [&](int column, int row) {
      column = std::clamp(column, 0, image.width - 1);
      row = std::clamp(row, 0, image.height - 1);
      return regions.at(column / factor, row / factor);
    };
    for (int d = 1; d <= width_px; ++d)
      if (id_at(x - d, y) != id || id_at(x + d, y) != id || id_at(x, y - d) != id ||
          id_at(x, y + d) != id)
        return true;
    return false;
  };
  for (int row = 0; row < regions.height; ++row) {
    for (int column = 0; column < regions.width; ++column) {
      const std::int32_t id = regions.at(column, row);
      if (id <= 0 || is_inside(column, row, id)) continue;
      const Rgba color = mix(color_of(id, color_of_plane), kOutlineShade, 0.2);
      for (int y = row * factor; y < (row + 1) * factor; ++y)
        for (int x = column * factor; x < (column + 1) * factor; ++x)
          if (is_edge(x, y, id)) blend_pixel(image, x, y, color);
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
  const Ground below = ground_of(frame, result);
  const int factor = enlargement(below.image.width);
  Image8 tinted = below.image;
  for (int y = 0; y < tinted.height; ++y) {
    for (int x = 0; x < tinted.width; ++x) {
      const std::int32_t id = below.regions.at(x, y);
      if (id > 0) blend_pixel(tinted, x, y, color_of(id, color_of_plane), kTint);
    }
  }
  Image8 image = enlarge(tinted, factor);
  const RegionImage smooth = smooth_regions(below.regions);
  draw_outlines(image, smooth, factor, 2, color_of_plane);
  draw_ids(image, smooth, factor, result.segmentation.planes.size(), color_of_plane);
  return image;
}

// ---- Depth with its scale ----

namespace {

constexpr Rgba kInk{52, 58, 66, 255};
constexpr Rgba kNotMeasured{232, 234, 237, 255};
constexpr Rgba kHatch{196, 200, 206, 255};
constexpr Rgba kBeyond{150, 154, 160, 255};
constexpr int kBarRoom = 120;  // [px] right of the image
constexpr int kNoteRoom = 44;  // [px] below the image
constexpr int kHatchSpacing = 12;

bool measured(std::uint16_t count) { return count != 0 && count != 65535; }

/// The depths that the ramp spans: all but the outermost half percent of what is within range,
/// rounded outward to 10 cm.
struct Ramp {
  double low_m = 0, high_m = 1;
  Rgba color(double depth_m) const {
    // depth_color() keeps its neutral grey for 0.
    const double t = std::clamp((depth_m - low_m) / (high_m - low_m), 1e-6, 1.0);
    return depth_color(t, 1);
  }
};
Ramp ramp_of(const Frame& frame, double max_range_m) {
  std::vector<double> depths;
  for (const std::uint16_t count : frame.depth.data)
    if (measured(count) && count * frame.depth_unit_m <= max_range_m)
      depths.push_back(count * frame.depth_unit_m);
  if (depths.empty()) return {0, max_range_m};
  const auto at = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), depths.begin() + k, depths.end());
    return depths[static_cast<std::size_t>(k)];
  };
  Ramp ramp{std::floor(10 * at(0.005)) / 10, std::ceil(10 * at(0.995)) / 10};
  if (ramp.high_m - ramp.low_m < 0.15) ramp.high_m = ramp.low_m + 0.2;
  return ramp;
}

/// Of each count that a depth image can hold; those not measured are hatched.
std::vector<Rgba> colors_of_counts(const Frame& frame, const Ramp& ramp, double max_range_m) {
  std::vector<Rgba> colors(65536, kNotMeasured);
  std::vector<bool> is_there(colors.size());
  for (const std::uint16_t count : frame.depth.data) is_there[count] = measured(count);
  for (std::size_t count = 0; count < colors.size(); ++count) {
    if (!is_there[count]) continue;
    const double depth_m = static_cast<double>(count) * frame.depth_unit_m;
    colors[count] = depth_m > max_range_m ? kBeyond : ramp.color(depth_m);
  }
  return colors;
}

/// A round step that gives between 4 and 8 marks.
double tick_step(double span_m) {
  const double base = std::pow(10, std::floor(std::log10(span_m)));
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0})
    if (span_m / (step * base) <= 8) return step * base;
  return base;
}

void draw_bar(Image8& image, int left, int top, int height, const Ramp& ramp) {
  constexpr int kWidth = 22;
  const double span_m = ramp.high_m - ramp.low_m;
  for (int y = 0; y < height; ++y)  // near at the top
    fill_rect(image, left, top + y, kWidth, 1,
              ramp.color(ramp.low_m + span_m * (y + 0.5) / height));
  const double step = tick_step(span_m);
  const auto first = static_cast<int>(std::ceil(ramp.low_m / step - 1e-6));
  const auto last = static_cast<int>(std::floor(ramp.high_m / step + 1e-6));
  for (int k = first; k <= last; ++k) {
    const int y = top + static_cast<int>(std::lround((k * step - ramp.low_m) / span_m * height));
    fill_rect(image, left + kWidth, std::min(y, top + height - 1), 6, 1, kInk);
    char text[32];
    std::snprintf(text, sizeof text, step < 0.095 ? "%.2f" : "%.1f", k * step);
    const std::string unit = k == first ? " m" : "";
    draw_text(image, left + kWidth + 11, y + 6, text + unit, 17, kInk);
  }
}

void draw_notes(Image8& image, int bottom, double max_range_m) {
  const int top = bottom - kNoteRoom + 15;
  double x = 4;
  const auto swatch = [&](bool hatched, Rgba color, const std::string& text) {
    const int left = static_cast<int>(x);
    for (int dy = 0; dy < 18; ++dy)
      for (int dx = 0; dx < 26; ++dx)
        blend_pixel(image, left + dx, top + dy,
                    hatched && on_hatch(left + dx, top + dy, kHatchSpacing) ? kHatch : color);
    x += 34;
    x += draw_text(image, x, top + 15, text, 17, kInk) + 28;
  };
  swatch(true, kNotMeasured, "no measurement");
  char text[48];
  std::snprintf(text, sizeof text, "beyond %.4g m", max_range_m);
  swatch(false, kBeyond, text);
}

}  // namespace

Image8 image_depth(const Frame& frame, double max_range_m) {
  const int factor = enlargement(frame.depth.width);
  const int width = frame.depth.width * factor, height = frame.depth.height * factor;
  const Ramp ramp = ramp_of(frame, max_range_m);
  Image8 image(width + kBarRoom, height + kNoteRoom, 3, 255);
  const std::vector<Rgba> colors = colors_of_counts(frame, ramp, max_range_m);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint16_t count = frame.depth.at(x / factor, y / factor);
      const bool hatch = !measured(count) && on_hatch(x, y, kHatchSpacing);
      const Rgba color = hatch ? kHatch : colors[count];
      std::uint8_t* pixel = &image.at(x, y);
      pixel[0] = color.r;
      pixel[1] = color.g;
      pixel[2] = color.b;
    }
  }
  draw_bar(image, width + 18, 16, height - 32, ramp);
  draw_notes(image, image.height, max_range_m);
  return image;
}

}  // namespace planescope::render
