// Draws text and shapes on the CPU, and lays out overlays over a picture.

#include "render/paint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "render/gl.hpp"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

PLANESCOPE_ASSET_DECLARE(DejaVuSans_ttf);

namespace planescope::render {

// ---- Shapes ----

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
      throw Error("built-in font DejaVuSans.ttf: not a TrueType font");
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

}  // namespace

double draw_text(
    Image8& image, double x, double y, const std::string& utf8, double size_px, Rgba color) {
  const TextLayout layout = layout_text(utf8, size_px);
  const int baseline = static_cast<int>(std::lround(y));
  for (const PlacedGlyph& placed : layout.glyphs) {
    const GlyphPen pen = pen_at(x + placed.x);
    const GlyphBitmap glyph = glyph_bitmap(placed.codepoint, size_px, pen.phase);
    for (int row = 0; row < glyph.height; ++row)
      for (int column = 0; column < glyph.width; ++column)
        blend_pixel(image, pen.column + glyph.left + column, baseline + glyph.top + row, color,
                    glyph.coverage[row * glyph.width + column] / 255.0);
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
  GlyphBitmap halo{glyph.width + 2 * margin,
                   glyph.height + 2 * margin,
                   glyph.left - margin,
                   glyph.top - margin,
                   {}};
  halo.coverage.assign(static_cast<std::size_t>(halo.width) * halo.height, 0);
  for (int dy = -margin; dy <= margin; ++dy) {
    for (int dx = -margin; dx <= margin; ++dx) {
      const double weight = std::clamp(radius_px + 0.5 - std::hypot(dx, dy), 0.0, 1.0);
      if (weight <= 0) continue;
      for (int y = 0; y < glyph.height; ++y) {
        const std::uint8_t* from = glyph.coverage.data() + y * glyph.width;
        std::uint8_t* to = &halo.coverage[(y + margin + dy) * halo.width + margin + dx];
        for (int x = 0; x < glyph.width; ++x)
          to[x] = std::max(to[x], static_cast<std::uint8_t>(std::lround(from[x] * weight)));
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

// ---- Overlay of a picture ----

namespace {

/// A screen position.
Vec3f on_screen(double x, double y) { return {static_cast<float>(x), static_cast<float>(y), 0}; }

/// Layout with lengths that scale with the picture.
struct Pen {
  Overlay& overlay;
  const ThemeColors& theme;
  double scale;          // applied to all lengths below
  double width, height;  // picture size [px]

  float px(double length) const { return static_cast<float>(length * scale); }
  OverlayShape panel(double x0, double y0, double x1, double y1) const {
    const Vec3f low = on_screen(std::round(x0), std::round(y0));
    const Vec3f high = on_screen(std::round(x1), std::round(y1));
    return {low.x(), low.y(), high.x(), high.y(), theme.panel, theme.panel_border, px(7), 1};
  }
  /// Adds one line, truncated if wider than the available width. Returns its width.
  double add_line(double x,
                  double baseline,
                  double size_px,
                  const std::string& text,
                  Rgba color,
                  double room) const {
    const std::string line =
        shortened(text, [&](const auto& part) { return text_width(part, size_px) <= room; });
    overlay.texts.push_back({std::round(x), baseline, size_px, line, color});
    return text_width(line, size_px);
  }
  /// Adds a word with a halo.
  void add_word(double x,
                double baseline,
                double size_px,
                const std::string& text,
                Rgba color,
                double halo) const {
    const double left = x - text_width(text, size_px) / 2;
    overlay.texts.push_back({left, baseline, size_px, text, color, theme.halo, px(halo)});
  }
  void add_stroke(
      const Vec3f& from, const Vec3f& to, Rgba color, double thickness, float arrow = 0) const {
    overlay.segments.push_back({from, to, color, px(thickness), arrow, 0, 0});
  }
};

void add_heading(const Pen& pen, const DrawList& list) {
  if (list.title.empty() && list.subtitle.empty()) return;
  const double margin = pen.px(14), inset = pen.px(11);
  const double room = pen.width - 2 * (margin + inset);
  double y = margin + pen.px(9);
  double widest = 0;
  const auto add_line = [&](const std::string& text, double size_px, Rgba color) {
    y += size_px;
    widest = std::max(widest, pen.add_line(margin + inset, y, size_px, text, color, room));
  };
  if (!list.title.empty()) add_line(list.title, pen.px(18), pen.theme.ink);
  if (!list.title.empty() && !list.subtitle.empty()) y += pen.px(6);
  if (!list.subtitle.empty()) add_line(list.subtitle, pen.px(12.5), pen.theme.muted);
  pen.overlay.shapes.push_back(
      pen.panel(margin, margin, margin + 2 * inset + widest, y + pen.px(11)));
}

// Symbol of a legend entry, centered at (x, y).
void add_symbol(const Pen& pen, const LegendEntry& entry, double x, double y) {
  using Symbol = LegendEntry::Symbol;
  if (entry.symbol == Symbol::line || entry.symbol == Symbol::arrow) {
    const Vec3f middle = on_screen(x, y), half(pen.px(8), 0, 0);
    pen.add_stroke(middle - half, middle + half, entry.color, 2.4,
                   entry.symbol == Symbol::arrow ? 1.0f : 0.0f);
    return;
  }
  const double r = pen.px(6);
  const Vec3f low = on_screen(x - r, y - r), high = on_screen(x + r, y + r);
  OverlayShape shape{low.x(), low.y(), high.x(), high.y(), entry.color};
  shape.radius = entry.symbol == Symbol::dot ? static_cast<float>(r) : pen.px(2);
  if (entry.symbol != Symbol::dot) {
    shape.border = entry.color;
    shape.border_px = pen.px(1.4);
  }
  if (entry.symbol == Symbol::hatched_box) shape.hatch_period_px = pen.px(5);
  if (entry.symbol == Symbol::box) shape.fill.a = static_cast<std::uint8_t>(entry.color.a * 0.45);
  pen.overlay.shapes.push_back(shape);
}

// `top`: upper limit of the legend, which fills columns upward from the lower left corner.
void add_legend(const Pen& pen, const std::vector<LegendEntry>& legend, double top) {
  if (legend.empty()) return;
  const double margin = pen.px(14), inset = pen.px(11), row = pen.px(21);
  const double mark_room = pen.px(25);
  const double gap = pen.px(18);  // between columns
  const double size_px = pen.px(13);
  const double available = pen.height - margin - top - 2 * inset;
  const auto rows_that_fit = static_cast<std::size_t>(std::max(1.0, available / row));
  const std::size_t columns = (legend.size() + rows_that_fit - 1) / rows_that_fit;
  const std::size_t rows = (legend.size() + columns - 1) / columns;
  const double y0 = pen.height - margin - 2 * pen.px(8) - static_cast<double>(rows) * row;
  double x = margin + inset;
  const std::size_t panel = pen.overlay.shapes.size();  // drawn below the symbols
  pen.overlay.shapes.emplace_back();
  for (std::size_t first = 0; first < legend.size(); first += rows) {
    double widest = 0;
    const double room = pen.width - x - mark_room - margin - inset;
    for (std::size_t i = first; i < std::min(first + rows, legend.size()); ++i) {
      const double middle = y0 + pen.px(8) + (static_cast<double>(i - first) + 0.5) * row;
      add_symbol(pen, legend[i], x + pen.px(8), middle);
      widest =
          std::max(widest, pen.add_line(x + mark_room, middle + cap_height(size_px) / 2, size_px,
                                        legend[i].text, pen.theme.ink, std::max(room, 0.0)));
    }
    x += mark_room + widest + gap;
  }
  pen.overlay.shapes[panel] = pen.panel(margin, y0, x - gap + inset, pen.height - margin);
}

// The three world axes as seen by the camera, farthest first.
void add_axes(const Pen& pen, const View& view, double middle_x, double middle_y) {
  struct Axis {
    Vec3f in_eye;
    Rgba color;
    const char* name;
  };
  const Eigen::Matrix3f rotation = view.view.topLeftCorner<3, 3>();
  Axis axes[3] = {{rotation.col(0), pen.theme.axis_x, "x"},
                  {rotation.col(1), pen.theme.axis_y, "y"},
                  {rotation.col(2), pen.theme.axis_z, "z"}};
  std::ranges::stable_sort(axes, {}, [](const Axis& axis) { return axis.in_eye.z(); });
  const double letter_px = pen.px(13);
  const Vec3f from = on_screen(middle_x, middle_y);
  for (const Axis& axis : axes) {
    const Vec3f along(axis.in_eye.x(), -axis.in_eye.y(), 0);
    const Vec3f tip = from + along * pen.px(30);
    pen.add_stroke(from, tip, axis.color, 2.2, 1);
    // Place the letter beyond the tip or, for an axis along the view, beside the center.
    const float norm = along.norm();
    const Vec3f away = norm > 0.15f ? Vec3f(along / norm) : Vec3f(0.7071f, -0.7071f, 0);
    const Vec3f at = tip + away * pen.px(9);
    pen.add_word(at.x(), at.y() + 0.28 * letter_px, letter_px, axis.name, axis.color, 1.5);
  }
}

// A scale bar that ends at `right`, with its length above.
void add_scale_bar(const Pen& pen, const View& view, double right, double bottom) {
  const double max_px = std::min<double>(pen.px(150), 0.22 * pen.width);
  if (!(view.px_per_m_at_target > 0) || !std::isfinite(view.px_per_m_at_target)) return;
  const double length_m = round_length_m(view.px_per_m_at_target, max_px);
  const auto length_px = static_cast<float>(length_m * view.px_per_m_at_target);
  const Vec3f end = on_screen(std::round(right), std::round(bottom)) + Vec3f(0.5f, 0.5f, 0);
  const Vec3f begin = end - Vec3f(length_px, 0, 0), tick(0, pen.px(4), 0);
  for (const auto& [from, to] :
       {std::pair(begin, end), std::pair<Vec3f, Vec3f>(begin - tick, begin + tick),
        std::pair<Vec3f, Vec3f>(end - tick, end + tick)})
    pen.add_stroke(from, to, pen.theme.ink, 1.8);
  pen.add_word(0.5 * (begin.x() + end.x()), end.y() - pen.px(7), pen.px(12.5),
               length_text(length_m), pen.theme.ink, 1.8);
}

/// Bounds of a text.
struct Box {
  double x0, y0, x1, y1;
  bool overlaps(const Box& other) const {
    return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
  }
};
Box box_of(const OverlayText& text) {
  return {text.x, text.baseline - 0.8 * text.size_px, text.x + text_width(text.text, text.size_px),
          text.baseline + 0.1 * text.size_px};
}

// Whether a label overlaps a panel, the axes or the scale bar.
bool is_covered(const Box& label, const Overlay& by) {
  const auto is_on = [&](const Box& box) { return label.overlaps(box); };
  return std::ranges::any_of(by.shapes, is_on,
                             [](const OverlayShape& s) {
                               return Box{s.x0, s.y0, s.x1, s.y1};
                             }) ||
         std::ranges::any_of(
             by.segments, is_on,
             [](const Segment& s) {
               const double half = s.width_px / 2;
               const Vec3f low = s.a.cwiseMin(s.b), high = s.a.cwiseMax(s.b);
               return Box{low.x() - half, low.y() - half, high.x() + half, high.y() + half};
             }) ||
         std::ranges::any_of(by.texts, is_on, box_of);
}

struct PlacedLabel {
  double depth_m = 0, width = 0;
  std::int32_t rank = kSelectedLabel;
  OverlayText text;

  bool overlaps(const PlacedLabel& other) const {
    const double apart_x =
        std::max(text.x - (other.text.x + other.width), other.text.x - (text.x + width));
    const double apart_y = std::abs(text.baseline - other.text.baseline) -
                           0.9 * std::max(text.size_px, other.text.size_px);
    return apart_x < 0 && apart_y < 0;
  }
};

// Adds labels where the picture is free. If labels overlap, keeps the one with the lowest rank,
// or the nearest if equal.
void add_labels(const Pen& pen, const std::vector<DrawLabel>& labels, const View& view) {
  std::vector<PlacedLabel> placed;
  const double scale = std::max(1.0, pen.scale);
  for (const DrawLabel& label : labels) {
    const auto at = project(view, label.anchor);
    if (!at || label.text.empty()) continue;
    const double size_px = scale * label.size_px;
    const double width = text_width(label.text, size_px);
    const double wanted = at->px.x() - width / 2;
    if (wanted > pen.width || wanted + width < 0) continue;
    const double margin = pen.px(3);
    // Keep the label inside the picture.
    const double x = std::max(std::min(wanted, pen.width - width - margin), margin);
    if (at->px.y() < -size_px || at->px.y() > pen.height + size_px) continue;
    const OverlayText text = {.x = x,
                              .baseline = at->px.y() + cap_height(size_px) / 2,
                              .size_px = size_px,
                              .text = label.text,
                              .color = label.color,
                              .halo = pen.theme.halo,
                              .halo_px = std::clamp(0.16 * size_px, 1.5, 4.0)};
    if (!is_covered(box_of(text), pen.overlay))
      placed.push_back({at->depth_m, width, label.rank, text});
  }
  std::ranges::stable_sort(
      placed, {}, [](const PlacedLabel& label) { return std::pair(label.rank, label.depth_m); });
  std::vector<const PlacedLabel*> kept;
  for (const PlacedLabel& label : placed) {
    if (std::ranges::any_of(kept, [&](const auto* other) { return label.overlaps(*other); }))
      continue;
    kept.push_back(&label);
    pen.overlay.labels.push_back(label.text);
  }
}

}  // namespace

Overlay layout_overlay(const DrawList& list,
                       const View& view,
                       const ThemeColors& theme,
                       OverlayPart part) {
  Overlay overlay;
  const Pen pen = {overlay, theme, overlay_scale(view), static_cast<double>(view.width),
                   static_cast<double>(view.height)};
  if (part != OverlayPart::scene) {
    add_heading(pen, list);
    const double below_heading = overlay.shapes.empty() ? 0 : overlay.shapes.back().y1;
    add_legend(pen, list.legend, below_heading + pen.px(10));
  }
  if (part == OverlayPart::panels) return overlay;
  double right = pen.width - pen.px(22);
  if (list.show_axes) {
    const double reach = pen.px(50);
    add_axes(pen, view, pen.width - pen.px(8) - reach, pen.height - pen.px(8) - reach);
    right = pen.width - pen.px(20) - 2 * reach;
  }
  if (list.show_scale_bar) add_scale_bar(pen, view, right, pen.height - pen.px(24));
  add_labels(pen, list.labels, view);  // last, so that labels avoid everything else
  return overlay;
}

double overlay_scale(const View& view) {
  const double width = view.width / view.screen_scale, height = view.height / view.screen_scale;
  const double large = std::min(height / 720.0, width / 900.0);
  const double small = std::min({height / 500.0, width / 640.0, 1.0});  // panel of a window
  return view.screen_scale * std::clamp(std::max(large, small), 0.7, 2.5);
}

double round_length_m(double px_per_m, double max_px) {
  const double longest_m = max_px / px_per_m;
  const double decade = std::pow(10.0, std::floor(std::log10(longest_m)));
  for (const double step : {5.0, 2.0})
    if (step * decade <= longest_m) return step * decade;
  return decade;
}

std::string length_text(double length_m) {
  if (length_m >= 999.5) return fmt::format("{:g} km", length_m / 1000);
  if (length_m >= 0.9995) return fmt::format("{:g} m", length_m);
  if (length_m >= 0.009995) return fmt::format("{:g} cm", length_m * 100);
  return fmt::format("{:g} mm", length_m * 1000);
}

}  // namespace planescope::render
