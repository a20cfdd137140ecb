// Tests of ground truth per voxel, and of scoring a frame.

#include <gtest/gtest.h>

#include "core/planes/pipeline/truth.hpp"

namespace planescope::planes {
namespace {

TEST(Truth, LabelImagesGiveTruthPerPixel) {
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

TEST(Truth, ACloudWithLabelsOnlyHasNoTruePlanes) {
  PointSet set;
  set.points.assign(3, Vec3f(1, 0, 0));
  EXPECT_FALSE(truth_of_cloud(set).has_value());
  set.label = {1, 2, 9};
  const auto truth = truth_of_cloud(set);
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->values.label, (std::vector<std::uint8_t>{1, 2, 0}));
  EXPECT_EQ(truth->values.instance, (std::vector<std::int32_t>{-1, -1, -1}));
}

TEST(Truth, ItFollowsTheMeasuredPoints) {
  Frame frame;
  frame.cloud.emplace();
  frame.cloud->points = {Vec3f(1, 0, 0), Vec3f::Zero(), Vec3f(0, 1, 0), Vec3f(0, 0, 1)};
  frame.cloud->instance = {1, 2, 3, 4};
  const auto source = measured_sources(frame);
  EXPECT_EQ(source, (std::vector<std::uint32_t>{0, 2, 3}));
  const FrameTruth gathered = truth_on_points(truth_of_cloud(*frame.cloud)->values, source);
  EXPECT_EQ(gathered.instance, (std::vector<std::int32_t>{1, 3, 4}));
}

// A floor and a wall of 20x20 points with 5 cm spacing; the wall can be out of range.
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

/// Twelve points, each its own voxel. Planes 1 and 2 are found; the first has six points.
struct Scored {
  FrameResult result;
  SourceTruth truth;

  Scored() {
    for (int i = 0; i < 12; ++i) {
      const bool second = i >= 6;
      result.cloud.points.push_back(
          Vec3f(static_cast<float>(i % 3), static_cast<float>(i % 6 / 3), second ? 1.F : 0.F));
      result.cloud.source.push_back(i);
      result.voxels.voxel_of.push_back(i);
      result.classification.labels.push_back(Label::h);
      result.plane_of.push_back(second ? 2 : 1);
      truth.values.instance.push_back(second ? 65534 : 40000);
      truth.values.label.push_back(1);
    }
    result.segmentation.planes.resize(2);
    for (int k = 0; k < 2; ++k) {
      result.segmentation.planes[k].id = k + 1;
      result.segmentation.planes[k].label = Label::h;
    }
  }
};

TEST(Score, IdsOfLabelsMayBeAnyNumbers) {
  const Scored s;
  const Metrics metrics = score_frame(s.result, s.truth);
  EXPECT_EQ(metrics.planes_truth, 2);
  EXPECT_EQ(metrics.mean_iou, 100);
  EXPECT_EQ(metrics.point_accuracy, 100);
}

TEST(Score, AVoxelBelongsToThePlaneOfMostOfItsPoints) {
  Scored s;  // four voxels of three points; the true plane of one changes within it
  s.result.voxels.voxel_of = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};
  s.result.voxels.points = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 0, 1), Vec3f(1, 0, 1)};
  s.result.voxels.count = {3, 3, 3, 3};
  s.result.classification.labels.resize(4);
  s.result.segmentation.plane_of = {1, 1, 2, 1};
  s.truth.values.instance[3] = 65534;
  const Metrics all = score_voxels(s.result, s.truth, 1);
  EXPECT_EQ(all.points, 4u);
  EXPECT_EQ(all.point_accuracy, 75);
  EXPECT_EQ(score_voxels(s.result, s.truth, 3).planes_truth, 0);
}

TEST(Score, SmallTruePlanesAreIgnoredByPointsOrVoxels) {
  Scored s;  // the second plane has all its points in one voxel
  for (int i = 6; i < 12; ++i) s.result.voxels.voxel_of[i] = 6;
  s.result.voxels.points.resize(7);
  s.result.voxels.count = {1, 1, 1, 1, 1, 1, 6};
  EXPECT_EQ(score_frame(s.result, s.truth, {.points = 6}).planes_truth, 2);
  EXPECT_EQ(score_frame(s.result, s.truth, {.points = 7}).planes_truth, 0);
  const Metrics by_voxels = score_frame(s.result, s.truth, {.voxels = 2});
  EXPECT_EQ(by_voxels.planes_truth, 1);
  EXPECT_EQ(by_voxels.planes_found, 1) << "what is found on the other is neither right nor wrong";
  EXPECT_EQ(by_voxels.points, 6u) << "points are counted, not voxels";
}

TEST(Score, EveryPointIsScoredByTheMatchOfItsTruePlane) {
  Scored s;
  s.result.plane_of[0] = 0;
  s.result.plane_of[1] = 2;
  s.truth.values.instance[2] = 0;
  s.truth.values.label[3] = 2;
  s.truth.values.instance[4] = -1;
  s.result.voxels.voxel_of[5] = kNoVoxel;
  const EvaluatedFrame evaluated = evaluate_frame(s.result, s.truth);
  const std::vector<Verdict> expected = {Verdict::missed,   Verdict::wrong_plane,
                                         Verdict::invented, Verdict::wrong_class,
                                         Verdict::unscored, Verdict::unscored};
  EXPECT_EQ(std::vector<Verdict>(evaluated.verdict.begin(), evaluated.verdict.begin() + 6),
            expected);
  for (std::size_t i = 6; i < 12; ++i) EXPECT_EQ(evaluated.verdict[i], Verdict::right);
  EXPECT_EQ(evaluated.found_of, (std::vector<int>{1, 2}));
  EXPECT_EQ(evaluated.true_plane[1], 1);
  EXPECT_EQ(evaluated.true_plane[11], 2);
}

}  // namespace
}  // namespace planescope::planes
