// Text on the CPU, for overlays on camera images.

#include <algorithm>
#include <cmath>

#include "render/font.hpp"
#include "render/renderer.hpp"

namespace planescope::render {
namespace {

void blend(Image8& image, const GlyphBitmap& glyph, int left, int top, Rgba color) {
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
    const long quarters = std::lround((x + placed.x) * Font::kPhases);
    const int pen = static_cast<int>(std::floor(static_cast<double>(quarters) / Font::kPhases));
    const int phase = static_cast<int>(quarters - static_cast<long>(pen) * Font::kPhases);
    const GlyphBitmap glyph = font.glyph(placed.codepoint, size_px, phase);
    blend(image, glyph, pen + glyph.left, baseline + glyph.top, color);
  }
  return layout.width;
}

double text_width(const std::string& utf8, double size_px) {
  return default_font().layout(utf8, size_px).width;
}

}  // namespace planescope::render
