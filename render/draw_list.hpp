#pragma once

// The interface between core and pixels: plain points, lines, boxes and polygons, and the
// cameras to view them. They are made by pure functions without GL, so that tests can check the
// drawn scene.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::planes {
struct PreparedFrame;
struct Segmentation;
struct FrameResult;
}  // namespace planescope::planes

namespace planescope::render {

struct Rgba {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Rgba&) const = default;
};

struct DrawPoints {
  std::vector<Vec3f> positions;      // world [m]
  std::vector<Rgba> colors;          // one per point
  std::vector<std::uint32_t> ids;    // for picking; empty: not pickable
  float size_m = 0.02f;              // splat diameter in the world ...
  float min_px = 1.5f, max_px = 14;  // ... clamped to this range on screen
  bool operator==(const DrawPoints&) const = default;
};

struct DrawLines {
  std::vector<Vec3f> positions;  // two per segment, world [m]
  std::vector<Rgba> colors;      // one per segment
  float width_px = 1.5f;
  bool shine_through = false;  // faintly visible through occluders
  bool lifted = false;         // drawn above the points of its surface, like polygons
  bool operator==(const DrawLines&) const = default;
};

enum class BoxStyle : std::uint8_t { outline, tinted, hatched };  // tinted: faint faces + outline

/// A cube or a frustum: six planar faces. Bit 0 of a corner's index is set if it is greater along
/// the box's first axis, bit 1 along the second, bit 2 along the third; the axes are right-handed.
struct DrawBox {
  std::array<Vec3f, 8> corners;
  Rgba color;
  BoxStyle style = BoxStyle::outline;
  std::uint32_t id = 0;  // 0: not pickable
  bool operator==(const DrawBox&) const = default;
};

/// Corners of an axis-aligned box.
inline std::array<Vec3f, 8> box_corners(const Vec3f& min, const Vec3f& max) {
  std::array<Vec3f, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = {(i & 1) != 0 ? max.x() : min.x(), (i & 2) != 0 ? max.y() : min.y(),
                  (i & 4) != 0 ? max.z() : min.z()};
  return corners;
}

inline Vec3f middle_of(const DrawBox& box) {
  Vec3f sum = Vec3f::Zero();
  for (const Vec3f& corner : box.corners) sum += corner;
  return sum / 8;
}

/// Calls edge(from, to) for each of a box's twelve edges.
template <typename Edge>
void each_edge(const DrawBox& box, const Edge& edge) {
  for (unsigned from = 0; from < 8; ++from)
    for (unsigned bit = 1; bit <= 4; bit <<= 1)
      if ((from & bit) == 0) edge(box.corners[from], box.corners[from | bit]);
}

struct DrawPolygon {           // planar and filled; outlined if convex
  std::vector<Vec3f> corners;  // world [m]
  Rgba fill;
  Rgba outline;
  float outline_px = 2;
  std::uint32_t id = 0;
  std::vector<std::uint32_t> triangles = {};  // three corners each; empty: convex
  bool operator==(const DrawPolygon&) const = default;
};

struct DrawArrow {
  Vec3f from;
  Vec3f to;
  Rgba color;
  float width_px = 3;
  bool operator==(const DrawArrow&) const = default;
};

/// Decides which of two overlapping labels is drawn: the one with the lower rank, or the nearer one
/// if equal.
enum LabelRank : std::int32_t {
  kSelectedLabel = 0,
  kCurrentLabel = 1,
  kFigureLabel = 2,      // stairs
  kPlaneLabel = 100,     // up to 1100 for the smallest planes
  kNumeralLabel = 2000,  // case of a node
};

struct DrawLabel {   // text at a world position, drawn on top of everything except other labels
  Vec3f anchor;      // position of its center
  std::string text;  // UTF-8
  Rgba color;
  float size_px = 14;
  std::int32_t rank = kSelectedLabel;
  bool operator==(const DrawLabel&) const = default;
};

struct LegendEntry {
  enum class Symbol : std::uint8_t { dot, box, hatched_box, line, arrow };
  Symbol symbol = Symbol::dot;
  Rgba color;
  std::string text;
  bool operator==(const LegendEntry&) const = default;
};

/// Everything in one picture. Drawn in this order: points, boxes, polygons from back to front,
/// lines, arrows, labels, overlay. Points occlude everything behind them. Tinted and hatched boxes
/// occlude each other, but only tint the points in and behind them; everything else is transparent.
struct DrawList {
  std::vector<DrawPoints> points;
  std::vector<DrawLines> lines;
  std::vector<DrawBox> boxes;
  std::vector<DrawPolygon> polygons;
  std::vector<DrawArrow> arrows;
  std::vector<DrawLabel> labels;

  std::string title;                // overlay, top left
  std::string subtitle;             // below the title, smaller
  std::vector<LegendEntry> legend;  // overlay, bottom left
  bool pick_points_first = false;   // pick boxes only where nothing else is hit, and polygons only
                                    // where no points on them are hit
  bool show_axes = true;            // axes triad with x y z, bottom right
  bool show_scale_bar = true;       // a round length at the camera's target distance
  bool operator==(const DrawList&) const = default;

  void explain(Rgba color,
               std::string text,
               LegendEntry::Symbol symbol = LegendEntry::Symbol::dot) {
    legend.push_back({symbol, color, std::move(text)});
  }
  /// Offset toward the eye of polygons, arrows and lifted lines, so that they cover the splats of
  /// their own points, which protrude by half their size and noise.
  float lift_m() const {
    float largest_m = 0;
    for (const DrawPoints& cloud : points) largest_m = std::max(largest_m, cloud.size_m);
    return largest_m;
  }
};

// ---- Cameras ----

/// An orbiting camera: looks from `eye` at `target`; `up` points up on screen.
struct Camera {
  Vec3d eye = Vec3d(-1, -1, 1);
  Vec3d target = Vec3d::Zero();
  Vec3d up = Vec3d::UnitZ();
  double fov_y_deg = 45;
  bool orthographic = false;
  double ortho_height_m = 2;
  double near_m = 0.02, far_m = 200;
};

enum class Theme : std::uint8_t { light, dark };

/// A camera prepared for a picture.
struct View {
  Eigen::Matrix4f view;  // world -> eye: x right, y up, looking along -z [m]
  Eigen::Matrix4f proj;  // eye -> clip
  bool orthographic = false;
  float near_m = 0, far_m = 0;
  float px_per_m = 0;  // pixels per meter at 1 m from the eye; at any distance if orthographic
  double px_per_m_at_target = 0;
  int width = 0, height = 0;  // [px]
  double screen_scale = 1;    // device pixels per logical pixel

  Eigen::Vector2f size_px() const {
    return {static_cast<float>(width), static_cast<float>(height)};
  }
};

View make_view(const Camera& camera, int width, int height, double screen_scale = 1);

/// Screen position of a world point, in pixels from the top left corner, and its distance along the
/// view axis. nullopt for points in front of the near plane.
struct ScreenPoint {
  Vec2d px;
  double depth_m = 0;
};
std::optional<ScreenPoint> project(const View& view, const Vec3f& world);

/// A few points that represent the extent of all points in any view: for each of many directions, a
/// point that exceeds all but `outliers` of the points. At most 96; empty for no points.
std::vector<Vec3f> extent_of(std::span<const Vec3f> points, double outliers);

/// The points without separate pieces that contain less than 2 % of them. Pieces are connected
/// groups of cells on a grid of `cell_m`.
std::vector<Vec3f> bulk_of(std::span<const Vec3f> points, double cell_m);

/// Direction and projection of a view, without its position.
struct Lens {
  Vec3d forward = Vec3d::UnitX();  // unit
  Vec3d up = Vec3d::UnitZ();
  double fov_y_deg = 45;
  double aspect = 4.0 / 3;  // width / height
  bool orthographic = false;
  double room = 1;  // distance factor, relative to the distance at which the points fill the view
};

/// A camera in which the points fill the view, up to a margin. With `lens.orthographic`, still a
/// perspective camera, at a distance where an orthographic view of the height at its target fits.
Camera camera_fitting(std::span<const Vec3f> extent, const Lens& lens);

/// A frame's default view, without aspect ratio.
struct Home {
  Vec3d forward = Vec3d::UnitX();  // unit
  std::vector<Vec3f> extent;       // extent of the bulk of its points
};
Home home_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation);

/// A view of the frame that fits its kept points (all but the outermost half percent). Depth
/// frames: from behind and above the sensor, in its viewing direction. Clouds: from the -x side.
Camera frame_camera(const planes::PreparedFrame& prepared,
                    const planes::Segmentation& segmentation,
                    double aspect);
Camera frame_camera(const planes::FrameResult& result, double aspect);

}  // namespace planescope::render
