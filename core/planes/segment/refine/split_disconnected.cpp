#include "core/planes/segment/refine/split_disconnected.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/segment/cells.hpp"
#include "core/planes/segment/parts.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes::split_disconnected {
namespace {

constexpr double kMaxCells = 1000;  // along an axis: a bound on memory

/// What was measured, by the direction in which it was seen.
class Rays {
  static constexpr std::size_t kTiles = 64;  // along an axis of the picture
  static constexpr std::size_t kAside = kTiles * kTiles;

 public:
  struct Ray {
    Vec3f end;
    std::int32_t point = -1;  // Morton position; -1 of what lies beyond the crop
    double behind_m = 0;      // how far behind a plane, at least, of one that it passed through
  };
  explicit Rays(const SegmentState& state);

  /// Which have been visited, by their tiles.
  using Visited = std::vector<std::uint8_t>;
  static Visited none_visited() { return Visited(kAside + 1, 0); }

  /// Calls visit(ray) for all that may have been seen through the convex region with these
  /// corners, and for some more, but not again for those visited before.
  template <typename Visit>
  void visit_through(std::span<const Vec3d> corners, Visited& visited, const Visit& visit) const {
    const auto visit_tile = [&](std::size_t tile) {
      if (visited[tile]) return;
      visited[tile] = 1;
      for (std::uint32_t k = first_[tile]; k < first_[tile + 1]; ++k) visit(rays_[k]);
    };
    constexpr double kForRounding = 0.01;  // of a tile
    const Vec2d first = Vec2d::Zero(), last = Vec2d::Constant(kTiles);
    Vec2d low = last, high = first;
    for (const Vec3d& corner : corners) {
      const std::optional<Vec2d> place = place_of(picture_of(corner));
      low = low.cwiseMin(place.value_or(first));
      high = high.cwiseMax(place.value_or(last));
    }
    const std::size_t from = tile_at(low.array() - kForRounding);
    const std::size_t to = tile_at(high.array() + kForRounding);
    for (std::size_t row = from / kTiles; row <= to / kTiles; ++row)
      for (std::size_t column = from % kTiles; column <= to % kTiles; ++column)
        visit_tile(row * kTiles + column);
    visit_tile(kAside);
  }

 private:
  /// Where the ray meets a plane before the sensor; nothing where it is far from its axis.
  std::optional<Vec2d> picture_of(const Vec3d& p) const {
    const Vec3d ray = p - sensor_;
    const double ahead = axis_.dot(ray);
    if (!(ahead > 0.2 * ray.norm())) return std::nullopt;
    return Vec2d(basis_.u.dot(ray) / ahead, basis_.v.dot(ray) / ahead);
  }
  /// In tiles, from the corner of the first.
  std::optional<Vec2d> place_of(const std::optional<Vec2d>& picture) const {
    if (!picture || !low_.allFinite()) return std::nullopt;
    return Vec2d((*picture - low_).array() * scale_.array());
  }
  static std::size_t tile_at(const Vec2d& place) {
    const Vec2d within = place.cwiseMax(0).cwiseMin(kTiles - 1);
    return static_cast<std::size_t>(within.y()) * kTiles + static_cast<std::size_t>(within.x());
  }

  Vec3d sensor_, axis_;
  PlaneBasis basis_;
  Vec2d low_ = Vec2d::Constant(INFINITY), scale_ = Vec2d::Zero();
  std::vector<std::uint32_t> first_;  // per tile, and of what is aside: CSR
  std::vector<Ray> rays_;
};

Rays::Rays(const SegmentState& state) : sensor_(state.sensor) {
  std::vector<Ray> all;
  all.reserve(state.octree.points.size() + state.more.beyond.size());
  const split_disconnected::Options& options = state.options.split_disconnected;
  const auto add = [&](const Vec3f& p, std::int32_t point, double tau_m) {
    all.push_back({p, point, std::max(options.behind_m, options.behind_taus * tau_m)});
  };
  for (std::uint32_t i = 0; i < state.octree.points.size(); ++i)
    add(state.octree.points[i], static_cast<std::int32_t>(i), state.reach(i).limit_m);
  for (const Vec3f& p : state.more.beyond) add(p, -1, state.tau(p.cast<double>()));
  Vec3d sum = Vec3d::Zero();
  for (const Ray& ray : all) sum += (ray.end.cast<double>() - sensor_).normalized();
  axis_ = sum.norm() > 0 ? Vec3d(sum.normalized()) : Vec3d::UnitX();
  basis_ = plane_basis(axis_);
  Vec2d high = -low_;
  std::vector<std::optional<Vec2d>> pictures;
  pictures.reserve(all.size());
  for (const Ray& ray : all)
    if (const auto& at = pictures.emplace_back(picture_of(ray.end.cast<double>()))) {
      low_ = low_.cwiseMin(*at);
      high = high.cwiseMax(*at);
    }
  for (int axis = 0; axis < 2; ++axis)
    scale_[axis] = high[axis] > low_[axis] ? kTiles / (high[axis] - low_[axis]) : 0;
  std::vector<std::size_t> tile;
  tile.reserve(all.size());
  first_.assign(kAside + 2, 0);
  for (const std::optional<Vec2d>& picture : pictures) {
    const std::optional<Vec2d> place = place_of(picture);
    tile.push_back(place ? tile_at(*place) : kAside);
    ++first_[tile.back() + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  rays_.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) rays_[next[tile[i]]++] = all[i];
}

/// Where the sensor's rays passed through a plane, within the bounds of its points.
class Sight {
 public:
  /// `points`: the plane's, at a distance of `spacing_m` from each other.
  Sight(const SegmentState& state,
        std::int32_t plane,
        std::span<const std::uint32_t> points,
        const Rays& rays,
        double spacing_m);
  /// Did rays pass through most of the gap between two parts of the plane, where they are nearest?
  /// A gap that something hides is not open, nor one without measurements.
  bool is_open_between(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b);

 private:
  Vec2d on_plane(const Vec3d& p) const { return {u_.dot(p), v_.dot(p)}; }
  std::optional<Vec3d> passed_at(const Rays::Ray& ray) const;
  void mark(const Rays::Ray& ray);
  /// Cells [x0, x1) x [y0, y1) of the grid.
  struct Block {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  };
  void mark_through(const Block& block);
  bool is_passed(const Block& block) const;
  bool is_open_at(const Vec3d& p);

  const SegmentState& state_;
  const Rays& rays_;
  const std::int32_t plane_;
  const split_disconnected::Options& options_;
  const PlaneFit& fit_;
  const double sensor_m_;  // from the plane
  Vec3d u_, v_;            // axes on the plane
  Vec2d low_;              // corner of the grid on it
  double cell_m_ = 0;
  int columns_ = 0, rows_ = 0;        // along u and v
  std::vector<std::uint8_t> passed_;  // per cell: rays did, of those looked at
  Rays::Visited looked_at_ = Rays::none_visited();
};

Sight::Sight(const SegmentState& state,
             std::int32_t plane,
             std::span<const std::uint32_t> points,
             const Rays& rays,
             double spacing_m)
    : state_(state),
      rays_(rays),
      plane_(plane),
      options_(state.options.split_disconnected),
      fit_(state.planes[plane].fit),
      sensor_m_(fit_.distance_m(state.sensor)) {
  u_ = fit_.normal.unitOrthogonal();
  v_ = fit_.normal.cross(u_);
  low_ = Vec2d::Constant(INFINITY);
  Vec2d high = -low_;
  for (const std::uint32_t i : points) {
    const Vec2d p = on_plane(state.point(i));
    low_ = low_.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec2d size = high - low_;
  cell_m_ = std::max({options_.sight_cell_m, spacing_m, size.maxCoeff() / kMaxCells});
  columns_ = static_cast<int>(size.x() / cell_m_) + 1;
  rows_ = static_cast<int>(size.y() / cell_m_) + 1;
  passed_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
}

void Sight::mark_through(const Block& block) {
  std::array<Vec3d, 4> corners;
  for (int k = 0; k < 4; ++k)
    corners[k] = fit_.offset_m() * fit_.normal +
                 (low_.x() + (k % 2 == 0 ? block.x0 : block.x1) * cell_m_) * u_ +
                 (low_.y() + (k / 2 == 0 ? block.y0 : block.y1) * cell_m_) * v_;
  rays_.visit_through(corners, looked_at_, [&](const Rays::Ray& ray) { mark(ray); });
}

std::optional<Vec3d> Sight::passed_at(const Rays::Ray& ray) const {
  const Vec3d measured = ray.end.cast<double>();
  const double point_m = fit_.distance_m(measured);
  if (sensor_m_ * point_m >= 0) return std::nullopt;  // before the plane
  if (std::abs(point_m) < ray.behind_m) return std::nullopt;
  if (ray.point >= 0 && state_.plane_of[ray.point] == plane_) return std::nullopt;
  return state_.sensor + sensor_m_ / (sensor_m_ - point_m) * (measured - state_.sensor);
}

void Sight::mark(const Rays::Ray& ray) {
  const std::optional<Vec3d> passed = passed_at(ray);
  if (!passed) return;
  const Vec2d at = (on_plane(*passed) - low_) / cell_m_;
  if (at.x() < 0 || at.y() < 0 || at.x() >= columns_ || at.y() >= rows_) return;
  passed_[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(columns_) +
          static_cast<std::size_t>(at.x())] = 1;
}

bool Sight::is_passed(const Block& block) const {
  for (int y = block.y0; y < block.y1; ++y)
    for (int x = block.x0; x < block.x1; ++x)
      if (passed_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(x)])
        return true;
  return false;
}

bool Sight::is_open_at(const Vec3d& p) {
  // Rays are about a cell apart.
  const Vec2d at = (on_plane(p) - low_) / cell_m_;
  const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
  const Block around{std::max(0, column - 1), std::max(0, row - 1), std::min(columns_, column + 2),
                     std::min(rows_, row + 2)};
  if (is_passed(around)) return true;
  mark_through(around);
  return is_passed(around);
}

bool Sight::is_open_between(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  const std::vector<Vec3f>& points = state_.octree.points;
  // From the point of b nearest to a's first, back and forth: not the very nearest pair, but one
  // that faces each other.
  std::uint32_t from = a[0], to = b[0];
  const auto nearest = [&](std::span<const std::uint32_t> part, std::uint32_t point) {
    std::uint32_t found = part[0];
    float least = INFINITY;
    for (const std::uint32_t i : part)
      if (const float off = (points[i] - points[point]).squaredNorm(); off < least)
        least = off, found = i;
    return found;
  };
  for (bool changed = true; changed;) {
    const std::uint32_t next_to = nearest(b, from), next_from = nearest(a, next_to);
    changed = next_to != to || next_from != from;
    to = next_to, from = next_from;
  }
  const Vec3d start = points[from].cast<double>(), gap = points[to].cast<double>() - start;
  const int samples = static_cast<int>(gap.norm() / cell_m_) - 1;
  int open = 0;
  for (int k = 1; k <= samples; ++k) open += is_open_at(start + gap * k / (samples + 1)) ? 1 : 0;
  return samples > 0 && open >= options_.open_share * samples;
}

constexpr Stage kStage = Stage::split_disconnected;

/// Could the part found a plane? What holds for candidates with uncertain normals holds for it.
bool is_plane_of_its_own(const SegmentState& state, const Part& part) {
  const PlaneFit fit = fit_plane(moments_of(state, part));
  return r3_weak_candidates::can_found(fit, state.sigma_ang(fit), state.options.r3_weak_candidates);
}

/// Joins the parts between which the sensor did not look through the plane: what hides the gap may
/// hide a connection. Without rays nothing is known to hide anything. Parts too small for planes of
/// their own stay with the first. `points`: all of the plane.
std::vector<Part> parts_seen_apart(const SegmentState& state,
                                   std::int32_t plane,
                                   std::span<const std::uint32_t> points,
                                   std::optional<Rays>& rays,
                                   double spacing_m,
                                   std::vector<Part> parts) {
  const auto scraps = std::stable_partition(parts.begin() + 1, parts.end(), [&](const Part& part) {
    return is_plane_of_its_own(state, part);
  });
  const auto count = static_cast<std::uint32_t>(scraps - parts.begin());
  DisjointSets sets(parts.size());
  for (auto k = count; k < parts.size(); ++k) sets.join(0, k);
  if (count > 1 && state.more.rays) {
    if (!rays) rays.emplace(state);
    Sight sight(state, plane, points, *rays, spacing_m);
    for (std::uint32_t a = 0; a < count; ++a)
      for (std::uint32_t b = a + 1; b < count; ++b)
        if (sets.root(a) != sets.root(b) && !sight.is_open_between(parts[a], parts[b]))
          sets.join(a, b);
  }
  std::vector<Part> result(parts.size());
  for (std::uint32_t k = 0; k < parts.size(); ++k) {
    Part& whole = result[sets.root(k)];
    whole.insert(whole.end(), parts[k].begin(), parts[k].end());
  }
  std::erase_if(result, [](const Part& part) { return part.empty(); });
  for (Part& part : result) std::sort(part.begin(), part.end());
  return result;
}

/// The plane that keeps the largest part is fitted anew.
void shrink(SegmentState& state, std::int32_t plane, const Part& kept) {
  log_refine(state, state.options.split_disconnected, plane);
  fit_again(state, plane, moments_of(state, kept));
}

/// A part too small to be a candidate is none.
void drop(SegmentState& state, std::int32_t plane, const Part& points) {
  log(state, {.type = EventType::leave, .stage = kStage, .plane = plane});
  drop_plane(state, plane, points);
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (options.rule == SplitRule::off) return;
  const auto least = static_cast<std::size_t>(std::max(3, state.options.theta_n_in));
  const bool seen = options.rule == SplitRule::seen;
  const double spacing_m = std::sqrt(typical_area_per_point(state));
  const double gap_m =
      seen ? std::max(options.gap_m, options.gap_spacings * spacing_m) : options.gap_m;
  const int levels = levels_of_gap(state.octree.cube, gap_m);
  const bool shared = levels == state.options.noise.neighbour_levels;
  const CellGrid own = shared ? CellGrid{} : make_cell_grid(state.octree, levels);
  PartFinder finder(state.octree, shared ? state.neighbour_cells() : own, levels, gap_m);
  const PlanePoints members = points_by_plane(state);
  std::optional<Rays> rays;  // from the first plane in several parts on
  const auto founded = static_cast<std::int32_t>(state.planes.size());
  for (std::int32_t plane = 0; plane < founded; ++plane) {
    if (!state.planes[plane].alive) continue;
    std::vector<Part> parts = finder.parts_of(members.of(plane));
    if (parts.size() < 2) continue;
    // The largest keeps the plane, the others found their own.
    std::stable_sort(parts.begin(), parts.end(),
                     [](const Part& a, const Part& b) { return a.size() > b.size(); });
    if (seen)
      parts = parts_seen_apart(state, plane, members.of(plane), rays, spacing_m, std::move(parts));
    for (std::size_t p = 1; p < parts.size(); ++p) {
      const std::int32_t part = found_part(state, kStage, plane, parts[p]);
      if (parts[p].size() < least) drop(state, part, parts[p]);
    }
    if (parts.size() < 2) continue;
    shrink(state, plane, parts[0]);
    if (parts[0].size() < least) drop(state, plane, parts[0]);
  }
}

}  // namespace planescope::planes::split_disconnected
