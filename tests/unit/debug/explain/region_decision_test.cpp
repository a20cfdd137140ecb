#include "core/debug/explain/region_decision.hpp"

#include <gtest/gtest.h>

#include "core/debug/explain/compare.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

std::vector<std::uint32_t> voxels_of(const Run& run, std::int32_t plane) {
  std::vector<std::uint32_t> voxels;
  for (std::uint32_t i = 0; i < run.segmentation.plane_of.size(); ++i)
    if (run.segmentation.plane_of[i] == plane) voxels.push_back(i);
  return voxels;
}

TEST(RegionDecision, RunsThatAreTheSameDoNotPart) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0.003);
  for (const planes::PlaneRegion& plane : run->segmentation.planes) {
    const auto voxels = voxels_of(*run, plane.id);
    EXPECT_EQ(first_difference(*run, *run, voxels).step, 0);
    EXPECT_EQ(plane_of_region(*run, voxels), plane.id);
    EXPECT_EQ(loss_of_region(*run, voxels).step, 0) << "nothing of it is lost";
  }
}

TEST(RegionDecision, APlaneIsLostWhereItsNodesAreDecidedOtherwise) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  planes::PipelineOptions options = a->options;
  options.segment.theta_n_in = 60;  // nodes with fewer points are none
  const auto b = make_run(a->subject, options);
  int lost = 0;
  for (const PlanePair& pair : compare_runs(*a, *b).planes) {
    if (pair.a == 0 || pair.b > 0) continue;
    const auto voxels = voxels_of(*a, pair.a);
    EXPECT_EQ(plane_of_region(*b, voxels), 0);
    const RegionDecision parting = first_difference(*b, *a, voxels);
    ASSERT_GT(parting.step, 0);
    const planes::TraceEvent& event = *b->event_at(parting.step);
    if (event.type == planes::EventType::drop) continue;  // most of it had been assigned
    ++lost;
    ASSERT_EQ(event.type, planes::EventType::decide);
    EXPECT_EQ(event.node_case, static_cast<int>(planes::Case::II))
        << describe_event(*b, parting.step);
    const std::int32_t there = same_node(*b, event.node, *a);
    ASSERT_GE(there, 0);
    EXPECT_NE(a->octree().nodes[there].decided, planes::Case::II);
    EXPECT_EQ(b->timeline.node_of_point(parting.voxel, b->steps()), event.node);

    const RegionDecision loss = loss_of_region(*b, voxels);
    ASSERT_GT(loss.step, 0);
    EXPECT_GE(loss.points, 1u);
    EXPECT_LE(loss.points, voxels.size());
  }
  EXPECT_GT(lost, 0);
}

TEST(RegionDecision, PlanesThatBecameOnePartAtTheMergeThatJoinedThem) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0);
  planes::PipelineOptions options = a->options;
  options.segment.theta_coplane = 0;  // everything of a label is one plane
  const auto b = make_run(a->subject, options);
  ASSERT_LT(b->segmentation.planes.size(), a->segmentation.planes.size());
  int merged = 0;
  for (const planes::PlaneRegion& plane : a->segmentation.planes) {
    const auto voxels = voxels_of(*a, plane.id);
    const RegionDecision parting = first_difference(*b, *a, voxels);
    if (parting.step == 0) continue;  // it founded the one
    const planes::TraceEvent& event = *b->event_at(parting.step);
    merged += event.type == planes::EventType::merge;
    const RegionDecision joining = joining_of_region(*b, voxels);
    if (joining.step == 0) continue;
    EXPECT_NE(b->event_at(joining.step)->type, planes::EventType::found);
  }
  EXPECT_GT(merged, 0);
}

}  // namespace
}  // namespace planescope::debug
