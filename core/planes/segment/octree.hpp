#pragma once

// Sun et al. 2023, Sec. IV-A. A linear octree: points sorted by Morton code, a node is a range of
// them. Nodes are made when their parent is divided, appended in breadth-first order, so that the
// node array is the paper's queue Q_N itself.

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

/// The space that the octree of a depth image divides: pixels u and v, and inverse depth rho = 1 /
/// z. A plane in space is a plane in it, and the noise of stereo depth is the same everywhere.
struct ImageSpace {
  double fx = 0, fy = 0, cx = 0, cy = 0;   // [px], without distortion
  Pose T_local_camera = Pose::Identity();  // camera: x right, y down, z forward
  double root_px = 1024;                   // side of the root in u and v, a power of two
  double px_per_inverse_m = 64;            // a cell of s px is s / 64 1/m high in rho
  double farthest_m = 1;                   // greatest z of the points: cells are drawn up to it

  /// (u, v, rho) [px, px, 1/m] to local coordinates [m], and back. What is beyond `farthest_m`, the
  /// infinitely far rho = 0 as well, comes to that depth.
  Vec3d to_local(const Vec3d& at) const {
    const double z = 1 / std::max(at.z(), 1 / farthest_m);
    return T_local_camera * Vec3d((at.x() - cx) / fx * z, (at.y() - cy) / fy * z, z);
  }
  Vec3d from_local(const Vec3d& point) const {
    const Vec3d p = T_local_camera.inverse() * point;
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, 1 / p.z()};
  }
};

/// Case of a node (the paper's figure 4): I impure, II too few inliers, III not planar, IV a plane.
enum class Case : std::uint8_t { none = 0, I = 1, II = 2, III = 3, IV = 4 };
const char* to_string(Case c);

struct OctreeNode {
  std::uint64_t code = 0;   // Morton code of its cell at its own depth
  std::uint32_t begin = 0;  // its points: Octree::order[begin, end)
  std::uint32_t end = 0;
  std::uint32_t count_h = 0;  // points labelled h; the others are v
  std::int32_t parent = -1;
  std::int32_t first_child = -1;  // children stand side by side; -1 if never divided
  std::uint8_t child_count = 0;   // non-empty children only
  std::uint8_t depth = 0;
  Case decided = Case::none;
  bool at_max_depth = false;  // I or III here: its points went to the leftovers (drawn hatched)
  bool by_label = false;      // I: the points of each label were fitted by themselves here

  std::uint32_t size() const { return end - begin; }
};

struct Octree {
  Cube cube;                            // max_depth counts in either space
  std::optional<ImageSpace> image;      // present: cells divide (u, v, 1 / z), not the cube
  std::vector<std::uint64_t> keys;      // Morton codes at max depth, ascending
  std::vector<std::uint32_t> order;     // order[i]: index in the input of the i-th point
  std::vector<Vec3f> points;            // the points and ...
  std::vector<Label> labels;            // ... their labels in Morton order
  std::vector<std::uint32_t> h_before;  // points labelled h among the first i; size n + 1
  std::vector<OctreeNode> nodes;        // breadth-first; nodes[0] is the root

  // Of a cell of the cube; cell_corners() is for both spaces.
  Vec3d node_min(const OctreeNode& node) const;      // lower corner, local coordinates [m]
  double node_edge_m(const OctreeNode& node) const;  // [m]
};

/// A cell in the coordinates that its octree divides: x, y, z [m], or u, v, 1 / z [px, px, 1/m].
Bounds cell_bounds(const Octree& octree, const OctreeNode& node);
/// The corners of such bounds in local coordinates [m]. An index has bit 0 for greater x or u, bit
/// 1 for greater y or v, bit 2 for greater z or farther away: right-handed in both spaces.
std::array<Vec3f, 8> corners_of(const Octree& octree, const Bounds& bounds);
/// Likewise of a node's cell: a cube, or the frustum that the camera sees it as.
std::array<Vec3f, 8> cell_corners(const Octree& octree, const OctreeNode& node);
/// The middle of a cell in the coordinates that its octree divides, as a local position [m].
Vec3d cell_center(const Octree& octree, const OctreeNode& node);
/// Whether both divide the same space: cells of the same code are then the same, depth by depth.
bool same_cells(const Octree& a, const Octree& b);
/// The size of the cells at a depth: "5 cm", or "16 px × 0.25 1/m".
std::string cell_size_text(const Octree& octree, int depth);

/// Sorts the points into the cube's cells and makes the root. All points must lie in the cube.
Octree build_octree(std::span<const Vec3f> points, std::span<const Label> labels, const Cube& cube);

/// Appends the non-empty children of node `index`.
void divide(Octree& octree, std::int32_t index);

}  // namespace planescope::planes
