#include "core/planes/evaluate/label_accuracy.hpp"

#include <cmath>
#include <unordered_map>

namespace planescope::planes {
namespace {

double percent_of(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 100.0;
}

}  // namespace

double LabelAccuracy::percent() const { return percent_of(edge_right + inner_right, edge + inner); }
double LabelAccuracy::edge_percent() const { return percent_of(edge_right, edge); }
double LabelAccuracy::inner_percent() const { return percent_of(inner_right, inner); }

LabelAccuracy& LabelAccuracy::operator+=(const LabelAccuracy& other) {
  edge_right += other.edge_right;
  edge += other.edge;
  inner_right += other.inner_right;
  inner += other.inner;
  return *this;
}

std::vector<std::uint8_t> near_other_label(std::span<const Vec3f> points,
                                           std::span<const Label> labels,
                                           std::span<const Vec3f> reference_points,
                                           std::span<const Label> reference_labels) {
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (x & 0x1fffff) | (y & 0x1fffff) << 21 | (z & 0x1fffff) << 42;
  };
  const auto cell = [](float v) {
    return static_cast<std::int64_t>(std::floor(v / kEdgeDistanceM));
  };
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> grid;
  for (std::uint32_t i = 0; i < reference_points.size(); ++i) {
    const Vec3f& p = reference_points[i];
    if (reference_labels[i] != Label::unknown)
      grid[key(cell(p.x()), cell(p.y()), cell(p.z()))].push_back(i);
  }
  std::vector<std::uint8_t> near(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = cell(points[i].x()), y = cell(points[i].y()), z = cell(points[i].z());
    for (int d = 0; d < 27 && !near[i]; ++d) {
      const auto found = grid.find(key(x + d % 3 - 1, y + d / 3 % 3 - 1, z + d / 9 - 1));
      if (found == grid.end()) continue;
      for (const std::uint32_t j : found->second)
        if (reference_labels[j] != labels[i] &&
            (reference_points[j] - points[i]).squaredNorm() <
                static_cast<float>(kEdgeDistanceM * kEdgeDistanceM))
          near[i] = 1;
    }
  }
  return near;
}

LabelAccuracy label_accuracy(std::span<const Label> truth,
                             std::span<const Label> found,
                             std::span<const std::uint8_t> near_edge) {
  LabelAccuracy accuracy;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] == Label::unknown) continue;
    const bool right = truth[i] == found[i];
    ++(near_edge[i] ? accuracy.edge : accuracy.inner);
    (near_edge[i] ? accuracy.edge_right : accuracy.inner_right) += right;
  }
  return accuracy;
}

LabelAccuracy label_accuracy(const LabelledCloud& cloud, std::span<const Label> found) {
  if (!cloud.near_edge.empty()) return label_accuracy(cloud.labels, found, cloud.near_edge);
  return label_accuracy(cloud.labels, found,
                        near_other_label(cloud.points, cloud.labels, cloud.points, cloud.labels));
}

}  // namespace planescope::planes
