// Builds the linear octree, and divides its nodes.

#include "core/planes/segment/octree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/model/morton.hpp"
#include "core/model/text.hpp"

namespace planescope::planes {
const char* to_string(Case c) {
  constexpr const char* kNames[] = {"-", "I", "II", "III", "IV"};
  return kNames[static_cast<int>(c)];
}

Vec3d Octree::node_min(const OctreeNode& node) const {
  assert(!image);
  const auto cell = morton_cell(node.code);
  return cube.min_corner + node_edge_m(node) * Vec3d(cell[0], cell[1], cell[2]);
}

double Octree::node_edge_m(const OctreeNode& node) const {
  assert(!image);
  return cube.edge_m / static_cast<double>(1u << node.depth);
}

Bounds cell_bounds(const Octree& octree, const OctreeNode& node) {
  if (!octree.image) {
    const Vec3d low = octree.node_min(node);
    return {low, low + Vec3d::Constant(octree.node_edge_m(node))};
  }
  const double side_px = std::ldexp(octree.image->root_px, -node.depth);
  const Vec3d side(side_px, side_px, side_px / octree.image->px_per_inverse_m);
  const auto cell = morton_cell(node.code);
  const Vec3d low = side.cwiseProduct(Vec3d(cell[0], cell[1], cell[2]));
  return {low, low + side};
}

std::array<Vec3f, 8> corners_of(const Octree& octree, const Bounds& bounds) {
  std::array<Vec3f, 8> corners;
  for (unsigned i = 0; i < corners.size(); ++i) {
    const bool third = ((i & 4) != 0) != octree.image.has_value();  // far away means small 1 / z
    const Vec3d at((i & 1) != 0 ? bounds.max.x() : bounds.min.x(),
                   (i & 2) != 0 ? bounds.max.y() : bounds.min.y(),
                   third ? bounds.max.z() : bounds.min.z());
    corners[i] = (octree.image ? octree.image->to_local(at) : at).cast<float>();
  }
  return corners;
}

std::array<Vec3f, 8> cell_corners(const Octree& octree, const OctreeNode& node) {
  return corners_of(octree, cell_bounds(octree, node));
}

Vec3d cell_center(const Octree& octree, const OctreeNode& node) {
  const Bounds cell = cell_bounds(octree, node);
  const Vec3d middle = (cell.min + cell.max) / 2;
  return octree.image ? octree.image->to_local(middle) : middle;
}

bool same_cells(const Octree& a, const Octree& b) {
  if (a.image && b.image)
    return a.image->root_px == b.image->root_px &&
           a.image->px_per_inverse_m == b.image->px_per_inverse_m;
  return !a.image && !b.image && a.cube.min_corner == b.cube.min_corner &&
         a.cube.edge_m == b.cube.edge_m;
}

std::string cell_size_text(const Octree& octree, int depth) {
  if (!octree.image) return length_text(std::ldexp(octree.cube.edge_m, -depth));
  const double side_px = std::ldexp(octree.image->root_px, -depth);
  return fmt::format("{:g} px × {:g} 1/m", side_px, side_px / octree.image->px_per_inverse_m);
}

Octree build_octree(std::span<const Vec3f> points,
                    std::span<const Label> labels,
                    const Cube& cube) {
  assert(points.size() == labels.size());
  assert(cube.max_depth >= 0 && cube.max_depth <= 21);
  const std::size_t n = points.size();
  const std::uint32_t cells = 1u << cube.max_depth;
  const double scale = cells / cube.edge_m;
  const auto cell_of = [&](float x, double low) {
    const double c = (static_cast<double>(x) - low) * scale;
    // A point on the upper face belongs to the last cell.
    return std::min(cells - 1, static_cast<std::uint32_t>(std::max(0.0, c)));
  };

  Octree octree;
  octree.cube = cube;
  octree.keys.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f& p = points[i];
    octree.keys[i] =
        morton_code(cell_of(p.x(), cube.min_corner.x()), cell_of(p.y(), cube.min_corner.y()),
                    cell_of(p.z(), cube.min_corner.z()));
  }
  sort_codes(octree.keys, octree.order, 3 * cube.max_depth);
  octree.points.resize(n);
  octree.labels.resize(n);
  octree.h_before.resize(n + 1);
  octree.h_before[0] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t from = octree.order[i];
    octree.points[i] = points[from];
    octree.labels[i] = labels[from];
    octree.h_before[i + 1] = octree.h_before[i] + (labels[from] == Label::h ? 1 : 0);
  }
  if (n > 0) {
    octree.nodes.reserve(n / 4 + 16);
    OctreeNode root;
    root.end = static_cast<std::uint32_t>(n);
    root.count_h = octree.h_before[n];
    octree.nodes.push_back(root);
  }
  return octree;
}

void divide(Octree& octree, std::int32_t index) {
  const OctreeNode parent = octree.nodes[index];
  assert(parent.first_child < 0 && parent.depth < octree.cube.max_depth);
  const int shift = 3 * (octree.cube.max_depth - parent.depth - 1);
  std::uint8_t count = 0;
  const auto first_child = static_cast<std::int32_t>(octree.nodes.size());
  for (std::uint32_t begin = parent.begin; begin < parent.end;) {
    const std::uint64_t code = octree.keys[begin] >> shift;
    const std::uint64_t beyond = (code + 1) << shift;
    const auto last = octree.keys.begin() + parent.end;
    const auto end = static_cast<std::uint32_t>(
        std::lower_bound(octree.keys.begin() + begin, last, beyond) - octree.keys.begin());
    OctreeNode child;
    child.code = code;
    child.begin = begin;
    child.end = end;
    child.count_h = octree.h_before[end] - octree.h_before[begin];
    child.parent = index;
    child.depth = static_cast<std::uint8_t>(parent.depth + 1);
    octree.nodes.push_back(child);
    ++count;
    begin = end;
  }
  octree.nodes[index].first_child = first_child;
  octree.nodes[index].child_count = count;
}

}  // namespace planescope::planes
