#include "core/labels/edit/selection.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "core/labels/edit/operations.hpp"
#include "small_frames.hpp"

namespace planescope::labels {
namespace {

int covered(const Image8& mask) { return std::accumulate(mask.data.begin(), mask.data.end(), 0); }

TEST(DrawnShape, ABrushTakesThePixelsWithinItsRadiusOfThePath) {
  const DrawnShape shape{DrawnShape::Kind::stroke, {{10, 10}, {30, 16}, {12, 30}}, 5.3f};
  const Image8 mask = mask_of(shape, 48, 40);
  const auto distance = [](const Vec2f& p, const Vec2f& a, const Vec2f& b) {
    const float t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0f, 1.0f);
    return (p - a - t * (b - a)).norm();
  };
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 48; ++x) {
      const Vec2f p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const float d = std::min(distance(p, shape.path[0], shape.path[1]),
                               distance(p, shape.path[1], shape.path[2]));
      if (std::abs(d - shape.radius_px) < 1e-3f) continue;
      EXPECT_EQ(mask.at(x, y), d < shape.radius_px) << x << "," << y;
    }
}

TEST(DrawnShape, ADotIsADiscAndMayHangOverTheBorder) {
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {{8.5f, 8.5f}}, 1}, 20, 20)), 5);
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {{0, 0}}, 2}, 20, 20)), 3);
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {{-50, 4}}, 8}, 20, 20)), 0);
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {}, 8}, 20, 20)), 0);
}

TEST(DrawnShape, AnAreaTakesThePixelsWhoseCentresAreInside) {
  const Image8 mask =
      mask_of({DrawnShape::Kind::area, {{2, 3}, {7, 3}, {7, 9}, {2, 9}}, 0}, 20, 20);
  EXPECT_EQ(covered(mask), 5 * 6);
  EXPECT_EQ(mask.at(2, 3), 1);
  EXPECT_EQ(mask.at(7, 3), 0);
}

TEST(DrawnShape, WhereALassoCrossesItselfItIsEmptyInTheMiddle) {
  const std::vector<Vec2f> twice{{0, 0}, {20, 0}, {20, 20}, {0, 20}, {0, 0},
                                 {5, 5}, {15, 5}, {15, 15}, {5, 15}, {5, 5}};
  const Image8 mask = mask_of({DrawnShape::Kind::area, twice, 0}, 20, 20);
  EXPECT_EQ(mask.at(2, 10), 1);
  EXPECT_EQ(mask.at(10, 10), 0);
}

TEST(PixelsOnImage, AreMeasuredAndNotUnderAHiddenLabel) {
  Frame frame = test::frame_of(20, 10, [](int, int) { return 1.0; });
  frame.depth.at(3, 3) = 0;
  const LabelGrid grid = make_label_grid(frame, Gravity{});
  const DrawnShape all{DrawnShape::Kind::area, {{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0};
  EXPECT_EQ(pixels_on_image(grid, all).size(), 199u);
  FrameLabels labels = painted(empty_labels(grid, ""), grid, test::rectangle(grid, 10, 0, 20, 10),
                               {1}, PaintMode::over);
  labels = with_flag(labels, 1, PlaneFlag::hidden, true);
  EXPECT_EQ(pixels_on_image(grid, all, shown_pixels(labels)).size(), 99u);
}

/// A box of 0.2 m at 0.8 m before a wall at 1.2 m, seen from the sensor or from beside it.
class BoxBeforeAWall : public testing::Test {
 protected:
  static bool on_box(int u, int v) { return u >= 60 && u < 100 && v >= 40 && v < 80; }
  const LabelGrid grid = make_label_grid(
      test::frame_of(160, 120, [](int u, int v) { return on_box(u, v) ? 0.8 : 1.2; }), Gravity{});

  /// Moved sideways by `x`, looking along +z; shows about what the sensor sees.
  static SpaceView view_from(float x, bool orthographic = false) {
    SpaceView view;
    view.width = 640;
    view.height = 480;
    view.orthographic = orthographic;
    view.point_size_m = 0.016f;
    view.px_per_m = 400;
    view.clip_from_sensor.setZero();
    Eigen::Matrix4f& m = view.clip_from_sensor;
    m(0, 0) = orthographic ? 1.0f : 2 * 400 / 640.0f;
    m(1, 1) = orthographic ? -4 / 3.0f : -2 * 400 / 480.0f;
    m(0, 3) = -m(0, 0) * x;
    if (orthographic) {
      view.px_per_m = 320;
      m(2, 2) = 0.2f;
      m(2, 3) = -1;
      m(3, 3) = 1;
    } else {
      const float near_m = 0.1f, far_m = 10;
      m(2, 2) = (far_m + near_m) / (far_m - near_m);
      m(2, 3) = -2 * far_m * near_m / (far_m - near_m);
      m(3, 2) = 1;
    }
    return view;
  }
  const DrawnShape everything{DrawnShape::Kind::area, {{0, 0}, {640, 0}, {640, 480}, {0, 480}}, 0};
};

TEST_F(BoxBeforeAWall, FromTheSensorNothingIsHidden) {
  const SeenPoints seen = see(grid, view_from(0));
  const SpaceSelection selection = points_in_space(seen, everything, false);
  EXPECT_GT(selection.pixels.size(), 0.99 * static_cast<double>(grid.measured_count));
}

TEST_F(BoxBeforeAWall, FromTheSideTheBoxCoversWallThatThroughTakes) {
  for (const bool orthographic : {false, true}) {
    const SpaceView view = view_from(orthographic ? 0.0f : 0.3f, orthographic);
    const SeenPoints seen = see(grid, view);
    // A shape on the box's left part: from the side, wall that the sensor saw is behind it.
    const Vec2f box = seen.place[test::pixel_at(grid, 66, 60)];
    const DrawnShape shape{DrawnShape::Kind::stroke, {box}, 16};
    const SpaceSelection visible = points_in_space(seen, shape, false);
    ASSERT_FALSE(visible.pixels.empty());
    for (const std::uint32_t i : visible.pixels)
      EXPECT_TRUE(on_box(static_cast<int>(i) % 160, static_cast<int>(i) / 160)) << i;
    const SpaceSelection through = points_in_space(seen, shape, true);
    EXPECT_EQ(through.hidden, visible.hidden);
    EXPECT_EQ(through.pixels.size(), visible.pixels.size() + visible.hidden);
    EXPECT_TRUE(orthographic || visible.hidden > 0);
  }
}

TEST_F(BoxBeforeAWall, WhatIsNotShownNeitherCoversNorIsSelected) {
  std::vector<std::uint8_t> shown(grid.pixels(), 1);
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u) shown[test::pixel_at(grid, u, v)] = !on_box(u, v);
  const SeenPoints seen = see(grid, view_from(0.3f), shown);
  const SpaceSelection selection = points_in_space(seen, everything, true);
  EXPECT_EQ(selection.hidden, 0u);
  for (const std::uint32_t i : selection.pixels) EXPECT_TRUE(shown[i]);
}

TEST_F(BoxBeforeAWall, PointsBehindTheEyeOrOutOfViewHaveNoPlace) {
  const SeenPoints seen = see(grid, view_from(5));
  EXPECT_TRUE(points_in_space(seen, everything, true).pixels.empty());
}

TEST_F(BoxBeforeAWall, ASlantedNoisySurfaceDoesNotHideItself) {
  const auto view =
      test::view_of(lab::make_scene("stairs", 3), lab::make_scene("stairs", 3).camera, false);
  SpaceView space = view_from(0);
  space.point_size_m = 0.004f;
  space.px_per_m = 385;
  space.clip_from_sensor(0, 0) = 2 * 385 / 640.0f;
  space.clip_from_sensor(1, 1) = -2 * 385 / 480.0f;
  const SeenPoints seen = see(view.grid, space);
  const double visible = std::accumulate(seen.visible.begin(), seen.visible.end(), 0.0);
  EXPECT_GT(visible, 0.98 * static_cast<double>(view.grid.measured_count));
}

}  // namespace
}  // namespace planescope::labels
