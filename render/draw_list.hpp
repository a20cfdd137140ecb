#pragma once

// The bridge from core to pixels: plain points, lines, boxes and polygons, made by pure functions
// without GL, so that a test can assert on what would be drawn; and from where they are seen.

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
  float size_m = 0.02f;              // diameter of the splat in the world ...
  float min_px = 1.5f, max_px = 14;  // ... held between these on screen
  bool operator==(const DrawPoints&) const = default;
};

struct DrawLines {
  std::vector<Vec3f> positions;  // two per segment, world [m]
  std::vector<Rgba> colors;      // one per segment
  float width_px = 1.5f;
  bool shine_through = false;  // seen faintly through what hides them
  bool lifted = false;         // over the points of the surface that they lie on, as polygons are
  bool operator==(const DrawLines&) const = default;
};

enum class BoxStyle : std::uint8_t { outline, tinted, hatched };  // tinted: faint faces + outline

/// A cube or a frustum: six planar faces. A corner's index has bit 0 where it is greater along the
/// box's first axis, bit 1 along the second, bit 2 along the third; the axes are right-handed.
struct DrawBox {
  std::array<Vec3f, 8> corners;
  Rgba color;
  BoxStyle style = BoxStyle::outline;
  std::uint32_t id = 0;  // 0: not pickable
  bool operator==(const DrawBox&) const = default;
};

/// The corners of an axis-aligned box.
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

struct DrawPolygon {           // planar, filled; outlined where it is convex
  std::vector<Vec3f> corners;  // world [m]
  Rgba fill;
  Rgba outline;
  float outline_px = 2;
  std::uint32_t id = 0;
  std::vector<std::uint32_t> triangles = {};  // three corners each; empty: it is convex
  bool operator==(const DrawPolygon&) const = default;
};

struct DrawArrow {
  Vec3f from;
  Vec3f to;
  Rgba color;
  float width_px = 3;
  bool operator==(const DrawArrow&) const = default;
};

/// Which of two labels stays where they would stand on each other: the lower, of equal ones the
/// nearer.
enum LabelRank : std::int32_t {
  kSelectedLabel = 0,
  kCurrentLabel = 1,
  kFigureLabel = 2,      // of stairs
  kPlaneLabel = 100,     // up to 1100, the smaller the plane
  kNumeralLabel = 2000,  // of a node's case
};

struct DrawLabel {   // text at a place in the world, on top of all but another label
  Vec3f anchor;      // of its middle
  std::string text;  // UTF-8
  Rgba color;
  float size_px = 14;
  std::int32_t rank = kSelectedLabel;
  bool operator==(const DrawLabel&) const = default;
};

struct LegendEntry {
  enum class Mark : std::uint8_t { dot, box, hatched_box, line, arrow };
  Mark mark = Mark::dot;
  Rgba color;
  std::string text;
  bool operator==(const LegendEntry&) const = default;
};

/// Everything in one picture. Drawn in this order: points, boxes, polygons from back to front,
/// lines, arrows, labels, then the overlay. Points hide what lies behind them. Tinted and hatched
/// boxes hide one another, but only tint the points in and behind them; all else is seen through.
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
  bool pick_points_first = false;   // faces of boxes are picked only where nothing else is, and
                                    // polygons where the points that lie on them are not
  bool show_axes = true;            // axes triad with x y z, bottom right
  bool show_scale_bar = true;       // a round length at the camera's target distance
  bool operator==(const DrawList&) const = default;

  void explain(Rgba color, std::string text, LegendEntry::Mark mark = LegendEntry::Mark::dot) {
    legend.push_back({mark, color, std::move(text)});
  }
  /// How much nearer to the eye polygons, arrows and lifted lines are drawn: they lie over the
  /// splats of their own points, which stand out by half their size and noise.
  float lift_m() const {
    float largest_m = 0;
    for (const DrawPoints& cloud : points) largest_m = std::max(largest_m, cloud.size_m);
    return largest_m;
  }
};

// ---- Cameras ----

/// An orbiting camera: looks from `eye` at `target`, `up` is up on screen.
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

/// A camera made ready for a picture.
struct View {
  Eigen::Matrix4f view;  // world -> eye: x right, y up, looking along -z [m]
  Eigen::Matrix4f proj;  // eye -> clip
  bool orthographic = false;
  float near_m = 0, far_m = 0;
  float px_per_m = 0;  // of a length at 1 m from the eye; anywhere where orthographic
  double px_per_m_at_target = 0;
  int width = 0, height = 0;  // [px]
  double screen_scale = 1;    // pixels per pixel of an ordinary screen

  Eigen::Vector2f size_px() const {
    return {static_cast<float>(width), static_cast<float>(height)};
  }
};

View make_view(const Camera& camera, int width, int height, double screen_scale = 1);

/// Where a world point lands, in pixels from the top left corner, and its distance along the view
/// axis. Nothing for points before the near plane.
struct ScreenPoint {
  Vec2d px;
  double depth_m = 0;
};
std::optional<ScreenPoint> project(const View& view, const Vec3f& world);

/// A few of the points that stand for all of them in a view: in each of many directions, one that
/// all but `outliers` of the points stay below. At most 96; none of none.
std::vector<Vec3f> reach_of(std::span<const Vec3f> points, double outliers);

/// The points without what stands far apart from the rest and has less than 2 % of them: pieces on
/// a grid of cells of `cell_m`, which touch where their cells do.
std::vector<Vec3f> bulk_of(std::span<const Vec3f> points, double cell_m);

/// How a view looks, apart from where it stands.
struct Lens {
  Vec3d forward = Vec3d::UnitX();  // unit
  Vec3d up = Vec3d::UnitZ();
  double fov_y_deg = 45;
  double aspect = 4.0 / 3;  // width by height
  bool orthographic = false;
  double room = 1;  // how far away: times the distance at which the points fill the view
};

/// A camera from which the points just fill the view, but for a margin. A perspective one that
/// stands where an orthographic view of the height at its target shows the same, if that is asked.
Camera camera_holding(std::span<const Vec3f> reach, const Lens& lens);

/// A frame's own view, before its shape is known.
struct Home {
  Vec3d forward = Vec3d::UnitX();  // unit
  std::vector<Vec3f> reach;        // of the bulk of its points
};
Home home_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation);

/// A view of the frame that just holds its kept points (all but the outermost half percent). Depth
/// frames: from behind and above the sensor, looking the way it looks. Clouds: from the -x side.
Camera frame_camera(const planes::PreparedFrame& prepared,
                    const planes::Segmentation& segmentation,
                    double aspect);
Camera frame_camera(const planes::FrameResult& result, double aspect);

}  // namespace planescope::render
