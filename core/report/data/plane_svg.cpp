#include "core/report/data/plane_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace planescope::report {
namespace {

using planes::PolygonRing;

constexpr double kPanelPx = 320, kGapPx = 16, kTextPx = 44;
constexpr int kColumns = 3;

constexpr const char* kStyle =
    "text { font: 13px sans-serif; fill: #222 }\n"
    ".why { font-size: 10px }\n"
    ".covers { fill: #c9d3dc; stroke: #51616f; fill-rule: evenodd }\n"
    ".unknown { fill: #f3e6c4; stroke: #b08d2e }\n"
    ".foot { fill: #8fc79a; fill-rule: evenodd }\n"
    ".piece { fill: none; stroke: #1f7a37 }\n"
    ".best { fill: none; stroke: #b3261e; stroke-dasharray: 4 3 }\n";

/// From a plane to its panel: all of it, as large as there is room, v upwards.
class Panel {
 public:
  Panel(const planes::Outline& outline, const Vec2d& corner) : corner_(corner) {
    for (const planes::Outline::Part& part : outline.parts)
      for (const Vec2d& p : part.outer) box_.extend(p);
    if (!box_.isEmpty()) scale_ = kPanelPx / std::max(1e-6, box_.sizes().maxCoeff());
  }
  double px(double metres) const { return metres * scale_; }
  Vec2d at(const Vec2d& p) const {
    return corner_ + scale_ * Vec2d(p.x() - box_.min().x(), box_.max().y() - p.y());
  }
  std::string path(const PolygonRing& ring) const {
    std::string text;
    for (const Vec2d& p : ring)
      text += fmt::format("{}{:.1f} {:.1f}", text.empty() ? 'M' : 'L', at(p).x(), at(p).y());
    return text + "Z";
  }

 private:
  Vec2d corner_;
  Eigen::AlignedBox2d box_;
  double scale_ = 1;
};

std::string drawn(const char* kind, const std::string& path) {
  return path.empty() ? path : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, path);
}

std::string plane_svg(const FramePlanes& found, std::size_t k, const Vec2d& corner) {
  const planes::Outline& outline = found.outlines[k];
  const planes::Foothold& foothold = found.footholds[k];
  const Panel panel(outline, corner + Vec2d(0, kTextPx));
  std::string covers, unknown, foot, pieces, svg;
  for (const planes::Outline::Part& part : outline.parts) {
    covers += panel.path(part.outer);
    for (const PolygonRing& hole : part.holes) covers += panel.path(hole);
    for (const PolygonRing& hole : part.unknown) unknown += panel.path(hole);
  }
  if (foothold.space) {
    for (const planes::Polygon& polygon : foothold.space->area) {
      foot += panel.path(polygon.outer);
      for (const PolygonRing& hole : polygon.holes) foot += panel.path(hole);
    }
    for (const PolygonRing& piece : foothold.space->pieces) pieces += panel.path(piece);
  }
  const PlaneSummary& s = found.summaries[k];
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">Plane {}, {}, {:.2f} m2</text>\n", corner.x(),
                     corner.y() + 14, s.id, to_string(s.label), outline.area_m2);
  if (foothold.space)
    svg += fmt::format("<text class=\"why\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", corner.x(),
                       corner.y() + 32,
                       foothold.steppable ? "steppable" : "not steppable: " + foothold.why_not);
  svg += drawn("covers", covers) + drawn("unknown", unknown) + drawn("foot", foot) +
         drawn("piece", pieces);
  const Vec3d to_best = foothold.surface.best_place - outline.origin;
  const Vec2d best = panel.at({outline.basis.u.dot(to_best), outline.basis.v.dot(to_best)});
  return svg + fmt::format("<circle class=\"best\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n",
                           best.x(), best.y(), panel.px(foothold.surface.clearance_m));
}

}  // namespace

std::string planes_svg(const FramePlanes& found) {
  const double column_px = kPanelPx + kGapPx, row_px = kTextPx + kPanelPx + kGapPx;
  const int count = static_cast<int>(found.summaries.size());
  const int columns = std::clamp(count, 1, kColumns), rows = (count + kColumns - 1) / kColumns;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<style>\n{2}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      columns * column_px + kGapPx, rows * row_px + kGapPx, kStyle);
  for (int k = 0; k < count; ++k)
    svg += plane_svg(found, static_cast<std::size_t>(k),
                     {kGapPx + (k % kColumns) * column_px, kGapPx + (k / kColumns) * row_px});
  return svg + "</svg>\n";
}

}  // namespace planescope::report
