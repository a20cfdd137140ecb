#include "core/planes/segment/refine/r7_second_merge.hpp"

#include <algorithm>
#include <numeric>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes {
namespace r7_second_merge {
namespace {

using PointsOf = std::vector<std::vector<std::uint32_t>>;  // per plane, Morton positions

void merge_into(SegmentState& state, std::int32_t plane, std::int32_t into, PointsOf& points_of) {
  log_refine(state, state.options.r7_second_merge, plane, into);
  std::vector<std::uint32_t>& moved = points_of[plane];
  join_planes(state, plane, into, moved);
  points_of[into].insert(points_of[into].end(), moved.begin(), moved.end());
  moved.clear();
}

PointsOf points_of_planes(const SegmentState& state) {
  PointsOf points_of(state.planes.size());
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (state.plane_of[i] >= 0) points_of[state.plane_of[i]].push_back(i);
  return points_of;
}

/// Merges the smallest plane that has a partner; false: none has.
bool merge_one(SegmentState& state,
               std::span<const std::int32_t> smallest_first,
               PointsOf& points_of) {
  for (std::size_t i = 0; i < smallest_first.size(); ++i) {
    const std::int32_t plane = smallest_first[i];
    if (!state.planes[plane].alive) continue;
    const std::int32_t partner =
        choose_partner_of_plane(state, plane, smallest_first.subspan(i + 1));
    if (partner < 0) continue;
    if (points_of.empty()) points_of = points_of_planes(state);
    merge_into(state, plane, partner, points_of);
    return true;
  }
  return false;
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on) return;
  std::vector<std::int32_t> smallest_first(state.planes.size());
  std::iota(smallest_first.begin(), smallest_first.end(), 0);
  PointsOf points_of;  // from the first merge on
  do {
    std::stable_sort(smallest_first.begin(), smallest_first.end(), [&](auto a, auto b) {
      return state.planes[a].moments.count < state.planes[b].moments.count;
    });
  } while (merge_one(state, smallest_first, points_of));
}

}  // namespace r7_second_merge

std::int32_t choose_partner_of_plane(const SegmentState& state,
                                     std::int32_t plane,
                                     std::span<const std::int32_t> larger,
                                     const PairVisitor* visitor) {
  const GrowingPlane& small = state.planes[plane];
  const MeasuredPlane measured = state.measured(small);
  CheapestPair best{visitor};
  for (const std::int32_t k : larger)
    if (state.planes[k].alive && state.planes[k].label == small.label)
      best.consider(pair_by_distance(state, k, measured));
  return best.plane;
}

}  // namespace planescope::planes
