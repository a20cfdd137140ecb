#pragma once

// Sun et al. 2023, Sec. IV-A. A linear octree: points are sorted by Morton code, and a node is a
// range of points. Dividing a node appends its children in breadth-first order, so the node array
// is also the queue Q_N of the paper.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/plane.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::planes {

/// Coordinates of a depth image's octree: pixels u and v, and inverse depth rho = 1 / z. Planes in
/// 3D are planes in these coordinates, and the noise of stereo depth is uniform.
struct ImageSpace {
  double fx = 0, fy = 0, cx = 0, cy = 0;   // [px], without distortion
  Pose T_local_camera = Pose::Identity();  // camera: x right, y down, z forward
  double root_px = 1024;                   // side of the root in u and v, a power of two
  double px_per_inverse_m = 64;            // a cell of s px is s / 64 1/m deep in rho
  double farthest_m = 1;                   // greatest z of the points: limits the drawing of cells

  /// Converts (u, v, rho) [px, px, 1/m] to local coordinates [m] and back. Points beyond
  /// `farthest_m`, including rho = 0 at infinity, are clamped to that depth.
  Vec3d to_local(const Vec3d& at) const {
    const double z = 1 / std::max(at.z(), 1 / farthest_m);
    return T_local_camera * Vec3d((at.x() - cx) / fx * z, (at.y() - cy) / fy * z, z);
  }
  Vec3d from_local(const Vec3d& point) const {
    const Vec3d p = T_local_camera.inverse() * point;
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, 1 / p.z()};
  }
};

/// Case of a node (Fig. 4 of the paper): I impure, II too few inliers, III not planar, IV a plane.
enum class Case : std::uint8_t { none = 0, I = 1, II = 2, III = 3, IV = 4 };
const char* to_string(Case c);

struct OctreeNode {
  std::uint64_t code = 0;   // Morton code of its cell at its own depth
  std::uint32_t begin = 0;  // points: Octree::order[begin, end)
  std::uint32_t end = 0;
  std::uint32_t count_h = 0;  // points labeled h; the others are v
  std::int32_t parent = -1;
  std::int32_t first_child = -1;  // children are contiguous; -1 if never divided
  std::uint8_t child_count = 0;   // non-empty children only
  std::uint8_t depth = 0;
  Case decided = Case::none;
  bool at_max_depth = false;  // case I or III: its points became leftovers (drawn hatched)
  bool by_label = false;      // case I: the points of each label were fitted separately

  std::uint32_t size() const { return end - begin; }
};

struct Octree {
  Cube cube;                            // max_depth applies to both coordinate systems
  std::optional<ImageSpace> image;      // set: cells divide (u, v, 1 / z), not the cube
  std::vector<std::uint64_t> keys;      // Morton codes at max depth, ascending
  std::vector<std::uint32_t> order;     // order[i]: input index of the i-th point
  std::vector<Vec3f> points;            // points and ...
  std::vector<Label> labels;            // ... labels in Morton order
  std::vector<std::uint32_t> h_before;  // number of points labeled h among the first i; size n + 1
  std::vector<OctreeNode> nodes;        // breadth-first; nodes[0] is the root

  // Cells of the cube only; cell_corners() supports both coordinate systems.
  Vec3d node_min(const OctreeNode& node) const;      // lower corner, local coordinates [m]
  double node_edge_m(const OctreeNode& node) const;  // [m]
};

/// Bounds of a cell in the octree's coordinates: x, y, z [m], or u, v, 1 / z [px, px, 1/m].
Bounds cell_bounds(const Octree& octree, const OctreeNode& node);
/// Corners of such bounds in local coordinates [m]. Bit 0 of the index selects greater x or u, bit
/// 1 greater y or v, bit 2 greater z or distance: right-handed in both coordinate systems.
std::array<Vec3f, 8> corners_of(const Octree& octree, const Bounds& bounds);
/// Corners of a node's cell: a cube, or a frustum of the camera.
std::array<Vec3f, 8> cell_corners(const Octree& octree, const OctreeNode& node);
/// Center of a cell in the octree's coordinates, converted to local coordinates [m].
Vec3d cell_center(const Octree& octree, const OctreeNode& node);
/// Whether both octrees divide the same space, so that cells with the same code and depth coincide.
bool same_cells(const Octree& a, const Octree& b);
/// Cell size at a depth: "5 cm", or "16 px × 0.25 1/m".
std::string cell_size_text(const Octree& octree, int depth);

/// Sorts the points into the cube's cells and creates the root. All points must be inside the cube.
Octree build_octree(std::span<const Vec3f> points, std::span<const Label> labels, const Cube& cube);

/// Appends the non-empty children of node `index`.
void divide(Octree& octree, std::int32_t index);

}  // namespace planescope::planes
