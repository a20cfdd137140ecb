// The depth image with its scale.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "render/paint.hpp"
#include "render/palette.hpp"
#include "render/renderer.hpp"
#include "render/scenes.hpp"

namespace planescope {
namespace {

constexpr Rgba kInk{52, 58, 66, 255};
constexpr Rgba kUnmeasured{232, 234, 237, 255};
constexpr Rgba kHatch{196, 200, 206, 255};
constexpr Rgba kBeyond{150, 154, 160, 255};
constexpr int kBarRoom = 120;  // [px] right of the image
constexpr int kNoteRoom = 44;  // [px] below the image
constexpr int kHatchSpacing = 12;

Rgba pixel_color(std::uint16_t count, double unit_m, double max_range_m, int x, int y) {
  if (count == 0 || count == 65535) return on_hatch(x, y, kHatchSpacing) ? kHatch : kUnmeasured;
  const double depth_m = count * unit_m;
  return depth_m > max_range_m ? kBeyond : depth_color(depth_m, max_range_m);
}

/// A round step that gives between 4 and 8 marks.
double tick_step(double max_m) {
  const double base = std::pow(10, std::floor(std::log10(max_m)));
  for (const double step : {0.1, 0.2, 0.25, 0.5, 1.0, 2.0})
    if (max_m / (step * base) <= 8) return step * base;
  return base;
}

void draw_bar(Image8& image, int left, int top, int height, double max_m) {
  constexpr int kWidth = 22;
  for (int y = 0; y < height; ++y) {
    const double depth_m = max_m * (y + 0.5) / height;  // near at the top
    fill_rect(image, left, top + y, kWidth, 1, depth_color(depth_m, max_m));
  }
  const double step = tick_step(max_m);
  for (int k = 0; k * step <= max_m * 1.0001; ++k) {
    const int y = top + static_cast<int>(std::lround(k * step / max_m * height));
    fill_rect(image, left + kWidth, std::min(y, top + height - 1), 6, 1, kInk);
    char text[32];
    std::snprintf(text, sizeof text, step < 0.1 ? "%.2f" : "%.1f", k * step);
    const std::string unit = k == 0 ? " m" : "";
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
  swatch(true, kUnmeasured, "no measurement");
  char text[48];
  std::snprintf(text, sizeof text, "beyond %.4g m", max_range_m);
  swatch(false, kBeyond, text);
}

}  // namespace

Image8 image_depth(const Frame& frame, double max_range_m) {
  const int factor = enlargement(frame.depth.width);
  const int width = frame.depth.width * factor, height = frame.depth.height * factor;
  Image8 image(width + kBarRoom, height + kNoteRoom, 3, 255);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      blend_pixel(image, x, y,
                  pixel_color(frame.depth.at(x / factor, y / factor), frame.depth_unit_m,
                              max_range_m, x, y));
  draw_bar(image, width + 18, 16, height - 32, max_range_m);
  draw_notes(image, image.height, max_range_m);
  return image;
}

}  // namespace planescope
