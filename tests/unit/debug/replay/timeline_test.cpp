// Tests of replay: the state at each step follows from the events.

#include "core/debug/replay/timeline.hpp"

#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <set>

#include "core/planes/segment/criteria.hpp"
#include "support/scenes.hpp"

namespace planescope::debug {
namespace {

const Vec3d kSensor(-1.5, 0, 1);
constexpr std::uint64_t kClouds = 12;

struct NamedOptions {
  const char* name;
  planes::SegmentOptions options;
};
void PrintTo(const NamedOptions& named, std::ostream* out) { *out << named.name; }

planes::SegmentOptions without_labels() {
  planes::SegmentOptions options = planes::profile_options(planes::Profile::paper);
  options.use_labels = false;
  return options;
}

struct Traced {
  planes::Trace trace;
  planes::Segmentation segmentation;
  Timeline timeline;
};

Traced traced(const test::LabeledCloud& cloud, const planes::SegmentOptions& options) {
  Traced result;
  result.segmentation =
      planes::segment(cloud.points, cloud.labels, cloud.cube, kSensor, options, &result.trace);
  result.timeline = Timeline(result.trace, result.segmentation);
  return result;
}

/// Changes by one event: the new planes of points, and changed planes.
struct Changes {
  std::map<std::int32_t, std::int32_t> plane_of;  // by point; -1: unassigned
  std::set<std::int32_t> planes;
};

/// Changes of each step; empty for step 0.
std::vector<Changes> changes_by_step(const Traced& run, std::size_t points) {
  std::vector<Changes> changes(static_cast<std::size_t>(run.timeline.steps()) + 1);
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(points); ++p)
    for (const planes::PointChange& change : run.timeline.changes_of_point(p)) {
      EXPECT_EQ(change.leftover, change.plane < 0);
      EXPECT_TRUE(changes[change.step].plane_of.emplace(p, change.plane).second);
    }
  for (std::int32_t k = 0; k < run.timeline.plane_count(); ++k)
    for (const planes::PlaneChange& change : run.timeline.changes_of_plane(k))
      changes[change.step].planes.insert(k);
  return changes;
}

/// Expected changes by an event of the paper's method, derived from the octree, the labels and the
/// previous planes of the points.
class Expected {
 public:
  Expected(const Traced& run, const planes::SegmentOptions& options)
      : run_(run), octree_(run.segmentation.octree), options_(options) {}

  Changes of(const planes::TraceEvent& event) const {
    using enum planes::EventType;
    switch (event.type) {
      case visit:
      case drop:
        return {};
      case decide:
        return {left_over_by(octree_.nodes[event.node]), {}};
      case found:
      case merge:
        return {candidate_of(event, event.plane), {event.plane}};
      case assign:
        return {{{event.point, event.plane}}, {}};
      case refine:
        break;
    }
    return {};
  }

  /// Points of a plane at a step, with their new plane.
  std::map<std::int32_t, std::int32_t> points_of(std::int32_t plane,
                                                 std::int32_t step,
                                                 std::int32_t to) const {
    std::map<std::int32_t, std::int32_t> points;
    for (const std::uint32_t p : octree_.order)
      if (run_.timeline.point_at(static_cast<std::int32_t>(p), step).plane == plane)
        points[static_cast<std::int32_t>(p)] = to;
    return points;
  }

 private:
  template <typename Wanted>
  std::map<std::int32_t, std::int32_t> in_node(const planes::OctreeNode& node,
                                               std::int32_t to,
                                               Wanted wanted) const {
    std::map<std::int32_t, std::int32_t> points;
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (wanted(octree_.labels[i])) points[static_cast<std::int32_t>(octree_.order[i])] = to;
    return points;
  }

  std::map<std::int32_t, std::int32_t> candidate_of(const planes::TraceEvent& event,
                                                    std::int32_t to) const {
    return in_node(octree_.nodes[event.node], to,
                   [&](Label label) { return !options_.use_labels || label == event.label; });
  }

  std::map<std::int32_t, std::int32_t> left_over_by(const planes::OctreeNode& node) const {
    const planes::Purity purity = planes::purity_of(node, options_.use_labels);
    const bool all = node.decided == planes::Case::II || node.at_max_depth;
    const bool outliers = node.decided == planes::Case::IV;
    return in_node(node, -1, [&](Label label) {
      return all || (outliers && options_.use_labels && label != purity.inlier);
    });
  }

  const Traced& run_;
  const planes::Octree& octree_;
  const planes::SegmentOptions& options_;
};

class Replay : public testing::TestWithParam<NamedOptions> {};
/// These profiles fit a plane whenever its points change; `refined` does so after many points have
/// moved.
class ReplayOfThePaper : public Replay {};

TEST_P(ReplayOfThePaper, EachEventMakesExactlyItsOwnChanges) {
  const planes::SegmentOptions& options = GetParam().options;
  for (std::uint64_t seed = 1; seed <= kClouds && !HasFailure(); ++seed) {
    const test::LabeledCloud cloud = test::random_cloud(seed);
    const Traced run = traced(cloud, options);
    ASSERT_EQ(run.timeline.steps(), static_cast<std::int32_t>(run.trace.events.size()));
    const Expected expected(run, options);
    const std::vector<Changes> changes = changes_by_step(run, cloud.points.size());
    for (std::int32_t step = 1; step <= run.timeline.steps(); ++step) {
      const planes::TraceEvent& event = run.trace.events[static_cast<std::size_t>(step) - 1];
      const Changes should = expected.of(event);
      ASSERT_EQ(changes[step].plane_of, should.plane_of) << "cloud " << seed << ", step " << step;
      ASSERT_EQ(changes[step].planes, should.planes) << "cloud " << seed << ", step " << step;
    }
  }
}

TEST_P(Replay, NodesAreQueuedVisitedAndSettledByTheirEvents) {
  const Traced run = traced(test::random_cloud(5), GetParam().options);
  const std::vector<planes::OctreeNode>& nodes = run.segmentation.octree.nodes;
  for (std::int32_t step = 1; step <= run.timeline.steps(); ++step) {
    const planes::TraceEvent& event = run.trace.events[static_cast<std::size_t>(step) - 1];
    if (event.type == planes::EventType::visit) {
      EXPECT_EQ(run.timeline.visited_at()[event.node], step);
    } else if (event.type == planes::EventType::decide) {
      EXPECT_EQ(run.timeline.decided_at()[event.node], step);
    }
  }
  EXPECT_EQ(run.timeline.queued_at()[0], 0);
  for (std::size_t n = 1; n < nodes.size(); ++n) {
    const std::int32_t queued = run.timeline.decided_at()[nodes[n].parent];
    const auto node = static_cast<std::int32_t>(n);
    EXPECT_EQ(run.timeline.queued_at()[n], queued);
    EXPECT_EQ(run.timeline.node_state(node, queued - 1), NodeState::unborn);
    EXPECT_EQ(run.timeline.node_state(node, queued), NodeState::queued);
    EXPECT_EQ(run.timeline.node_state(node, run.timeline.visited_at()[n]), NodeState::visited);
    EXPECT_EQ(run.timeline.node_state(node, run.timeline.decided_at()[n]), NodeState::settled);
  }
}

TEST_P(ReplayOfThePaper, PlanesAreFittedToTheirPointsUntilLeftoversJoin) {
  const planes::SegmentOptions& options = GetParam().options;
  for (std::uint64_t seed = 1; seed <= kClouds; ++seed) {
    const test::LabeledCloud cloud = test::random_cloud(seed);
    const Traced run = traced(cloud, options);
    const Expected at(run, options);
    for (std::int32_t k = 0; k < run.timeline.plane_count(); ++k)
      for (const planes::PlaneChange& change : run.timeline.changes_of_plane(k)) {
        if (!change.alive) continue;
        const auto points = at.points_of(k, change.step, k);
        EXPECT_EQ(change.moments.count, static_cast<double>(points.size()));
        EXPECT_EQ(change.fit.count, change.moments.count);
        Vec3d sum = Vec3d::Zero();
        for (const auto& [p, plane] : points) sum += cloud.points[p].cast<double>();
        EXPECT_LT((change.fit.centroid - sum / change.fit.count).norm(), 1e-9);
      }
  }
}

TEST_P(Replay, TheLastStepIsTheResult) {
  const planes::SegmentOptions& options = GetParam().options;
  const test::LabeledCloud cloud = test::random_cloud(31);
  const Traced run = traced(cloud, options);
  const planes::Segmentation& s = run.segmentation;
  const Timeline& timeline = run.timeline;
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(s.plane_of.size()); ++p) {
    const planes::PointChange last = timeline.point_at(p, timeline.steps());
    EXPECT_EQ(last.plane < 0 ? 0 : timeline.result_of_plane(last.plane), s.plane_of[p]);
    EXPECT_EQ(last.leftover, s.plane_of[p] == 0);
    const std::vector<std::int32_t> path = timeline.path_of_point(p);
    EXPECT_EQ(path.front(), 0);
    EXPECT_EQ(path.back(), timeline.node_of_point(p, timeline.steps()));
  }
}

TEST(ReplayInputs, ContainEveryKindOfEventAndStage) {
  std::set<std::pair<planes::EventType, planes::Stage>> seen;
  for (std::uint64_t seed = 1; seed <= kClouds; ++seed)
    for (const planes::SegmentOptions& options :
         {without_labels(), planes::profile_options(planes::Profile::refined)})
      for (const planes::TraceEvent& event : traced(test::random_cloud(seed), options).trace.events)
        seen.emplace(event.type, event.stage);
  using enum planes::EventType;
  for (const auto& [type, stage] :
       std::set<std::pair<planes::EventType, planes::Stage>>{{visit, planes::Stage::criteria},
                                                             {decide, planes::Stage::criteria},
                                                             {found, planes::Stage::merge},
                                                             {merge, planes::Stage::merge},
                                                             {assign, planes::Stage::assign},
                                                             {drop, planes::Stage::assign},
                                                             {found, planes::Stage::criteria},
                                                             {refine, planes::Stage::join},
                                                             {assign, planes::Stage::grow},
                                                             {drop, planes::Stage::grow},
                                                             {refine, planes::Stage::list}})
    EXPECT_TRUE(seen.contains({type, stage}))
        << static_cast<int>(type) << ", " << planes::to_string(stage);
}

const auto of_the_paper = testing::Values(
    NamedOptions{"paper", planes::profile_options(planes::Profile::paper)},
    NamedOptions{"paper_closest", planes::profile_options(planes::Profile::paper_closest)},
    NamedOptions{"paper_without_labels", without_labels()});
const auto name_of = [](const auto& named) { return named.param.name; };

INSTANTIATE_TEST_SUITE_P(Paper, ReplayOfThePaper, of_the_paper, name_of);
INSTANTIATE_TEST_SUITE_P(Paper, Replay, of_the_paper, name_of);
INSTANTIATE_TEST_SUITE_P(Refined,
                         Replay,
                         testing::Values(NamedOptions{
                             "refined", planes::profile_options(planes::Profile::refined)}),
                         name_of);

}  // namespace
}  // namespace planescope::debug
