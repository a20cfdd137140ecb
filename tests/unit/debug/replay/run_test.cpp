// Tests of recorded runs: voxels, truth, facts about nodes, and event texts.

#include "core/debug/replay/run.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/planes/classify/classifier.hpp"
#include "replay_subject.hpp"

namespace planescope::debug {
namespace {

/// Two points in the same voxel, an invalid one, one alone, and one that is cropped.
Frame cloud_frame() {
  Frame frame;
  frame.cloud.emplace();
  frame.cloud->points = {
      {0.501f, 0.5f, 0.5f}, {0, 0, 0}, {0.502f, 0.5f, 0.5f}, {-0.5f, 0.2f, 0.1f}, {9, 9, 9}};
  frame.cloud->label = {1, 0, 1, 2, 2};
  frame.cloud->instance = {4, 0, 4, 2, 2};
  frame.gravity = Gravity{Vec3d(0, 0, -1), GravitySource::option, 1, ""};
  return frame;
}

planes::PipelineOptions crop_at_3_m() {
  planes::PipelineOptions options;
  options.cloud.max_range_m = 3;
  options.cloud.range_for_clouds = true;
  return options;
}

TEST(Subject, SourcesFindTheirVoxels) {
  const Frame frame = cloud_frame();
  const auto subject =
      make_subject(frame, planes::truth_of_cloud(*frame.cloud), crop_at_3_m(), nullptr);
  ASSERT_EQ(subject->voxel_count(), 2u);
  EXPECT_NE(subject->voxel_of_source(0), planes::kNoVoxel);
  EXPECT_EQ(subject->voxel_of_source(0), subject->voxel_of_source(2));
  EXPECT_NE(subject->voxel_of_source(0), subject->voxel_of_source(3));
  EXPECT_EQ(subject->voxel_of_source(1), planes::kNoVoxel) << "not measured";
  EXPECT_EQ(subject->voxel_of_source(4), planes::kNoVoxel) << "out of range";
  EXPECT_EQ(subject->voxel_of_source(77), planes::kNoVoxel) << "not in the frame";
}

TEST(Subject, VoxelsHaveTheTruthOfTheirPoints) {
  const Frame frame = cloud_frame();
  const auto subject =
      make_subject(frame, planes::truth_of_cloud(*frame.cloud), crop_at_3_m(), nullptr);
  ASSERT_TRUE(subject->voxel_truth.known());
  EXPECT_EQ(subject->voxel_truth.plane_count, 4);
  EXPECT_EQ(subject->voxel_truth.plane[subject->voxel_of_source(0)], 4);
  EXPECT_EQ(subject->voxel_truth.plane[subject->voxel_of_source(3)], 2);
  EXPECT_EQ(subject->voxel_truth.label[subject->voxel_of_source(3)], 2);
}

TEST(Subject, WithoutTruthNothingIsKnown) {
  const auto classifier = planes::make_pca_classifier();
  const auto subject = make_subject(cloud_frame(), std::nullopt, crop_at_3_m(), classifier.get());
  EXPECT_FALSE(subject->voxel_truth.known());
  EXPECT_FALSE(subject->truth.has_value());
  EXPECT_TRUE(subject->frame.is_cloud());
}

TEST(Run, FactsAgreeWithTheDecisions) {
  for (const planes::Profile profile :
       {planes::Profile::paper, planes::Profile::paper_closest, planes::Profile::refined}) {
    const auto run = make_run(test::stair_subject(0.003), test::options_of(profile));
    for (const planes::TraceEvent& event : run->trace.events) {
      if (event.type != planes::EventType::decide) continue;
      const NodeFacts& facts = run->facts[event.node];
      const auto decided = static_cast<planes::Case>(event.node_case);
      EXPECT_EQ(planes::is_pure(facts.purity, run->segment_options), decided != planes::Case::I);
      if (decided == planes::Case::III || decided == planes::Case::IV) {
        EXPECT_EQ(facts.e_n <= facts.theta_e_n, decided == planes::Case::IV);
      }
    }
  }
}

TEST(Run, FactsCountTheTruePlanesOfEachNode) {
  const auto run = make_run(test::stair_subject(), test::options_of(planes::Profile::paper));
  const NodeFacts& root = run->facts[0];
  EXPECT_EQ(root.truth_planes, 5u);
  EXPECT_EQ(root.truth_plane, 1);
  EXPECT_EQ(root.truth_points, 600u);
  EXPECT_EQ(root.truth_known, run->segmentation.plane_of.size());
}

TEST(Run, EveryEventHasItsOwnSentence) {
  const planes::PipelineOptions options = test::options_of(planes::Profile::refined);
  const auto run = make_run(test::subject_of(test::random_cloud(4)), options);
  for (std::int32_t step = 0; step <= run->steps(); ++step) {
    const std::string text = describe_event(*run, step);
    EXPECT_GT(text.size(), 10u);
    EXPECT_EQ(text.find('?'), std::string::npos) << text;
    EXPECT_EQ(text.find("P0"), std::string::npos) << text;
    EXPECT_EQ(text.find("-1"), std::string::npos) << text;
  }
  EXPECT_EQ(describe_event(*run, 1).substr(0, 16), "node 0 (depth 0)");
}

TEST(Run, PlanesAreNumberedByFinalIdAndTemporaryOnesBeyond) {
  const planes::PipelineOptions options = test::options_of(planes::Profile::refined);
  const auto run = make_run(test::subject_of(test::random_cloud(4)), options);
  const Timeline& timeline = run->timeline;
  const auto listed = static_cast<std::int32_t>(run->segmentation.planes.size());
  ASSERT_GT(listed, 1);
  ASSERT_GT(timeline.plane_count(), listed) << "some do not stay";
  for (const planes::PlaneRegion& plane : run->segmentation.planes)
    EXPECT_EQ(plane_name(*run, plane.founded), "P" + std::to_string(plane.id));
  std::vector<std::int32_t> beyond;
  for (std::int32_t plane = 0; plane < timeline.plane_count(); ++plane) {
    EXPECT_EQ(timeline.plane_of_number(timeline.number_of_plane(plane)), plane);
    if (timeline.result_of_plane(plane) == 0) beyond.push_back(timeline.number_of_plane(plane));
  }
  EXPECT_EQ(beyond.front(), listed + 1);
  EXPECT_TRUE(std::ranges::is_sorted(beyond)) << "in order of founding";
  EXPECT_EQ(beyond.back(), timeline.greatest_number());
  EXPECT_EQ(timeline.plane_of_number(timeline.greatest_number() + 1), -1);
  EXPECT_EQ(timeline.plane_of_number(0), -1);
}

TEST(Run, ASceneWithoutPointsHasNoSteps) {
  auto subject = std::make_shared<Subject>();
  const auto run = make_run(subject, test::options_of(planes::Profile::paper));
  EXPECT_EQ(run->steps(), 0);
  EXPECT_EQ(run->timeline.plane_count(), 0);
}

}  // namespace
}  // namespace planescope::debug
