#include "render/paint.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::render {

void blend_pixel(Image8& image, int x, int y, Rgba color, double coverage) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  const double weight = coverage * color.a / 255;
  const std::uint8_t source[3] = {color.r, color.g, color.b};
  for (int c = 0; c < 3; ++c) {
    const double below = image.at(x, y, c);
    image.at(x, y, c) =
        static_cast<std::uint8_t>(std::lround(below + weight * (source[c] - below)));
  }
}

void fill_rect(Image8& image, int x, int y, int width, int height, Rgba color) {
  for (int row = y; row < y + height; ++row)
    for (int column = x; column < x + width; ++column) blend_pixel(image, column, row, color);
}

void fill_disc(Image8& image, double cx, double cy, double radius, Rgba color) {
  const auto first_row = static_cast<int>(std::floor(cy - radius - 1));
  const auto last_row = static_cast<int>(std::ceil(cy + radius + 1));
  const auto first_column = static_cast<int>(std::floor(cx - radius - 1));
  const auto last_column = static_cast<int>(std::ceil(cx + radius + 1));
  for (int y = first_row; y <= last_row; ++y) {
    for (int x = first_column; x <= last_column; ++x) {
      const double outside = std::hypot(x + 0.5 - cx, y + 0.5 - cy) - radius;
      const double coverage = std::clamp(0.5 - outside, 0.0, 1.0);
      if (coverage > 0) blend_pixel(image, x, y, color, coverage);
    }
  }
}

bool on_hatch(int x, int y, int spacing_px) { return (x + y) % spacing_px < spacing_px / 4; }

Image8 enlarge(const Image8& image, int factor) {
  Image8 large(image.width * factor, image.height * factor, image.channels);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        large.at(x, y, c) = image.at(x / factor, y / factor, c);
  return large;
}

int enlargement(int width) {
  constexpr int kCrispWidth = 1000;
  return width <= 0 ? 1 : std::clamp((kCrispWidth + width - 1) / width, 1, 4);
}

}  // namespace planescope::render
