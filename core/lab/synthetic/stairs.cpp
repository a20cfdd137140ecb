// Point sampling of surfaces, and the random staircases of the paper's evaluation set (Sec. V).

#include "core/lab/synthetic/stairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/model/random.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {

// ---- Farthest point sampling ----

namespace {

/// A kd-tree that stores, for every node, the point farthest from all chosen ones. A new choice
/// changes only the few leaves that are nearer to it than to all earlier choices.
class FarthestTree {
 public:
  explicit FarthestTree(std::span<const Vec3f> points)
      : order_(points.size()), distance2_(points.size(), kFar) {
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.reserve(2 * points.size() / kLeafPoints + 2);
    build(points, 0, static_cast<std::uint32_t>(points.size()));
    sorted_.reserve(points.size());
    for (const std::uint32_t index : order_) sorted_.push_back(points[index]);
  }

  std::uint32_t farthest() const { return nodes_[0].farthest; }
  void choose(const Vec3f& point) { update(0, point); }

 private:
  static constexpr std::uint32_t kLeafPoints = 32;
  static constexpr float kFar = std::numeric_limits<float>::max();

  struct Node {
    Vec3f min, max;                // of its points
    float distance2 = kFar;        // of its farthest point from the chosen ones
    std::uint32_t farthest = 0;    // that point, the first of equals
    std::uint32_t begin = 0, end;  // in sorted_
    std::uint32_t right = 0;       // the left child follows its parent; 0: a leaf
  };

  void build(std::span<const Vec3f> points, std::uint32_t begin, std::uint32_t end) {
    Node node;
    node.begin = begin;
    node.end = end;
    node.min = node.max = points[order_[begin]];
    for (std::uint32_t i = begin; i < end; ++i) {
      node.min = node.min.cwiseMin(points[order_[i]]);
      node.max = node.max.cwiseMax(points[order_[i]]);
    }
    const auto first = order_.begin() + begin, last = order_.begin() + end;
    node.farthest = *std::min_element(first, last);
    const std::size_t self = nodes_.size();
    nodes_.push_back(node);
    if (end - begin <= kLeafPoints) {
      std::sort(first, last);  // so that the first of equals comes first
      return;
    }
    int axis = 0;
    (node.max - node.min).maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(first, order_.begin() + middle, last, [&](std::uint32_t a, std::uint32_t b) {
      return points[a][axis] < points[b][axis];
    });
    build(points, begin, middle);
    nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
    build(points, middle, end);
  }

  /// Rounding is monotonic: no point in the box can be nearer than this, so skipping is exact.
  static float box_distance2(const Node& node, const Vec3f& p) {
    const Vec3f d = (node.min - p).cwiseMax(p - node.max).cwiseMax(0.f);
    return d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
  }

  void update(std::uint32_t index, const Vec3f& p) {
    Node& node = nodes_[index];
    if (box_distance2(node, p) >= node.distance2) return;
    if (node.right == 0) return update_leaf(node, p);
    update(index + 1, p);
    update(node.right, p);
    const Node &a = nodes_[index + 1], &b = nodes_[node.right];
    const bool left =
        a.distance2 > b.distance2 || (a.distance2 == b.distance2 && a.farthest < b.farthest);
    node.distance2 = left ? a.distance2 : b.distance2;
    node.farthest = left ? a.farthest : b.farthest;
  }

  void update_leaf(Node& node, const Vec3f& p) {
    node.distance2 = -1;
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Vec3f d = sorted_[i] - p;
      distance2_[i] = std::min(distance2_[i], d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
      if (distance2_[i] <= node.distance2) continue;
      node.distance2 = distance2_[i];
      node.farthest = order_[i];
    }
  }

  std::vector<std::uint32_t> order_;  // point at each index of sorted_
  std::vector<Vec3f> sorted_;         // leaf by leaf
  std::vector<float> distance2_;      // from the nearest chosen point, in the order of sorted_
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count) {
  std::vector<std::uint32_t> chosen;
  if (points.empty()) return chosen;
  FarthestTree tree(points);
  chosen.reserve(std::min(count, points.size()));
  while (chosen.size() < std::min(count, points.size())) {
    chosen.push_back(tree.farthest());
    tree.choose(points[chosen.back()]);
  }
  return chosen;
}

// ---- Surfaces ----

SurfacePoints sample_surface(std::span<const Rectangle> rectangles,
                             std::size_t count,
                             const Mat3d& turn,
                             Random& random) {
  double area = 0;
  for (const Rectangle& r : rectangles) area += r.area();
  // Dense: four times the requested number, at least 32768 points, spread evenly by area.
  const std::size_t dense = std::max<std::size_t>(32768, 4 * count);
  SurfacePoints all;
  for (std::size_t k = 0; k < rectangles.size(); ++k) {
    const Rectangle& r = rectangles[k];
    const auto n =
        static_cast<std::size_t>(std::lround(static_cast<double>(dense) * r.area() / area));
    for (std::size_t i = 0; i < n; ++i) {
      double u = random.uniform(), v = random.uniform();
      if (r.halved && u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      all.points.push_back((turn * (r.corner + u * r.side_u + v * r.side_v)).cast<float>());
      all.rectangle.push_back(static_cast<std::uint32_t>(k));
    }
  }
  if (count == 0) return all;
  SurfacePoints even;
  for (const std::uint32_t i : farthest_points(all.points, count)) {
    even.points.push_back(all.points[i]);
    even.rectangle.push_back(all.rectangle[i]);
  }
  return even;
}

Vec3f with_noise(const Vec3f& point, double sigma_m, Random& random) {
  Vec3d p = point.cast<double>();
  if (sigma_m > 0)
    for (int axis = 0; axis < 3; ++axis) p[axis] += sigma_m * random.normal();
  return p.cast<float>();
}

// ---- Stairs ----

namespace {

Mat3d turn_of(const Stairs& stairs) {
  return Eigen::AngleAxisd(stairs.yaw_rad, Vec3d::UnitZ()).toRotationMatrix();
}

/// Riser, tread, riser, ... before the staircase is rotated.
std::vector<Rectangle> faces_of(const Stairs& stairs) {
  std::vector<Rectangle> faces;
  for (int s = 0; s < stairs.steps; ++s) {
    const double x = s * stairs.length_m, z = s * stairs.height_m;
    const Vec3d across(0, stairs.width_m, 0);
    faces.push_back({{x, 0, z}, across, {0, 0, stairs.height_m}, {-1, 0, 0}});
    faces.push_back({{x, 0, z + stairs.height_m}, {stairs.length_m, 0, 0}, across, {0, 0, 1}});
  }
  return faces;
}

double distance(const Vec3d& p, const Rectangle& face) {
  const Vec3d d = p - face.corner;
  const double u = face.side_u.squaredNorm(), v = face.side_v.squaredNorm();
  return (d - std::clamp(d.dot(face.side_u) / u, 0.0, 1.0) * face.side_u -
          std::clamp(d.dot(face.side_v) / v, 0.0, 1.0) * face.side_v)
      .norm();
}

}  // namespace

Stairs make_stairs(int index, const StairsOptions& options) {
  Random random(options.seed * 0x9e3779b97f4a7c15ULL +
                static_cast<std::uint64_t>(index) * 0xd1b54a32d192ed03ULL);
  Stairs stairs;
  stairs.steps = random.integer(options.min_steps, options.max_steps);
  stairs.length_m = random.uniform(options.min_length_m, options.max_length_m);
  stairs.width_m = random.uniform(options.min_width_m, options.max_width_m);
  stairs.height_m = random.uniform(options.min_height_m, options.max_height_m);
  const double yaw = random.uniform(0, 2 * std::numbers::pi);
  stairs.yaw_rad = options.random_yaw ? yaw : 0;
  const Mat3d turn = turn_of(stairs);
  const std::vector<Rectangle> faces = faces_of(stairs);
  for (const Rectangle& f : faces) stairs.normals.push_back(turn * f.normal);

  const SurfacePoints surface =
      sample_surface(faces, static_cast<std::size_t>(options.points), turn, random);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const std::uint32_t face = surface.rectangle[i];
    stairs.cloud.points.push_back(with_noise(surface.points[i], options.noise_m, random));
    stairs.cloud.instance.push_back(static_cast<std::int32_t>(face) + 1);
    stairs.cloud.label.push_back(static_cast<std::uint8_t>(label_of_normal(faces[face].normal)));
  }
  return stairs;
}

std::vector<TruePolygon> true_polygons(const Stairs& stairs) {
  const Mat3d turn = turn_of(stairs);
  std::vector<TruePolygon> polygons;
  for (const Rectangle& f : faces_of(stairs)) {
    const Vec3d far = f.corner + f.side_u + f.side_v;
    polygons.push_back(
        {{turn * f.corner, turn * (f.corner + f.side_u), turn * far, turn * (f.corner + f.side_v)},
         static_cast<int>(polygons.size()) + 1});
  }
  return polygons;
}

planes::LabeledCloud labeled(const Stairs& stairs) {
  planes::LabeledCloud cloud{"stairs", stairs.cloud.points, {}, {}};
  const Mat3d turn_back = turn_of(stairs).transpose();
  const std::vector<Rectangle> faces = faces_of(stairs);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto label = static_cast<Label>(stairs.cloud.label[i]);
    const Vec3d p = turn_back * cloud.points[i].cast<double>();
    const bool near = std::any_of(faces.begin(), faces.end(), [&](const Rectangle& face) {
      return label_of_normal(face.normal) != label && distance(p, face) < planes::kEdgeDistanceM;
    });
    cloud.labels.push_back(label);
    cloud.near_edge.push_back(near);
  }
  return cloud;
}

// ---- Clouds of many points or planes ----

PointsOnPlanes tiles(int side, int points) {
  constexpr double kEdge_m = 5, kStep_m = 0.04, kNoise_m = 0.002;
  Random random(3);
  std::vector<double> heights(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (double& height : heights) height = kStep_m * random.integer(0, 49);
  PointsOnPlanes cloud;
  for (int i = 0; i < points; ++i) {
    const double x = random.uniform(0, side), y = random.uniform(0, side);
    const double z = heights[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                             static_cast<std::size_t>(x)];
    cloud.points.emplace_back(kEdge_m * x / side, kEdge_m * y / side,
                              z + kNoise_m * random.normal());
    cloud.labels.push_back(Label::h);
  }
  return cloud;
}

PointsOnPlanes scattered_stairs(int points) {
  constexpr double kNoise_m = 0.002;
  const Stairs stairs = make_stairs(0, {.points = 16});
  const std::vector<TruePolygon> faces = true_polygons(stairs);
  std::vector<double> area_until;
  double area = 0;
  for (const TruePolygon& face : faces) {
    const auto& c = face.corners;
    area += (c[1] - c[0]).cross(c[3] - c[0]).norm();
    area_until.push_back(area);
  }
  Random random(5);
  PointsOnPlanes cloud;
  for (int i = 0; i < points; ++i) {
    const auto at = std::ranges::lower_bound(area_until, random.uniform(0, area));
    const auto f = std::min(static_cast<std::size_t>(at - area_until.begin()), faces.size() - 1);
    const auto& c = faces[f].corners;
    const double u = random.uniform(), v = random.uniform();
    const Vec3d& normal = stairs.normals[f];
    const Vec3d p =
        c[0] + u * (c[1] - c[0]) + v * (c[3] - c[0]) + kNoise_m * random.normal() * normal;
    cloud.points.push_back(p.cast<float>());
    cloud.labels.push_back(std::abs(normal.z()) > 0.5 ? Label::h : Label::v);
  }
  return cloud;
}

}  // namespace planescope::lab
