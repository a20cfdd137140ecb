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

/// Merges the smallest plane that has a partner, and again, until none has. A merge changes one
/// plane: those before it that had no partner are only asked about that one.
class SmallestFirst {
 public:
  explicit SmallestFirst(SegmentState& state) : state_(state), order_(state.planes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](auto a, auto b) { return count(a) < count(b); });
  }

  void merge_all() {
    for (std::size_t i = 0; i < order_.size();) {
      const std::int32_t plane = order_[i];
      std::span<const std::int32_t> larger = std::span(order_).subspan(i + 1);
      if (i < asked_) larger = {&grown_, 1};
      std::int32_t into = -1;
      if (state_.planes[plane].alive) into = choose_partner_of_plane(state_, plane, larger);
      if (into < 0) {
        ++i;
        continue;
      }
      if (points_of_.empty()) points_of_ = points_of_planes(state_);
      merge_into(state_, plane, into, points_of_);
      grown_ = into;
      asked_ = std::max(asked_, i);
      move_up(into);
      i = 0;
    }
  }

 private:
  double count(std::int32_t plane) const { return state_.planes[plane].moments.count; }

  /// To its place among the larger ones; of equals it stays the first.
  void move_up(std::int32_t plane) {
    const auto from = std::ranges::find(order_, plane);
    const auto to = std::find_if(from + 1, order_.end(),
                                 [&](std::int32_t k) { return count(k) >= count(plane); });
    std::rotate(from, from + 1, to);
  }

  SegmentState& state_;
  std::vector<std::int32_t> order_;  // planes, ascending by size
  std::size_t asked_ = 0;            // so many of these have no partner but perhaps ...
  std::int32_t grown_ = -1;          // ... this one
  PointsOf points_of_;               // from the first merge on
};

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (options.on) SmallestFirst(state).merge_all();
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
      best.consider_by_distance(state, k, measured);
  return best.plane;
}

}  // namespace planescope::planes
