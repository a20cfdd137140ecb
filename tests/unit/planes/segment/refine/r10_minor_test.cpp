#include "core/planes/segment/refine/r10_minor.hpp"

#include <gtest/gtest.h>

#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

/// A ball of 30 cm before a wall, and a board of 10 x 10 cm beside it.
Frame ball_and_board() {
  return test::depth_frame([](double x, double y) {
    const Vec3d ray = Vec3d(x, y, 1);
    const Vec3d center(-0.3, 0, 1.3);
    const double b = ray.dot(center), c = center.squaredNorm() - 0.3 * 0.3;
    const double under = b * b - ray.squaredNorm() * c;
    if (under > 0) return (b - std::sqrt(under)) / ray.squaredNorm();
    if (std::abs(x - 0.35) < 0.05 && std::abs(y) < 0.05) return 1.0;
    return 1.9;
  });
}

TEST(MinorPlanes, FacetsOfACurvedThingAreListedApart) {
  const Frame frame = ball_and_board();
  const FrameResult all =
      test::result_of(frame, [](SegmentOptions& options) { options.r10_minor.on = false; });
  const FrameResult result = test::result_of(frame);
  EXPECT_GT(all.segmentation.planes.size(), 3u);
  EXPECT_LE(result.segmentation.planes.size(), 3u);
  EXPECT_TRUE(all.segmentation.minor.empty());
  EXPECT_EQ(result.segmentation.minor.size() + result.segmentation.planes.size(),
            all.segmentation.planes.size());
}

TEST(MinorPlanes, ASmallBoardIsNone) {
  const FrameResult result = test::result_of(ball_and_board());
  const int board = test::plane_at(result, 459, 239), wall = test::plane_at(result, 580, 60);
  EXPECT_GT(board, 0);
  EXPECT_GT(wall, 0);
  EXPECT_NE(board, wall);
}

}  // namespace
}  // namespace planescope::planes
