#include "core/planes/segment/refine/r11_pixel_borders.hpp"

#include <gtest/gtest.h>

#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

/// Share of the pixels around the crease that have the right plane.
double right_around_crease(const FrameResult& result) {
  const int wall = test::plane_at(result, 320, 120), floor = test::plane_at(result, 320, 470);
  EXPECT_NE(wall, floor);
  const int crease = 439;  // y = 0.4988
  int right = 0, all = 0;
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    const int v = static_cast<int>(result.cloud.source[i]) / 640;
    if (std::abs(v - crease) > 12) continue;
    ++all;
    right += result.plane_of[i] == (v <= crease ? wall : floor);
  }
  return static_cast<double>(right) / all;
}

TEST(PixelBorders, FollowTheCreaseWhereVoxelsDoNot) {
  const Frame frame = test::floor_and_wall();
  const double by_voxel = right_around_crease(test::result_of(
      frame, [](SegmentOptions& options) { options.r11_pixel_borders.on = false; }));
  const double by_pixel = right_around_crease(test::result_of(frame));
  EXPECT_GT(by_pixel, 0.95);
  EXPECT_LT(1 - by_pixel, 0.7 * (1 - by_voxel));
}

TEST(PixelBorders, MoveThePointsThatMostPixelsLeave) {
  const FrameResult result = test::result_of(test::floor_and_wall());
  ASSERT_FALSE(result.segmentation.plane_of_pixel.empty());
  const VoxelMembers members = voxel_members(result.voxels);
  for (std::size_t v = 0; v < result.voxels.points.size(); ++v) {
    int own = 0, all = 0;
    for (std::uint32_t m = members.first[v]; m < members.first[v + 1]; ++m, ++all)
      own += result.plane_of[members.members[m]] == result.segmentation.plane_of[v];
    EXPECT_TRUE(own > 0 || all == 0) << "voxel " << v << " has a plane that none of its pixels has";
  }
}

}  // namespace
}  // namespace planescope::planes
