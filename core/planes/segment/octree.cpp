#include "core/planes/segment/octree.hpp"

#include <algorithm>
#include <cassert>

#include "core/model/morton.hpp"

namespace planescope::planes {
const char* to_string(Case c) {
  constexpr const char* kNames[] = {"-", "I", "II", "III", "IV"};
  return kNames[static_cast<int>(c)];
}

Vec3d Octree::node_min(const OctreeNode& node) const {
  const auto cell = morton_cell(node.code);
  return cube.min_corner + node_edge_m(node) * Vec3d(cell[0], cell[1], cell[2]);
}

double Octree::node_edge_m(const OctreeNode& node) const {
  return cube.edge_m / static_cast<double>(1u << node.depth);
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
