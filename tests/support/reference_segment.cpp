#include "support/reference_segment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <utility>

#include "core/segment/criteria.hpp"
#include "core/segment/noise.hpp"

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
  Label label = Label::h;
  Points points;  // that the fit is made from
  PlaneFit fit;
  Moments moments = {};  // of the points, made anew with each fit
  Bounds bounds = {};
  double sigma_ang = 0;
};

struct GrowingPlane : Candidate {
  bool alive = true;
};

class Method {
 public:
  Method(std::span<const Vec3f> points,
         std::span<const Label> labels,
         Cube cube,
         const Vec3d& sensor,
         const SegmentOptions& options)
      : points_(points), labels_(labels), cube_(cube), sensor_(sensor), options_(options) {}

  Result run() {
    if (options_.cube_anchor == CubeAnchor::min_corner && !points_.empty()) {
      Vec3f low = points_[0];
      for (const Vec3f& p : points_) low = low.cwiseMin(p);
      cube_.min_corner = low.cast<double>();
    }
    root_ = std::make_unique<Node>();
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) insert(i);
    measure_noise();
    plane_of_.assign(points_.size(), -1);
    traverse();
    if (options_.r3_weak_candidates) join_weak();
    if (options_.r7_second_merge) merge_again();
    if (options_.r2_explain_away) prune();
    assign();
    if (options_.r6_refit) refit();
    if (options_.r5_reassign_shared_cells) reassign();
    if (options_.r5_reassign_shared_cells && options_.r2_explain_away) drop_emptied();
    split();
    return conclude();
  }

 private:
  Vec3d at(int i) const { return points_[i].cast<double>(); }
  bool has(int i, Label label) const { return !options_.use_labels || labels_[i] == label; }
  double range(const Vec3d& p) const { return (p - sensor_).norm(); }
  double tau(const Vec3d& p) const { return noise_.tau(range(p)); }

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
  Cell coarse_of(int i) const {  // 10 cm: eight leaves
    Cell cell = leaf_of(i);
    for (int& c : cell) c >>= std::min(3, cube_.max_depth);
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

  /// (X - mu 1)(X - mu 1)^T, from the points.
  Mat3d scatter_of(const Points& set) const {
    const Vec3d mean = mean_of(set);
    Mat3d scatter = Mat3d::Zero();
    for (const int i : set) scatter += (at(i) - mean) * (at(i) - mean).transpose();
    return scatter;
  }

  Moments moments_of(const Points& set) const {
    Moments moments;
    for (const int i : set) moments.add(at(i));
    return moments;
  }

  Bounds bounds_of(const Points& set) const {
    Bounds bounds;
    for (const int i : set) bounds.add(at(i));
    return bounds;
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
    return f;
  }

  DistanceTerms terms(const GrowingPlane& plane, const Candidate& candidate) const {
    return distance_terms(
        {plane.fit, plane.moments, plane.sigma_ang, tau(plane.fit.centroid), plane.bounds},
        {candidate.fit, candidate.moments, candidate.sigma_ang, tau(candidate.fit.centroid),
         candidate.bounds});
  }

  void measure_noise() {
    noise_.fixed_rms_m = options_.fixed_rms_m;
    noise_.fixed_tau_m = options_.fixed_tau_m;
    if (!options_.estimate_sigma) return;
    std::map<std::pair<Cell, Label>, Points> cells;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i)
      cells[{coarse_of(i), options_.use_labels ? labels_[i] : Label::unknown}].push_back(i);
    std::vector<NoiseSample> samples;
    for (const auto& [key, set] : cells) {
      if (set.size() < 8) continue;
      const PlaneFit f = fit(set);
      samples.push_back({range(f.centroid), std::sqrt(f.eigenvalues[0] / (f.count - 3))});
    }
    fit_noise(noise_, samples, options_.sigma_by_range);
  }

  bool planar(Candidate& c) const {
    const double r = range(c.fit.centroid);
    c.sigma_ang = normal_uncertainty(c.fit, noise_.sigma(r));
    if (!options_.rms_criterion3)
      return normal_error(c.fit, options_.mse_normalization) <= options_.theta_e_n_m2;
    return std::sqrt(c.fit.eigenvalues[0] / c.fit.count) <= noise_.theta_rms(r);
  }

  Candidate fit_label(const Points& set, Label label) const {
    Candidate c;
    c.label = label;
    for (const int i : set)
      if (has(i, label)) c.points.push_back(i);
    c.fit = fit(c.points);
    c.moments = moments_of(c.points);
    c.bounds = bounds_of(c.points);
    return c;
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

  /// False: the node must be divided.
  bool conquered(const Node& node) {
    int n_h = 0;
    for (const int i : node.points) n_h += has(i, Label::h);
    const int n_v = static_cast<int>(node.points.size()) - n_h;
    const Label inlier = n_h >= n_v ? Label::h : Label::v;
    const Label outlier = n_h >= n_v ? Label::v : Label::h;
    const int n_in = std::max(n_h, n_v), n_out = std::min(n_h, n_v);
    const bool pure =
        n_out <= options_.theta_n_out && n_out <= options_.theta_r_out * (n_in + n_out);
    Candidate in = fit_label(node.points, inlier);
    if (!pure) {
      if (!options_.r4_fit_impure_nodes || n_in < options_.theta_n_in || !planar(in)) return false;
      Candidate out = fit_label(node.points, outlier);
      const bool both = n_out >= options_.theta_n_in;
      if (both && !planar(out)) return false;
      accept(in);
      if (both)
        accept(out);
      else
        leave(node.points, &inlier);
      return true;
    }
    if (n_in < options_.theta_n_in) {
      leave(node.points, nullptr);
      return true;
    }
    if (!planar(in)) return false;
    leave(node.points, &inlier);
    accept(in);
    return true;
  }

  void accept(const Candidate& c) {
    if (options_.r3_weak_candidates && c.sigma_ang > 4 * M_PI / 180)
      weak_.push_back(c);
    else
      conquer(c);
  }

  void found(const Candidate& c) {
    planes_.push_back({c});
    for (const int i : c.points) plane_of_[i] = static_cast<int>(planes_.size()) - 1;
  }

  void merge(const Points& set, int plane) {
    GrowingPlane& p = planes_[plane];
    p.points.insert(p.points.end(), set.begin(), set.end());
    p.fit = fit(p.points);
    p.moments = moments_of(p.points);
    p.bounds = bounds_of(p.points);
    p.sigma_ang = normal_uncertainty(p.fit, noise_.sigma(range(p.fit.centroid)));
    for (const int i : set) plane_of_[i] = plane;
  }

  void conquer(const Candidate& c) {
    int best = -1;
    double least = 0;
    for (int k = 0; k < static_cast<int>(planes_.size()); ++k) {
      double cost = 0;
      if (options_.r1_merge_by_distance) {
        if (planes_[k].label != c.label) continue;
        const DistanceTerms t = terms(planes_[k], c);
        if (!t.passes()) continue;
        cost = t.cost();
      } else {
        const Coplanarity t = coplanarity(planes_[k].fit, c.fit);
        if (!is_coplanar(t, options_)) continue;
        cost = t.offset_m;
      }
      if (best < 0 || cost < least) {
        best = k;
        least = cost;
      }
      if (options_.merge_partner == MergePartner::first) break;
    }
    if (best < 0)
      found(c);
    else
      merge(c.points, best);
  }

  /// Planes that have points in the 27 cells around each cell, as they are now.
  std::map<Cell, std::set<int>> planes_near() const {
    std::map<Cell, std::set<int>> near;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      if (plane_of_[i] < 0) continue;
      const Cell c = coarse_of(i);
      for (int d = 0; d < 27; ++d)
        near[{c[0] + d % 3 - 1, c[1] + d / 3 % 3 - 1, c[2] + d / 9 - 1}].insert(plane_of_[i]);
    }
    return near;
  }

  void join_weak() {
    auto near = planes_near();
    const int strong = static_cast<int>(planes_.size());
    for (const Candidate& c : weak_) {
      int best = -1;
      double least = 0;
      const auto consider = [&](int k, bool any_angle) {
        if (planes_[k].label != c.label) return;
        DistanceTerms t = terms(planes_[k], c);
        if (any_angle) t.max_angle_deg = 180;
        if (!t.passes() || (best >= 0 && t.cost() >= least)) return;
        best = k;
        least = t.cost();
      };
      std::set<int> around;
      for (const int i : c.points)
        around.insert(near[coarse_of(i)].begin(), near[coarse_of(i)].end());
      for (const int k : around) consider(k, true);
      for (int k = strong; k < static_cast<int>(planes_.size()); ++k) consider(k, false);
      if (best >= 0)
        merge(c.points, best);
      else if (c.points.size() >= 10 && c.sigma_ang <= 8 * M_PI / 180)
        found(c);
      else
        leftovers_.insert(leftovers_.end(), c.points.begin(), c.points.end());
    }
  }

  void merge_again() {
    std::vector<int> order(planes_.size());
    std::iota(order.begin(), order.end(), 0);
    const auto size = [&](int k) { return planes_[k].points.size(); };
    for (bool changed = true; changed;) {
      changed = false;
      std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) < size(b); });
      for (std::size_t i = 0; i < order.size() && !changed; ++i) {
        GrowingPlane& small = planes_[order[i]];
        if (!small.alive) continue;
        const Candidate c{small.label,   small.points, small.fit,
                          small.moments, small.bounds, small.sigma_ang};
        int best = -1;
        double least = 0;
        for (std::size_t j = i + 1; j < order.size(); ++j) {
          const GrowingPlane& large = planes_[order[j]];
          if (!large.alive || large.label != small.label) continue;
          const DistanceTerms t = terms(large, c);
          if (!t.passes() || (best >= 0 && t.cost() >= least)) continue;
          best = order[j];
          least = t.cost();
        }
        if (best < 0) continue;
        small.alive = false;
        merge(c.points, best);
        changed = true;
      }
    }
  }

  bool larger(int a, int b) const {
    const auto na = planes_[a].points.size(), nb = planes_[b].points.size();
    return na > nb || (na == nb && a < b);
  }

  Points points_on(int plane) const {
    Points result;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i)
      if (plane_of_[i] == plane) result.push_back(i);
    return result;
  }

  double typical_area() const {
    std::multimap<double, double> areas;
    double points = 0, below = 0;
    for (const GrowingPlane& plane : planes_)
      if (plane.alive) {
        areas.insert({area_per_point(plane.fit), plane.fit.count});
        points += plane.fit.count;
      }
    for (const auto& [area, count] : areas)
      if ((below += count) >= points / 2) return area;
    return 0;
  }

  void prune() {
    auto near = planes_near();
    std::vector<int> order(planes_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return larger(b, a); });
    const double typical = typical_area();
    for (const int k : order) {
      if (!planes_[k].alive) continue;
      const Points own = points_on(k);
      int unexplained = 0;
      for (const int i : own) {
        bool explained = false;
        for (const int other : near[coarse_of(i)])
          explained |= planes_[other].alive && larger(other, k) &&
                       std::abs(planes_[other].fit.distance_m(at(i))) <=
                           tau(at(i)) * (planes_[other].label == planes_[k].label ? 1 : 0.5);
        unexplained += !explained;
      }
      const PlaneFit& f = planes_[k].fit;
      const bool wide =
          std::sqrt(f.eigenvalues[1] / f.count) >= 2 * noise_.sigma(range(f.centroid));
      const bool dense = 0.12 * area_per_point(f) <= typical;
      const double z = std::abs(f.normal.z());
      const bool h = planes_[k].label == Label::h;
      const bool contradicted = options_.use_labels && (h ? z < 0.5 : z > std::sqrt(0.75));
      if (!contradicted && wide && dense &&
          unexplained >= std::max(8.0, 0.25 * static_cast<double>(own.size())))
        continue;
      planes_[k].alive = false;
      for (const int i : own) {
        plane_of_[i] = -1;
        leftovers_.push_back(i);
      }
    }
  }

  int nearest(const std::set<int>& candidates, int i) const {
    int best = -1;
    double least = 0;
    for (const int k : candidates) {
      if (!planes_[k].alive) continue;
      const double distance = std::abs(planes_[k].fit.distance_m(at(i)));
      if (distance > tau(at(i))) continue;
      const double cost =
          distance + (has(i, planes_[k].label) ? 0 : 1.5 * noise_.sigma(range(at(i))));
      if (best >= 0 && cost >= least) continue;
      best = k;
      least = cost;
    }
    return best;
  }

  void assign() {
    auto near = planes_near();
    for (const int i : std::exchange(leftovers_, {})) {
      if (options_.leftover_rule == LeftoverRule::nearest) {
        plane_of_[i] = nearest(near[coarse_of(i)], i);
        continue;
      }
      for (int k = 0; k < static_cast<int>(planes_.size()) && plane_of_[i] < 0; ++k)
        if (planes_[k].alive &&
            std::abs(planes_[k].fit.distance_m(at(i))) <= options_.leftover_distance_m)
          plane_of_[i] = k;
    }
  }

  void refit() {
    auto near = planes_near();
    std::vector<Points> sure(planes_.size()), all(planes_.size());
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      if (plane_of_[i] < 0) continue;
      all[plane_of_[i]].push_back(i);
      bool shared = false;
      for (const int k : near[coarse_of(i)])
        shared |= k != plane_of_[i] && planes_[k].alive &&
                  std::abs(planes_[k].fit.distance_m(at(i))) <= tau(at(i));
      if (!shared) sure[plane_of_[i]].push_back(i);
    }
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      GrowingPlane& plane = planes_[k];
      const double enough = std::max(10.0, 0.3 * static_cast<double>(plane.points.size()));
      if (!plane.alive || static_cast<double>(sure[k].size()) < enough) continue;
      const PlaneFit of_sure = fit(sure[k]), of_all = fit(all[k]);
      const bool strip = uncertainty(of_sure) > 1.2 * uncertainty(of_all);
      plane.points = strip ? all[k] : sure[k];
      plane.fit = strip ? of_all : of_sure;
    }
  }
  double uncertainty(const PlaneFit& f) const {
    return normal_uncertainty(f, noise_.sigma(range(f.centroid)));
  }

  void reassign() {
    auto near = planes_near();
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) {
      if (plane_of_[i] < 0 || near[coarse_of(i)].size() < 2) continue;
      const int k = nearest(near[coarse_of(i)], i);
      if (k >= 0) plane_of_[i] = k;
    }
  }

  void drop_emptied() {
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      const Points kept = points_on(static_cast<int>(k));
      if (!planes_[k].alive || 2 * kept.size() >= planes_[k].points.size()) continue;
      planes_[k].alive = false;
      for (const int i : kept) {
        plane_of_[i] = -1;
        leftovers_.push_back(i);
      }
    }
    assign();
  }

  std::vector<Points> parts_of(Points rest) const {
    std::vector<Points> parts;
    while (!rest.empty()) {
      Points part{rest.back()};
      rest.pop_back();
      for (std::size_t reached = 0; reached < part.size(); ++reached) {
        const auto touches = [&, at = points_[part[reached]]](int i) {
          return (points_[i] - at).norm() <= options_.split_gap_m;
        };
        std::copy_if(rest.begin(), rest.end(), std::back_inserter(part), touches);
        std::erase_if(rest, touches);
      }
      std::sort(part.begin(), part.end());
      parts.push_back(part);
    }
    return parts;
  }

  void split() {
    if (options_.split_disconnected != SplitRule::on) return;
    const std::size_t founded = planes_.size();
    for (std::size_t k = 0; k < founded; ++k) {
      const std::vector<Points> parts = parts_of(points_on(static_cast<int>(k)));
      if (!planes_[k].alive || parts.size() < 2) continue;
      planes_[k].alive = false;
      for (const Points& part : parts) {
        const bool large = static_cast<int>(part.size()) >= std::max(3, options_.theta_n_in);
        for (const int i : part) plane_of_[i] = -1;
        if (large) found({.label = planes_[k].label, .points = part, .fit = fit(part)});
      }
    }
  }

  Result conclude() const {
    Result result;
    std::vector<int> number(planes_.size(), -1);
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      const bool used = std::count(plane_of_.begin(), plane_of_.end(), static_cast<int>(k)) > 0;
      if (!planes_[k].alive || !used) continue;
      number[k] = static_cast<int>(result.planes.size());
      result.planes.push_back({planes_[k].label, planes_[k].fit});
    }
    for (const int k : plane_of_) result.plane_of.push_back(k < 0 ? -1 : number[k]);
    return result;
  }

  std::span<const Vec3f> points_;
  std::span<const Label> labels_;
  Cube cube_;
  Vec3d sensor_;
  const SegmentOptions& options_;
  NoiseModel noise_;
  std::unique_ptr<Node> root_;
  std::vector<GrowingPlane> planes_;
  std::vector<Candidate> weak_;
  std::vector<int> plane_of_;
  Points leftovers_;
};

}  // namespace

Result segment(std::span<const Vec3f> points,
               std::span<const Label> labels,
               const Cube& cube,
               const Vec3d& sensor,
               const SegmentOptions& options) {
  return Method(points, labels, cube, sensor, options).run();
}

}  // namespace planescope::reference
