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

#include "support/reference_criteria.hpp"

namespace planescope::reference {
namespace {

using Cell = std::array<int, 3>;
using Points = std::vector<int>;

struct Node {
  int depth = 0;
  Points points;
  std::array<std::unique_ptr<Node>, 8> children;
};

struct Candidate : Surface {
  Label label = Label::h;
  Points points;  // that it is made from
};

struct GrowingPlane : Candidate {
  bool alive = true;
};

class Method {
 public:
  Method(std::span<const Vec3f> points,
         std::span<const Label> labels,
         planes::Cube cube,
         const Vec3d& sensor,
         const planes::SegmentOptions& options,
         const planes::Measurements& more)
      : points_(points),
        labels_(labels),
        cube_(cube),
        sensor_(sensor),
        options_(options),
        more_(more) {}

  Result run() {
    if (options_.cube_anchor == planes::CubeAnchor::min_corner && !points_.empty()) {
      Vec3f low = points_[0];
      for (const Vec3f& p : points_) low = low.cwiseMin(p);
      cube_.min_corner = low.cast<double>();
    }
    root_ = std::make_unique<Node>();
    for (int i = 0; i < static_cast<int>(points_.size()); ++i) insert(i);
    measure_noise();
    plane_of_.assign(points_.size(), -1);
    traverse();
    if (options_.r3_weak_candidates.on) join_weak();
    if (options_.r7_second_merge.on) merge_again();
    if (options_.r2_explain_away.on) prune();
    assign();
    if (options_.r6_refit.on) refit();
    if (options_.r5_reassign_shared_cells.on) reassign();
    if (options_.r5_reassign_shared_cells.on && options_.r2_explain_away.on) drop_emptied();
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

  /// R8: covariance of the measurements that point i is the mean of.
  Mat3d spread_of(int i) const {
    if (more_.spreads.empty()) return Mat3d::Zero();
    const Spread& s = more_.spreads[i];
    Mat3d spread;
    spread << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
    return spread;
  }

  /// (X - mu 1)(X - mu 1)^T, from the points.
  Mat3d scatter_of(const Points& set) const {
    const Vec3d mean = mean_of(set);
    Mat3d scatter = Mat3d::Zero();
    for (const int i : set) scatter += (at(i) - mean) * (at(i) - mean).transpose() + spread_of(i);
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

  Surface surface_of(const Points& set) const {
    Surface s;
    s.fit = fit(set);
    s.sigma_ang = normal_sigma(s.fit, noise_.sigma(range(s.fit.centroid)));
    s.tau = tau(s.fit.centroid);
    if (set.empty()) return s;
    s.scatter = scatter_of(set);
    for (int axis = 0; axis < 3; ++axis) {
      s.extent[axis] = {1e300, -1e300};
      for (const int i : set) {
        s.extent[axis].first = std::min(s.extent[axis].first, at(i)[axis]);
        s.extent[axis].second = std::max(s.extent[axis].second, at(i)[axis]);
      }
    }
    return s;
  }

  void measure_noise() {
    noise_.fixed_rms = options_.noise.fixed_rms_m;
    noise_.fixed_tau = options_.noise.fixed_tau_m;
    if (!options_.noise.estimate_sigma) return;
    noise_.by_range = options_.noise.sigma_by_range;
    noise_.of_spreads = !more_.spreads.empty();
    std::map<std::pair<Cell, Label>, Points> cells;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i)
      cells[{coarse_of(i), options_.use_labels ? labels_[i] : Label::unknown}].push_back(i);
    std::vector<std::pair<double, double>> samples;
    for (const auto& [key, set] : cells) {
      if (set.size() < 8) continue;
      const PlaneFit f = fit(set);
      samples.push_back({range(f.centroid), std::sqrt(f.eigenvalues[0] / (f.count - 3))});
    }
    noise_.measure(samples);
  }

  bool planar(const PlaneFit& f) const {
    const double variance = f.eigenvalues[0] / f.count;
    if (options_.noise.rms_criterion3)
      return std::sqrt(variance) <= noise_.theta_rms(range(f.centroid));
    const bool mean = options_.mse_normalization == planes::MseNormalization::mean;
    return (mean ? variance : f.eigenvalues[0]) <= options_.theta_e_n_m2;
  }

  Candidate fit_label(const Points& set, Label label) const {
    Points of_label;
    for (const int i : set)
      if (has(i, label)) of_label.push_back(i);
    return {surface_of(of_label), label, of_label};
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
    const Candidate in = fit_label(node.points, inlier);
    if (!pure) {
      if (!options_.r4_fit_impure_nodes.on || n_in < options_.theta_n_in || !planar(in.fit))
        return false;
      const Candidate out = fit_label(node.points, outlier);
      const bool both = n_out >= options_.theta_n_in;
      if (both && !planar(out.fit)) return false;
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
    if (!planar(in.fit)) return false;
    leave(node.points, &inlier);
    accept(in);
    return true;
  }

  void accept(const Candidate& c) {
    if (options_.r3_weak_candidates.on && c.sigma_ang > 4 * M_PI / 180)
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
    static_cast<Surface&>(p) = surface_of(p.points);
    for (const int i : set) plane_of_[i] = plane;
  }

  void conquer(const Candidate& c) {
    int best = -1;
    double least = 0;
    for (int k = 0; k < static_cast<int>(planes_.size()); ++k) {
      const bool r1 = options_.r1_merge_by_distance.on;
      if (r1 && planes_[k].label != c.label) continue;
      const auto cost =
          r1 ? cost_of_merging(planes_[k], c) : offset_of_coplanar(planes_[k].fit, c.fit, options_);
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

  /// Planes that have points in the 27 cells around each cell, as they are now.
  std::map<Cell, std::set<int>> planes_near() const {
    std::map<Cell, std::set<int>> in, near;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i)
      if (plane_of_[i] >= 0) in[coarse_of(i)].insert(plane_of_[i]);
    for (const auto& [c, planes] : in)
      for (int d = 0; d < 27; ++d)
        near[{c[0] + d % 3 - 1, c[1] + d / 3 % 3 - 1, c[2] + d / 9 - 1}].insert(planes.begin(),
                                                                                planes.end());
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
        const auto cost = cost_of_merging(planes_[k], c, any_angle);
        if (!cost || (best >= 0 && *cost >= least)) return;
        best = k;
        least = *cost;
      };
      std::set<int> around;
      for (const int i : c.points)
        around.insert(near[coarse_of(i)].begin(), near[coarse_of(i)].end());
      for (const int k : around) consider(k, true);
      for (int k = strong; k < static_cast<int>(planes_.size()); ++k) consider(k, false);
      if (best >= 0)
        merge(c.points, best);
      else if (c.points.size() >= 6 && c.sigma_ang <= 8 * M_PI / 180)
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
        int best = -1;
        double least = 0;
        for (std::size_t j = i + 1; j < order.size(); ++j) {
          const GrowingPlane& large = planes_[order[j]];
          if (!large.alive || large.label != small.label) continue;
          const auto cost = cost_of_merging(large, small);
          if (!cost || (best >= 0 && *cost >= least)) continue;
          best = order[j];
          least = *cost;
        }
        if (best < 0) continue;
        small.alive = false;
        merge(small.points, best);
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
        areas.insert({area_of_a_point(plane.fit), plane.fit.count});
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
          std::sqrt(f.eigenvalues[1] / f.count) >= 1.2 * noise_.sigma(range(f.centroid));
      const bool dense = 0.12 * area_of_a_point(f) <= typical;
      const double z = std::abs(f.normal.z());
      const bool h = planes_[k].label == Label::h;
      const bool contradicted = options_.use_labels && (h ? z < 0.5 : z > std::sqrt(0.75));
      if (!contradicted && wide && dense &&
          unexplained >= std::max(5.0, 0.25 * static_cast<double>(own.size())))
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
      if (options_.leftover_rule == planes::LeftoverRule::nearest) {
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
    return normal_sigma(f, noise_.sigma(range(f.centroid)));
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

  /// The points in the order in which a walk through the tree meets them.
  void walk(const Node& node, Points& met) const {
    if (node.depth == cube_.max_depth)
      met.insert(met.end(), node.points.begin(), node.points.end());
    for (const auto& child : node.children)
      if (child) walk(*child, met);
  }

  /// What hangs together by steps of at most `gap`. The points of a part are in the order of the
  /// walk; the largest part is the first, of equal ones that which the walk meets first.
  std::vector<Points> parts_of(Points rest, double gap) const {
    std::vector<Points> parts;
    while (!rest.empty()) {
      Points part{rest.back()};
      rest.pop_back();
      for (std::size_t reached = 0; reached < part.size(); ++reached) {
        const auto touching = std::partition(
            rest.begin(), rest.end(),
            [&, at = points_[part[reached]]](int i) { return (points_[i] - at).norm() > gap; });
        part.insert(part.end(), touching, rest.end());
        rest.erase(touching, rest.end());
      }
      std::sort(part.begin(), part.end(), [&](int a, int b) { return met_[a] < met_[b]; });
      parts.push_back(part);
    }
    std::sort(parts.begin(), parts.end(), [&](const Points& a, const Points& b) {
      return a.size() != b.size() ? a.size() > b.size() : met_[a[0]] < met_[b[0]];
    });
    return parts;
  }

  bool is_plane_of_its_own(const Points& part) const {
    return part.size() >= 6 && surface_of(part).sigma_ang <= 8 * M_PI / 180;
  }

  /// Where the sensor looked at p through the plane.
  std::optional<Vec3d> passed(const PlaneFit& f, const Vec3d& p) const {
    if (std::abs(f.distance_m(p)) < std::max(0.03, 2 * tau(p))) return {};
    return crossing(f, sensor_, p);
  }

  PassedCells passed_cells(int plane, double spacing) const {
    const PlaneFit& f = planes_[plane].fit;
    std::vector<Vec3d> own, others;
    for (int i = 0; i < static_cast<int>(points_.size()); ++i)
      (plane_of_[i] == plane ? own : others).push_back(at(i));
    for (const Vec3f& p : more_.beyond) others.push_back(p.cast<double>());
    PassedCells cells(f, own, spacing);
    for (const Vec3d& p : others)
      if (const auto where = passed(f, p)) cells.add(*where);
    return cells;
  }

  int nearest_to(int point, const Points& part) const {
    int best = part[0];
    const auto distance2 = [&](int i) { return (points_[i] - points_[point]).squaredNorm(); };
    for (const int i : part)
      if (distance2(i) < distance2(best)) best = i;
    return best;
  }

  /// Was half of the way between two points that face each other looked through?
  bool is_open(const PassedCells& cells, const Points& a, const Points& b) const {
    int from = a[0], to = -1;
    while (to != nearest_to(from, b)) {
      to = nearest_to(from, b);
      from = nearest_to(to, a);
    }
    const Vec3d way = at(to) - at(from);
    const int steps = static_cast<int>(way.norm() / cells.edge());
    int open = 0;
    for (int k = 1; k < steps; ++k) open += cells.any_at(at(from) + way * k / steps);
    return steps > 1 && 2 * open >= steps - 1;
  }

  /// Puts together the parts of a plane that were not seen to be apart. Those that are no planes of
  /// their own go to the largest.
  std::vector<Points> parts_seen_apart(int plane,
                                       const std::vector<Points>& parts,
                                       double spacing) {
    const PassedCells cells = passed_cells(plane, spacing);
    std::vector<Points> planes, scraps;
    for (const Points& part : parts)
      (planes.empty() || is_plane_of_its_own(part) ? planes : scraps).push_back(part);
    std::vector<std::size_t> group(planes.size());
    std::iota(group.begin(), group.end(), 0);
    for (std::size_t a = 0; a < planes.size(); ++a)
      for (std::size_t b = a + 1; b < planes.size(); ++b) {
        const bool open = !more_.rays || is_open(cells, planes[a], planes[b]);
        ++(open ? gaps_.open : gaps_.hidden);
        const auto [low, high] = std::minmax({group[a], group[b]});
        if (!open) std::replace(group.begin(), group.end(), high, low);
      }
    gaps_.scraps += static_cast<int>(scraps.size());
    std::map<std::size_t, Points> joined;
    for (std::size_t k = 0; k < planes.size(); ++k)
      joined[group[k]].insert(joined[group[k]].end(), planes[k].begin(), planes[k].end());
    for (const Points& scrap : scraps)
      joined[0].insert(joined[0].end(), scrap.begin(), scrap.end());
    std::vector<Points> result;
    for (const auto& [number, points] : joined) result.push_back(points);
    return result;
  }

  void split() {
    if (options_.split_disconnected.rule == planes::SplitRule::off) return;
    const bool seen = options_.split_disconnected.rule == planes::SplitRule::seen;
    const double spacing = std::sqrt(typical_area());
    const double gap = seen ? std::max(options_.split_disconnected.gap_m, 2 * spacing)
                            : options_.split_disconnected.gap_m;
    Points order;
    walk(*root_, order);
    met_.resize(points_.size());
    for (std::size_t k = 0; k < order.size(); ++k) met_[order[k]] = k;
    const int founded = static_cast<int>(planes_.size());
    for (int plane = 0; plane < founded; ++plane) {
      if (!planes_[plane].alive) continue;
      std::vector<Points> parts = parts_of(points_on(plane), gap);
      if (seen && parts.size() > 1) parts = parts_seen_apart(plane, parts, spacing);
      if (parts.size() < 2) continue;
      gaps_.splits += seen;
      part(plane, parts);
    }
  }

  /// The first part keeps the plane; one that is too small for Criterion 2 is given up.
  void part(int plane, const std::vector<Points>& parts) {
    for (const Points& points : parts) {
      const Candidate c{surface_of(points), planes_[plane].label, points};
      if (&points == &parts[0])
        static_cast<Candidate&>(planes_[plane]) = c;
      else
        found(c);
      if (static_cast<int>(points.size()) >= std::max(3, options_.theta_n_in)) continue;
      for (const int i : points) plane_of_[i] = -1;
    }
  }

  Result conclude() const {
    Result result;
    result.gaps = gaps_;
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
  planes::Cube cube_;
  Vec3d sensor_;
  const planes::SegmentOptions& options_;
  const planes::Measurements& more_;
  Noise noise_;
  std::unique_ptr<Node> root_;
  std::vector<GrowingPlane> planes_;
  std::vector<Candidate> weak_;
  std::vector<int> plane_of_;
  Points leftovers_;
  std::vector<std::size_t> met_;  // per point: when the walk does
  Gaps gaps_;
};

}  // namespace

Result segment(std::span<const Vec3f> points,
               std::span<const Label> labels,
               const planes::Cube& cube,
               const Vec3d& sensor,
               const planes::SegmentOptions& options,
               const planes::Measurements& more) {
  return Method(points, labels, cube, sensor, options, more).run();
}

}  // namespace planescope::reference
