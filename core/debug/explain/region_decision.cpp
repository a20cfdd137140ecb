#include "core/debug/explain/region_decision.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/debug/explain/score.hpp"

namespace planescope::debug {
namespace {

/// Decisions by how many points they are about. A plane is seldom lost in one step: of the kind of
/// decision that is about the most points, the one that is about the most.
class Ballot {
 public:
  explicit Ballot(const Run& run) : run_(run) {}
  void vote(std::int32_t step, std::uint32_t voxel) {
    if (step <= 0) return;
    const planes::TraceEvent& event = *run_.event_at(step);
    Kind& kind =
        kinds_[{static_cast<int>(event.type), event.node_case, static_cast<int>(event.stage)}];
    ++kind.points;
    Step& votes = kind.steps[step];
    if (votes.points++ == 0) votes.voxel = static_cast<std::int32_t>(voxel);
  }
  /// The earliest of those with the most points.
  RegionDecision winner() const {
    if (kinds_.empty()) return {};
    const auto points = [](const auto& entry) { return entry.second.points; };
    const Kind& kind = std::ranges::max_element(kinds_, {}, points)->second;
    const auto& [step, votes] = *std::ranges::max_element(kind.steps, {}, points);
    return {step, votes.voxel, kind.points, kind.steps.size()};
  }

 private:
  struct Step {
    std::size_t points = 0;
    std::int32_t voxel = -1;
  };
  struct Kind {
    std::size_t points = 0;
    std::map<std::int32_t, Step> steps;
  };
  const Run& run_;
  std::map<std::tuple<int, int, int>, Kind> kinds_;  // by type, case and stage
};

const planes::TraceEvent& founding_of(const Run& run, std::int32_t plane) {
  return *run.event_at(run.timeline.changes_of_plane(plane).front().step);
}

/// Where two runs decide otherwise: planes are the same where they were founded alike.
class Parting {
 public:
  Parting(const Run& a, const Run& b) : a_(a), b_(b), to_b_(a, b), to_a_(b, a) {}

  /// The first step of b that the voxel's life in a does not have in its place; 0 where there is
  /// none.
  std::int32_t step_of(std::uint32_t voxel_of_b) const {
    const auto in_b = static_cast<std::int32_t>(voxel_of_b), in_a = to_a_.voxel(in_b);
    if (in_a < 0) return 0;
    const std::set<std::int32_t> life_a = steps_of_point(a_, in_a),
                                 life_b = steps_of_point(b_, in_b);
    const auto alike = [this](std::int32_t step_a, std::int32_t step_b) {
      return are_alike(*a_.event_at(step_a), *b_.event_at(step_b));
    };
    const auto at_b = std::ranges::mismatch(life_a, life_b, alike).in2;
    return at_b == life_b.end() ? 0 : *at_b;
  }

 private:
  bool are_alike(const planes::TraceEvent& a, const planes::TraceEvent& b) const {
    const bool of_planes = a.node < 0 && a.point < 0;
    const bool same = of_planes
                          ? a.type == b.type && a.stage == b.stage && b.node < 0 && b.point < 0
                          : to_b_.same_event(a, b);
    return same && (a.plane < 0) == (b.plane < 0) && (a.plane < 0 || same_plane(a.plane, b.plane));
  }
  bool same_plane(std::int32_t plane_a, std::int32_t plane_b) const {
    const planes::TraceEvent& a = founding_of(a_, plane_a);
    // Of a part that split off, its number must do: nothing else tells the parts apart.
    return to_b_.same_event(a, founding_of(b_, plane_b)) && (a.node >= 0 || plane_a == plane_b);
  }

  const Run& a_;
  const Run& b_;
  Correspondence to_b_, to_a_;
};

}  // namespace

RegionDecision first_difference(const Run& run,
                                const Run& a,
                                std::span<const std::uint32_t> voxels) {
  if (!run.is_ours() || !a.is_ours()) return {};
  const Parting parting(a, run);
  Ballot ballot(run);
  for (const std::uint32_t voxel : voxels) ballot.vote(parting.step_of(voxel), voxel);
  return ballot.winner();
}

RegionDecision loss_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  Ballot ballot(run);
  if (run.is_ours())
    for (const std::uint32_t voxel : voxels)
      if (run.segmentation.plane_of[voxel] == 0)
        ballot.vote(loss_of(run, static_cast<std::int32_t>(voxel)).left, voxel);
  return ballot.winner();
}

RegionDecision joining_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  Ballot merges(run), single(run);
  if (run.is_ours())
    for (const std::uint32_t voxel : voxels) {
      const std::int32_t step = step_of_plane(run, static_cast<std::int32_t>(voxel));
      if (step == 0 || run.event_at(step)->type == planes::EventType::found) continue;
      (run.event_at(step)->point < 0 ? merges : single).vote(step, voxel);
    }
  const RegionDecision merge = merges.winner();
  return merge.step > 0 ? merge : single.winner();
}

std::int32_t plane_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  std::vector<std::int32_t> planes;
  for (const std::uint32_t voxel : voxels) planes.push_back(run.segmentation.plane_of[voxel]);
  const std::int32_t most = most_common_plane(planes);
  return 2 * std::ranges::count(planes, most) > std::ssize(planes) ? most : 0;
}

}  // namespace planescope::debug
