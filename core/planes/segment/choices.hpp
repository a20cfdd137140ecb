#pragma once

// Every choice among planes that the method makes, told once. The stages pass no visitor; to
// explain a choice, it is made again with one, which is told of each pair that was compared, in
// order.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "core/planes/segment/cells.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes {

/// A candidate compared with a plane: by direction (Criterion 4) or by distance (R1).
struct Pair {
  std::int32_t plane = -1;
  std::variant<Coplanarity, DistanceTerms> terms;
  bool coplanar = false;
  double cost = 0;  // of coplanar ones, the one with the least is chosen
};
using PairVisitor = std::function<void(const Pair&)>;
PairStrain strain_of(const Pair& pair, const SegmentOptions& options);
/// The one that comes nearest to passing, of equals the first; null without any.
const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options);
/// R1's terms, of a plane of the list and what is compared with it. `any_angle`: see DistanceTerms.
Pair pair_by_distance(const SegmentState& state,
                      std::int32_t k,
                      const MeasuredPlane& measured,
                      bool any_angle = false);

/// Too far apart for R1, which is quickly told: pair_by_distance() would not be coplanar.
bool is_out_of_reach(const SegmentState& state, std::int32_t k, const MeasuredPlane& measured);

/// Of the coplanar pairs, the one with the least cost; of equals the first.
struct CheapestPair {
  const PairVisitor* visitor = nullptr;
  std::int32_t plane = -1;
  double cost = 0;

  /// Of the k-th plane by R1; only who explains the choice wants those out of reach as well.
  void consider_by_distance(const SegmentState& state,
                            std::int32_t k,
                            const MeasuredPlane& measured,
                            bool any_angle = false) {
    if (visitor || !is_out_of_reach(state, k, measured))
      consider(pair_by_distance(state, k, measured, any_angle));
  }
  void consider(const Pair& pair) {
    if (visitor) (*visitor)(pair);
    if (!pair.coplanar || (plane >= 0 && pair.cost >= cost)) return;
    plane = pair.plane;
    cost = pair.cost;
  }
};

/// Criterion 4, or R1 in its place, of the k-th plane of the list and the candidate; nothing where
/// the plane is gone or, by R1, of the other label. `measured`: state.measured(candidate).
std::optional<Pair> compare(const SegmentState& state,
                            std::int32_t k,
                            const Candidate& candidate,
                            const MeasuredPlane& measured);

/// The plane that the candidate joins, -1 if it founds one: the first coplanar one of the list or
/// the best, as the options ask.
std::int32_t choose_partner(const SegmentState& state,
                            const Candidate& candidate,
                            const PairVisitor* visitor = nullptr);

/// What lies near what at one moment: the planes with points in the cells around each point.
/// Not to outlive the state.
struct Neighbourhood {
  explicit Neighbourhood(const SegmentState& state)
      : grid(state.neighbour_cells()),
        planes(planes_near_cells(grid, state.plane_of, state.planes.size())),
        plane_count(static_cast<std::int32_t>(state.planes.size())) {}
  std::span<const std::int32_t> near(std::uint32_t i) const { return planes.near(grid.cell_of[i]); }

  const CellGrid& grid;  // the state's
  CellPlanes planes;
  std::int32_t plane_count = 0;
};

/// R3: the plane that a weak candidate joins, -1 if none. `strong`: when the strong ones had been
/// merged; of these, planes near the candidate are asked, whatever their angle, and all that weak
/// candidates have founded since.
std::int32_t choose_partner_of_weak(const SegmentState& state,
                                    const Candidate& candidate,
                                    const Neighbourhood& strong,
                                    const PairVisitor* visitor = nullptr);

/// R7: the plane among `larger` that `plane` merges into, -1 if none.
std::int32_t choose_partner_of_plane(const SegmentState& state,
                                     std::int32_t plane,
                                     std::span<const std::int32_t> larger,
                                     const PairVisitor* visitor = nullptr);

/// By the rule.
Reach reach_of(const SegmentState& state, std::uint32_t i, LeftoverRule rule);

/// A point compared with a plane.
struct PointTerms {
  std::int32_t plane = -1;
  double distance_m = 0;
  double limit_m = 0;
  double penalty_m = 0;
  bool passes() const { return distance_m <= limit_m; }
};
using PointVisitor = std::function<void(const PointTerms&)>;
PointTerms point_terms(const SegmentState& state,
                       std::int32_t plane,
                       std::uint32_t i,
                       const Reach& reach);

/// `plane` -1: none. `distance_m` is that from the plane or, by the rule `first`, from the nearest
/// that was asked; -1 without one.
struct PlaneChoice {
  std::int32_t plane = -1;
  double distance_m = -1;
};
/// As written: the first of the list within the distance.
PlaneChoice choose_first_plane(const SegmentState& state,
                               std::uint32_t i,
                               const PointVisitor* visitor = nullptr);
/// Of the planes `near`, the nearest within tau, where one of the other label must be nearer.
PlaneChoice choose_nearest_plane(const SegmentState& state,
                                 std::span<const std::int32_t> near,
                                 std::uint32_t i,
                                 const PointVisitor* visitor = nullptr);

/// R2: what speaks for a plane, and whether it stays.
struct Evidence {
  std::size_t points = 0, unexplained = 0;  // its own, and those on no larger plane nearby
  bool unexplained_enough = false;
  bool wide = false;         // wider than the noise alone could make it
  bool dense = false;        // not far thinner than the others
  bool contradicts = false;  // its direction contradicts its label
  bool stays() const { return unexplained_enough && wide && dense && !contradicts; }
};
/// `points`: the plane's. `typical_area`: typical_area_per_point() when the pruning began.
Evidence evidence_for(const SegmentState& state,
                      std::int32_t plane,
                      std::span<const std::uint32_t> points,
                      const Neighbourhood& around,
                      double typical_area);

}  // namespace planescope::planes
