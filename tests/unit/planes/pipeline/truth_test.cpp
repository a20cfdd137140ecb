#include "core/planes/pipeline/truth.hpp"

#include <gtest/gtest.h>

#include "core/planes/pipeline/score.hpp"

namespace planescope::planes {
namespace {

TEST(Truth, LabelImagesBecomeTruthPerPixel) {
  FrameLabels labels;
  labels.plane = Image16(4, 1);
  labels.plane.data = {0, 3, kPlaneIgnore, 1};
  labels.hv = Image8(4, 1);
  labels.hv.data = {0, 2, kHvIgnore, 1};
  labels.planes.push_back({3, Label::v, Vec3d::UnitX(), 0.4, 0, 0, 1});
  const SourceTruth truth = truth_of_labels(labels);
  EXPECT_EQ(truth.values.instance, (std::vector<std::int32_t>{0, 3, -1, 1}));
  EXPECT_EQ(truth.values.label, (std::vector<std::uint8_t>{0, 2, 0, 1}));
  ASSERT_EQ(truth.normals.size(), 3u);
  EXPECT_EQ(truth.normals[2], Vec3d(1, 0, 0));
  EXPECT_EQ(truth.normals[0], Vec3d(0, 0, 0)) << "not known";
}

TEST(Truth, ACloudWithLabelsAloneSaysNothingAboutPlanes) {
  PointSet set;
  set.points.assign(3, Vec3f(1, 0, 0));
  EXPECT_FALSE(truth_of_cloud(set).has_value());
  set.label = {1, 2, 9};
  const auto truth = truth_of_cloud(set);
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->values.label, (std::vector<std::uint8_t>{1, 2, 0}));
  EXPECT_EQ(truth->values.instance, (std::vector<std::int32_t>{-1, -1, -1}));
}

TEST(Truth, ItFollowsThePointsThatWereMeasured) {
  Frame frame;
  frame.cloud.emplace();
  frame.cloud->points = {Vec3f(1, 0, 0), Vec3f::Zero(), Vec3f(0, 1, 0), Vec3f(0, 0, 1)};
  frame.cloud->instance = {1, 2, 3, 4};
  const auto source = measured_sources(frame);
  EXPECT_EQ(source, (std::vector<std::uint32_t>{0, 2, 3}));
  const FrameTruth gathered = truth_on_points(truth_of_cloud(*frame.cloud)->values, source);
  EXPECT_EQ(gathered.instance, (std::vector<std::int32_t>{1, 3, 4}));
}

// A floor and a wall of 20x20 points, 5 cm apart; the wall is out of range where asked for.
Frame floor_and_far_wall() {
  Frame frame;
  PointSet& set = frame.cloud.emplace();
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      const float a = 0.02f * static_cast<float>(i), b = 0.02f * static_cast<float>(j);
      set.points.emplace_back(0.5f + a, b, -0.3f);
      set.label.push_back(1);
      set.instance.push_back(1);
      set.points.emplace_back(2.0f, a, b);
      set.label.push_back(2);
      set.instance.push_back(2);
    }
  return frame;
}

TEST(Score, CroppedPointsAreNotScored) {
  const Frame frame = floor_and_far_wall();
  const SourceTruth truth = *truth_of_cloud(*frame.cloud);
  PipelineOptions options;
  const auto score = [&] {
    const FrameTruth on_points = truth_on_points(truth.values, measured_sources(frame));
    return score_frame(run_frame(frame, options, nullptr, &on_points), truth);
  };
  const Metrics whole = score();
  EXPECT_EQ(whole.planes_truth, 2);
  EXPECT_EQ(whole.points, 800u);
  options.cloud.range_for_clouds = true;
  options.cloud.max_range_m = 1.5;
  const Metrics near = score();
  EXPECT_EQ(near.planes_truth, 1);
  EXPECT_EQ(near.planes_found, 1);
  EXPECT_EQ(near.points, 400u);
  EXPECT_EQ(near.r_m, 0);
}

}  // namespace
}  // namespace planescope::planes
