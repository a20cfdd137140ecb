// Tests of the history of a point, from voxel to final plane.

#include "core/debug/explain/provenance.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/debug/explain/compare.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

/// Checks every point of a few clouds with every profile.
template <typename Check>
void on_every_point(Check check) {
  for (const planes::SegmentOptions& options :
       {planes::profile_options(planes::Profile::paper),
        planes::profile_options(planes::Profile::paper_closest),
        planes::profile_options(planes::Profile::refined)})
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const auto run = test::run_of_cloud(seed, options);
      for (std::size_t i = 0; i < run->subject->voxel_count(); i += 5) check(*run, i);
    }
}

TEST(Provenance, AHistoryIsInOrderAndEndsWithTheResult) {
  on_every_point([](const planescope::debug::Run& run, std::size_t i) {
    const std::vector<HistoryEvent> life = history_of(run, i);
    ASSERT_GE(life.size(), 5u);
    EXPECT_EQ(life.front().stage, "pixel");
    EXPECT_EQ(life.back().stage, "result");
    EXPECT_EQ(life.back().text.rfind("unassigned", 0) == 0, run.segmentation.plane_of[i] == 0);
    std::int32_t step = 0;
    for (const HistoryEvent& event : life) {
      EXPECT_FALSE(event.text.empty());
      if (event.step < 0) continue;
      EXPECT_GT(event.step, step);
      step = event.step;
    }
  });
}

TEST(Provenance, OneDecisionIsTheCauseAndPartOfTheHistory) {
  on_every_point([](const planescope::debug::Run& run, std::size_t i) {
    const WhyNot why = why_not(run, i);
    ASSERT_GT(why.step, 0) << why.answer;
    const std::vector<HistoryEvent> life = history_of(run, i);
    EXPECT_EQ(std::count_if(life.begin(), life.end(),
                            [](const HistoryEvent& event) { return event.decisive; }),
              1)
        << why.answer;
    EXPECT_EQ(why.answer.rfind("Lost", 0) == 0, run.segmentation.plane_of[i] == 0) << why.answer;
    planes::PipelineOptions options = run.options;
    if (!why.remedy.option.empty()) {
      EXPECT_NO_THROW(planes::set_option(options, why.remedy.option, why.remedy.value));
    }
  });
}

TEST(Provenance, CroppedAndUnmeasuredPointsAreReportedAsSuch) {
  const auto subject = test::stairs_subject(0, 0);
  subject->point_of_source[3] = planes::kNoVoxel;
  subject->prepared.voxels.voxel_of[4] = planes::kNoVoxel;
  const auto run = make_run(subject, {});
  EXPECT_NE(why_not(*run, 3).answer.find("no measurement"), std::string::npos);
  EXPECT_NE(why_not(*run, 4).answer.find("cropped"), std::string::npos);
  EXPECT_NE(why_not(*run, 1u << 30).answer.find("no such point"), std::string::npos);
  EXPECT_EQ(why_not(*run, 3).step, -1);
  EXPECT_LE(history_of(*run, 3).size(), 2u);
}

TEST(Provenance, ARemedyHasItsPromisedEffect) {
  // A node too small for a plane: with the smaller threshold it can become one.
  const auto run =
      test::run_of_stairs(planes::profile_options(planes::Profile::paper_closest), 0.003);
  int tried = 0;
  for (std::size_t i = 0; i < run->subject->voxel_count() && tried < 5; ++i) {
    const WhyNot why = why_not(*run, i);
    if (why.remedy.option != "theta_n_in") continue;
    planes::PipelineOptions options = run->options;
    planes::set_option(options, why.remedy.option, why.remedy.value);
    const auto changed = make_run(run->subject, options);
    EXPECT_NE(changed->octree().nodes[why.node].decided, planes::Case::II) << why.remedy.text;
    ++tried;
  }
  EXPECT_GT(tried, 0);
}

TEST(Provenance, APointInTheWrongPlaneReportsTheMergeThatFusedThem) {
  planes::SegmentOptions options = planes::profile_options(planes::Profile::paper);
  options.theta_coplane = 0.3;  // steps are fused
  const auto run = test::run_of_stairs(options, 0.003);
  const VoxelTruth& truth = run->subject->voxel_truth;
  int fused = 0;
  for (std::size_t i = 0; i < truth.plane.size(); i += 10) {
    const WhyNot why = why_not(*run, i);
    if (why.answer.find("were merged") == std::string::npos) continue;
    ASSERT_NE(run->event_at(why.step), nullptr);
    EXPECT_EQ(run->event_at(why.step)->type, planes::EventType::merge);
    EXPECT_EQ(why.remedy.option, "merge_offset_m");
    ++fused;
  }
  EXPECT_GT(fused, 0);
}

std::vector<std::uint32_t> voxels_of(const Run& run, std::int32_t plane) {
  std::vector<std::uint32_t> voxels;
  for (std::uint32_t i = 0; i < run.segmentation.plane_of.size(); ++i)
    if (run.segmentation.plane_of[i] == plane) voxels.push_back(i);
  return voxels;
}

TEST(RegionDecision, IdenticalRunsHaveNone) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0.003);
  for (const planes::PlaneRegion& plane : run->segmentation.planes) {
    const auto voxels = voxels_of(*run, plane.id);
    EXPECT_EQ(first_difference(*run, *run, voxels).step, 0);
    EXPECT_EQ(plane_of_region(*run, voxels), plane.id);
    EXPECT_EQ(loss_of_region(*run, voxels).step, 0) << "nothing of it is lost";
  }
}

TEST(RegionDecision, ForALostPlaneIsWhereItsNodesAreDecidedDifferently) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  planes::PipelineOptions options = a->options;
  options.segment.theta_n_in = 60;  // nodes with fewer points are not candidates
  const auto b = make_run(a->subject, options);
  int lost = 0;
  for (const PlanePair& pair : compare_runs(*a, *b).planes) {
    if (pair.a == 0 || pair.b > 0) continue;
    const auto voxels = voxels_of(*a, pair.a);
    EXPECT_EQ(plane_of_region(*b, voxels), 0);
    const RegionDecision parting = first_difference(*b, *a, voxels);
    ASSERT_GT(parting.step, 0);
    const planes::TraceEvent& event = *b->event_at(parting.step);
    if (event.type == planes::EventType::drop) continue;  // most of its points had been assigned
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

TEST(RegionDecision, ForFusedPlanesIsTheMergeThatJoinedThem) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0);
  planes::PipelineOptions options = a->options;
  options.segment.theta_coplane = 0;  // all points with the same label are one plane
  const auto b = make_run(a->subject, options);
  ASSERT_LT(b->segmentation.planes.size(), a->segmentation.planes.size());
  int merged = 0;
  for (const planes::PlaneRegion& plane : a->segmentation.planes) {
    const auto voxels = voxels_of(*a, plane.id);
    const RegionDecision parting = first_difference(*b, *a, voxels);
    if (parting.step == 0) continue;  // the plane that it founded
    const planes::TraceEvent& event = *b->event_at(parting.step);
    merged += event.type == planes::EventType::merge;
    const RegionDecision joining = joining_of_region(*b, voxels);
    if (joining.step == 0) continue;
    EXPECT_NE(b->event_at(joining.step)->type, planes::EventType::found);
  }
  EXPECT_GT(merged, 0);
}

TEST(Provenance, TwoPointsMeetAtTheStepThatPutsThemInOnePlane) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.001);
  const auto voxels = static_cast<std::int32_t>(run->subject->voxel_count());
  int met = 0, apart = 0;
  for (std::int32_t a = 0; a < voxels; a += 97)
    for (std::int32_t b = a + 1; b < voxels; b += 89) {
      const std::int32_t step = step_of_meeting(*run, a, b);
      const std::int32_t plane = run->segmentation.plane_of[a];
      const bool together = plane > 0 && plane == run->segmentation.plane_of[b];
      ASSERT_EQ(step > 0, together);
      ++(together ? met : apart);
      if (!together) continue;
      const auto plane_at = [&](std::int32_t voxel, std::int32_t at) {
        return run->timeline.point_at(voxel, at).plane;
      };
      EXPECT_EQ(plane_at(a, step), plane_at(b, step));
      EXPECT_TRUE(plane_at(a, step - 1) < 0 || plane_at(a, step - 1) != plane_at(b, step - 1));
    }
  EXPECT_GT(met, 0);
  EXPECT_GT(apart, 0);
}

}  // namespace
}  // namespace planescope::debug
