#pragma once

// What the scenes of a frame share: colours, bounds, the gravity arrow.

#include <span>
#include <string>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

inline constexpr Rgba kSceneText{32, 36, 42, 255};
inline constexpr Rgba kSceneFaded{190, 194, 200, 255};  // what a scene is not about

Rgba with_alpha(Rgba color, std::uint8_t alpha);
Rgba mix(Rgba a, Rgba b, double share_b);  // opaque
int color_id_of(int plane_id, std::span<const int> color_of_plane);
Rgba color_of(int plane_id, std::span<const int> color_of_plane);

/// The voxels as splats that close the surface, without colours yet.
DrawPoints voxel_points(const planes::VoxelCloud& voxels);

/// The points inside range and cube as dots, without colours yet; `at`: the cloud's index of each.
DrawPoints kept_points(const planes::Cloud& cloud, std::vector<std::size_t>& at);

/// A node's whole cell, and the part of it that holds its points: on a plane, a tile. Colours and
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

}  // namespace planescope::render
