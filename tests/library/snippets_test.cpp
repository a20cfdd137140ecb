// Compiles and runs the code for Eigen and OpenCV in docs/library.md, which the build extracts.

#include <gtest/gtest.h>

#include "snippet_eigen.hpp"

#ifdef PLANESCOPE_WITH_OPENCV
#include "snippet_opencv.hpp"
#endif

namespace {

constexpr int kWidth = 160, kHeight = 120;

/// A wall 1 m ahead in the left half of the image; nothing in the right half.
bool is_wall(int u) { return u < kWidth / 2; }

planescope::Camera camera() {
  planescope::Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 120;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

TEST(Snippets, EigenReadsPlanesAndPoses) {
  std::vector<std::uint16_t> counts;
  for (int i = 0; i < kWidth * kHeight; ++i) counts.push_back(is_wall(i % kWidth) ? 1000 : 0);
  planescope::DepthImage image;
  image.counts = counts.data();
  image.camera = camera();
  image.gravity = planescope::Vec3{0, 1, 0};
  const planescope::Result result = planescope::segment(image);
  ASSERT_EQ(result.planes().size(), 1U);
  const Eigen::Hyperplane<double, 3> plane = eigen_plane(result.planes()[0]);
  const Eigen::Isometry3d T_sensor_world = eigen_pose(result.T_world_sensor()).inverse();
  EXPECT_NEAR(plane.absDistance(Eigen::Vector3d::Zero()), 1, 1e-3);
  EXPECT_NEAR((T_sensor_world * plane.projection(Eigen::Vector3d::Zero())).z(), 1, 1e-3);
  const Eigen::Matrix3Xd points = eigen_points(result);
  ASSERT_EQ(points.cols(), kWidth * kHeight);
  EXPECT_NEAR(plane.absDistance(points.col(kWidth * 60 + 10)), 0, 1e-3);
}

TEST(Snippets, OpenCvImagesAreSegmentedToLabelImages) {
#ifdef PLANESCOPE_WITH_OPENCV
  const cv::Matx33d K(120, 0, 79.5, 0, 120, 59.5, 0, 0, 1);
  cv::Mat depth(kHeight, kWidth + 7, CV_16U, cv::Scalar(0));  // wider than the part in use
  depth.colRange(0, kWidth / 2).setTo(1000);
  const planescope::Result result = planescope::segment(
      frame_of(depth.colRange(0, kWidth), K, 0.001), planescope::Options().set("gravity", "0,1,0"));
  const cv::Mat labels = labels_of(result, depth.colRange(0, kWidth).size());
  EXPECT_EQ(labels.at<int>(60, 10), 1);
  EXPECT_EQ(labels.at<int>(60, 150), 0);
#else
  GTEST_SKIP() << "OpenCV is not installed (libopencv-dev)";
#endif
}

}  // namespace
