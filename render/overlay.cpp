#include "render/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"
#include "render/paint.hpp"

namespace planescope::render {
namespace {

// One line of text, shortened where it is wider than there is room.
std::string fitted(const std::string& text, double size_px, double room_px) {
  return shortened(text,
                   [&](const std::string& part) { return text_width(part, size_px) <= room_px; });
}

struct Pen {
  Overlay& overlay;
  const ThemeColors& theme;
  double scale;          // of all lengths below
  double width, height;  // of the picture [px]

  float px(double length) const { return static_cast<float>(length * scale); }
};

OverlayShape make_panel(const Pen& pen, double x0, double y0, double x1, double y1) {
  OverlayShape panel;
  panel.x0 = static_cast<float>(std::round(x0));
  panel.y0 = static_cast<float>(std::round(y0));
  panel.x1 = static_cast<float>(std::round(x1));
  panel.y1 = static_cast<float>(std::round(y1));
  panel.fill = pen.theme.panel;
  panel.border = pen.theme.panel_border;
  panel.radius = pen.px(7);
  panel.border_px = 1;
  return panel;
}

void add_heading(const Pen& pen, const DrawList& list) {
  if (list.title.empty() && list.subtitle.empty()) return;
  const double margin = pen.px(14);
  const double inset = pen.px(11);
  const double room = pen.width - 2 * (margin + inset);
  const double title_px = pen.px(18);
  const double subtitle_px = pen.px(12.5);
  double y = margin + pen.px(9);
  double widest = 0;
  const auto add_line = [&](const std::string& text, double size_px, Rgba color) {
    const std::string line = fitted(text, size_px, room);
    y += size_px;
    pen.overlay.texts.push_back({.x = std::round(margin + inset),
                                 .baseline = y,
                                 .size_px = size_px,
                                 .text = line,
                                 .color = color});
    widest = std::max(widest, text_width(line, size_px));
  };
  if (!list.title.empty()) add_line(list.title, title_px, pen.theme.ink);
  if (!list.title.empty() && !list.subtitle.empty()) y += pen.px(6);
  if (!list.subtitle.empty()) add_line(list.subtitle, subtitle_px, pen.theme.muted);
  pen.overlay.shapes.push_back(
      make_panel(pen, margin, margin, margin + 2 * inset + widest, y + pen.px(11)));
}

// The mark of a legend entry, about (x, y) as its middle.
void add_mark(const Pen& pen, const LegendEntry& entry, double x, double y) {
  const double r = pen.px(6);
  const auto fx = static_cast<float>(x);
  const auto fy = static_cast<float>(y);
  OverlayShape shape;
  shape.x0 = static_cast<float>(x - r);
  shape.y0 = static_cast<float>(y - r);
  shape.x1 = static_cast<float>(x + r);
  shape.y1 = static_cast<float>(y + r);
  shape.fill = entry.color;
  switch (entry.mark) {
    case LegendEntry::Mark::dot:
      shape.radius = static_cast<float>(r);
      pen.overlay.shapes.push_back(shape);
      break;
    case LegendEntry::Mark::box:
    case LegendEntry::Mark::hatched_box:
      shape.border = entry.color;
      shape.border_px = pen.px(1.4);
      shape.radius = pen.px(2);
      if (entry.mark == LegendEntry::Mark::hatched_box) {
        shape.hatch_period_px = pen.px(5);
      } else {
        shape.fill.a = static_cast<std::uint8_t>(entry.color.a * 0.45);
      }
      pen.overlay.shapes.push_back(shape);
      break;
    case LegendEntry::Mark::line:
    case LegendEntry::Mark::arrow: {
      const float half = pen.px(8);
      const float arrow = entry.mark == LegendEntry::Mark::arrow ? 1.0f : 0.0f;
      pen.overlay.segments.push_back({Vec3f(fx - half, fy, 0), Vec3f(fx + half, fy, 0), entry.color,
                                      pen.px(2.4), arrow, 0, 0});
      break;
    }
  }
}

// `top`: where the legend may begin; it fills columns upwards from the lower left corner.
void add_legend(const Pen& pen, const std::vector<LegendEntry>& legend, double top) {
  if (legend.empty()) return;
  const double margin = pen.px(14);
  const double inset = pen.px(11);
  const double row = pen.px(21);
  const double mark_room = pen.px(25);
  const double gap = pen.px(18);  // between columns
  const double size_px = pen.px(13);
  const double available = pen.height - margin - top - 2 * inset;
  const auto rows_that_fit = static_cast<std::size_t>(std::max(1.0, available / row));
  const std::size_t columns = (legend.size() + rows_that_fit - 1) / rows_that_fit;
  const std::size_t rows = (legend.size() + columns - 1) / columns;
  const double y0 = pen.height - margin - 2 * pen.px(8) - static_cast<double>(rows) * row;
  double x = margin + inset;
  const std::size_t panel = pen.overlay.shapes.size();  // below the marks
  pen.overlay.shapes.emplace_back();
  for (std::size_t first = 0; first < legend.size(); first += rows) {
    double widest = 0;
    const double room = pen.width - x - mark_room - margin - inset;
    for (std::size_t i = first; i < std::min(first + rows, legend.size()); ++i) {
      const double middle = y0 + pen.px(8) + (static_cast<double>(i - first) + 0.5) * row;
      const std::string text = fitted(legend[i].text, size_px, std::max(room, 0.0));
      add_mark(pen, legend[i], x + pen.px(8), middle);
      pen.overlay.texts.push_back({.x = std::round(x + mark_room),
                                   .baseline = middle + cap_height(size_px) / 2,
                                   .size_px = size_px,
                                   .text = text,
                                   .color = pen.theme.ink});
      widest = std::max(widest, text_width(text, size_px));
    }
    x += mark_room + widest + gap;
  }
  pen.overlay.shapes[panel] = make_panel(pen, margin, y0, x - gap + inset, pen.height - margin);
}

// The three world axes as seen by the camera, the farthest first.
void add_axes(const Pen& pen, const View& view, double middle_x, double middle_y) {
  struct Axis {
    Eigen::Vector3f in_eye;
    Rgba color;
    const char* name;
  };
  const Eigen::Matrix3f rotation = view.view.topLeftCorner<3, 3>();
  Axis axes[3] = {{rotation.col(0), pen.theme.axis_x, "x"},
                  {rotation.col(1), pen.theme.axis_y, "y"},
                  {rotation.col(2), pen.theme.axis_z, "z"}};
  std::stable_sort(std::begin(axes), std::end(axes),
                   [](const Axis& a, const Axis& b) { return a.in_eye.z() < b.in_eye.z(); });
  const float length = pen.px(30);
  const double letter_px = pen.px(13);
  for (const Axis& axis : axes) {
    const Vec3f from(static_cast<float>(middle_x), static_cast<float>(middle_y), 0);
    const Vec3f on_screen(axis.in_eye.x(), -axis.in_eye.y(), 0);
    pen.overlay.segments.push_back(
        {from, from + on_screen * length, axis.color, pen.px(2.2), 1, 0, 0});
    // The letter stands off the tip; for an axis along the view, beside the middle.
    const float norm = on_screen.norm();
    const Vec3f away = norm > 0.15f ? Vec3f(on_screen / norm) : Vec3f(0.7071f, -0.7071f, 0);
    const Vec3f at = from + on_screen * length + away * pen.px(9);
    const double half = text_width(axis.name, letter_px) / 2;
    pen.overlay.texts.push_back({.x = at.x() - half,
                                 .baseline = at.y() + 0.28 * letter_px,
                                 .size_px = letter_px,
                                 .text = axis.name,
                                 .color = axis.color,
                                 .halo = pen.theme.halo,
                                 .halo_px = pen.px(1.5)});
  }
}

// A bar that ends at `right`, its length above it.
void add_scale_bar(const Pen& pen, const View& view, double right, double bottom) {
  const double max_px = std::min<double>(pen.px(150), 0.22 * pen.width);
  if (!(view.px_per_m_at_target > 0) || !std::isfinite(view.px_per_m_at_target)) return;
  const double length_m = round_length_m(view.px_per_m_at_target, max_px);
  const auto length_px = static_cast<float>(length_m * view.px_per_m_at_target);
  const auto x1 = static_cast<float>(std::round(right)) + 0.5f;
  const float x0 = x1 - length_px;
  const auto y = static_cast<float>(std::round(bottom)) + 0.5f;
  const float tick = pen.px(4);
  const float width = pen.px(1.8);
  const Rgba color = pen.theme.ink;
  const auto stroke = [&](float xa, float ya, float xb, float yb) {
    pen.overlay.segments.push_back({Vec3f(xa, ya, 0), Vec3f(xb, yb, 0), color, width, 0, 0, 0});
  };
  stroke(x0, y, x1, y);
  stroke(x0, y - tick, x0, y + tick);
  stroke(x1, y - tick, x1, y + tick);
  const std::string text = length_text(length_m);
  const double size_px = pen.px(12.5);
  pen.overlay.texts.push_back({.x = 0.5 * (x0 + x1) - text_width(text, size_px) / 2,
                               .baseline = y - pen.px(7),
                               .size_px = size_px,
                               .text = text,
                               .color = color,
                               .halo = pen.theme.halo,
                               .halo_px = pen.px(1.8)});
}

struct PlacedLabel {
  double depth_m = 0;
  double width = 0;
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

// Whether a label would stand on a panel, the axes or the scale bar.
bool is_covered(const OverlayText& label, double width, const Overlay& by) {
  const double top = label.baseline - 0.8 * label.size_px;
  const double bottom = label.baseline + 0.1 * label.size_px;
  const auto covers = [&](double x0, double y0, double x1, double y1) {
    return label.x < x1 && x0 < label.x + width && top < y1 && y0 < bottom;
  };
  return std::any_of(by.shapes.begin(), by.shapes.end(),
                     [&](const OverlayShape& s) { return covers(s.x0, s.y0, s.x1, s.y1); }) ||
         std::any_of(by.segments.begin(), by.segments.end(),
                     [&](const Segment& s) {
                       const double half = s.width_px / 2;
                       const Vec3f low = s.a.cwiseMin(s.b);
                       const Vec3f high = s.a.cwiseMax(s.b);
                       return covers(low.x() - half, low.y() - half, high.x() + half,
                                     high.y() + half);
                     }) ||
         std::any_of(by.texts.begin(), by.texts.end(), [&](const OverlayText& text) {
           return covers(text.x, text.baseline - 0.8 * text.size_px,
                         text.x + text_width(text.text, text.size_px),
                         text.baseline + 0.1 * text.size_px);
         });
}

// By rank, then the nearest.
void drop_overlapping(std::vector<PlacedLabel>& labels) {
  std::stable_sort(labels.begin(), labels.end(), [](const PlacedLabel& a, const PlacedLabel& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.depth_m < b.depth_m;
  });
  std::vector<PlacedLabel> kept;
  for (PlacedLabel& label : labels) {
    const auto covers = [&](const PlacedLabel& other) { return label.overlaps(other); };
    if (std::none_of(kept.begin(), kept.end(), covers)) kept.push_back(std::move(label));
  }
  labels = std::move(kept);
}

// Where nothing else lies over the picture yet.
void add_labels(const Pen& pen, const std::vector<DrawLabel>& labels, const View& view) {
  std::vector<PlacedLabel> placed;
  const double scale = std::max(1.0, pen.scale);
  for (const DrawLabel& label : labels) {
    const auto at = project(view, label.anchor);
    if (!at || label.text.empty()) continue;
    const double size_px = scale * label.size_px;
    const double width = text_width(label.text, size_px);
    const double wanted = at->px.x() - (label.centered ? width / 2 : 0);
    if (wanted > pen.width || wanted + width < 0) continue;
    const double margin = pen.px(3);
    const double x = std::max(std::min(wanted, pen.width - width - margin), margin);  // all of it
    if (at->px.y() < -size_px || at->px.y() > pen.height + size_px) continue;
    const OverlayText text = {.x = x,
                              .baseline = at->px.y() + cap_height(size_px) / 2,
                              .size_px = size_px,
                              .text = label.text,
                              .color = label.color,
                              .halo = pen.theme.halo,
                              .halo_px = std::clamp(0.16 * size_px, 1.5, 4.0)};
    if (!is_covered(text, width, pen.overlay))
      placed.push_back({at->depth_m, width, label.rank, text});
  }
  drop_overlapping(placed);
  for (PlacedLabel& label : placed) pen.overlay.labels.push_back(std::move(label.text));
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
  add_labels(pen, list.labels, view);  // last: they keep clear of all the rest
  return overlay;
}

double overlay_scale(const View& view) {
  const double width = view.width / view.screen_scale, height = view.height / view.screen_scale;
  const double large = std::min(height / 720.0, width / 900.0);
  const double small = std::min({height / 500.0, width / 640.0, 1.0});  // a panel of a window
  return view.screen_scale * std::clamp(std::max(large, small), 0.7, 2.5);
}

double round_length_m(double px_per_m, double max_px) {
  const double longest_m = max_px / px_per_m;
  const double decade = std::pow(10.0, std::floor(std::log10(longest_m)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= longest_m) return step * decade;
  }
  return decade;
}

std::string length_text(double length_m) {
  if (length_m >= 999.5) return fmt::format("{:g} km", length_m / 1000);
  if (length_m >= 0.9995) return fmt::format("{:g} m", length_m);
  if (length_m >= 0.009995) return fmt::format("{:g} cm", length_m * 100);
  return fmt::format("{:g} mm", length_m * 1000);
}

}  // namespace planescope::render
