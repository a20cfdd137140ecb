#include "render/paint.hpp"

#include <algorithm>
#include <cmath>

#include "render/font.hpp"

namespace planescope::render {

// ---- Marks ----

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
  const std::size_t row_bytes = static_cast<std::size_t>(large.width) * large.channels;
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* const first = &large.at(0, y * factor);
    std::uint8_t* out = first;
    for (int x = 0; x < image.width; ++x)
      for (int copy = 0; copy < factor; ++copy)
        for (int c = 0; c < image.channels; ++c) *out++ = image.at(x, y, c);
    for (int copy = 1; copy < factor; ++copy)
      std::copy_n(first, row_bytes, first + copy * row_bytes);
  }
  return large;
}

int enlargement(int width) {
  constexpr int kCrispWidth = 1000;
  return width <= 0 ? 1 : std::clamp((kCrispWidth + width - 1) / width, 1, 4);
}

// ---- Text ----

// Text on the CPU, for overlays on camera images.

namespace {

void blend_glyph(Image8& image, const GlyphBitmap& glyph, int left, int top, Rgba color) {
  const std::uint8_t rgb[3] = {color.r, color.g, color.b};
  const int x_begin = std::max(0, -left);
  const int x_end = std::min(glyph.width, image.width - left);
  const int y_begin = std::max(0, -top);
  const int y_end = std::min(glyph.height, image.height - top);
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      const int alpha = glyph.coverage[static_cast<std::size_t>(y) * glyph.width + x] * color.a;
      for (int c = 0; c < std::min(3, image.channels); ++c) {
        std::uint8_t& value = image.at(left + x, top + y, c);
        const int mixed = value * (255 * 255 - alpha) + rgb[c] * alpha;
        value = static_cast<std::uint8_t>((mixed + 255 * 255 / 2) / (255 * 255));
      }
    }
  }
}

}  // namespace

double draw_text(
    Image8& image, double x, double y, const std::string& utf8, double size_px, Rgba color) {
  const Font& font = default_font();
  const TextLayout layout = font.layout(utf8, size_px);
  const int baseline = static_cast<int>(std::lround(y));
  for (const PlacedGlyph& placed : layout.glyphs) {
    const Font::Pen pen = Font::pen_at(x + placed.x);
    const GlyphBitmap glyph = font.glyph(placed.codepoint, size_px, pen.phase);
    blend_glyph(image, glyph, pen.column + glyph.left, baseline + glyph.top, color);
  }
  return layout.width;
}

double text_width(const std::string& utf8, double size_px) {
  return default_font().layout(utf8, size_px).width;
}

}  // namespace planescope::render
