// Rows of the octree, the axis of the timeline, axes of histograms, as pure functions.

#include "app/desktop/debugger/debugger.hpp"

#include <algorithm>
#include <set>

#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct OctreeRows : testing::Test {
  State state = run_state();
  const planescope::debug::Run& run = *state.run();

  std::vector<std::int32_t> nodes_at(std::int32_t step, std::int32_t selected = -1) const {
    std::vector<std::int32_t> nodes;
    for (const OctreeRow& row : octree_rows(run, step, selected, {})) nodes.push_back(row.node);
    return nodes;
  }
};

TEST_F(OctreeRows, ContainQueuedNodesAndNoFutureOnes) {
  for (std::int32_t step = 0; step <= run.steps(); step += 97) {
    const std::vector<std::int32_t> nodes = nodes_at(step);
    const std::set<std::int32_t> shown(nodes.begin(), nodes.end());
    EXPECT_EQ(shown.size(), nodes.size());
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(run.octree().nodes.size()); ++n) {
      const debug::NodeState now = run.timeline.node_state(n, step);
      if (now == debug::NodeState::unborn || now == debug::NodeState::queued) {
        EXPECT_EQ(shown.contains(n), now == debug::NodeState::queued) << n << " at " << step;
      }
    }
  }
}

TEST_F(OctreeRows, FoldSettledNodes) {
  EXPECT_EQ(nodes_at(run.steps()), std::vector<std::int32_t>{0});
  const auto opened = octree_rows(run, run.steps(), -1, {{0, true}});
  EXPECT_EQ(opened.size(), 1u + run.octree().nodes[0].child_count);
  EXPECT_EQ(octree_rows(run, 40, -1, {{0, false}}).size(), 1u);
}

TEST_F(OctreeRows, UnfoldTheSelectedNode) {
  const auto last = static_cast<std::int32_t>(run.octree().nodes.size()) - 1;
  const auto nodes = nodes_at(run.steps(), last);
  for (std::int32_t n = last; n >= 0; n = run.octree().nodes[static_cast<std::size_t>(n)].parent)
    EXPECT_EQ(std::count(nodes.begin(), nodes.end(), n), 1) << n;
}

TEST_F(OctreeRows, FindNodesByNumberAndByEvent) {
  debug::FilterProblem problem;
  ASSERT_EQ(octree_matches(run, run.steps(), "41", problem).size(), 1u);
  EXPECT_TRUE(octree_matches(run, 0, "41", problem).empty()) << "not born yet";
  EXPECT_TRUE(octree_matches(run, run.steps(), "99999999999", problem).empty());
  const auto all = octree_matches(run, run.steps(), "case==IV", problem);
  EXPECT_EQ(all.size(), run.segmentation.counts.nodes_per_case[4]);
  const auto some = octree_matches(run, run.steps() / 20, "case==IV", problem);
  EXPECT_LT(some.size(), all.size());
  octree_matches(run, 0, "case==", problem);
  EXPECT_FALSE(problem.message.empty());
}

TEST_F(OctreeRows, CountDescendants) {
  for (const std::int32_t step : {1, 200, run.steps()})
    for (std::int32_t top = 0; top < 60; ++top) {
      SubtreeCounts expected = {};
      for (std::int32_t n = top + 1; n < static_cast<std::int32_t>(run.octree().nodes.size());
           ++n) {
        if (run.timeline.node_state(n, step) == debug::NodeState::unborn) continue;
        std::int32_t above = n;
        while (above > top) above = run.octree().nodes[static_cast<std::size_t>(above)].parent;
        const bool settled = run.timeline.node_state(n, step) == debug::NodeState::settled;
        const planes::Case decided = run.octree().nodes[static_cast<std::size_t>(n)].decided;
        if (above == top) ++expected[settled ? static_cast<std::size_t>(decided) : 0];
      }
      EXPECT_EQ(count_subtree(run, step, top), expected) << top << " at " << step;
    }
}

TEST(TimelineColumns, ContainEveryEventOnce) {
  const State state = run_state();
  const planescope::debug::Run& run = *state.run();
  const debug::StepRange all{0, run.steps()};
  for (const int count : {1, 7, 500, 20'000}) {
    const std::vector<TimelineColumn> columns = timeline_columns(run, all, count);
    ASSERT_EQ(static_cast<int>(columns.size()), count);
    std::size_t events = 0, decided = 0;
    for (const TimelineColumn& column : columns) {
      events += column.events;
      decided += column.decided();
    }
    EXPECT_EQ(events, run.trace.events.size());
    EXPECT_EQ(decided, run.octree().nodes.size());
    for (std::int32_t step = 0; step <= run.steps(); step += 50) {
      const StepAxis axis{all, 0, static_cast<float>(count)};
      if (count > run.steps()) {
        EXPECT_EQ(axis.at(axis.middle(step)), step);
      }
      EXPECT_LE(std::abs(axis.middle(step) - static_cast<float>(column_of_step(step, all, count))),
                1.01f);
    }
  }
  const std::vector<TimelineColumn> some = timeline_columns(run, {11, 20}, 10);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(some[i].events, 1u);
    const planes::TraceEvent& event = *run.event_at(11 + static_cast<std::int32_t>(i));
    EXPECT_EQ(some[i].decided(), event.type == planes::EventType::decide ? 1u : 0u);
  }
}

TEST(StepAxis, ZoomsAboutAStepAndStaysWithinTheTrace) {
  const debug::StepRange all{0, 1000};
  const debug::StepRange near = zoomed(all, 250, 0.5, 1000);
  EXPECT_NEAR(near.count(), 500, 1);
  EXPECT_NEAR((250.5 - near.first) / near.count(), 250.5 / 1001, 0.002) << "stays under the mouse";
  EXPECT_EQ(zoomed(near, 250, 100, 1000), all);
  const debug::StepRange nearest = zoomed(near, 250, 1e-9, 1000);
  EXPECT_TRUE(nearest.contains(250));
  EXPECT_GE(nearest.count(), 10);
  EXPECT_EQ(zoomed({3, 12}, 5, 1.01, 1000).count(), 11) << "even by a notch";
  EXPECT_EQ(zoomed({0, 4}, 2, 0.5, 4), (debug::StepRange{0, 4})) << "a short trace is all shown";
  EXPECT_EQ(moved({100, 199}, -500, 1000), (debug::StepRange{0, 99}));
  EXPECT_EQ(moved({100, 199}, 5000, 1000), (debug::StepRange{901, 1000}));
}

TEST(StepAxis, ScrollsToTheCursorOnlyIfItIsOutside) {
  const debug::StepRange shown{100, 199};
  EXPECT_EQ(scrolled_to(shown, 199, 1000), shown);
  for (const std::int32_t step : {200, 99, 700, 0, 1000}) {
    const debug::StepRange now = scrolled_to(shown, step, 1000);
    EXPECT_TRUE(now.contains(step)) << step;
    EXPECT_EQ(now.count(), shown.count()) << step;
  }
  EXPECT_GE(scrolled_to(shown, 200, 1000).last, 205) << "what comes next is in sight, too";
}

TEST(HistogramAxis, SharesAndValuesAreInverse) {
  debug::Histogram histogram;
  histogram.quantity = "mse";
  histogram.logarithmic = true;
  histogram.bins = {{0.001, 0.01}, {0.01, 0.1}, {0.1, 7}};
  const HistogramAxis axis(histogram);
  for (double share = 0; share < 1; share += 0.05)
    EXPECT_NEAR(axis.share(axis.value(share)), share, 1e-9);
  EXPECT_EQ(axis.share(0), 0);
  EXPECT_EQ(axis.share(100), 1);
  EXPECT_EQ(filter_between(histogram, 2.0 / 3, 1.0 / 3), "mse>=0.01 && mse<0.1");
}

TEST(HistogramAxis, TicksAreRoundAndCoverTheAxis) {
  debug::Histogram linear;
  for (int i = 0; i < 20; ++i) linear.bins.push_back({0.17 * i, 0.17 * (i + 1)});
  const std::vector<double> ticks = axis_ticks(linear);
  EXPECT_GE(ticks.size(), 3u);
  EXPECT_LE(ticks.size(), 6u);
  EXPECT_TRUE(std::ranges::is_sorted(ticks));
  for (const double tick : ticks) {
    EXPECT_NEAR(tick, std::round(tick), 1e-9);  // 1, 2, 3: not 0.85
    EXPECT_GE(tick, linear.bins.front().low);
    EXPECT_LE(tick, linear.bins.back().high);
  }
  debug::Histogram decades;
  decades.logarithmic = true;
  decades.bins = {{0, 0.001}, {0.001, 0.01}, {0.01, 0.1}, {0.1, 7}};
  EXPECT_EQ(axis_ticks(decades), (std::vector<double>{0, 0.0001, 0.001, 0.01, 0.1}));
  debug::Histogram narrow;  // without a round value, its ends are labeled
  narrow.bins = {{3.1, 3.2}};
  EXPECT_EQ(axis_ticks(narrow), (std::vector<double>{3.1, 3.2}));
  EXPECT_TRUE(axis_ticks({}).empty());
}

}  // namespace
}  // namespace planescope::desktop
