#include "render/scene_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "render/font.hpp"

namespace planescope::render {
namespace {

/// Of what is `reach_px` about a place on screen.
Part about(double x, double y, double reach_px) {
  return {whole_px(std::floor(x - reach_px)), whole_px(std::floor(y - reach_px)),
          whole_px(std::ceil(x + reach_px)), whole_px(std::ceil(y + reach_px))};
}

/// Of what is drawn between these points, and `reach_px` beyond. What comes before the near plane
/// may be anywhere.
Part about(const View& view, std::span<const Vec3f> points, double reach_px) {
  const Part all{0, 0, view.width, view.height};
  Part part;
  for (const Vec3f& point : points) {
    const auto at = project(view, point);
    // Far beside the picture, integers would end.
    if (!at || !(at->px.cwiseAbs().maxCoeff() < 1e6)) return all;
    const Part here = about(at->px.x(), at->px.y(), reach_px);
    part = &point == points.data() ? here : around(part, here);
  }
  return part;
}

std::uint64_t hashed_text(std::uint64_t hash, const std::string& text) {
  for (const char c : text) hash = hashed(hash, static_cast<unsigned char>(c));
  return hashed(hash, text.size());
}

std::uint64_t hashed_color(std::uint64_t hash, Rgba color) { return hashed_bytes(hash, color); }

enum Kind : std::uint64_t { kPoint = 1, kBox, kPolygon, kLine, kArrow, kText, kShape, kStroke };

struct Writer {
  const View& view;
  Tiles tiles;
  float bias_m = 0;  // polygons, arrows and lifted lines stand out by the largest splat

  void add_points(const DrawPoints& cloud, float shade_radius_px);
  void add_box(const DrawBox& box);
  void add_polygon(const DrawPolygon& polygon);
  void add_lines(const DrawLines& lines);
  void add_arrow(const DrawArrow& arrow);
  void add_text(const OverlayText& text);
  void add_shape(const OverlayShape& shape);
  void add_stroke(const Segment& stroke);
};

void Writer::add_points(const DrawPoints& cloud, float shade_radius_px) {
  std::uint64_t start = hashed_bytes(kPoint, cloud.size_m);
  start = hashed_bytes(hashed_bytes(start, cloud.min_px), cloud.max_px);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const auto at = project(view, cloud.positions[i]);
    if (!at) continue;  // not seen
    const double scale = view.orthographic ? view.px_per_m : view.px_per_m / at->depth_m;
    const double least = std::max(cloud.min_px, 1.0f);
    const double size_px =
        std::clamp<double>(cloud.size_m * scale, least, std::max<double>(cloud.max_px, least));
    if (!(at->px.cwiseAbs().maxCoeff() < 1e6)) continue;
    // A point shades its neighbours.
    const double reach_px = size_px / 2 + shade_radius_px + 3;
    tiles.add(about(at->px.x(), at->px.y(), reach_px),
              hashed_color(hashed_bytes(start, cloud.positions[i]), cloud.colors[i]));
  }
}

void Writer::add_box(const DrawBox& box) {
  std::uint64_t hash = kBox;
  for (const Vec3f& corner : box.corners) hash = hashed_bytes(hash, corner);
  tiles.add(about(view, box.corners, 4),
            hashed(hashed_color(hash, box.color), static_cast<std::uint64_t>(box.style)));
}

void Writer::add_polygon(const DrawPolygon& polygon) {
  if (polygon.corners.empty()) return;
  std::uint64_t hash = hashed_bytes(hashed_bytes(kPolygon, bias_m), polygon.outline_px);
  hash = hashed_color(hashed_color(hash, polygon.fill), polygon.outline);
  for (const Vec3f& corner : polygon.corners) hash = hashed_bytes(hash, corner);
  for (const std::uint32_t corner : polygon.triangles) hash = hashed(hash, corner);
  tiles.add(about(view, polygon.corners, polygon.outline_px + 4), hash);
}

void Writer::add_lines(const DrawLines& lines) {
  std::uint64_t start = hashed(hashed_bytes(kLine, lines.width_px), lines.shine_through);
  if (lines.lifted) start = hashed_bytes(start, bias_m);
  for (std::size_t i = 0; i < lines.colors.size() && 2 * i + 1 < lines.positions.size(); ++i) {
    const std::array<Vec3f, 2> ends = {lines.positions[2 * i], lines.positions[2 * i + 1]};
    tiles.add(about(view, ends, lines.width_px + 4),
              hashed_color(hashed_bytes(hashed_bytes(start, ends[0]), ends[1]), lines.colors[i]));
  }
}

void Writer::add_arrow(const DrawArrow& arrow) {
  const std::array<Vec3f, 2> ends = {arrow.from, arrow.to};
  const std::uint64_t hash = hashed_bytes(hashed_bytes(kArrow, bias_m), arrow.width_px);
  tiles.add(about(view, ends, 4 * arrow.width_px + 12),
            hashed_color(hashed_bytes(hashed_bytes(hash, ends[0]), ends[1]), arrow.color));
}

void Writer::add_text(const OverlayText& text) {
  const double width = default_font().layout(text.text, text.size_px).width;
  const double reach_px = text.size_px + text.halo_px + 2;
  std::uint64_t hash = hashed_text(kText, text.text);
  for (const double value : {text.x, text.baseline, text.size_px, text.halo_px})
    hash = hashed_bytes(hash, value);
  tiles.add(around(about(text.x, text.baseline - text.size_px / 2, reach_px),
                   about(text.x + width, text.baseline - text.size_px / 2, reach_px)),
            hashed_color(hashed_color(hash, text.color), text.halo));
}

void Writer::add_shape(const OverlayShape& shape) {
  tiles.add(around(about(shape.x0, shape.y0, 2), about(shape.x1, shape.y1, 2)),
            hashed_bytes(kShape, shape));
}

void Writer::add_stroke(const Segment& stroke) {
  const double reach_px = 4 * stroke.width_px + 12;
  tiles.add(around(about(stroke.a.x(), stroke.a.y(), reach_px),
                   about(stroke.b.x(), stroke.b.y(), reach_px)),
            hashed_bytes(kStroke, stroke));
}

}  // namespace

Tiles scene_tiles(const DrawList& list,
                  const Overlay& overlay,
                  const View& view,
                  float shade_radius_px) {
  Writer writer{view, Tiles(view.width, view.height)};
  for (const DrawPoints& cloud : list.points) writer.bias_m = std::max(writer.bias_m, cloud.size_m);
  for (const DrawPoints& cloud : list.points) writer.add_points(cloud, shade_radius_px);
  for (const DrawBox& box : list.boxes) writer.add_box(box);
  for (const DrawPolygon& polygon : list.polygons) writer.add_polygon(polygon);
  for (const DrawLines& lines : list.lines) writer.add_lines(lines);
  for (const DrawArrow& arrow : list.arrows) writer.add_arrow(arrow);
  for (const OverlayText& text : overlay.labels) writer.add_text(text);
  for (const OverlayShape& shape : overlay.shapes) writer.add_shape(shape);
  for (const Segment& stroke : overlay.segments) writer.add_stroke(stroke);
  for (const OverlayText& text : overlay.texts) writer.add_text(text);
  return std::move(writer.tiles);
}

}  // namespace planescope::render
