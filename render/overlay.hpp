#pragma once

// What lies over a picture, laid out in pixels without GL: title, legend, axes, scale bar, labels.

#include <string>
#include <vector>

#include "render/palette.hpp"
#include "render/view.hpp"

namespace planescope::render {

/// A line or arrow of constant width on screen.
struct Segment {
  Vec3f a, b;
  Rgba color;
  float width_px = 1;
  float arrow = 0;   // 1: with a head at b
  float bias_m = 0;  // drawn this much nearer to the eye
  std::uint32_t id = 0;
};

struct OverlayShape {  // rounded rectangle, in pixels from the top left corner
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  Rgba fill, border;
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

/// `panels`: title and legend; `scene`: all else.
enum class OverlayPart : std::uint8_t { all, scene, panels };
Overlay layout_overlay(const DrawList& list,
                       const View& view,
                       const ThemeColors& theme,
                       OverlayPart part = OverlayPart::all);

/// Scale of text and line widths, which grow with the picture: 1 for one of 500 to 720 rows on an
/// ordinary screen, so that text stays legible in a panel of a window.
double overlay_scale(const View& view);

/// The longest length of the series 1, 2, 5, 10, ... that takes at most `max_px`.
double round_length_m(double px_per_m, double max_px);
std::string length_text(double length_m);  // "5 mm", "20 cm", "1 m", "2 km"

}  // namespace planescope::render
