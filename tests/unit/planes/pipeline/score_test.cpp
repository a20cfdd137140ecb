#include "core/planes/pipeline/score.hpp"

#include <gtest/gtest.h>

namespace planescope::planes {
namespace {

/// Twelve points, each its own voxel: planes 1 and 2 found, six points of the first.
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

TEST(Score, SmallTruePlanesAreLeftOutByTheirPointsOrTheirVoxels) {
  Scored s;  // the second plane: all its points in one voxel
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

TEST(Score, EveryPointIsJudgedByThePlaneThatStandsForItsOwn) {
  Scored s;
  s.result.plane_of[0] = 0;
  s.result.plane_of[1] = 2;
  s.truth.values.instance[2] = 0;
  s.truth.values.label[3] = 2;
  s.truth.values.instance[4] = -1;
  s.result.voxels.voxel_of[5] = kNoVoxel;
  const JudgedFrame judged = judge_frame(s.result, s.truth);
  const std::vector<Verdict> expected = {Verdict::missed,   Verdict::wrong_plane,
                                         Verdict::invented, Verdict::wrong_class,
                                         Verdict::unscored, Verdict::unscored};
  EXPECT_EQ(std::vector<Verdict>(judged.verdict.begin(), judged.verdict.begin() + 6), expected);
  for (std::size_t i = 6; i < 12; ++i) EXPECT_EQ(judged.verdict[i], Verdict::right);
  EXPECT_EQ(judged.found_of, (std::vector<int>{1, 2}));
  EXPECT_EQ(judged.true_plane[1], 1);
  EXPECT_EQ(judged.true_plane[11], 2);
}

}  // namespace
}  // namespace planescope::planes
