// Sun et al. 2023, Sec. IV-B and IV-C, applied to (u, v, rho) instead of 3D space: the first
// regions are the nodes of case IV. Point labels are not used: Criterion 1 tests for a second plane
// instead of a second label.

#include <algorithm>

#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr double kLeastPixels = 5;     // smallest node to which the criteria apply
constexpr double kLeastHalf = 8;       // px: smallest halves that may be two planes
constexpr double kDevelops = 1.0 / 6;  // mean squared distance of two pixels of a cell along one
                                       // axis, as a share of its squared side

/// Case of a node and the value that decided it: the value of the first failed criterion, or of
/// Criterion 3.
struct Decision {
  Case decided = Case::none;
  double value = 0;
  ImageTerms terms = {};
};

class Division {
 public:
  Division(DepthSegmentation& s, Octree& octree) : s_(s), octree_(octree) {}

  void run() {
    const std::vector<DepthCell>& roots = s_.cells.levels.back();
    if (roots.empty()) return;
    find_parts();
    append(roots[0], 0, -1, 0);
    // The array of nodes serves as the queue Q_N.
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(octree_.nodes.size()); ++node)
      visit(node);
  }

 private:
  int level_of(std::int32_t node) const { return s_.cells.depth() - octree_.nodes[node].depth; }

  void append(const DepthCell& cell, std::uint32_t index, std::int32_t parent, int depth) {
    OctreeNode node;
    node.code = cell.code;
    node.begin = cell.first_pixel;
    node.end = cell.end_pixel;
    node.parent = parent;
    node.depth = static_cast<std::uint8_t>(depth);
    octree_.nodes.push_back(node);
    cell_of_.push_back(index);
  }

  void visit(std::int32_t index) {
    Trace* const trace = s_.traced.trace;
    if (trace) {
      trace->events.push_back({.type = EventType::visit, .node = index});
      trace->visited_at.push_back(trace->steps());
    }
    ++s_.counts.nodes_visited;
    const int level = level_of(index);
    const DepthCell& cell = s_.cells.levels[level][cell_of_[index]];
    const InversePlane plane = cell.moments.fit();
    const Decision decision = decide(index, cell, plane);
    OctreeNode& node = octree_.nodes[index];
    node.decided = decision.decided;
    if (trace) {
      trace->events.push_back({.type = EventType::decide,
                               .node_case = static_cast<std::uint8_t>(decision.decided),
                               .node = index,
                               .value = static_cast<float>(decision.value)});
      trace->image_terms.push_back(decision.terms);
    }
    ++s_.counts.nodes_per_case[static_cast<int>(decision.decided)];
    ++s_.counts.nodes_per_case_depth[static_cast<int>(decision.decided)][node.depth];
    if (trace) trace->decided_at.push_back(trace->steps());

    if (decision.decided == Case::IV) {
      found(index, cell, plane);
    } else if (level > 0 && cell.moments.n >= kLeastPixels) {
      divide(index, cell, level);
    } else {
      node.at_max_depth = decision.decided != Case::II;
      s_.counts.leftovers += node.size();
      if (trace)
        for (std::uint32_t i = node.begin; i < node.end; ++i)
          trace->points.push_back({i, {trace->steps(), -1, true}});
    }
  }

  /// For each cell: the highest cost of treating the cell, or any cell within it, as one plane;
  /// infinite if a cell within it is not flat. This prevents a small object on a large plane from
  /// being absorbed by the cell around it.
  void find_parts() {
    parts_.resize(s_.cells.levels.size());
    for (int level = 1; level <= s_.cells.depth(); ++level) {
      const std::vector<DepthCell>& below = s_.cells.levels[level - 1];
      std::vector<double>& parts = parts_[level];
      parts.reserve(s_.cells.levels[level].size());
      for (const DepthCell& cell : s_.cells.levels[level]) {
        double dearest = 0;
        if (level > 1)
          for (std::uint32_t k = cell.begin; k < cell.end; ++k)
            dearest = std::max(
                {dearest, parts_[level - 1][k], is_rough(below[k], level - 1) ? kNotFlat : 0});
        if (dearest < kNotFlat && is_filled(cell, level))
          dearest = std::max(dearest, two_planes(cell, level));
        parts.push_back(dearest);
      }
    }
  }

  double filled(const DepthCell& cell, int level) const {
    const double side = DepthCells::side_px(level);
    return cell.moments.n / (side * side);
  }
  bool is_filled(const DepthCell& cell, int level) const {
    return cell.moments.n >= kLeastPixels && filled(cell, level) >= s_.options.filled;
  }
  bool is_rough(const DepthCell& cell, int level) const {
    return is_filled(cell, level) && flatness(cell, level, cell.moments.fit()) > s_.options.flat;
  }

  /// Variance of a cell about its plane, relative to the variance explained by noise and bow.
  double flatness(const DepthCell& cell, int level, const InversePlane& plane) const {
    const double side = DepthCells::side_px(level), n = cell.moments.n;
    const double expected =
        s_.noise.white2(plane) + s_.noise.bow2(plane) * s_.noise.developed(kDevelops * side * side);
    return plane.sse / (n - 3) / expected;
  }

  Decision decide(std::int32_t index, const DepthCell& cell, const InversePlane& plane) const {
    const int level = level_of(index);
    ImageTerms terms{.filled = static_cast<float>(filled(cell, level))};
    if (!is_filled(cell, level)) return {Case::II, terms.filled, terms};
    if (level > 0) {
      const double two = parts_[level][cell_of_[index]];
      terms.two_planes = static_cast<float>(two);
      if (two > s_.options.two_planes * s_.options.merge_cost) return {Case::I, two, terms};
    }
    const double flat = flatness(cell, level, plane);
    terms.variance = static_cast<float>(flat);
    return {flat <= s_.options.flat ? Case::IV : Case::III, flat, terms};
  }

  /// Cost of joining the two halves of a cell: the highest over u, v and rho.
  double two_planes(const DepthCell& cell, int level) const {
    const std::vector<DepthCell>& below = s_.cells.levels[level - 1];
    double dearest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      PixelMoments half[2];
      for (std::uint32_t k = cell.begin; k < cell.end; ++k)
        half[below[k].code >> axis & 1] += below[k].moments;
      if (half[0].n < kLeastHalf || half[1].n < kLeastHalf) continue;
      dearest =
          std::max(dearest, s_.noise.join_cost(half[0], half[0].fit(), half[1], half[1].fit()));
    }
    return dearest;
  }

  void found(std::int32_t index, const DepthCell& cell, const InversePlane& plane) {
    const auto region = static_cast<std::int32_t>(s_.regions.size());
    DepthRegion& founded = s_.regions.emplace_back();
    founded.moments = cell.moments;
    founded.plane = plane;
    const OctreeNode& node = octree_.nodes[index];
    for (std::uint32_t i = node.begin; i < node.end; ++i) s_.region_of[s_.cells.pixels[i]] = region;
    ++s_.counts.candidates;
    log_founded(s_, octree_, region, index);
  }

  void divide(std::int32_t index, const DepthCell& cell, int level) {
    octree_.nodes[index].first_child = static_cast<std::int32_t>(octree_.nodes.size());
    octree_.nodes[index].child_count = static_cast<std::uint8_t>(cell.end - cell.begin);
    const int depth = octree_.nodes[index].depth + 1;
    for (std::uint32_t k = cell.begin; k < cell.end; ++k)
      append(s_.cells.levels[level - 1][k], k, index, depth);
    if (Trace* const trace = s_.traced.trace)
      trace->queued_at.resize(octree_.nodes.size(), trace->steps());
  }

  DepthSegmentation& s_;
  Octree& octree_;
  std::vector<std::uint32_t> cell_of_;      // per node: index in its level
  std::vector<std::vector<double>> parts_;  // per level and cell
};

}  // namespace

void divide_image(DepthSegmentation& s, Octree& octree) { Division(s, octree).run(); }

}  // namespace planescope::planes
