#include "core/replay/timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>

#include "core/segment/snapshot.hpp"
#include "support/scenes.hpp"

namespace planescope {
namespace {

const Vec3d kSensor(-1.5, 0, 1);
constexpr std::uint64_t kClouds = 12;

struct NamedOptions {
  const char* name;
  SegmentOptions options;
};
void PrintTo(const NamedOptions& named, std::ostream* out) { *out << named.name; }

SegmentOptions split_options() {
  SegmentOptions options = profile_options(Profile::refined);
  options.split_disconnected = SplitRule::on;
  options.split_gap_m = 0.025;  // finer than the clouds are sampled: many parts, many too small
  return options;
}

SegmentOptions without_labels() {
  SegmentOptions options = profile_options(Profile::paper);
  options.use_labels = false;
  return options;
}

SegmentOptions with_spreads() {
  SegmentOptions options = profile_options(Profile::refined);
  options.r8_voxel_spread = true;
  return options;
}

Measurements more_of(const test::LabelledCloud& cloud, const SegmentOptions& options) {
  Measurements more;
  if (options.r8_voxel_spread) more.spreads.assign(cloud.points.size(), {.xx = 2e-5f, .zz = 1e-5f});
  return more;
}

void expect_same_fit(const PlaneFit& a, const PlaneFit& b) {
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.eigenvalues, b.eigenvalues);
}

void expect_same_nodes(const Timeline& timeline, std::int32_t k, const SegmentSnapshot& stopped) {
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(timeline.queued_at().size()); ++n) {
    NodeState expected = NodeState::unborn;
    if (n < static_cast<std::int32_t>(stopped.nodes.size())) {
      const bool visited = n < static_cast<std::int32_t>(stopped.visited);
      expected = stopped.nodes[n].decided != Case::none ? NodeState::settled
                 : visited                              ? NodeState::visited
                                                        : NodeState::queued;
    }
    ASSERT_EQ(timeline.node_state(n, k), expected) << "node " << n;
  }
}

void expect_same_points(const Timeline& timeline, std::int32_t k, const SegmentSnapshot& stopped) {
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(stopped.plane_of.size()); ++p) {
    const PointChange now = timeline.point_at(p, k);
    ASSERT_EQ(now.plane, stopped.plane_of[p]) << "point " << p;
    ASSERT_EQ(now.leftover, stopped.leftover[p] != 0) << "point " << p;
    const std::int32_t node = timeline.node_of_point(p, k);
    ASSERT_LT(node, static_cast<std::int32_t>(stopped.nodes.size()));
    ASSERT_LT(stopped.nodes[node].first_child, 0) << "the deepest that is there";
  }
}

void expect_same_planes(const Timeline& timeline, std::int32_t k, const SegmentSnapshot& stopped) {
  for (std::int32_t p = 0; p < timeline.plane_count(); ++p) {
    SCOPED_TRACE(p);
    const PlaneChange* now = timeline.plane_at(p, k);
    ASSERT_EQ(now != nullptr, p < static_cast<std::int32_t>(stopped.planes.size()));
    if (!now) continue;
    EXPECT_EQ(timeline.label_of_plane(p), stopped.planes[p].label);
    EXPECT_EQ(now->alive, stopped.planes[p].alive);
    EXPECT_EQ(now->into, stopped.planes[p].into);
    EXPECT_EQ(now->moments.count, stopped.planes[p].moments.count);
    expect_same_fit(now->fit, stopped.planes[p].fit);
  }
}

class Replay : public testing::TestWithParam<NamedOptions> {};

TEST_P(Replay, TheStateAtAnyStepIsThatOfARunStoppedThere) {
  const SegmentOptions& options = GetParam().options;
  for (std::uint64_t seed = 1; seed <= kClouds; ++seed) {
    const test::LabelledCloud cloud = test::random_cloud(seed);
    const Measurements more = more_of(cloud, options);
    Trace trace;
    const Segmentation segmentation =
        segment(cloud.points, cloud.labels, cloud.cube, kSensor, options, &trace, more);
    const Timeline timeline(trace, segmentation, options);
    ASSERT_EQ(timeline.steps(), static_cast<std::int32_t>(trace.events.size()));

    Random random(seed);
    std::int32_t k = random.integer(0, timeline.steps());
    for (int move = 0; move < 40 && !HasFailure(); ++move) {
      SCOPED_TRACE(testing::Message() << "cloud " << seed << ", step " << k);
      const SegmentSnapshot stopped =
          segment_until(cloud.points, cloud.labels, cloud.cube, kSensor, options, k, more);
      ASSERT_EQ(stopped.events, static_cast<std::size_t>(k));
      expect_same_nodes(timeline, k, stopped);
      expect_same_points(timeline, k, stopped);
      expect_same_planes(timeline, k, stopped);
      // A few steps either way, or a leap; now and then to the ends.
      const int leap = random.integer(0, 5);
      if (leap == 0)
        k = random.integer(0, timeline.steps());
      else if (leap == 1)
        k = random.integer(0, 1) * timeline.steps();
      else
        k = std::clamp(k + random.integer(-3, 3), 0, timeline.steps());
    }
  }
}

TEST_P(Replay, TheLastStepIsTheResult) {
  const SegmentOptions& options = GetParam().options;
  const test::LabelledCloud cloud = test::random_cloud(31);
  Trace trace;
  const Segmentation s = segment(cloud.points, cloud.labels, cloud.cube, kSensor, options, &trace);
  const Timeline timeline(trace, s, options);
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(s.plane_of.size()); ++p) {
    const PointChange last = timeline.point_at(p, timeline.steps());
    EXPECT_EQ(last.plane < 0 ? 0 : timeline.result_of_plane(last.plane), s.plane_of[p]);
    EXPECT_EQ(last.leftover, s.plane_of[p] == 0);
    const std::vector<std::int32_t> path = timeline.path_of_point(p);
    EXPECT_EQ(path.front(), 0);
    EXPECT_EQ(path.back(), timeline.node_of_point(p, timeline.steps()));
  }
}

TEST(ReplayInputs, HoldEveryKindOfEventAndRefinement) {
  std::set<std::pair<EventType, int>> seen;
  for (std::uint64_t seed = 1; seed <= kClouds; ++seed) {
    const test::LabelledCloud cloud = test::random_cloud(seed);
    Trace trace;
    segment(cloud.points, cloud.labels, cloud.cube, kSensor, split_options(), &trace);
    for (const TraceEvent& event : trace.events) seen.emplace(event.type, event.refinement);
  }
  using enum EventType;
  for (const auto& kind : std::set<std::pair<EventType, int>>{{visit, 0},
                                                              {decide, 0},
                                                              {found, 1},
                                                              {merge, 1},
                                                              {wait, 3},
                                                              {found, 3},
                                                              {merge, 3},
                                                              {leave, 3},
                                                              {assign, 0},
                                                              {drop, 0},
                                                              {refine, 2},
                                                              {refine, 5},
                                                              {refine, 6},
                                                              {refine, 7},
                                                              {found, kSplit},
                                                              {refine, kSplit},
                                                              {leave, kSplit}})
    EXPECT_TRUE(seen.contains(kind)) << static_cast<int>(kind.first) << ", R" << kind.second;
}

INSTANTIATE_TEST_SUITE_P(Profiles,
                         Replay,
                         testing::Values(NamedOptions{"paper", profile_options(Profile::paper)},
                                         NamedOptions{"paper_closest",
                                                      profile_options(Profile::paper_closest)},
                                         NamedOptions{"refined", profile_options(Profile::refined)},
                                         NamedOptions{"refined_split", split_options()},
                                         NamedOptions{"refined_spreads", with_spreads()},
                                         NamedOptions{"paper_without_labels", without_labels()}),
                         [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace planescope
