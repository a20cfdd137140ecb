// Reference implementation of the paper's method, simple rather than fast (Sun et al. 2023).

#include "support/reference_segment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>

namespace planescope::reference {
namespace {

using Cell = std::array<int, 3>;
using Points = std::vector<int>;

struct Node {
  int depth = 0;
  Points points;
  std::array<std::unique_ptr<Node>, 8> children;
};

struct Candidate {
  PlaneFit fit;
  Label label = Label::h;
  Points points;  // points of the plane
};

/// Offset [m] between a list's plane and a candidate if they are coplanar by Criterion 4.
std::optional<double> offset_of_coplanar(const PlaneFit& plane,
                                         const PlaneFit& candidate,
                                         const planes::SegmentOptions& o) {
  const Vec3d dmu = plane.centroid - candidate.centroid;
  const double offset = std::abs(plane.normal.dot(dmu));
  const double most = 1 - o.theta_coplane;
  if (std::abs(plane.normal.dot(candidate.normal)) < o.theta_coplane) return {};
  if (dmu.norm() > 0 && offset / dmu.norm() > most) return {};
  if (o.criterion4_n2 && dmu.norm() > 0 && std::abs(candidate.normal.dot(dmu)) / dmu.norm() > most)
    return {};
  if (o.merge_offset_m > 0 && offset > o.merge_offset_m) return {};
  return offset;
}

class Method {
 public:
  Method(std::span<const Vec3f> points,
         std::span<const Label> labels,
         planes::Cube cube,
         const planes::SegmentOptions& options)
      : points_(points), labels_(labels), cube_(cube), options_(options) {}

  Result run() {
    if (options_.cube_anchor == planes::CubeAnchor::min_corner && !points_.empty()) {
      Vec3f low = points_[0];
      for (const Vec3f& p : points_) low = low.cwiseMin(p);
      cube_.min_corner = low.cast<double>();
    }
    root_ = std::make_unique<Node>();
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) insert(i);
    plane_of_.assign(points_.size(), -1);
    traverse();
    assign();
    return conclude();
  }

 private:
  Vec3d at(int i) const { return points_[i].cast<double>(); }
  bool has(int i, Label label) const { return !options_.use_labels || labels_[i] == label; }
  Cell leaf_of(int i) const {
    Cell cell;
    const int cells = 1 << cube_.max_depth;
    for (int k = 0; k < 3; ++k) {
      const double c =
          (static_cast<double>(points_[i][k]) - cube_.min_corner[k]) * (cells / cube_.edge_m);
      cell[k] = std::clamp(static_cast<int>(std::max(0.0, c)), 0, cells - 1);
    }
    return cell;
  }
  void insert(int i) {
    const Cell leaf = leaf_of(i);
    Node* node = root_.get();
    node->points.push_back(i);
    for (int depth = 1; depth <= cube_.max_depth; ++depth) {
      const int bit = cube_.max_depth - depth;
      const int child =
          (leaf[0] >> bit & 1) | (leaf[1] >> bit & 1) << 1 | (leaf[2] >> bit & 1) << 2;
      auto& next = node->children[child];
      if (!next) {
        next = std::make_unique<Node>();
        next->depth = depth;
      }
      node = next.get();
      node->points.push_back(i);
    }
  }

  Vec3d mean_of(const Points& set) const {
    Vec3d mean = Vec3d::Zero();
    for (const int i : set) mean += at(i);
    return mean / static_cast<double>(set.size());
  }

  /// (X - mu 1)(X - mu 1)^T, computed from the points.
  Mat3d scatter_of(const Points& set) const {
    const Vec3d mean = mean_of(set);
    Mat3d scatter = Mat3d::Zero();
    for (const int i : set) scatter += (at(i) - mean) * (at(i) - mean).transpose();
    return scatter;
  }

  PlaneFit fit(const Points& set) const {
    PlaneFit f;
    f.count = static_cast<double>(set.size());
    if (set.empty()) return f;
    f.centroid = mean_of(set);
    if (set.size() < 3) return f;
    const Eigen::SelfAdjointEigenSolver<Mat3d> solver(scatter_of(set));
    f.eigenvalues = solver.eigenvalues().cwiseMax(0.0);
    f.normal = solver.eigenvectors().col(0);
    Vec3d::Index largest = 0;
    f.normal.cwiseAbs().maxCoeff(&largest);
    if (f.normal[largest] < 0) f.normal = -f.normal;
    return f;
  }

  bool planar(const PlaneFit& f) const {
    const double variance = f.eigenvalues[0] / f.count;
    const bool mean = options_.mse_normalization == planes::MseNormalization::mean;
    return (mean ? variance : f.eigenvalues[0]) <= options_.theta_e_n_m2;
  }

  Candidate fit_label(const Points& set, Label label) const {
    Points of_label;
    for (const int i : set)
      if (has(i, label)) of_label.push_back(i);
    return {fit(of_label), label, of_label};
  }

  void leave(const Points& set, const Label* except) {
    for (const int i : set)
      if (!except || !has(i, *except)) leftovers_.push_back(i);
  }

  void traverse() {
    std::deque<const Node*> queue{root_.get()};
    while (!queue.empty()) {
      const Node* node = queue.front();
      queue.pop_front();
      if (node->points.empty()) continue;
      if (conquered(*node)) continue;
      if (node->depth == cube_.max_depth) {
        leave(node->points, nullptr);
        continue;
      }
      for (const auto& child : node->children)
        if (child) queue.push_back(child.get());
    }
  }

  /// Returns false if the node must be divided.
  bool conquered(const Node& node) {
    int n_h = 0;
    for (const int i : node.points) n_h += has(i, Label::h);
    const int n_v = static_cast<int>(node.points.size()) - n_h;
    const Label inlier = n_h >= n_v ? Label::h : Label::v;
    const int n_in = std::max(n_h, n_v), n_out = std::min(n_h, n_v);
    const bool pure =
        n_out <= options_.theta_n_out && n_out <= options_.theta_r_out * (n_in + n_out);
    const Candidate in = fit_label(node.points, inlier);
    if (!pure) return false;
    if (n_in < options_.theta_n_in) {
      leave(node.points, nullptr);
      return true;
    }
    if (!planar(in.fit)) return false;
    leave(node.points, &inlier);
    conquer(in);
    return true;
  }

  void found(const Candidate& c) {
    planes_.push_back(c);
    for (const int i : c.points) plane_of_[i] = static_cast<int>(planes_.size()) - 1;
  }

  void merge(const Points& set, int plane) {
    Candidate& p = planes_[plane];
    p.points.insert(p.points.end(), set.begin(), set.end());
    p.fit = fit(p.points);
    for (const int i : set) plane_of_[i] = plane;
  }

  void conquer(const Candidate& c) {
    int best = -1;
    double least = 0;
    for (int k = 0; k < static_cast<int>(planes_.size()); ++k) {
      const auto cost = offset_of_coplanar(planes_[k].fit, c.fit, options_);
      if (!cost) continue;
      if (best < 0 || *cost < least) {
        best = k;
        least = *cost;
      }
      if (options_.merge_partner == planes::MergePartner::first) break;
    }
    if (best < 0)
      found(c);
    else
      merge(c.points, best);
  }

  void assign() {
    for (const int i : leftovers_)
      for (int k = 0; k < static_cast<int>(planes_.size()) && plane_of_[i] < 0; ++k)
        if (std::abs(planes_[k].fit.distance_m(at(i))) <= options_.leftover_distance_m)
          plane_of_[i] = k;
  }

  Result conclude() const {
    Result result;
    std::vector<int> number(planes_.size(), -1);
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      const bool used = std::count(plane_of_.begin(), plane_of_.end(), static_cast<int>(k)) > 0;
      if (!used) continue;
      number[k] = static_cast<int>(result.planes.size());
      result.planes.push_back({planes_[k].label, planes_[k].fit});
    }
    for (const int k : plane_of_) result.plane_of.push_back(k < 0 ? -1 : number[k]);
    return result;
  }

  std::span<const Vec3f> points_;
  std::span<const Label> labels_;
  planes::Cube cube_;
  const planes::SegmentOptions& options_;
  std::unique_ptr<Node> root_;
  std::vector<Candidate> planes_;
  std::vector<int> plane_of_;
  Points leftovers_;
};

}  // namespace

Result segment(std::span<const Vec3f> points,
               std::span<const Label> labels,
               const planes::Cube& cube,
               const planes::SegmentOptions& options) {
  return Method(points, labels, cube, options).run();
}

}  // namespace planescope::reference
