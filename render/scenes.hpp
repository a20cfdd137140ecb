#pragma once

// Draw lists and pictures of a frame's stages: pure functions over core's results, no GL.
// Coordinates are those of the cloud: world axes (z up), meters, relative to `Cloud::origin`.
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
/// Cloud by classifier margin: the label's color if certain, dark if uncertain.
DrawList scene_margins(const planes::FrameResult& result);
/// Octree nodes by case I-IV: voxels in the color of the node that settled them, inside the
/// bounding box of that node's points (never larger than its cell). Divided nodes are faint
/// outlines of their cells.
DrawList scene_cases(const planes::FrameResult& result);
/// Voxels in the colors of their planes, with outline, holes, normal and number of each plane.
DrawList scene_planes(const Frame& frame,
                      const planes::FrameResult& result,
                      std::span<const int> color_of_plane);
/// Unassigned points, with the planes faded.
DrawList scene_leftovers(const planes::FrameResult& result, std::span<const int> color_of_plane);

/// Counterparts of image_overlay and image_depth for clouds: every point of the file in its own
/// color (gray if none), overlaid with the planes' colors; and colored by height.
DrawList scene_overlay(const Frame& frame,
                       const planes::FrameResult& result,
                       std::span<const int> color_of_plane);
DrawList scene_heights(const planes::FrameResult& result);

/// Pictures of depth frames in image space, enlarged by a whole factor if the image is small.
/// Planes are drawn over the color image (projected if it is not aligned) or, without calibrated
/// color, over shaded depth; with outlines and ids.
Image8 image_overlay(const Frame& frame,
                     const planes::FrameResult& result,
                     std::span<const int> color_of_plane);
/// Depth as a color ramp with its scale in meters. Unmeasured pixels are hatched, pixels beyond
/// `max_range_m` gray.
Image8 image_depth(const Frame& frame, double max_range_m);

// ---- Ground truth, result and errors, side by side ----

/// Summary of errors as a share of the scored points: "missed 3.1 %, wrong plane 0.4 %", or
/// "no errors".
std::string errors_text(const planes::EvaluatedFrame& evaluated);

/// Labels, result and errors over the relief of a depth frame, with titles and a legend of errors.
Image8 image_truth(const Frame& frame,
                   const planes::FrameResult& result,
                   const planes::EvaluatedFrame& evaluated,
                   std::span<const int> color_of_plane);

/// The same three pictures for a cloud, to be drawn separately and joined.
std::array<DrawList, 3> scenes_truth(const planes::FrameResult& result,
                                     const planes::EvaluatedFrame& evaluated,
                                     std::span<const int> color_of_plane);

/// Joins images of equal height in a row, with narrow white gaps.
Image8 side_by_side(std::span<const Image8> images);

// ---- Plane ids in image space, and backgrounds ----

/// Plane id per pixel; 0: none.
using RegionImage = Image<std::int32_t>;

/// Whether each depth pixel has its color at the same position of the color image.
bool has_aligned_color(const Frame& frame);

/// Depth as a gray relief lit from the camera, to distinguish surfaces without color.
Image8 shaded_depth(const Frame& frame);

/// Plane ids on the pixels of the depth image.
RegionImage regions_on_depth(const Frame& frame, const planes::FrameResult& result);

/// Plane ids on a color image that is calibrated but not aligned: each depth pixel is projected as
/// a patch large enough to leave no holes, with the nearest surface in front.
RegionImage regions_on_color(const Frame& frame, const planes::FrameResult& result);

/// For drawing outlines: replaces pinholes and specks by the majority id of their 5x5 neighborhood.
RegionImage smooth_regions(const RegionImage& regions);

/// The innermost pixel of each region, by plane id - 1; depth_px 0 if the region is missing.
struct InteriorPoint {
  int x = 0, y = 0;
  double depth_px = 0;  // distance to the nearest pixel of another region
};
std::vector<InteriorPoint> interior_points(const RegionImage& regions, std::size_t plane_count);

// ---- Common parts of scenes ----

inline constexpr Rgba kSceneText{32, 36, 42, 255};
inline constexpr Rgba kSceneFaded{190, 194, 200, 255};  // background elements of a scene

int color_id_of(int plane_id, std::span<const int> color_of_plane);
Rgba color_of(int plane_id, std::span<const int> color_of_plane);

/// The voxels as splats without gaps, not yet colored.
DrawPoints voxel_points(const planes::VoxelCloud& voxels);

/// Indices of a node's points.
inline std::span<const std::uint32_t> members(const planes::Octree& octree,
                                              const planes::OctreeNode& node) {
  return std::span(octree.order).subspan(node.begin, node.size());
}

/// A node's whole cell, and the bounding box of its points inside the cell (a flat tile for a
/// plane). The caller sets colors and styles.
DrawBox cell_box(const planes::Octree& octree, const planes::OctreeNode& node);
DrawBox points_box(const planes::Octree& octree,
                   const planes::OctreeNode& node,
                   double voxel_size_m);

/// Convex hull of points projected onto a plane, counter-clockwise about the normal.
std::vector<Vec3f> outline_on_plane(const PlaneFit& plane, std::span<const Vec3f> points);

/// Smallest and largest value along each axis, without the outermost percent.
struct RobustBounds {
  Vec3f low = Vec3f::Zero(), high = Vec3f::Zero();
  float diagonal() const { return (high - low).norm(); }
};
RobustBounds robust_bounds(std::span<const Vec3f> points);

/// Whether a plane is large enough, as a share of all voxels, for an arrow and a name.
bool is_named(std::size_t voxels, std::size_t all);
/// Rank of a plane's label, by its share of all voxels.
std::int32_t plane_label_rank(std::size_t voxels, std::size_t all);
/// Position of the name of a plane with these voxels: its centroid if the plane covers it, else
/// where the plane's points are densest.
Vec3f place_on_plane(const Vec3d& centroid, std::span<const Vec3f> own, float voxel_m);
/// Length of the normal arrows in a scene with these voxels.
float normal_arrow_m(std::span<const Vec3f> voxels);

/// Largest number of nodes with numerals in a scene; the largest nodes come first.
inline constexpr std::size_t kMostNumerals = 60;
/// Smallest edge of a node with a numeral: the edge of a cube or, for a frustum, the longer edge at
/// the near end of its points_box().
double least_numeral_edge_m(std::span<const Vec3f> voxels);
double numeral_edge_m(const planes::Octree& octree,
                      const planes::OctreeNode& node,
                      const DrawBox& tile);
/// "III"; "I*" if the node was fitted label by label.
std::string case_numeral(const planes::OctreeNode& node);

/// Adds the gravity arrow at the left edge of the frame's default view; its label reports estimated
/// and assumed directions.
void add_gravity(const planes::FrameResult& result, DrawList& list);

/// Formats a share of the whole: "12.3 %".
std::string percent(std::size_t part, std::size_t whole);

/// Number of nodes by case. `count`: indexed by Case. `on_image`: whether the octree divides a
/// depth image.
void add_case_legend(std::span<const std::size_t> count, bool on_image, DrawList& list);

/// Lists the largest planes with label and size.
void add_plane_legend(const planes::FrameResult& result,
                      std::span<const int> color_of_plane,
                      DrawList& list);

// ---- Finished planes: outlines with holes, foot space, stairs ----
// In scene coordinates, relative to Cloud::origin.

/// Outline of a plane. Lines are pairs of end points.
struct PlaneShape {
  std::vector<Vec3f> rings;    // outer rings, and holes where something else was seen
  std::vector<Vec3f> unknown;  // dashes around unmeasured holes
  // Triangles of the filled shape, three corners each; empty if not filled.
  std::vector<Vec3f> corners;
  std::vector<std::uint32_t> triangles;
};

/// One per plane, by id - 1, not filled yet. `origin`: world position of the scene's origin.
std::vector<PlaneShape> plane_shapes(std::span<const planes::Outline> outlines,
                                     const Vec3d& origin);
/// Fills a shape; leaves it unfilled if its outline cannot be triangulated.
void fill_shape(const planes::Outline& outline, const Vec3d& origin, PlaneShape& shape);

struct FootShape {
  std::vector<Vec3f> rings;                // area for its center, as pairs of end points
  std::vector<std::vector<Vec3f>> pieces;  // convex
};

/// Analysis of a run's planes; unknown parts are empty.
struct PlaneScene {
  std::vector<PlaneShape> shapes;  // by id - 1
  std::vector<FootShape> foot;     // same; empty without a foot
  std::vector<bool> steppable;     // same
  planes::Stairs stairs;           // world coordinates
  std::vector<Vec3f> centroids;    // centroids of planes, by id - 1
  Vec3d origin = Vec3d::Zero();
  bool complete = false;  // the analysis has finished

  bool has_stairs() const {
    return !stairs.flights.empty() || !stairs.kerbs.empty() || !stairs.ramps.empty();
  }
  /// Whether a plane is steppable; nullopt if unknown.
  std::optional<bool> verdict(int plane_id) const;
};

/// Planes ordered by id; `outlines` and `footholds` likewise.
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

/// Areas for the center of a foot: outlined, with faint lines around convex pieces; gray on planes
/// that are not steppable.
void add_foot_space(const PlaneScene& scene, Theme theme, DrawList& list);

/// Nosings with the rise and going of each step, an arrow up each flight and ramp, and kerbs.
void add_stairs(const PlaneScene& scene, Theme theme, DrawList& list);

}  // namespace planescope::render
