#include "core/segment/octree.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace planescope {
namespace {

/// Puts two zero bits between the lower 21 bits of x.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2) & 0x1249249249249249ULL;
  return x;
}

std::uint64_t gather(std::uint64_t x) {
  x &= 0x1249249249249249ULL;
  x = (x | x >> 2) & 0x10c30c30c30c30c3ULL;
  x = (x | x >> 4) & 0x100f00f00f00f00fULL;
  x = (x | x >> 8) & 0x1f0000ff0000ffULL;
  x = (x | x >> 16) & 0x1f00000000ffffULL;
  x = (x | x >> 32) & 0x1fffff;
  return x;
}

struct Entry {
  std::uint64_t key;
  std::uint32_t index;
};

/// Stable least-significant-digit radix sort on the lower `bits` of the keys.
void radix_sort(std::vector<Entry>& entries, int bits) {
  constexpr int kDigit = 8;
  std::vector<Entry> other(entries.size());
  for (int shift = 0; shift < bits; shift += kDigit) {
    std::array<std::uint32_t, 1 << kDigit> start{};
    const auto digit = [shift](const Entry& e) { return (e.key >> shift) & ((1 << kDigit) - 1); };
    for (const Entry& e : entries) ++start[digit(e)];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) sum += std::exchange(s, sum);
    for (const Entry& e : entries) other[start[digit(e)]++] = e;
    entries.swap(other);
  }
}

}  // namespace

const char* to_string(Case c) {
  constexpr const char* kNames[] = {"-", "I", "II", "III", "IV"};
  return kNames[static_cast<int>(c)];
}

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::array<std::uint32_t, 3> morton_cell(std::uint64_t code) {
  return {static_cast<std::uint32_t>(gather(code)), static_cast<std::uint32_t>(gather(code >> 1)),
          static_cast<std::uint32_t>(gather(code >> 2))};
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

  std::vector<Entry> entries(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f& p = points[i];
    entries[i] = {
        morton_code(cell_of(p.x(), cube.min_corner.x()), cell_of(p.y(), cube.min_corner.y()),
                    cell_of(p.z(), cube.min_corner.z())),
        static_cast<std::uint32_t>(i)};
  }
  radix_sort(entries, 3 * cube.max_depth);

  Octree octree;
  octree.cube = cube;
  octree.keys.resize(n);
  octree.order.resize(n);
  octree.points.resize(n);
  octree.labels.resize(n);
  octree.h_before.resize(n + 1);
  octree.h_before[0] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t from = entries[i].index;
    octree.keys[i] = entries[i].key;
    octree.order[i] = from;
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

}  // namespace planescope
