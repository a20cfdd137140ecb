#include "render/paint.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "render/gl.hpp"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

PLANESCOPE_ASSET_DECLARE(DejaVuSans_ttf);

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

namespace {

constexpr int kPhases = 4;

const stbtt_fontinfo& font() {
  static const stbtt_fontinfo info = [] {
    stbtt_fontinfo made = {};
    if (!stbtt_InitFont(&made, planescope_asset_DejaVuSans_ttf, 0))
      throw Error("the font compiled in, DejaVuSans.ttf, is not a TrueType font");
    return made;
  }();
  return info;
}

float font_scale(double size_px) {
  return stbtt_ScaleForMappingEmToPixels(&font(), static_cast<float>(size_px));
}

int glyph_index(char32_t codepoint) {
  return stbtt_FindGlyphIndex(&font(), static_cast<int>(codepoint));
}

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
  const TextLayout layout = layout_text(utf8, size_px);
  const int baseline = static_cast<int>(std::lround(y));
  for (const PlacedGlyph& placed : layout.glyphs) {
    const GlyphPen pen = pen_at(x + placed.x);
    const GlyphBitmap glyph = glyph_bitmap(placed.codepoint, size_px, pen.phase);
    blend_glyph(image, glyph, pen.column + glyph.left, baseline + glyph.top, color);
  }
  return layout.width;
}

double text_width(const std::string& utf8, double size_px) {
  return layout_text(utf8, size_px).width;
}

double cap_height(double size_px) { return 0.729 * size_px; }

GlyphPen pen_at(double x) {
  const long quarters = std::lround(x * kPhases);
  const int column = static_cast<int>(std::floor(static_cast<double>(quarters) / kPhases));
  return {column, static_cast<int>(quarters - static_cast<long>(column) * kPhases)};
}

GlyphBitmap glyph_bitmap(char32_t codepoint, double size_px, int phase) {
  const float scale = font_scale(size_px), shift = static_cast<float>(phase) / kPhases;
  const int index = glyph_index(codepoint);
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  stbtt_GetGlyphBitmapBoxSubpixel(&font(), index, scale, scale, shift, 0, &x0, &y0, &x1, &y1);
  GlyphBitmap glyph{std::max(0, x1 - x0), std::max(0, y1 - y0), x0, y0, {}};
  glyph.coverage.resize(static_cast<std::size_t>(glyph.width) * glyph.height);
  if (!glyph.coverage.empty())
    stbtt_MakeGlyphBitmapSubpixel(&font(), glyph.coverage.data(), glyph.width, glyph.height,
                                  glyph.width, scale, scale, shift, 0, index);
  return glyph;
}

bool has_glyph(char32_t codepoint) { return glyph_index(codepoint) != 0; }

TextLayout layout_text(const std::string& utf8, double size_px) {
  const double scale = font_scale(size_px);
  TextLayout layout;
  int previous = 0;
  for (const char32_t codepoint : decode_utf8(utf8)) {
    const int index = glyph_index(codepoint);
    if (previous != 0) layout.width += scale * stbtt_GetGlyphKernAdvance(&font(), previous, index);
    layout.glyphs.push_back({codepoint, layout.width});
    int advance = 0;
    stbtt_GetGlyphHMetrics(&font(), index, &advance, nullptr);
    layout.width += scale * advance;
    previous = index;
  }
  return layout;
}

std::string_view font_file() { return PLANESCOPE_ASSET(DejaVuSans_ttf); }

GlyphBitmap grown(const GlyphBitmap& glyph, double radius_px) {
  const int margin = static_cast<int>(std::ceil(radius_px)) + 1;
  GlyphBitmap halo;
  halo.width = glyph.width + 2 * margin;
  halo.height = glyph.height + 2 * margin;
  halo.left = glyph.left - margin;
  halo.top = glyph.top - margin;
  halo.coverage.assign(static_cast<std::size_t>(halo.width) * halo.height, 0);
  for (int dy = -margin; dy <= margin; ++dy) {
    for (int dx = -margin; dx <= margin; ++dx) {
      const double weight = std::clamp(radius_px + 0.5 - std::hypot(dx, dy), 0.0, 1.0);
      if (weight <= 0) continue;
      for (int y = 0; y < glyph.height; ++y) {
        const std::uint8_t* from =
            glyph.coverage.data() + static_cast<std::size_t>(y) * glyph.width;
        std::uint8_t* to = halo.coverage.data() +
                           static_cast<std::size_t>(y + margin + dy) * halo.width + margin + dx;
        for (int x = 0; x < glyph.width; ++x) {
          to[x] = std::max(to[x], static_cast<std::uint8_t>(std::lround(from[x] * weight)));
        }
      }
    }
  }
  return halo;
}

std::vector<char32_t> decode_utf8(const std::string& utf8) {
  constexpr char32_t kReplacement = 0xFFFD;
  std::vector<char32_t> text;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const int length = lead < 0x80           ? 1
                       : (lead >> 5) == 0x06 ? 2
                       : (lead >> 4) == 0x0E ? 3
                       : (lead >> 3) == 0x1E ? 4
                                             : 0;
    char32_t codepoint = length <= 1 ? lead : lead & (0xFFu >> (length + 1));
    bool valid = length > 0 && i + length <= utf8.size();
    for (int k = 1; valid && k < length; ++k) {
      const auto next = static_cast<unsigned char>(utf8[i + k]);
      valid = (next & 0xC0u) == 0x80u;
      codepoint = (codepoint << 6) | (next & 0x3Fu);
    }
    text.push_back(valid ? codepoint : kReplacement);
    i += valid ? static_cast<std::size_t>(length) : 1;
  }
  return text;
}

}  // namespace planescope::render
