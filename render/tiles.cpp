// Finds the changed parts of a picture (renderer.hpp).

#include <algorithm>
#include <cmath>
#include <span>

#include "render/paint.hpp"
#include "render/renderer.hpp"

namespace planescope::render {
namespace {

constexpr int kTile_px = 32;  // a few letters: changes are seldom smaller

int tiles_along(int length_px) { return (length_px + kTile_px - 1) / kTile_px; }

}  // namespace

int whole_px(double place) {
  constexpr double kFar = 1e6;
  return std::isnan(place) ? 0 : static_cast<int>(std::clamp(place, -kFar, kFar));
}

Part common(const Part& a, const Part& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

Part around(const Part& a, const Part& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

std::vector<Part> at_most(std::vector<Part> parts, std::size_t count) {
  const auto smaller = [](const Part& a, const Part& b) { return a.pixels() < b.pixels(); };
  while (parts.size() > count) {
    std::iter_swap(std::min_element(parts.begin(), parts.end(), smaller), parts.end() - 1);
    const Part least = parts.back();
    parts.pop_back();
    const auto growth = [&](const Part& part) {
      return around(part, least).pixels() - part.pixels();
    };
    const auto host =
        std::min_element(parts.begin(), parts.end(),
                         [&](const Part& a, const Part& b) { return growth(a) < growth(b); });
    *host = around(*host, least);
  }
  return parts;
}

std::vector<Part> apart(std::vector<Part> parts, int reach_px) {
  for (std::size_t i = 0; i < parts.size();) {
    const Part near{parts[i].x0 - reach_px, parts[i].y0 - reach_px, parts[i].x1 + reach_px,
                    parts[i].y1 + reach_px};
    const auto other = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
      return &part != &parts[i] && !common(near, part).empty();
    });
    if (other == parts.end()) {
      ++i;
      continue;
    }
    *other = around(*other, parts[i]);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
  return parts;
}

Tiles::Tiles(int width, int height)
    : width_(width),
      height_(height),
      hashes_(static_cast<std::size_t>(tiles_along(width)) * tiles_along(height)) {}

void Tiles::add(const Part& touched, std::uint64_t hash) {
  const Part part = common(touched, {0, 0, width_, height_});
  if (part.empty()) return;
  const int columns = tiles_along(width_);
  for (int y = part.y0 / kTile_px; y <= (part.y1 - 1) / kTile_px; ++y)
    for (int x = part.x0 / kTile_px; x <= (part.x1 - 1) / kTile_px; ++x) {
      std::uint64_t& tile = hashes_[static_cast<std::size_t>(y) * columns + x];
      tile = hashed(tile, hash);
    }
}

std::vector<Part> Tiles::changes_since(const Tiles& before) const {
  if (before.width_ != width_ || before.height_ != height_) return {{0, 0, width_, height_}};
  const int columns = tiles_along(width_), rows = tiles_along(height_);
  const auto differs = [&](int x, int y) {
    const std::size_t i = static_cast<std::size_t>(y) * columns + x;
    return hashes_[i] != before.hashes_[i];
  };
  // Merge adjacent tiles of a row, and equal rows.
  std::vector<Part> parts;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (!differs(x, y)) continue;
      const int first = x;
      while (x < columns && differs(x, y)) ++x;
      const Part run{first * kTile_px, y * kTile_px, std::min(x * kTile_px, width_),
                     std::min((y + 1) * kTile_px, height_)};
      const auto above = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
        return part.y1 == run.y0 && part.x0 == run.x0 && part.x1 == run.x1;
      });
      if (above == parts.end())
        parts.push_back(run);
      else
        above->y1 = run.y1;
    }
  }
  return parts;
}

// ---- Scenes ----

namespace {

/// The part within `reach_px` of a screen position.
Part about(double x, double y, double reach_px) {
  return {whole_px(std::floor(x - reach_px)), whole_px(std::floor(y - reach_px)),
          whole_px(std::ceil(x + reach_px)), whole_px(std::ceil(y + reach_px))};
}

/// The part that contains everything drawn between these points, plus `reach_px`. Objects that
/// cross the near plane may be anywhere.
Part about(const View& view, std::span<const Vec3f> points, double reach_px) {
  const Part all{0, 0, view.width, view.height};
  Part part;
  for (const Vec3f& point : points) {
    const auto at = project(view, point);
    // Far outside the picture, integers would overflow.
    if (!at || !(at->px.cwiseAbs().maxCoeff() < 1e6)) return all;
    const Part here = about(at->px.x(), at->px.y(), reach_px);
    part = &point == points.data() ? here : around(part, here);
  }
  return part;
}

enum Kind : std::uint64_t { kPoint = 1, kBox, kPolygon, kLine, kArrow, kText, kShape, kStroke };

void add_points(const DrawPoints& cloud, const View& view, float shade_radius_px, Tiles& tiles) {
  const std::uint64_t start = hashed(kPoint, cloud.size_m, cloud.min_px, cloud.max_px);
  const double least = std::max(cloud.min_px, 1.0f);
  const double most = std::max<double>(cloud.max_px, least);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const auto at = project(view, cloud.positions[i]);
    if (!at || !(at->px.cwiseAbs().maxCoeff() < 1e6)) continue;  // not visible
    const double scale = view.orthographic ? view.px_per_m : view.px_per_m / at->depth_m;
    // Points shade their neighbors.
    const double reach_px =
        std::clamp<double>(cloud.size_m * scale, least, most) / 2 + shade_radius_px + 3;
    tiles.add(about(at->px.x(), at->px.y(), reach_px),
              hashed(start, cloud.positions[i], cloud.colors[i]));
  }
}

void add_polygon(const DrawPolygon& polygon, const View& view, float bias_m, Tiles& tiles) {
  if (polygon.corners.empty()) return;
  std::uint64_t hash = hashed(kPolygon, bias_m, polygon.outline_px, polygon.fill, polygon.outline);
  for (const Vec3f& corner : polygon.corners) hash = hashed(hash, corner);
  for (const std::uint32_t corner : polygon.triangles) hash = hashed(hash, corner);
  tiles.add(about(view, polygon.corners, polygon.outline_px + 4), hash);
}

void add_lines(const DrawLines& lines, const View& view, float bias_m, Tiles& tiles) {
  const std::uint64_t start =
      hashed(kLine, lines.width_px, int{lines.shine_through}, lines.lifted ? bias_m : 0);
  for (std::size_t i = 0; i < lines.colors.size() && 2 * i + 1 < lines.positions.size(); ++i) {
    const std::array<Vec3f, 2> ends = {lines.positions[2 * i], lines.positions[2 * i + 1]};
    tiles.add(about(view, ends, lines.width_px + 4), hashed(start, ends, lines.colors[i]));
  }
}

void add_text(const OverlayText& text, Tiles& tiles) {
  const double width = text_width(text.text, text.size_px);
  const double reach_px = text.size_px + text.halo_px + 2;
  const double middle = text.baseline - text.size_px / 2;
  std::uint64_t hash = hashed(kText, text.x, text.baseline, text.size_px, text.halo_px, text.color,
                              text.halo, text.text.size());
  for (const char c : text.text) hash = hashed(hash, int{c});
  tiles.add(around(about(text.x, middle, reach_px), about(text.x + width, middle, reach_px)), hash);
}

}  // namespace

Tiles scene_tiles(const DrawList& list,
                  const Overlay& overlay,
                  const View& view,
                  float shade_radius_px) {
  Tiles tiles(view.width, view.height);
  const float bias_m = list.lift_m();
  for (const DrawPoints& cloud : list.points) add_points(cloud, view, shade_radius_px, tiles);
  for (const DrawBox& box : list.boxes)
    tiles.add(about(view, box.corners, 4),
              hashed(kBox, box.corners, box.color, static_cast<int>(box.style)));
  for (const DrawPolygon& polygon : list.polygons) add_polygon(polygon, view, bias_m, tiles);
  for (const DrawLines& lines : list.lines) add_lines(lines, view, bias_m, tiles);
  for (const DrawArrow& arrow : list.arrows) {
    const std::array<Vec3f, 2> ends = {arrow.from, arrow.to};
    tiles.add(about(view, ends, 4 * arrow.width_px + 12),
              hashed(kArrow, bias_m, arrow.width_px, ends, arrow.color));
  }
  for (const OverlayText& text : overlay.labels) add_text(text, tiles);
  for (const OverlayShape& shape : overlay.shapes)
    tiles.add(around(about(shape.x0, shape.y0, 2), about(shape.x1, shape.y1, 2)),
              hashed(kShape, shape));
  for (const Segment& stroke : overlay.segments) {
    const double reach_px = 4 * stroke.width_px + 12;
    tiles.add(around(about(stroke.a.x(), stroke.a.y(), reach_px),
                     about(stroke.b.x(), stroke.b.y(), reach_px)),
              hashed(kStroke, stroke));
  }
  for (const OverlayText& text : overlay.texts) add_text(text, tiles);
  return tiles;
}

}  // namespace planescope::render
