#include "core/evaluate/label_accuracy.hpp"

#include <cmath>
#include <unordered_map>

namespace planescope {
namespace {

constexpr double kEdge = 0.02;  // [m]: "near an edge"

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 100.0;
}

/// Which points have a point of another label within 2 cm.
std::vector<bool> near_edges(std::span<const Vec3f> points, std::span<const Label> labels) {
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (x & 0x1fffff) | (y & 0x1fffff) << 21 | (z & 0x1fffff) << 42;
  };
  const auto cell = [](float v) { return static_cast<std::int64_t>(std::floor(v / kEdge)); };
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> grid;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    grid[key(cell(points[i].x()), cell(points[i].y()), cell(points[i].z()))].push_back(i);
  std::vector<bool> near(points.size(), false);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = cell(points[i].x()), y = cell(points[i].y()), z = cell(points[i].z());
    for (int d = 0; d < 27 && !near[i]; ++d) {
      const auto found = grid.find(key(x + d % 3 - 1, y + d / 3 % 3 - 1, z + d / 9 - 1));
      if (found == grid.end()) continue;
      for (const std::uint32_t j : found->second)
        if (labels[j] != labels[i] && labels[j] != Label::unknown &&
            (points[j] - points[i]).squaredNorm() < static_cast<float>(kEdge * kEdge))
          near[i] = true;
    }
  }
  return near;
}

}  // namespace

double LabelAccuracy::edge_percent() const { return percent(edge_right, edge); }
double LabelAccuracy::inner_percent() const { return percent(inner_right, inner); }

LabelAccuracy& LabelAccuracy::operator+=(const LabelAccuracy& other) {
  edge_right += other.edge_right;
  edge += other.edge;
  inner_right += other.inner_right;
  inner += other.inner;
  return *this;
}

LabelAccuracy label_accuracy(std::span<const Vec3f> points,
                             std::span<const Label> truth,
                             std::span<const Label> found) {
  LabelAccuracy accuracy;
  const std::vector<bool> near = near_edges(points, truth);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (truth[i] == Label::unknown) continue;
    const bool right = truth[i] == found[i];
    ++(near[i] ? accuracy.edge : accuracy.inner);
    (near[i] ? accuracy.edge_right : accuracy.inner_right) += right;
  }
  return accuracy;
}

}  // namespace planescope
