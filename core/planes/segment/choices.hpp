#pragma once

// How the paper's method chooses among planes. The stages pass no visitor. To explain a choice, it
// is made again with a visitor, which sees each pair in the order in which pairs were compared.

#include <cstdint>
#include <functional>
#include <span>

#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes {

/// A candidate compared with a plane (Criterion 4).
struct Pair {
  std::int32_t plane = -1;
  Coplanarity terms;
  bool coplanar = false;
};
using PairVisitor = std::function<void(const Pair&)>;
/// The one that comes nearest to passing, of equals the first; null without any.
const Pair* nearest_pair(std::span<const Pair> pairs, const SegmentOptions& options);

/// The plane that the candidate joins, -1 if it founds one: the first coplanar one of the list or
/// the one with the least offset, as the options ask.
std::int32_t choose_partner(const SegmentState& state,
                            const Candidate& candidate,
                            const PairVisitor* visitor = nullptr);

/// A point compared with a plane.
struct PointTerms {
  std::int32_t plane = -1;
  double distance_m = 0;
  double limit_m = 0;
  bool passes() const { return distance_m <= limit_m; }
};
using PointVisitor = std::function<void(const PointTerms&)>;

/// `plane` -1: none. `distance_m` is that from the plane or, without one, from the nearest; -1
/// where there is none.
struct PlaneChoice {
  std::int32_t plane = -1;
  double distance_m = -1;
};
/// The first plane of the list within leftover_distance_m of the point.
PlaneChoice choose_plane(const SegmentState& state,
                         std::uint32_t i,
                         const PointVisitor* visitor = nullptr);

}  // namespace planescope::planes
