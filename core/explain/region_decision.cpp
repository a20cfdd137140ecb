#include "core/explain/region_decision.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include "core/explain/correspondence.hpp"
#include "core/explain/point_facts.hpp"

namespace planescope {
namespace {

/// Decisions by how many points they are about. A plane is seldom lost in one step: of the kind of
/// decision that is about the most points, the one that is about the most.
class Ballot {
 public:
  explicit Ballot(const Run& run) : run_(run) {}
  void vote(std::int32_t step, std::uint32_t voxel) {
    if (step <= 0) return;
    const TraceEvent& event = *run_.event_at(step);
    Kind& kind =
        kinds_[{static_cast<int>(event.type), event.node_case, static_cast<int>(event.stage)}];
    ++kind.points;
    Step& votes = kind.steps[step];
    if (votes.points++ == 0) votes.voxel = static_cast<std::int32_t>(voxel);
  }
  /// The earliest of those with the most points.
  RegionDecision winner() const {
    RegionDecision best;
    for (const auto& [name, kind] : kinds_) {
      if (kind.points <= best.points) continue;
      best = {0, -1, kind.points, kind.steps.size()};
      std::size_t most = 0;
      for (const auto& [step, votes] : kind.steps)
        if (votes.points > most) {
          most = votes.points;
          best.step = step;
          best.voxel = votes.voxel;
        }
    }
    return best;
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

std::int32_t founding_of(const Run& run, std::int32_t plane) {
  return run.timeline.changes_of_plane(plane).front().step;
}

/// Whether two runs decide alike: planes are the same where they were founded alike.
class Likeness {
 public:
  Likeness(const Run& a, const Run& b) : a_(a), b_(b), same_(a, b), back_(b, a) {}

  std::int32_t voxel_in_a(std::uint32_t voxel_of_b) const {
    return back_.voxel(static_cast<std::int32_t>(voxel_of_b));
  }
  bool alike(std::int32_t step_a, std::int32_t step_b) const {
    const TraceEvent& a = *a_.event_at(step_a);
    const TraceEvent& b = *b_.event_at(step_b);
    if (a.node < 0 && a.point < 0) return alike_by_planes(a, b);
    if (!same_.same_event(a, b) || (a.plane < 0) != (b.plane < 0)) return false;
    return a.plane < 0 || same_plane(a.plane, b.plane);
  }

 private:
  bool alike_by_planes(const TraceEvent& a, const TraceEvent& b) const {
    return a.type == b.type && a.stage == b.stage && b.node < 0 && b.point < 0 &&
           (a.plane < 0) == (b.plane < 0) && (a.plane < 0 || same_plane(a.plane, b.plane));
  }
  bool same_plane(std::int32_t plane_a, std::int32_t plane_b) const {
    const TraceEvent& a = *a_.event_at(founding_of(a_, plane_a));
    const TraceEvent& b = *b_.event_at(founding_of(b_, plane_b));
    // Of a part that split off, its number must do: nothing else tells the parts apart.
    return same_.same_event(a, b) && (a.node >= 0 || plane_a == plane_b);
  }

  const Run& a_;
  const Run& b_;
  Correspondence same_, back_;
};

/// The first step of b that the voxel's life in a does not have in its place; 0 where there is
/// none.
std::int32_t parting(const Run& a, const Run& b, const Likeness& likeness, std::uint32_t voxel) {
  const std::int32_t in_a = likeness.voxel_in_a(voxel);
  if (in_a < 0) return 0;
  const auto life_a = steps_of_point(a, in_a);
  const auto life_b = steps_of_point(b, static_cast<std::int32_t>(voxel));
  auto at_a = life_a.begin();
  for (const std::int32_t step : life_b) {
    if (at_a == life_a.end() || !likeness.alike(*at_a, step)) return step;
    ++at_a;
  }
  return 0;
}

}  // namespace

RegionDecision first_difference(const Run& run,
                                const Run& a,
                                std::span<const std::uint32_t> voxels) {
  if (!run.is_ours() || !a.is_ours()) return {};
  const Likeness likeness(a, run);
  Ballot ballot(run);
  for (const std::uint32_t voxel : voxels) ballot.vote(parting(a, run, likeness, voxel), voxel);
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
      if (step == 0 || run.event_at(step)->type == EventType::found) continue;
      (run.event_at(step)->point < 0 ? merges : single).vote(step, voxel);
    }
  const RegionDecision merge = merges.winner();
  return merge.step > 0 ? merge : single.winner();
}

std::int32_t plane_of_region(const Run& run, std::span<const std::uint32_t> voxels) {
  std::vector<std::size_t> counts(run.segmentation.planes.size() + 1, 0);
  for (const std::uint32_t voxel : voxels) ++counts[run.segmentation.plane_of[voxel]];
  const auto most = std::max_element(counts.begin() + 1, counts.end());
  return most != counts.end() && 2 * *most > voxels.size()
             ? static_cast<std::int32_t>(most - counts.begin())
             : 0;
}

}  // namespace planescope
