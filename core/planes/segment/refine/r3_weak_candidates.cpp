#include "core/planes/segment/refine/r3_weak_candidates.hpp"

#include <numbers>
#include <set>

#include "core/planes/segment/choices.hpp"

namespace planescope::planes {
namespace r3_weak_candidates {
namespace {

constexpr Stage kStage = Stage::r3_weak_candidates;
constexpr double kRadians = std::numbers::pi / 180;

void leave(SegmentState& state, const Candidate& candidate) {
  log(state, {.type = EventType::leave,
              .stage = kStage,
              .label = candidate.label,
              .node = candidate.node,
              .value = static_cast<float>(candidate.sigma_ang)});
  const OctreeNode& node = state.octree.nodes[candidate.node];
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    if (state.has_label(i, candidate.label)) leave_point(state, i);
}

}  // namespace

bool is_weak(double sigma_ang, const Options& options) {
  return options.on && sigma_ang > options.sure_sigma_ang_deg * kRadians;
}

bool can_found(const PlaneFit& fit, double sigma_ang, const Options& options) {
  return fit.count >= options.found_points && sigma_ang <= options.found_sigma_ang_deg * kRadians;
}

void run(SegmentState& state, const Options& options) {
  if (state.weak.empty()) return;
  const Neighbourhood strong(state);
  for (const Candidate& candidate : state.weak) {
    const std::int32_t partner = choose_partner_of_weak(state, candidate, strong);
    if (partner >= 0)
      merge(state, candidate, partner, kStage);
    else if (can_found(candidate.fit, candidate.sigma_ang, options))
      found(state, candidate, kStage);
    else
      leave(state, candidate);
  }
}

}  // namespace r3_weak_candidates

std::int32_t choose_partner_of_weak(const SegmentState& state,
                                    const Candidate& candidate,
                                    const Neighbourhood& strong,
                                    const PairVisitor* visitor) {
  const MeasuredPlane measured = state.measured(candidate);
  CheapestPair best{visitor};
  const auto consider = [&](std::int32_t k, bool any_angle) {
    if (state.planes[k].label == candidate.label)
      best.consider_by_distance(state, k, measured, any_angle);
  };
  std::set<std::int32_t> near;
  const OctreeNode& node = state.octree.nodes[candidate.node];
  std::optional<std::uint32_t> last_cell;  // points of a cell stand side by side
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    if (!state.has_label(i, candidate.label) || strong.grid.cell_of[i] == last_cell) continue;
    last_cell = strong.grid.cell_of[i];
    near.insert(strong.near(i).begin(), strong.near(i).end());
  }
  for (const std::int32_t k : near) consider(k, true);
  for (auto k = strong.plane_count; k < static_cast<std::int32_t>(state.planes.size()); ++k)
    consider(k, false);
  return best.plane;
}

}  // namespace planescope::planes
