// Tests of the comparison of two runs, and of traces as text.

#include "core/debug/explain/compare.hpp"

#include <gtest/gtest.h>

#include "core/debug/explain/trace_text.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

std::shared_ptr<const Run> rerun(const Run& run, void (*change)(planes::SegmentOptions&)) {
  planes::PipelineOptions options = run.options;
  change(options.segment);
  return make_run(run.subject, options);
}

TEST(Compare, ARunDoesNotDifferFromItself) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0.003);
  const Comparison same = compare_runs(*run, *run);
  EXPECT_EQ(same.diverging_step_a, planes::kNever);
  EXPECT_TRUE(same.nodes.empty());
  EXPECT_TRUE(same.changed_sources.empty());
  for (const PlanePair& pair : same.planes) {
    EXPECT_EQ(pair.a, pair.b);
    EXPECT_EQ(pair.iou, 1);
  }
  for (std::int32_t step = 0; step <= run->steps(); step += 7)
    EXPECT_EQ(same_step(*run, step, *run), step) << describe_event(*run, step);
}

TEST(Compare, TheFirstDifferenceIsTheFirstEffectOfTheThreshold) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const auto b = rerun(*a, [](planes::SegmentOptions& o) { o.theta_e_n_m2 = 0.0001; });
  const Comparison changed = compare_runs(*a, *b);
  ASSERT_NE(changed.diverging_step_a, planes::kNever);
  EXPECT_EQ(changed.diverging_step_a, changed.diverging_step_b);
  const planes::TraceEvent& event = *a->event_at(changed.diverging_step_a);
  EXPECT_EQ(event.type, planes::EventType::decide);
  EXPECT_EQ(event.node_case, 4);
  EXPECT_NE(changed.divergence.find("case III"), std::string::npos) << changed.divergence;
  ASSERT_FALSE(changed.nodes.empty());
  bool there = false;
  for (const NodeChange& node : changed.nodes) there = there || node.a == event.node;
  EXPECT_TRUE(there);
}

TEST(Compare, ANodeIsFoundInTheOtherRunByItsCell) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const auto b = rerun(*a, [](planes::SegmentOptions& o) { o.theta_e_n_m2 = 0.0001; });
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(a->octree().nodes.size()); ++n) {
    const std::int32_t other = same_node(*a, n, *b);
    if (other < 0) continue;
    EXPECT_EQ(a->octree().nodes[n].code, b->octree().nodes[other].code);
    EXPECT_EQ(a->octree().nodes[n].depth, b->octree().nodes[other].depth);
    EXPECT_EQ(same_node(*b, other, *a), n);
  }
}

TEST(Compare, DifferentCubesShareNoNodesButPlanes) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0);
  const auto b =
      rerun(*a, [](planes::SegmentOptions& o) { o.cube_anchor = planes::CubeAnchor::min_corner; });
  EXPECT_EQ(same_node(*a, 0, *b), -1);
  const Comparison changed = compare_runs(*a, *b);
  ASSERT_FALSE(changed.planes.empty());
  EXPECT_GT(changed.planes.front().iou, 0.8);
  EXPECT_LE(same_step(*a, a->steps() / 2, *b), b->steps());
}

TEST(Compare, PerfectStairsMatchEveryTruePlane) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0);
  const Comparison truth = compare_with_truth(*run);
  EXPECT_EQ(truth.planes.size(), static_cast<std::size_t>(run->subject->voxel_truth.plane_count));
  for (const PlanePair& pair : truth.planes) EXPECT_GT(pair.iou, 0.9);
  EXPECT_EQ(truth.compared_sources, run->subject->voxel_count());
  EXPECT_LT(truth.changed_sources.size(), truth.compared_sources / 50);
}

TEST(TraceText, DescribesEveryStepAndIsReproducible) {
  for (const planes::Profile profile :
       {planes::Profile::paper, planes::Profile::paper_closest, planes::Profile::refined}) {
    const auto run = test::run_of_stairs(planes::profile_options(profile), 0.003);
    const std::string text = trace_text(*run);
    for (std::int32_t step = 0; step <= run->steps(); ++step) {
      const std::string line = "\nstep " + std::to_string(step) + ": " + describe_event(*run, step);
      ASSERT_NE(text.find(line), std::string::npos) << line;
    }
    EXPECT_EQ(text.find(": invalid: "), std::string::npos) << "a filter of the list does not parse";
    EXPECT_EQ(text, trace_text(*test::run_of_stairs(planes::profile_options(profile), 0.003)));
  }
}

TEST(TraceText, ReportsWhereItDiffersFromThePinnedRun) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const auto b = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0.003);
  EXPECT_EQ(trace_text(*a).find("first different events"), std::string::npos);
  EXPECT_NE(trace_text(*b, a.get()).find("first different events: step"), std::string::npos);
}

}  // namespace
}  // namespace planescope::debug
