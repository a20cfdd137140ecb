// Tests of running rival methods through the pipeline.

#include <gtest/gtest.h>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "support/render_depth.hpp"

namespace planescope::planes {
namespace {

/// A floor and a wall on it, as a cloud with truth.
Frame floor_and_wall() {
  Frame frame;
  PointSet& set = frame.cloud.emplace();
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 80; ++j) {
      const float a = 0.0125f * static_cast<float>(i), b = 0.0125f * static_cast<float>(j);
      set.points.emplace_back(0.5f + a, b, -0.3f);
      set.label.push_back(1);
      set.instance.push_back(1);
      if (i >= 60) continue;  // the wall is smaller
      set.points.emplace_back(1.6f, b, a);
      set.label.push_back(2);
      set.instance.push_back(2);
    }
  return frame;
}

PipelineOptions options_of(Method method) {
  PipelineOptions options;
  options.method = method;
  options.gravity.mode = GravityMode::fixed;
  options.gravity.direction = Vec3d(0, 0, -1);
  options.cloud.voxel_size_m = 0;
  return options;
}

TEST(Rival, TheFloorIsHorizontalAndTheWallIsVertical) {
  const FrameResult result =
      run_frame(floor_and_wall(), options_of(Method::region_growing), nullptr);
  ASSERT_EQ(result.segmentation.planes.size(), 2u);
  const PlaneRegion& floor = result.segmentation.planes[0];
  const PlaneRegion& wall = result.segmentation.planes[1];
  EXPECT_EQ(floor.id, 1);
  EXPECT_EQ(floor.label, Label::h);
  EXPECT_NEAR(floor.fit.normal.z(), 1, 1e-3) << "floors look up";
  EXPECT_EQ(wall.label, Label::v);
  EXPECT_NEAR(wall.fit.normal.x(), -1, 1e-3) << "walls look at the sensor";
  EXPECT_GT(floor.points, wall.points) << "the largest comes first";
  EXPECT_TRUE(result.segmentation.octree.nodes.empty());
}

TEST(Rival, TheResultDoesNotDependOnTruthOrClassifier) {
  const Frame frame = floor_and_wall();
  const SourceTruth truth = *truth_of_cloud(*frame.cloud);
  const FrameTruth on_points = truth_on_points(truth.values, measured_sources(frame));
  PipelineOptions options = options_of(Method::region_growing);
  options.classifier = "truth";
  const FrameResult without = run_frame(frame, options, nullptr);
  const FrameResult with = run_frame(frame, options, make_pca_classifier().get(), &on_points);
  EXPECT_EQ(without.plane_of, with.plane_of);
  EXPECT_EQ(without.classification.labels, with.classification.labels);
  const Metrics metrics = score_frame(without, truth);
  EXPECT_EQ(metrics.planes_found, 2);
  EXPECT_GT(metrics.mean_iou, 95);
}

TEST(Rival, AVoxelHasTheLabelOfItsPlane) {
  const FrameResult result =
      run_frame(floor_and_wall(), options_of(Method::region_growing), nullptr);
  ASSERT_EQ(result.classification.labels.size(), result.voxels.points.size());
  for (std::size_t v = 0; v < result.voxels.points.size(); ++v) {
    const std::int32_t id = result.segmentation.plane_of[v];
    EXPECT_EQ(result.classification.labels[v],
              id > 0 ? result.segmentation.planes[static_cast<std::size_t>(id) - 1].label
                     : Label::unknown);
  }
}

TEST(Rival, OnDepthFramesRegionGrowingUsesPixelsAndVoxelsFollowTheMajority) {
  const Frame frame =
      test::render_depth({{Vec3d(-1, -2, 0), Vec3d(4, 0, 0), Vec3d(0, 4, 0)}}, {.noise_px = 0});
  PipelineOptions options = options_of(Method::region_growing);
  options.gravity.mode = GravityMode::automatic;
  const FrameResult result = run_frame(frame, options, nullptr);
  ASSERT_FALSE(result.segmentation.planes.empty());
  EXPECT_EQ(result.segmentation.planes[0].label, Label::h);
  EXPECT_EQ(result.segmentation.plane_of, vote_instances(result.voxels, result.plane_of));
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    if (!result.cloud.kept[i]) {
      EXPECT_EQ(result.plane_of[i], 0) << "cropped pixels take no part";
    }
}

TEST(Rival, ItsOptionsAreSetByName) {
  PipelineOptions options;
  set_option(options, "region_patch_px", "10");
  EXPECT_FALSE(find_option("region_patch_px").matters(options));
  set_option(options, "method", "region-growing");
  EXPECT_EQ(options.method, Method::region_growing);
  EXPECT_EQ(options.rivals.region_growing.patch_px, 10);
  EXPECT_TRUE(find_option("region_patch_px").matters(options));
  EXPECT_FALSE(find_option("theta_n_in").matters(options));
  EXPECT_TRUE(find_option("voxel_size_m").matters(options));
  EXPECT_THROW(set_option(options, "method", "hough"), Error);
  EXPECT_THROW(set_option(options, "method", "ransac"), Error) << "without Open3D";
}

}  // namespace
}  // namespace planescope::planes
