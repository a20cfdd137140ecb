// Outlines of real frames cover the same area as the planes' pixels.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/io/recording.hpp"
#include "core/planes/outline/outline.hpp"

namespace planescope::planes {
namespace {

/// Area covered by the pixels of each plane, by id - 1 [m^2].
std::vector<double> pixel_areas(const Frame& frame, const FrameResult& result) {
  std::vector<double> areas(result.segmentation.planes.size(), 0);
  const Vec3d ahead = result.cloud.T_world_sensor.linear().col(2);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    if (result.plane_of[i] == 0) continue;
    const std::size_t k = static_cast<std::size_t>(result.plane_of[i]) - 1;
    const PlaneFit& fit = result.segmentation.planes[k].fit;
    // Intersection of the pixel's ray with the plane; at 1 m depth, a pixel is 1 / f wide.
    const Vec3d ray = result.cloud.points[i].cast<double>() - result.sensor();
    const double slant = fit.normal.dot(ray) / ahead.dot(ray);
    const double z = fit.normal.dot(fit.centroid - result.sensor()) / slant;
    areas[k] += z * z / std::abs(frame.intrinsics.fx * frame.intrinsics.fy * slant);
  }
  return areas;
}

struct RealFrames {
  const char* recording;
  Vec3d gravity;
  std::optional<std::array<double, 4>> intrinsics = {};
};

io::RecordingOptions options_of(const RealFrames& frames) {
  io::RecordingOptions options;
  options.intrinsics = frames.intrinsics;
  return options;
}

class RealOutlines : public testing::TestWithParam<RealFrames> {};

TEST_P(RealOutlines, CoverTheAreaOfTheirPixels) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const auto recording = io::open_recording(std::filesystem::path(data) / GetParam().recording,
                                            options_of(GetParam()));
  Frame frame = recording->frame(0);
  frame.gravity = Gravity{GetParam().gravity, GravitySource::option, 1, "given"};
  PipelineOptions options;
  options.cloud.max_range_m = 4;
  const FrameResult result = run_frame(frame, options, make_pca_classifier().get());
  const std::vector<Outline> outlines = outlines_of(frame, result, 0.02);
  const std::vector<double> pixels = pixel_areas(frame, result);
  double all_m2 = 0, all_pixels_m2 = 0;
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    EXPECT_TRUE(is_valid(polygons_of(outlines[k]))) << "plane " << k + 1;
    if (pixels[k] < 0.02) continue;
    // Outlines omit parts that are too small.
    EXPECT_NEAR(outlines[k].area_m2 / pixels[k], 1, 0.16) << "plane " << k + 1;
    all_m2 += outlines[k].area_m2;
    all_pixels_m2 += pixels[k];
  }
  ASSERT_GT(all_pixels_m2, 0.5);
  EXPECT_NEAR(all_m2 / all_pixels_m2, 1, 0.07);
}

INSTANTIATE_TEST_SUITE_P(
    All,
    RealOutlines,
    testing::Values(RealFrames{"felixchenfy_d4xx_640x480", Vec3d(-0.323, 0.844, 0.428)},
                    RealFrames{"aims_slam_realsense_640x480", Vec3d(0.175, 0.922, 0.346),
                               std::array{383.8, 383.8, 321.7, 236.8}},
                    RealFrames{"cape_tunnel_structure_640x480", Vec3d(0.02, 0.929, 0.37)},
                    RealFrames{"realsense_sdk_bag/single_depth_color_640x480.bag", Vec3d(0, 1, 0)}),
    [](const auto& test) { return std::filesystem::path(test.param.recording).begin()->string(); });

}  // namespace
}  // namespace planescope::planes
