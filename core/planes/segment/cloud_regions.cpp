// Merges, grows and lists regions of a cloud, each step evaluated by its change of the objective.

#include "core/planes/segment/cloud_regions.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/segment/cells.hpp"

namespace planescope::planes {
namespace {

constexpr int kRounds = 4;           // largest number of rounds of moving points, fitting
                                     // and merging
constexpr double kNoisePoints = 50;  // weight of the measured noise, in points
constexpr double kLeastGap_m = 0.05, kGapSpacings = 2;  // closer points touch

/// Variance about a plane of `count` points with this sum of squares: the cloud's, or the plane's
/// own if larger. Ray errors displace points farther from surfaces seen head-on.
double variance_around(double cloud_m2, double squares_m2, double count) {
  return std::max(cloud_m2, (kNoisePoints * cloud_m2 + squares_m2) / (kNoisePoints + count));
}

// ---- Merging ----

/// Merges touching regions in order of cost.
class Merger {
 public:
  Merger(SegmentState& state, const CloudScales& scales, const ObjectiveOptions& options)
      : state_(state), scales_(scales), options_(options), roots_(state.planes.size()) {}

  /// Returns the number of merges. `near`: planes near the cells of `grid`. `any_label`: also merge
  /// regions with different labels.
  int merge_all(const CellGrid& grid, const CellPlanes& near, bool any_label) {
    any_label_ = any_label;
    size_.resize(state_.planes.size());
    for (std::size_t k = 0; k < size_.size(); ++k) size_[k] = state_.planes[k].moments.count;
    for (const auto& [a, b] : touching_pairs(grid, near)) offer(a, b);
    int merged = 0;
    while (!offers_.empty()) {
      const Offer best = offers_.top();
      offers_.pop();
      const std::int32_t a = roots_.root(best.a), b = roots_.root(best.b);
      if (a == b) continue;
      if (size_[a] + size_[b] > best.points) {  // one of them has grown since
        offer(a, b);
        continue;
      }
      merge(a, b, best.cost);
      ++merged;
    }
    return merged;
  }

 private:
  struct Offer {
    double cost = 0;
    double points = 0;  // of both regions when the offer was made
    std::int32_t a = -1, b = -1;
    bool operator<(const Offer& other) const {  // largest offer first
      return cost != other.cost ? cost > other.cost : std::pair(a, b) > std::pair(other.a, other.b);
    }
  };

  /// Gain of the objective from a second plane: the squares it saves, divided by the squares
  /// explained by noise and bow. Each plane's squares are limited from below by the noise,
  /// because cell boundaries cut a noisy surface into layers flatter than it. nullopt if not
  /// below the limit.
  std::optional<double> cost(const GrowingPlane& p, const GrowingPlane& q) const {
    Moments both = p.moments;
    both += q.moments;
    const double white2 = scales_.white_m * scales_.white_m;
    const auto squares = [&](const GrowingPlane& r) {
      return std::max(r.fit.eigenvalues[0], (r.moments.count - 3) * white2);
    };
    const double weight = p.moments.count * q.moments.count / both.count;
    const double apart_m2 = squares(p) + squares(q);
    const double explained_m2 =
        3 * variance_around(white2, apart_m2, both.count) + scales_.bow_m * scales_.bow_m * weight;
    const Cubic cubic(both);
    if (cubic.least_root_is_beyond(apart_m2 + options_.merge_cost * explained_m2)) return {};
    const double cost = std::max(0.0, cubic.least_root() - apart_m2) / explained_m2;
    if (cost >= options_.merge_cost) return {};
    return cost;
  }

  void offer(std::int32_t a, std::int32_t b) {
    const GrowingPlane &p = state_.planes[a], &q = state_.planes[b];
    if (!any_label_ && p.label != q.label) return;
    if (const std::optional<double> c = cost(p, q))
      offers_.push({*c, size_[a] + size_[b], std::min(a, b), std::max(a, b)});
  }

  void merge(std::int32_t a, std::int32_t b, double cost) {
    const auto [from, into] =
        size_[a] < size_[b] || (size_[a] == size_[b] && a > b) ? std::pair(a, b) : std::pair(b, a);
    log(state_, {.type = EventType::refine,
                 .stage = Stage::join,
                 .plane = from,
                 .other = into,
                 .value = static_cast<float>(cost)});
    ++state_.counts.merges;
    if (points_.empty()) gather_points();
    join_planes(state_, from, into, points_[from]);
    points_[into].insert(points_[into].end(), points_[from].begin(), points_[from].end());
    points_[from].clear();
    size_[into] += size_[from];
    roots_.join_into(from, into);
  }

  void gather_points() {
    const PlanePoints members = points_by_plane(state_);
    points_.resize(state_.planes.size());
    for (std::int32_t k = 0; k < std::ssize(points_); ++k)
      points_[k].assign(members.of(k).begin(), members.of(k).end());
  }

  /// Regions with points in touching cells, each pair once.
  std::vector<std::pair<std::int32_t, std::int32_t>> touching_pairs(const CellGrid& grid,
                                                                    const CellPlanes& near) const {
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    std::vector<std::vector<std::int32_t>> partners(state_.planes.size());  // by lower index
    for (std::uint32_t cell = 0; cell < grid.size(); ++cell) {
      const auto planes = near.near(cell);
      if (planes.size() < 2) continue;
      std::int32_t last = -1;
      for (std::uint32_t i = grid.starts[cell]; i < grid.starts[cell + 1]; ++i) {
        const std::int32_t a = state_.plane_of[i];
        if (a < 0 || a == last) continue;
        last = a;
        for (const std::int32_t b : planes) {
          if (a == b || !state_.planes[b].alive) continue;
          const auto [low, high] = std::minmax(a, b);
          if (std::ranges::find(partners[low], high) != partners[low].end()) continue;
          partners[low].push_back(high);
          pairs.emplace_back(low, high);
        }
      }
    }
    return pairs;
  }

  SegmentState& state_;
  const CloudScales& scales_;
  const ObjectiveOptions& options_;
  bool any_label_ = false;
  Roots roots_;
  std::vector<double> size_;                        // points per plane
  std::vector<std::vector<std::uint32_t>> points_;  // per plane, from the first merge on
  std::priority_queue<Offer> offers_;
};

// ---- Points ----

/// Assigns each point to the plane that explains it best.
class PointMover {
 public:
  PointMover(SegmentState& state,
             const CloudScales& scales,
             const ObjectiveOptions& options,
             const CellGrid& grid)
      : state_(state),
        options_(options),
        grid_(grid),
        variance_m2_(scales.variance_m2()),
        label_m_(options.label_sigma * scales.measured_m) {}

  /// Returns the number of points newly assigned to a plane.
  int move_all(const CellPlanes& near) {
    worth_.assign(state_.planes.size(), 0);
    second_.assign(state_.plane_of.size(), {});
    changed_.assign(state_.planes.size(), 0);
    int added = 0;
    for (std::uint32_t cell = 0; cell < grid_.size(); ++cell)
      for (std::uint32_t i = grid_.starts[cell]; i < grid_.starts[cell + 1]; ++i)
        added += move(i, near.near(cell)) ? 1 : 0;
    return added;
  }

  /// Increase of the objective without the plane, excluding the plane's own cost.
  double worth(std::int32_t plane) const { return worth_[plane]; }
  /// Same, for a plane consisting of only these points.
  double worth(std::span<const std::uint32_t> points) const {
    double sum = 0;
    for (const std::uint32_t i : points) sum += second_[i].loss;
    return sum;
  }
  /// Per plane, whether it gained or lost points.
  std::span<const std::uint8_t> changed() const { return changed_; }
  /// The plane that explains the point second best; -1 if none.
  std::int32_t second_plane(std::uint32_t i) const { return second_[i].plane; }

 private:
  /// Returns -1 if none.
  std::int32_t nearest_of(const Vec3d& p, std::span<const std::int32_t> planes) const {
    std::int32_t nearest = -1;
    double least = INFINITY;
    for (const std::int32_t k : planes) {
      if (!state_.planes[k].alive) continue;
      const double off = std::abs(state_.planes[k].fit.distance_m(p));
      if (off >= least) continue;
      least = off;
      nearest = k;
    }
    return nearest;
  }

  /// Returns whether it assigned a previously unassigned point.
  bool move(std::uint32_t i, std::span<const std::int32_t> near) {
    const double unexplained = options_.point_reach_sigma * options_.point_reach_sigma;
    double least = unexplained, next = unexplained;
    std::int32_t best = -1, second = -1;
    const Vec3d p = state_.point(i);
    for (const std::int32_t k : near) {
      const GrowingPlane& plane = state_.planes[k];
      if (!plane.alive) continue;
      const double off_m =
          std::abs(plane.fit.distance_m(p)) + (state_.has_label(i, plane.label) ? 0 : label_m_);
      const double cost =
          off_m * off_m / variance_around(variance_m2_, plane.fit.eigenvalues[0], plane.fit.count);
      if (cost < least) {
        next = least;
        second = best;
        least = cost;
        best = k;
      } else if (cost < next) {
        next = cost;
        second = k;
      }
    }
    second_[i] = {second, next - least};
    if (best >= 0) worth_[best] += next - least;
    const std::int32_t from = state_.plane_of[i];
    if (best == from) return false;
    const std::int32_t shown = best >= 0 || !state_.trace ? best : nearest_of(p, near);
    log(state_, {.type = best < 0 ? EventType::drop : EventType::assign,
                 .stage = Stage::grow,
                 .plane = best,
                 .other = from,
                 .point = state_.input_index(i),
                 .value = shown < 0 ? -1
                                    : static_cast<float>(
                                          std::abs(state_.planes[shown].fit.distance_m(p)))});
    if (best < 0)
      leave_point(state_, i);
    else
      give_point(state_, i, best);
    for (const std::int32_t k : {from, best})
      if (k >= 0) changed_[k] = 1;
    return from < 0;
  }

  SegmentState& state_;
  const ObjectiveOptions& options_;
  const CellGrid& grid_;
  const double variance_m2_, label_m_;
  std::vector<double> worth_;          // per plane
  std::vector<std::uint8_t> changed_;  // per plane
  struct Second {
    std::int32_t plane = -1;
    double loss = 0;  // in squared sigma
  };
  std::vector<Second> second_;  // per point
};

/// Refits changed planes to their points, and ends planes without points. The label follows the
/// normal: a level layer of a low riser then pays for points with the other label, and is dropped.
void fit_planes(SegmentState& state, std::span<const std::uint8_t> changed) {
  std::vector<Moments> moments(state.planes.size());
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (const std::int32_t k = state.plane_of[i]; k >= 0 && changed[k])
      moments[k].add(state.point(i));
  for (std::int32_t k = 0; k < std::ssize(changed); ++k) {
    GrowingPlane& plane = state.planes[k];
    if (!plane.alive || !changed[k]) continue;
    if (moments[k].count >= 3) {
      if (state.options.use_labels) plane.label = label_of_normal(plane.fit.normal);
      fit_again(state, k, moments[k]);
    } else if (moments[k].count == 0) {
      end_plane(state, k);
    }
  }
}

/// Drops planes whose cost exceeds their worth, and planes no wider than the noise, in order of
/// increasing worth. A plane is kept while one of its neighbors has just been dropped, since its
/// worth may have increased.
int drop_worthless(SegmentState& state,
                   const PointMover& mover,
                   const CloudScales& scales,
                   const ObjectiveOptions& options,
                   const CellGrid& grid) {
  const auto is_line = [&](const PlaneFit& fit) {
    return fit.eigenvalues[1] <= fit.count * scales.variance_m2();
  };
  std::vector<std::int32_t> order;
  for (std::int32_t k = 0; k < std::ssize(state.planes); ++k)
    if (state.planes[k].alive &&
        (mover.worth(k) < options.plane_cost || is_line(state.planes[k].fit)))
      order.push_back(k);
  if (order.empty()) return 0;
  std::ranges::stable_sort(order, {}, [&](std::int32_t k) { return mover.worth(k); });
  const PlanePoints members = points_by_plane(state);
  std::vector<std::uint8_t> touched(grid.size(), 0);
  int dropped = 0;
  for (const std::int32_t k : order) {
    const auto points = members.of(k);
    if (std::ranges::any_of(points, [&](std::uint32_t i) { return touched[grid.cell_of[i]]; }))
      continue;
    log(state, {.type = EventType::refine,
                .stage = Stage::list,
                .plane = k,
                .value = static_cast<float>(mover.worth(k))});
    drop_plane(state, k, points);
    ++dropped;
    for (const std::uint32_t i : points) {
      const std::uint32_t cell = grid.cell_of[i];
      for (std::uint32_t n = grid.neighbor_first[cell]; n < grid.neighbor_first[cell + 1]; ++n)
        touched[grid.neighbors[n]] = 1;
    }
  }
  return dropped;
}

// ---- Parts ----

/// Splits a plane into its disconnected parts if they are worth their cost. Points of other parts
/// go to their second-best planes.
void split_planes(SegmentState& state,
                  const PointMover& mover,
                  const ObjectiveOptions& options,
                  const CellGrid& grid,
                  int levels,
                  double gap_m) {
  PartFinder finder(state.octree, grid, levels, gap_m);
  const PlanePoints members = points_by_plane(state);
  const auto count = static_cast<std::int32_t>(state.planes.size());
  std::vector<std::uint8_t> changed(state.planes.size(), 0);
  for (std::int32_t plane = 0; plane < count; ++plane) {
    if (!state.planes[plane].alive) continue;
    std::vector<Part> parts = finder.parts_of(members.of(plane));
    if (parts.size() < 2) continue;
    changed[plane] = 1;
    std::ranges::stable_sort(parts, std::greater<>(), &Part::size);
    for (auto part = parts.begin() + 1; part != parts.end(); ++part) {
      if (part->size() >= 3 && mover.worth(*part) >= options.plane_cost) {
        found_part(state, Stage::parts, plane, *part);
        continue;
      }
      for (const std::uint32_t i : *part) {
        const std::int32_t other = mover.second_plane(i);
        if (other < 0 || !state.planes[other].alive) continue;
        log(state, {.type = EventType::assign,
                    .stage = Stage::parts,
                    .plane = other,
                    .other = plane,
                    .point = state.input_index(i),
                    .value = static_cast<float>(
                        std::abs(state.planes[other].fit.distance_m(state.point(i))))});
        give_point(state, i, other);
        changed[other] = 1;
      }
    }
  }
  changed.resize(state.planes.size(), 0);
  fit_planes(state, changed);
}

}  // namespace

void find_cloud_regions(SegmentState& state,
                        const CloudScales& scales,
                        const ObjectiveOptions& options) {
  const double gap_m = std::max(kLeastGap_m, kGapSpacings * scales.spacing_m);
  const int levels = levels_of_gap(state.octree.cube, gap_m);
  const CellGrid grid = make_cell_grid(state.octree, levels);
  state.counts.leftovers = static_cast<std::uint32_t>(state.leftovers.size());
  if (scales.variance_m2() <= 0) {  // nothing is as wide as a plane
    const PlanePoints members = points_by_plane(state);
    for (std::int32_t k = 0; k < std::ssize(state.planes); ++k) {
      log(state, {.type = EventType::refine, .stage = Stage::list, .plane = k});
      drop_plane(state, k, members.of(k));
    }
    return;
  }
  const auto near = [&] { return planes_near_cells(grid, state.plane_of, state.planes.size()); };
  CellPlanes around = near();
  Merger(state, scales, options).merge_all(grid, around, false);
  PointMover mover(state, scales, options, grid);

  for (int round = 0;; ++round) {
    around = near();
    const int added = mover.move_all(around);
    fit_planes(state, mover.changed());
    if (round >= kRounds) break;
    int redrawn = drop_worthless(state, mover, scales, options, grid);
    redrawn += Merger(state, scales, options).merge_all(grid, around, true);
    if (redrawn == 0 && added == 0) break;  // narrow tips grow by one cell per round
  }
  split_planes(state, mover, options, grid, levels, gap_m);
}

}  // namespace planescope::planes
