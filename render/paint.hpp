#pragma once

// Marks and text painted into an RGB image on the CPU, and the one typeface of pictures, reports
// and window: DejaVu Sans, compiled in.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

/// Color over the pixel, with `color.a` and `coverage` (0..1) as weights. Outside: nothing.
void blend_pixel(Image8& image, int x, int y, Rgba color, double coverage = 1);
void fill_rect(Image8& image, int x, int y, int width, int height, Rgba color);
void fill_disc(Image8& image, double cx, double cy, double radius, Rgba color);  // antialiased
/// Whether pixel (x, y) is on a diagonal hatching line.
bool on_hatch(int x, int y, int spacing_px);
/// Each pixel `factor` times in both directions.
Image8 enlarge(const Image8& image, int factor);
/// The factor that brings small sensor images to a size at which text and lines are crisp.
int enlargement(int width);

/// (x, y): left end of the baseline [px]. Returns the advance [px].
double draw_text(
    Image8& image, double x, double y, const std::string& utf8, double size_px, Rgba color);
double text_width(const std::string& utf8, double size_px);
double cap_height(double size_px);  // of a capital letter [px]

/// Coverage of one glyph, row 0 at the top. The pen stands at column -left, its baseline at row
/// -top.
struct GlyphBitmap {
  int width = 0, height = 0;  // [px]
  int left = 0, top = 0;
  std::vector<std::uint8_t> coverage;
};
/// Where a glyph is drawn: a whole pixel and a phase, quarters of a pixel to its right, so that
/// text is spaced evenly.
struct GlyphPen {
  int column = 0, phase = 0;
};
GlyphPen pen_at(double x);
/// `phase`: quarters of a pixel to the right.
GlyphBitmap glyph_bitmap(char32_t codepoint, double size_px, int phase);
/// The glyph grown by `radius_px` on all sides, with a soft end: a halo under it.
GlyphBitmap grown(const GlyphBitmap& glyph, double radius_px);
bool has_glyph(char32_t codepoint);

struct PlacedGlyph {
  char32_t codepoint = 0;
  double x = 0;  // of its pen, from the start of the text [px]
};
struct TextLayout {
  std::vector<PlacedGlyph> glyphs;
  double width = 0;  // advance of the whole [px]
};
TextLayout layout_text(const std::string& utf8, double size_px);
/// Code points of a text; bytes that are not UTF-8 become U+FFFD.
std::vector<char32_t> decode_utf8(const std::string& utf8);

/// The TrueType file compiled in.
std::string_view font_file();

}  // namespace planescope::render
