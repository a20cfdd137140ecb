#include "render/font.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "render/gl.hpp"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

PLANESCOPE_ASSET_DECLARE(DejaVuSans_ttf);

namespace planescope::render {

struct Font::Impl {
  stbtt_fontinfo info = {};
};

Font::Font() : impl_(std::make_unique<Impl>()) {
  if (!stbtt_InitFont(&impl_->info, planescope_asset_DejaVuSans_ttf, 0)) {
    throw Error("the font compiled in, DejaVuSans.ttf, is not a TrueType font");
  }
}
Font::~Font() = default;

Font::Pen Font::pen_at(double x) {
  const long quarters = std::lround(x * kPhases);
  const int column = static_cast<int>(std::floor(static_cast<double>(quarters) / kPhases));
  return {column, static_cast<int>(quarters - static_cast<long>(column) * kPhases)};
}

TextLayout Font::layout(const std::string& utf8, double size_px) const {
  const stbtt_fontinfo& info = impl_->info;
  const double scale = stbtt_ScaleForMappingEmToPixels(&info, static_cast<float>(size_px));
  TextLayout layout;
  int previous = 0;
  for (const char32_t codepoint : decode_utf8(utf8)) {
    const int index = stbtt_FindGlyphIndex(&info, static_cast<int>(codepoint));
    if (previous != 0) layout.width += scale * stbtt_GetGlyphKernAdvance(&info, previous, index);
    layout.glyphs.push_back({codepoint, layout.width});
    int advance = 0;
    stbtt_GetGlyphHMetrics(&info, index, &advance, nullptr);
    layout.width += scale * advance;
    previous = index;
  }
  return layout;
}

GlyphBitmap Font::glyph(char32_t codepoint, double size_px, int phase) const {
  const stbtt_fontinfo& info = impl_->info;
  const float scale = stbtt_ScaleForMappingEmToPixels(&info, static_cast<float>(size_px));
  const float shift = static_cast<float>(phase) / kPhases;
  const int index = stbtt_FindGlyphIndex(&info, static_cast<int>(codepoint));
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
  stbtt_GetGlyphBitmapBoxSubpixel(&info, index, scale, scale, shift, 0, &x0, &y0, &x1, &y1);
  GlyphBitmap glyph;
  glyph.width = std::max(0, x1 - x0);
  glyph.height = std::max(0, y1 - y0);
  glyph.left = x0;
  glyph.top = y0;
  glyph.coverage.resize(static_cast<std::size_t>(glyph.width) * glyph.height);
  if (!glyph.coverage.empty()) {
    stbtt_MakeGlyphBitmapSubpixel(&info, glyph.coverage.data(), glyph.width, glyph.height,
                                  glyph.width, scale, scale, shift, 0, index);
  }
  return glyph;
}

bool Font::has_glyph(char32_t codepoint) const {
  return stbtt_FindGlyphIndex(&impl_->info, static_cast<int>(codepoint)) != 0;
}

double Font::cap_height(double size_px) const {
  return 0.729 * size_px;  // of DejaVu Sans
}

std::string_view font_file() { return PLANESCOPE_ASSET(DejaVuSans_ttf); }

const Font& default_font() {
  static const Font font;
  return font;
}

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
