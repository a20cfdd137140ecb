#pragma once

// The one typeface of pictures, reports and window: glyphs as coverage, and where they stand.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace planescope::render {

/// Coverage of one glyph, row 0 at the top. The pen stands at column -left, its baseline at row
/// -top.
struct GlyphBitmap {
  int width = 0, height = 0;  // [px]
  int left = 0, top = 0;
  std::vector<std::uint8_t> coverage;
};

struct PlacedGlyph {
  char32_t codepoint = 0;
  double x = 0;  // of its pen, from the start of the text [px]
};

struct TextLayout {
  std::vector<PlacedGlyph> glyphs;
  double width = 0;  // advance of the whole [px]
};

class Font {
 public:
  /// Glyphs are drawn at quarters of a pixel, so that text is spaced evenly.
  static constexpr int kPhases = 4;

  Font();  // DejaVu Sans, compiled in
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  /// Where a glyph is drawn whose pen stands at x: a whole pixel, and a phase to its right.
  struct Pen {
    int column = 0;
    int phase = 0;  // quarters of a pixel
  };
  static Pen pen_at(double x);

  TextLayout layout(const std::string& utf8, double size_px) const;
  /// `phase`: quarters of a pixel to the right.
  GlyphBitmap glyph(char32_t codepoint, double size_px, int phase) const;
  bool has_glyph(char32_t codepoint) const;
  double cap_height(double size_px) const;  // of a capital letter [px]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The TrueType file compiled in, for those who rasterise it themselves.
std::string_view font_file();

/// Read-only and shared by all threads.
const Font& default_font();

/// The glyph grown by `radius_px` on all sides, with a soft end: a halo to lie under it.
GlyphBitmap grown(const GlyphBitmap& glyph, double radius_px);

/// Code points of a text; bytes that are no UTF-8 become U+FFFD.
std::vector<char32_t> decode_utf8(const std::string& utf8);

}  // namespace planescope::render
