#pragma once

// Shapes and text, either drawn into an RGB image on the CPU or laid out over a picture without GL
// (title, legend, axes, scale bar, labels). Pictures, reports and windows share one built-in
// typeface: DejaVu Sans.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"
#include "render/palette.hpp"

namespace planescope::render {

/// Blends the color over a pixel, weighted by `color.a` and `coverage` (0..1). Ignores pixels
/// outside the image.
void blend_pixel(Image8& image, int x, int y, Rgba color, double coverage = 1);
void fill_rect(Image8& image, int x, int y, int width, int height, Rgba color);
void fill_disc(Image8& image, double cx, double cy, double radius, Rgba color);  // antialiased
/// Whether pixel (x, y) is on a diagonal hatching line.
bool on_hatch(int x, int y, int spacing_px);
/// Repeats each pixel `factor` times in both directions.
Image8 enlarge(const Image8& image, int factor);
/// Factor that enlarges small sensor images until text and lines are crisp.
int enlargement(int width);

/// (x, y): left end of the baseline [px]. Returns the advance [px].
double draw_text(
    Image8& image, double x, double y, const std::string& utf8, double size_px, Rgba color);
double text_width(const std::string& utf8, double size_px);
double cap_height(double size_px);  // height of a capital letter [px]

/// Coverage of one glyph, row 0 at the top. The pen is at column -left, the baseline at row -top.
struct GlyphBitmap {
  int width = 0, height = 0;  // [px]
  int left = 0, top = 0;
  std::vector<std::uint8_t> coverage;
};
/// Pen position of a glyph: a whole pixel plus a phase in quarters of a pixel, for even spacing.
struct GlyphPen {
  int column = 0, phase = 0;
};
GlyphPen pen_at(double x);
/// `phase`: offset to the right in quarters of a pixel.
GlyphBitmap glyph_bitmap(char32_t codepoint, double size_px, int phase);
/// The glyph expanded by `radius_px` on all sides with a soft edge: its halo.
GlyphBitmap grown(const GlyphBitmap& glyph, double radius_px);
bool has_glyph(char32_t codepoint);

struct PlacedGlyph {
  char32_t codepoint = 0;
  double x = 0;  // pen position from the start of the text [px]
};
struct TextLayout {
  std::vector<PlacedGlyph> glyphs;
  double width = 0;  // total advance [px]
};
TextLayout layout_text(const std::string& utf8, double size_px);
/// Decodes UTF-8 into code points; invalid bytes become U+FFFD.
std::vector<char32_t> decode_utf8(const std::string& utf8);

/// Contents of the built-in TrueType file.
std::string_view font_file();

// ---- Overlay of a picture, in pixels ----

/// A line or arrow of constant width on screen.
struct Segment {
  Vec3f a, b;
  Rgba color;
  float width_px = 1;
  float arrow = 0;   // 1: arrowhead at b
  float bias_m = 0;  // drawn this much closer to the eye
  std::uint32_t id = 0;
};

struct OverlayShape {  // rounded rectangle, in pixels from the top left corner
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  Rgba fill = {}, border = {};
  float radius = 0;
  float border_px = 0;
  float hatch_period_px = 0;  // 0: not hatched
};

struct OverlayText {
  double x = 0;         // left end
  double baseline = 0;  // from the top
  double size_px = 14;
  std::string text;
  Rgba color;
  Rgba halo = {0, 0, 0, 0};
  double halo_px = 0;
};

struct Overlay {  // drawn in this order
  std::vector<OverlayText> labels;
  std::vector<OverlayShape> shapes;
  std::vector<Segment> segments;  // x and y in pixels
  std::vector<OverlayText> texts;
};

/// `panels`: title and legend; `scene`: everything else.
enum class OverlayPart : std::uint8_t { all, scene, panels };
Overlay layout_overlay(const DrawList& list,
                       const View& view,
                       const ThemeColors& theme,
                       OverlayPart part = OverlayPart::all);

/// Scale of text and line widths: 1 for pictures with 500 to 720 rows on a standard-density screen,
/// larger for larger pictures, so that text stays legible in a panel of a window.
double overlay_scale(const View& view);

/// The longest length of the series 1, 2, 5, 10, ... that is at most `max_px` wide.
double round_length_m(double px_per_m, double max_px);
std::string length_text(double length_m);  // "5 mm", "20 cm", "1 m", "2 km"

}  // namespace planescope::render
