#include "core/debug/replay/subject.hpp"

#include <gtest/gtest.h>

#include "core/planes/classify/classifier.hpp"

namespace planescope::debug {
namespace {

/// Two points that share a voxel, one that is no measurement, one alone, one that is cropped.
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

TEST(Subject, VoxelsTakeTheTruthOfTheirPoints) {
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

}  // namespace
}  // namespace planescope::debug
