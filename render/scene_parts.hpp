#pragma once

// What the scenes of a frame share: points, boxes, names, legends, and planes as they are drawn.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/stairs/stairs.hpp"
#include "render/palette.hpp"

namespace planescope::render {

inline constexpr Rgba kSceneText{32, 36, 42, 255};
inline constexpr Rgba kSceneFaded{190, 194, 200, 255};  // what a scene is not about

int color_id_of(int plane_id, std::span<const int> color_of_plane);
Rgba color_of(int plane_id, std::span<const int> color_of_plane);

/// The voxels as splats that close the surface, without colors yet.
DrawPoints voxel_points(const planes::VoxelCloud& voxels);

/// The points inside range and cube as dots, without colors yet; `at`: the cloud's index of each.
DrawPoints kept_points(const planes::Cloud& cloud, std::vector<std::size_t>& at);

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
