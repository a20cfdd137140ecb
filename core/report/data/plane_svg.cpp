// Draws each plane of a frame as SVG: outline, foot space, best place and cross-section.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/report/data/segment_files.hpp"

namespace planescope::report {
namespace {

using planes::Certainty;
using planes::Foothold;
using planes::Outline;
using planes::PolygonRing;

// A panel: lines of text, the plane, and below it a cross-section.
constexpr double kWidthPx = 320, kTextPx = 78, kPlanePx = 240, kCutPx = 96, kGapPx = 20;
constexpr double kPanelPx = kTextPx + kPlanePx + kCutPx, kBandPx = 34;  // half the section's height
constexpr int kColumns = 3;
constexpr double kDeg = 180 / M_PI;

constexpr const char* kStyle =
    "text { font: 13px sans-serif; fill: #222 }\n"
    ".small { font-size: 10px }\n"
    ".covers { fill: #c9d3dc; stroke: #51616f }\n"
    ".hole { fill: #fff; stroke: #8a4b2a }\n"
    ".unknown { fill: #f3e6c4; stroke: #b08d2e; stroke-dasharray: 3 2 }\n"
    ".foot { fill: #8fc79a; fill-rule: evenodd }\n"
    ".piece { fill: none; stroke: #1f7a37 }\n"
    ".best { fill: none; stroke: #b3261e; stroke-dasharray: 4 3 }\n"
    ".cut { fill: none; stroke: #2f5fa8; stroke-dasharray: 7 3 1 3 }\n"
    ".band { fill: #d5e0f2 }\n"
    ".place { fill: #2f5fa8 }\n"
    ".rule { fill: none; stroke: #222 }\n";

std::string drawn(const char* kind, const std::string& path) {
  return path.empty() ? path : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", kind, path);
}

std::string written(const Vec2d& at, const std::string& text, const char* kind = "small") {
  return fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kind, at.x(),
                     at.y(), text);
}

/// The largest round length up to `most`: 1, 2 or 5 times a power of ten.
double round_length(double most) {
  const double ten = std::pow(10, std::floor(std::log10(most)));
  return ten * (most >= 5 * ten ? 5 : most >= 2 * ten ? 2 : 1);
}

std::string path_of(const std::vector<Vec2d>& corners) {
  std::string text;
  for (const Vec2d& p : corners)
    text += fmt::format("{}{:.1f} {:.1f}", text.empty() ? 'M' : 'L', p.x(), p.y());
  return text;
}

/// Maps a plane to its panel: fitted to the panel, with v up.
class View {
 public:
  View(const Outline& outline, const Vec2d& corner) : corner_(corner) {
    for (const Outline::Part& part : outline.parts)
      for (const Vec2d& p : part.outer) box_.extend(p);
    if (box_.isEmpty()) return;
    const Vec2d size = box_.sizes().cwiseMax(1e-6);
    scale_ = std::min(kWidthPx / size.x(), (kPlanePx - 30) / size.y());  // space for the scale
  }
  double px(double metres) const { return metres * scale_; }
  Vec2d at(const Vec2d& p) const {
    return corner_ + scale_ * Vec2d(p.x() - box_.min().x(), box_.max().y() - p.y());
  }
  std::string path(const PolygonRing& ring) const {
    std::vector<Vec2d> corners;
    for (const Vec2d& p : ring) corners.push_back(at(p));
    return path_of(corners) + "Z";
  }
  std::string scale() const {
    const double length_m = round_length(100 / scale_);
    const Vec2d from = corner_ + Vec2d(0, kPlanePx - 10), to = from + Vec2d(px(length_m), 0);
    return drawn("rule", path_of({from + Vec2d(0, -4), from, to, to + Vec2d(0, -4)})) +
           written(to + Vec2d(6, 2), fmt::format("{:g} cm", length_m * 100));
  }

 private:
  Vec2d corner_;
  Eigen::AlignedBox2d box_;
  double scale_ = 1;
};

std::string outline_svg(const View& view, const Outline& outline) {
  std::string covers, holes, unknown;
  for (const Outline::Part& part : outline.parts) {
    covers += view.path(part.outer);
    for (const PolygonRing& hole : part.holes) holes += view.path(hole);
    for (const PolygonRing& hole : part.unknown) unknown += view.path(hole);
  }
  return drawn("covers", covers) + drawn("hole", holes) + drawn("unknown", unknown);
}

std::string foot_svg(const View& view, const planes::FootSpace& space) {
  std::string foot, pieces;
  for (const planes::Polygon& polygon : space.area) {
    foot += view.path(polygon.outer);
    for (const PolygonRing& hole : polygon.holes) foot += view.path(hole);
  }
  for (const PolygonRing& piece : space.pieces) pieces += view.path(piece);
  return drawn("foot", foot) + drawn("piece", pieces);
}

/// The circle at the best place, and the line of the cross-section.
std::string marks_svg(const View& view, const Outline& outline, const Foothold& foothold) {
  const auto on_plane = [&](const Vec3d& v) {
    return Vec2d(outline.basis.u.dot(v), outline.basis.v.dot(v));
  };
  const Vec2d best = view.at(on_plane(foothold.surface.best_place - outline.origin));
  std::string svg =
      fmt::format("<circle class=\"best\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", best.x(),
                  best.y(), view.px(foothold.surface.clearance_m));
  if (foothold.cut.empty()) return svg;
  const Vec2d towards = on_plane(foothold.certainty.axes[0]);
  return svg + drawn("cut", path_of({view.at(towards * foothold.cut.front().x()),
                                     view.at(towards * foothold.cut.back().x())}));
}

/// Measured points from the side, and the 2 sigma range of the true plane's height.
std::string cut_svg(const Foothold& foothold, const Vec2d& corner) {
  const std::vector<Vec2d>& cut = foothold.cut;
  if (cut.size() < 2) return {};
  const Certainty& known = foothold.certainty;
  const double low_m = cut.front().x(), length_m = std::max(1e-6, cut.back().x() - low_m);
  const auto band_m = [&](double x) {
    return 2 * std::hypot(known.sigma_offset_m, x * known.sigma_tilt_rad[0]);
  };
  double most_m = std::max({0.001, band_m(low_m), band_m(cut.back().x())});
  for (const Vec2d& place : cut) most_m = std::max(most_m, std::abs(place.y()));
  const auto at = [&](double x, double height_m) -> Vec2d {
    return corner + Vec2d((x - low_m) / length_m * kWidthPx, 46 - height_m / most_m * kBandPx);
  };
  std::vector<Vec2d> upper, lower;
  constexpr int kParts = 16;
  for (int i = 0; i <= kParts; ++i) {
    const double x = low_m + length_m * i / kParts;
    upper.push_back(at(x, band_m(x)));
    lower.push_back(at(x, -band_m(x)));
  }
  upper.insert(upper.end(), lower.rbegin(), lower.rend());
  std::string svg = drawn("band", path_of(upper) + "Z") +
                    drawn("cut", path_of({at(low_m, 0), at(cut.back().x(), 0)}));
  for (const Vec2d& place : cut) {
    const Vec2d p = at(place.x(), place.y());
    svg += fmt::format("<circle class=\"place\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.5\"/>\n", p.x(),
                       p.y());
  }
  const double rule_m = round_length(1.2 * most_m);
  const Vec2d up(kWidthPx + 5, 46 - rule_m / most_m * kBandPx / 2);
  const Vec2d top = corner + up, bottom = top + Vec2d(0, rule_m / most_m * kBandPx);
  return svg + drawn("rule", path_of({top, bottom})) +
         written(
             corner + Vec2d(0, 92),
             fmt::format("section of {:.0f} cm, heights enlarged {:.0f} times; scale bar: "
                         "{:g} mm",
                         length_m * 100, kBandPx / most_m / (kWidthPx / length_m), rule_m * 1e3));
}

std::string facts_svg(const planes::FramePlanes& found, std::size_t k, const Vec2d& corner) {
  const planes::PlaneSummary& s = found.summaries[k];
  const Foothold& foothold = found.footholds[k];
  const planes::Surface& surface = foothold.surface;
  const Certainty& known = foothold.certainty;
  std::string svg = written(
      corner + Vec2d(0, 14),
      fmt::format("Plane {}, {}, {:.2f} m2", s.id, to_string(s.label), found.outlines[k].area_m2),
      "title");
  if (foothold.space) {
    // If the reasons are too long for the panel: the first in full, and the number of the others.
    constexpr std::size_t kMostLetters = 58;
    std::string why = foothold.why_not;
    if (why.size() > kMostLetters) {
      const auto more = std::ranges::count(why, ';');
      why = fmt::format("{}; {} more", why.substr(0, why.find(';')), more);
    }
    svg +=
        written(corner + Vec2d(0, 30), foothold.steppable ? "steppable" : "not steppable: " + why);
  }
  const std::string slope = std::isnan(surface.slope_deg)
                                ? std::string("slope unknown")
                                : fmt::format("slope {:.1f} deg", surface.slope_deg);
  svg +=
      written(corner + Vec2d(0, 44),
              fmt::format("{}, rough {:.1f} mm, steps {:.1f} mm, support {:.2f}", slope,
                          surface.rough_rms_m * 1e3, surface.rough_step_m * 1e3, surface.support));
  return svg + written(corner + Vec2d(0, 58),
                       fmt::format(
                           "clearance {:.1f} cm; sigma: tilt {:.2f} and {:.2f} deg, offset {:.1f} "
                           "mm",
                           surface.clearance_m * 100, known.sigma_tilt_rad[0] * kDeg,
                           known.sigma_tilt_rad[1] * kDeg, known.sigma_offset_m * 1e3));
}

std::string plane_svg(const planes::FramePlanes& found, std::size_t k, const Vec2d& corner) {
  const Outline& outline = found.outlines[k];
  const Foothold& foothold = found.footholds[k];
  const View view(outline, corner + Vec2d(0, kTextPx));
  return facts_svg(found, k, corner) + outline_svg(view, outline) +
         (foothold.space ? foot_svg(view, *foothold.space) : std::string()) +
         marks_svg(view, outline, foothold) + view.scale() +
         cut_svg(foothold, corner + Vec2d(0, kTextPx + kPlanePx));
}

constexpr double kEntryPx = 170, kEntryRowPx = 18;

/// Legend of the colors, in as many columns as fit.
std::string legend_svg(const Vec2d& corner, int columns) {
  constexpr std::array<std::array<const char*, 2>, 9> kEntries = {
      {{"covers", "area of the plane"},
       {"hole", "hole: something else seen"},
       {"unknown", "unknown: not measured"},
       {"foot", "for the foot's center"},
       {"piece", "convex pieces of it"},
       {"best", "largest circle"},
       {"cut", "section; fitted plane"},
       {"place", "places in the section"},
       {"band", "true plane, 2 sigma"}}};
  std::string svg;
  for (std::size_t i = 0; i < kEntries.size(); ++i) {
    const Vec2d at = corner + Vec2d(kEntryPx * static_cast<double>(i % columns),
                                    kEntryRowPx * static_cast<double>(i / columns));
    const std::string kind = kEntries[i][0];
    if (kind == "cut")
      svg += drawn("cut", path_of({at + Vec2d(0, 5), at + Vec2d(18, 5)}));
    else if (kind == "place" || kind == "best")
      svg += fmt::format("<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>\n", kind,
                         at.x() + 9, at.y() + 5, kind == "best" ? "6" : "1.5");
    else
      svg +=
          fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"18\" height=\"10\"/>\n",
                      kind, at.x(), at.y());
    svg += written(at + Vec2d(24, 9), kEntries[i][1]);
  }
  return svg;
}

}  // namespace

std::string planes_svg(const planes::FramePlanes& found) {
  const double column_px = kWidthPx + kGapPx, row_px = kPanelPx + kGapPx;
  const int count = static_cast<int>(found.summaries.size());
  const int columns = std::clamp(count, 1, kColumns), rows = (count + kColumns - 1) / kColumns;
  const double width_px = columns * column_px + kGapPx;
  const int legend_columns = static_cast<int>((width_px - kGapPx) / kEntryPx);
  const double legend_px = kEntryRowPx * std::ceil(9.0 / legend_columns);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<style>\n{2}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width_px, rows * row_px + legend_px + kGapPx, kStyle);
  for (int k = 0; k < count; ++k)
    svg += plane_svg(found, static_cast<std::size_t>(k),
                     {kGapPx + (k % kColumns) * column_px, kGapPx / 2 + (k / kColumns) * row_px});
  return svg + legend_svg({kGapPx, rows * row_px + kGapPx / 2}, legend_columns) + "</svg>\n";
}

}  // namespace planescope::report
