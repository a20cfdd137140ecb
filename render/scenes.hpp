#pragma once

// Draw lists and pictures of a frame's stages: pure functions over core's results, no GL.
// Coordinates are the cloud's own: world axes (z up), meters, about `Cloud::origin`.
//
// `color_of_plane`: color id of each plane, by plane id - 1 (plane_colors.hpp); empty: the
// plane's own id.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "core/planes/stairs/stairs.hpp"
#include "render/palette.hpp"

namespace planescope::render {

DrawList scene_labels(const planes::FrameResult& result);  // cloud by h / v
/// Cloud by how sure the classifier is of h / v: the label's color where it is, dark where not.
DrawList scene_margins(const planes::FrameResult& result);
/// Octree nodes by case I-IV: voxels in the color of the node that settled them, in the box of
/// that node's points (never larger than its cell); divided nodes as the faint outline of their
/// cell.
DrawList scene_cases(const planes::FrameResult& result);
/// Voxels in the colors of their planes, with what each covers, its holes, normal and number.
DrawList scene_planes(const Frame& frame,
                      const planes::FrameResult& result,
                      std::span<const int> color_of_plane);
/// Points in no plane, the planes faded.
DrawList scene_leftovers(const planes::FrameResult& result, std::span<const int> color_of_plane);

/// For clouds, what image_overlay and image_depth are for depth frames: every point of the file in
/// its own color (grey where it has none) with the planes' colors over it, and by height.
DrawList scene_overlay(const Frame& frame,
                       const planes::FrameResult& result,
                       std::span<const int> color_of_plane);
DrawList scene_heights(const planes::FrameResult& result);

/// Image-space pictures of depth frames, enlarged by a whole factor where the sensor's image is
/// small. Planes over the color image, each depth pixel projected into it where it is not aligned,
/// or over shaded depth where there is no calibrated color; with outlines and ids.
Image8 image_overlay(const Frame& frame,
                     const planes::FrameResult& result,
                     std::span<const int> color_of_plane);
/// Depth as a ramp with its scale in meters; what was not measured is hatched, what lies beyond
/// `max_range_m` is grey.
Image8 image_depth(const Frame& frame, double max_range_m);

// ---- Ground truth, what was found, and where they differ, side by side ----

/// "missed 3.1 %, wrong plane 0.4 %" of the points scored, in words; "all right" where nothing is.
std::string errors_text(const planes::JudgedFrame& judged);

/// Labels, result and errors over the relief of a depth frame, with titles and the errors' legend.
Image8 image_truth(const Frame& frame,
                   const planes::FrameResult& result,
                   const planes::JudgedFrame& judged,
                   std::span<const int> color_of_plane);

/// The same three of a cloud, to be drawn one by one and joined.
std::array<DrawList, 3> scenes_truth(const planes::FrameResult& result,
                                     const planes::JudgedFrame& judged,
                                     std::span<const int> color_of_plane);

/// Images of one height in a row, narrow white gaps between them.
Image8 side_by_side(std::span<const Image8> images);

// ---- Plane ids in image space, and what lies under them ----

/// Plane id per pixel, 0 none.
using RegionImage = Image<std::int32_t>;

/// Whether each depth pixel has its color at the same place of the color image.
bool has_aligned_color(const Frame& frame);

/// Depth as a grey relief lit from the camera, so that surfaces can be told apart without color.
Image8 shaded_depth(const Frame& frame);

/// On the depth image's own pixels.
RegionImage regions_on_depth(const Frame& frame, const planes::FrameResult& result);

/// On the color image of a frame whose color is calibrated but not aligned: each depth pixel is
/// projected into it as a patch wide enough to leave no holes, the nearest surface in front.
RegionImage regions_on_color(const Frame& frame, const planes::FrameResult& result);

/// For drawing outlines: pinholes and specks go to the id that most of their 5x5 neighbors have.
RegionImage smooth_regions(const RegionImage& regions);

/// The pixel deepest inside each region, by plane id - 1; depth_px 0 where the region is absent.
struct InteriorPoint {
  int x = 0, y = 0;
  double depth_px = 0;  // to the nearest pixel of another region
};
std::vector<InteriorPoint> interior_points(const RegionImage& regions, std::size_t plane_count);

// ---- What scenes share ----

inline constexpr Rgba kSceneText{32, 36, 42, 255};
inline constexpr Rgba kSceneFaded{190, 194, 200, 255};  // what a scene is not about

int color_id_of(int plane_id, std::span<const int> color_of_plane);
Rgba color_of(int plane_id, std::span<const int> color_of_plane);

/// The voxels as splats that close the surface, without colors yet.
DrawPoints voxel_points(const planes::VoxelCloud& voxels);

/// The indices of a node's points.
inline std::span<const std::uint32_t> members(const planes::Octree& octree,
                                              const planes::OctreeNode& node) {
  return std::span(octree.order).subspan(node.begin, node.size());
}

/// A node's whole cell, and the part of it that holds its points: on a plane, a tile. Colors and
/// styles are the caller's to set.
DrawBox cell_box(const planes::Octree& octree, const planes::OctreeNode& node);
DrawBox points_box(const planes::Octree& octree,
                   const planes::OctreeNode& node,
                   double voxel_size_m);

/// Convex hull of points on a plane: projected, counter-clockwise about the normal.
std::vector<Vec3f> outline_on_plane(const PlaneFit& plane, std::span<const Vec3f> points);

/// Lowest and highest values of each axis, without the outermost percent.
struct RobustBounds {
  Vec3f low = Vec3f::Zero(), high = Vec3f::Zero();
  float diagonal() const { return (high - low).norm(); }
};
RobustBounds robust_bounds(std::span<const Vec3f> points);

/// Whether a plane is large enough, as a share of all voxels, to get an arrow and a name.
bool is_named(std::size_t voxels, std::size_t all);
/// Of the name of a plane with so many of all voxels.
std::int32_t plane_label_rank(std::size_t voxels, std::size_t all);
/// Where the name of a plane of these voxels stands: at its centroid where the plane is there, else
/// where most of it is close together.
Vec3f place_on_plane(const Vec3d& centroid, std::span<const Vec3f> own, float voxel_m);
/// Length of the arrows along planes' normals in a scene of these voxels.
float normal_arrow_m(std::span<const Vec3f> voxels);

/// Numerals stand on at most so many nodes of a scene, the largest, ...
inline constexpr std::size_t kMostNumerals = 60;
/// ... whose edge is at least this: of a cube its own, of a frustum the longer one of the nearer
/// end of its points_box().
double least_numeral_edge_m(std::span<const Vec3f> voxels);
double numeral_edge_m(const planes::Octree& octree,
                      const planes::OctreeNode& node,
                      const DrawBox& tile);
/// "III"; "I*" where the node was fitted label by label.
std::string case_numeral(const planes::OctreeNode& node);

/// The arrow stands at the left edge of the frame's own view; it says so where its direction is
/// only estimated or assumed.
void add_gravity(const planes::FrameResult& result, DrawList& list);

/// "12.3 %" of the whole.
std::string percent(std::size_t part, std::size_t whole);

/// How many nodes ended in each case. `count`: indexed by Case. `on_image`: of a depth image's
/// octree.
void add_case_legend(std::span<const std::size_t> count, bool on_image, DrawList& list);

/// The largest planes with their label and size.
void add_plane_legend(const planes::FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list);

// ---- Finished planes: their extent with its holes, room for a foot, stairs ----
// Coordinates are the scene's, about Cloud::origin.

/// What a plane covers. Lines are pairs of ends.
struct PlaneShape {
  std::vector<Vec3f> rings;    // outer ones, and those of holes where something else was seen
  std::vector<Vec3f> unknown;  // dashes about holes where nothing was measured
  // Filled by triangles, three corners each; empty where it is not.
  std::vector<Vec3f> corners;
  std::vector<std::uint32_t> triangles;
};

/// One for each plane, by id - 1, not filled yet. `origin`: of the scene, in the world.
std::vector<PlaneShape> plane_shapes(std::span<const planes::Outline> outlines,
                                     const Vec3d& origin);
/// Leaves a shape unfilled where its outline has no triangulation.
void fill_shape(const planes::Outline& outline, const Vec3d& origin, PlaneShape& shape);

struct FootShape {
  std::vector<Vec3f> rings;                // of the area for its centre, pairs of ends
  std::vector<std::vector<Vec3f>> pieces;  // convex
};

/// All that is known of a run's planes; what is empty is not known yet.
struct PlaneScene {
  std::vector<PlaneShape> shapes;  // by id - 1
  std::vector<FootShape> foot;     // likewise; empty where no foot is given
  std::vector<bool> steppable;     // likewise
  planes::Stairs stairs;           // in the world
  std::vector<Vec3f> centroids;    // of planes, by id - 1
  Vec3d origin = Vec3d::Zero();
  bool complete = false;  // nothing is being found out any more

  bool has_stairs() const {
    return !stairs.flights.empty() || !stairs.kerbs.empty() || !stairs.ramps.empty();
  }
  /// Whether a plane carries a foot; nothing where that is not known.
  std::optional<bool> verdict(int plane_id) const;
};

/// Of planes in the order of their ids. `footholds`: likewise.
PlaneScene plane_scene(std::span<const planes::PlaneRegion> planes,
                       std::span<const planes::Outline> outlines,
                       std::span<const planes::Foothold> footholds,
                       const planes::Stairs& stairs,
                       const Vec3d& origin);

struct ShapeLook {
  Rgba fill, line;
  float width_px = 1.5f;
  std::uint32_t id = 0;
};
void add_shape(const PlaneShape& shape, const ShapeLook& look, DrawList& list);

/// Where the centre of a foot may go: an area in a line, its convex pieces faint and thin; grey on
/// planes that carry none.
void add_foot_space(const PlaneScene& scene, Theme theme, DrawList& list);

/// Nosings with what each step rises and how far it goes, an arrow up each flight and ramp, kerbs.
void add_stairs(const PlaneScene& scene, Theme theme, DrawList& list);

}  // namespace planescope::render
