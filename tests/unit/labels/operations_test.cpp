// Label edits, and selection by drawn shapes.

#include "core/labels/edit/operations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/labels/edit/edit.hpp"
#include "core/labels/edit/selection.hpp"
#include "core/model/error.hpp"
#include "random_labels.hpp"
#include "small_frames.hpp"
#include "support/label_drafts.hpp"

namespace planescope::labels {
namespace {

using test::rectangle;

class Operations : public testing::Test {
 protected:
  const LabelGrid grid = test::wall_grid();
  const FrameLabels blank = empty_labels(grid, std::string(64, 'a'));

  FrameLabels with_plane(const FrameLabels& labels, int id, const PixelSet& pixels) const {
    return painted(labels, grid, pixels, {id}, PaintMode::over);
  }
};

TEST_F(Operations, PaintingCreatesAPlaneFittedToItsPixels) {
  const PixelSet pixels = rectangle(grid, 4, 4, 14, 14);
  const FrameLabels labels =
      painted(blank, grid, pixels, {3, Label::unknown, LabelOrigin::wand}, PaintMode::over);
  ASSERT_EQ(labels.planes.size(), 1u);
  const LabelPlane& plane = labels.planes[0];
  EXPECT_EQ(plane.id, 3);
  EXPECT_EQ(plane.label, Label::v);  // by its tilt
  EXPECT_EQ(plane.origin, LabelOrigin::wand);
  EXPECT_LT((plane.normal - Vec3d(0, 0, -1)).norm(), 1e-6);
  EXPECT_NEAR(plane.offset_m, -1, 1e-6);
  EXPECT_EQ(plane.fragments, 1);
  EXPECT_EQ(pixels_of_plane(labels, 3), pixels);
  EXPECT_EQ(labels.hv.data[pixels[0]], 2);
  EXPECT_EQ(blank.planes.size(), 0u);
}

TEST_F(Operations, WithoutGravityAPlaneHasNoClassUntilItIsKnown) {
  LabelGrid unknown = grid;
  unknown.gravity.source = GravitySource::none;
  const PixelSet pixels = rectangle(grid, 4, 4, 14, 14), others = rectangle(grid, 20, 4, 30, 14);
  FrameLabels labels =
      painted(empty_labels(unknown, std::string(64, 'a')), unknown, pixels, {1}, PaintMode::over);
  labels = painted(labels, unknown, others, {2, Label::h}, PaintMode::over);
  EXPECT_EQ(find_plane(labels, 1)->label, Label::unknown);
  EXPECT_EQ(labels.hv.data[pixels[0]], 0);
  EXPECT_EQ(find_plane(labels, 2)->label, Label::h) << "as it was given";
  EXPECT_TRUE(std::isnan(fit_plane(unknown, pixels).tilt_deg));

  const Gravity picked{Vec3d::UnitY(), GravitySource::picked, 1, "picked"};
  const FrameLabels reported = edited(labels, grid, set_gravity, picked);
  EXPECT_EQ(reported.gravity.source, GravitySource::picked);
  EXPECT_EQ(find_plane(reported, 1)->label, Label::v);
  EXPECT_EQ(reported.hv.data[pixels[0]], 2);
  EXPECT_EQ(find_plane(reported, 2)->label, Label::h) << "a person's word stays";
}

TEST_F(Operations, PixelsThatWereNotMeasuredKeepNoLabel) {
  Frame frame = test::frame_of(20, 20, [](int, int) { return 1.0; });
  frame.depth.at(6, 6) = 0;
  const LabelGrid holed = make_label_grid(frame, Gravity{});
  const FrameLabels labels =
      painted(empty_labels(holed, ""), holed, rectangle(holed, 4, 4, 14, 14), {1}, PaintMode::over);
  EXPECT_EQ(labels.plane.at(6, 6), 0);
  EXPECT_EQ(labels.plane.at(7, 6), 1);
}

TEST_F(Operations, AddingLabelsOnlyUnlabeledPixels) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = painted(labels, grid, rectangle(grid, 5, 0, 15, 10), {2}, PaintMode::add);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 100u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 50u);
}

TEST_F(Operations, SubtractingRemovesOnlyThePaintedLabel) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = with_plane(labels, 2, rectangle(grid, 10, 0, 20, 10));
  labels = painted(labels, grid, rectangle(grid, 5, 0, 15, 10), {1}, PaintMode::subtract);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 50u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 100u);
}

TEST_F(Operations, APlaneWithoutPixelsLeavesTheList) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = with_plane(labels, 2, rectangle(grid, 0, 0, 20, 20));
  ASSERT_EQ(labels.planes.size(), 1u);
  EXPECT_EQ(labels.planes[0].id, 2);
}

TEST_F(Operations, IgnoredAndClassOnlyPixelsAreNotPlanes) {
  FrameLabels labels =
      painted(blank, grid, rectangle(grid, 0, 0, 5, 5), {kPlaneIgnore}, PaintMode::over);
  labels = painted(labels, grid, rectangle(grid, 5, 0, 10, 5), {0, Label::h}, PaintMode::over);
  EXPECT_TRUE(labels.planes.empty());
  EXPECT_EQ(labels.plane.at(0, 0), kPlaneIgnore);
  EXPECT_EQ(labels.hv.at(0, 0), kHvIgnore);
  EXPECT_EQ(labels.plane.at(6, 0), 0);
  EXPECT_EQ(labels.hv.at(6, 0), 1);
  labels = painted(labels, grid, rectangle(grid, 0, 0, 10, 5), {0}, PaintMode::over);
  EXPECT_EQ(labels.plane.data, blank.plane.data);
  EXPECT_EQ(labels.hv.data, blank.hv.data);
}

TEST_F(Operations, LockedPlanesNeitherLoseNorGainPixels) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = edited(labels, grid, set_flag, 1, PlaneFlag::locked, true);
  EXPECT_EQ(with_plane(labels, 1, rectangle(grid, 10, 0, 20, 10)).plane.data, labels.plane.data);
  EXPECT_EQ(with_plane(labels, 2, rectangle(grid, 0, 0, 10, 10)).plane.data, labels.plane.data);
  EXPECT_TRUE(with_plane(labels, 2, rectangle(grid, 0, 0, 10, 10)).planes.size() == 1);
  EXPECT_THROW(edited(labels, grid, set_class, 1, Label::h), Error);
  EXPECT_THROW(edited(labels, grid, remove_plane, 1), Error);
  EXPECT_THROW(edited(labels, grid, split_by_parts, grid, 1, 0, 2), Error);
  EXPECT_FALSE(edited(labels, grid, set_flag, 1, PlaneFlag::locked, false).planes[0].locked);
}

TEST_F(Operations, HiddenPlanesLoseNoPixel) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = edited(labels, grid, set_flag, 1, PlaneFlag::hidden, true);
  labels = with_plane(labels, 2, rectangle(grid, 0, 0, 20, 10));
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 100u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 100u);
}

TEST_F(Operations, EditingACarriedPlaneConfirmsIt) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels.planes[0].confidence = 0.4;
  EXPECT_EQ(with_plane(labels, 2, rectangle(grid, 20, 0, 30, 10)).planes[0].confidence, 0.4);
  EXPECT_EQ(with_plane(labels, 1, rectangle(grid, 10, 0, 12, 10)).planes[0].confidence, 1);
  EXPECT_EQ(edited(labels, grid, set_class, 1, Label::h).planes[0].confidence, 1);
}

TEST_F(Operations, NewPlanesGetTheSmallestFreeNumber) {
  EXPECT_EQ(free_plane_id(blank), 1);
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 5, 5));
  labels = with_plane(labels, 3, rectangle(grid, 5, 0, 10, 5));
  EXPECT_EQ(free_plane_id(labels), 2);
  labels = with_plane(labels, 2, rectangle(grid, 10, 0, 15, 5));
  EXPECT_EQ(free_plane_id(labels), 4);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(labels.planes[i].id, i + 1);  // in order
}

TEST_F(Operations, ChangingAClassChangesAllItsPixels) {
  const FrameLabels labels =
      edited(with_plane(blank, 1, rectangle(grid, 0, 0, 5, 5)), grid, set_class, 1, Label::h);
  EXPECT_EQ(labels.planes[0].label, Label::h);
  EXPECT_EQ(std::ranges::count(labels.hv.data, 1), 25);
  EXPECT_THROW(edited(labels, grid, set_class, 2, Label::h), Error);
}

TEST_F(Operations, JoinedPlanesAreOne) {
  FrameLabels labels =
      painted(blank, grid, rectangle(grid, 0, 0, 5, 5), {1, Label::h}, PaintMode::over);
  labels = with_plane(labels, 2, rectangle(grid, 20, 0, 25, 5));
  labels = edited(labels, grid, join_planes, 1, 2);
  ASSERT_EQ(labels.planes.size(), 1u);
  EXPECT_EQ(labels.planes[0].fragments, 2);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 50u);
  EXPECT_EQ(std::ranges::count(labels.hv.data, 1), 50);
  EXPECT_THROW(edited(labels, grid, join_planes, 1, 2), Error);
}

TEST_F(Operations, SplittingByPartsKeepsTheNumberForTheLargest) {
  PixelSet pixels = rectangle(grid, 0, 0, 5, 5);
  for (const std::uint32_t pixel : rectangle(grid, 20, 0, 30, 10)) pixels.push_back(pixel);
  const FrameLabels labels =
      edited(with_plane(blank, 4, pixels), grid, split_by_parts, grid, 4, 0.001, 2);
  ASSERT_EQ(labels.planes.size(), 2u);
  EXPECT_EQ(pixels_of_plane(labels, 4).size(), 100u);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 25u);
  EXPECT_EQ(labels.planes[0].fragments, 1);
}

TEST_F(Operations, SmallPartsStayWithTheNearestLargeOne) {
  PixelSet pixels = rectangle(grid, 0, 0, 10, 10);
  for (const std::uint32_t pixel : rectangle(grid, 28, 0, 40, 10)) pixels.push_back(pixel);
  for (const std::uint32_t pixel : rectangle(grid, 12, 4, 14, 6)) pixels.push_back(pixel);
  const FrameLabels labels =
      edited(with_plane(blank, 1, pixels), grid, split_by_parts, grid, 1, 0.005, 2);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 120u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 104u);
}

TEST_F(Operations, PartsConnectAcrossUnmeasuredPixels) {
  const LabelGrid gap = make_label_grid(
      test::frame_of(40, 20, [](int u, int) { return u == 10 || u == 11 ? 0.0 : 1.0; }), Gravity{});
  const FrameLabels labels =
      painted(empty_labels(gap, ""), gap, rectangle(gap, 0, 0, 20, 10), {1}, PaintMode::over);
  EXPECT_EQ(edited(labels, gap, split_by_parts, gap, 1, 0, 2).planes.size(), 1u);
  EXPECT_EQ(edited(labels, gap, split_by_parts, gap, 1, 0, 1).planes.size(), 2u);
}

TEST_F(Operations, ACutSplitsOffThePixelsToItsRight) {
  const FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 20, 10));
  const auto down = sides_of_line(grid.width, grid.height, {12, 0}, {12, 20});
  const FrameLabels cut = edited(labels, grid, split_by_side, 1, down);
  EXPECT_EQ(pixels_of_plane(cut, 1), rectangle(grid, 12, 0, 20, 10));
  // right, looking down the image
  EXPECT_EQ(pixels_of_plane(cut, 2), rectangle(grid, 0, 0, 12, 10));
  const auto beside = sides_of_line(grid.width, grid.height, {30, 0}, {30, 20});
  EXPECT_EQ(edited(labels, grid, split_by_side, 1, beside).planes.size(), 1u);
}

TEST_F(Operations, ASegmentationReplacesAllButIgnoredPixelsAndLockedAndHiddenPlanes) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = with_plane(labels, 2, rectangle(grid, 10, 0, 20, 10));
  labels = edited(labels, grid, set_flag, 1, PlaneFlag::locked, true);
  const PixelSet ignored = rectangle(grid, 0, 15, 10, 20);
  labels = painted(labels, grid, ignored, {kPlaneIgnore}, PaintMode::over);
  std::vector<std::int32_t> plane_of(grid.pixels(), 0);
  for (const std::uint32_t pixel : rectangle(grid, 5, 0, 30, 10)) plane_of[pixel] = 1;
  for (const std::uint32_t pixel : rectangle(grid, 0, 10, 30, 20)) plane_of[pixel] = 2;
  const Label classes[] = {Label::h, Label::unknown};
  labels = edited(labels, grid, take_segmentation, grid, plane_of, classes);
  ASSERT_EQ(labels.planes.size(), 3u);
  EXPECT_EQ(pixels_of_plane(labels, 1), rectangle(grid, 0, 0, 10, 10));
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 300 - ignored.size());
  EXPECT_EQ(pixels_of_plane(labels, kPlaneIgnore), ignored);
  EXPECT_EQ(pixels_of_plane(labels, 3), rectangle(grid, 10, 0, 30, 10));  // 1 was in use
  EXPECT_EQ(find_plane(labels, 3)->label, Label::h);
  EXPECT_EQ(find_plane(labels, 2)->label, Label::v);  // by its tilt
  EXPECT_EQ(find_plane(labels, 2)->origin, LabelOrigin::algorithm);
}

TEST(LabelEdits, ApplyingGivesTheNewLabelsAndRevertingTheOldOnes) {
  Random random(1);
  FrameLabels labels = blank_labels(23, 17);
  for (int step = 0; step < 500; ++step) {
    const FrameLabels before = labels;
    const FrameLabels after = after_random_gesture(before, random);
    const LabelEdit edit = make_edit(3, "gesture", before, after);
    apply_edit(labels, edit);
    ASSERT_NO_FATAL_FAILURE(expect_same(labels, after)) << step;
    apply_edit(labels, reversed(edit));
    ASSERT_NO_FATAL_FAILURE(expect_same(labels, before)) << step;
    apply_edit(labels, edit);
  }
}

TEST(LabelEdits, RunsJoinWhereTheLabelsBeforeAndAfterAreTheSame) {
  const FrameLabels before = blank_labels(8, 6);
  FrameLabels after = before;
  after.planes = {LabelPlane{.id = 4}};
  for (int i = 5; i < 20; ++i) after.plane.data[i] = 4;
  for (int i = 12; i < 20; ++i) after.hv.data[i] = 1;
  const LabelEdit edit = make_edit(0, "Brush P4", before, after);
  const std::vector<LabelRun> expected = {{5, 7, 0, 4, 0, 0}, {12, 8, 0, 4, 0, 1}};
  EXPECT_EQ(edit.runs, expected);
  EXPECT_EQ(edit.changed_pixels(), 15u);
  ASSERT_EQ(edit.planes.size(), 1u);
  EXPECT_FALSE(edit.planes[0].before);
  EXPECT_EQ(edit.planes[0].after->id, 4);
  EXPECT_FALSE(edit.notes);
}

TEST(LabelEdits, TheOrderOfPlanesInTheListIsNotAChange) {
  FrameLabels before = blank_labels(8, 6);
  before.planes = {LabelPlane{.id = 9}, LabelPlane{.id = 2}};
  FrameLabels after = before;
  std::swap(after.planes[0], after.planes[1]);
  EXPECT_TRUE(make_edit(0, "sorted", before, after).empty());
}

int covered(const Image8& mask) { return std::accumulate(mask.data.begin(), mask.data.end(), 0); }

TEST(DrawnShape, ABrushSelectsPixelsWithinItsRadiusOfThePath) {
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

TEST(DrawnShape, ADotIsADiscAndMayExtendBeyondTheBorder) {
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {{8.5f, 8.5f}}, 1}, 20, 20)), 5);
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {{0, 0}}, 2}, 20, 20)), 3);
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {{-50, 4}}, 8}, 20, 20)), 0);
  EXPECT_EQ(covered(mask_of({DrawnShape::Kind::stroke, {}, 8}, 20, 20)), 0);
}

TEST(DrawnShape, AnAreaSelectsPixelsWhoseCentersAreInside) {
  const Image8 mask =
      mask_of({DrawnShape::Kind::area, {{2, 3}, {7, 3}, {7, 9}, {2, 9}}, 0}, 20, 20);
  EXPECT_EQ(covered(mask), 5 * 6);
  EXPECT_EQ(mask.at(2, 3), 1);
  EXPECT_EQ(mask.at(7, 3), 0);
}

TEST(DrawnShape, ASelfCrossingLassoIsEmptyInTheMiddle) {
  const std::vector<Vec2f> twice{{0, 0}, {20, 0}, {20, 20}, {0, 20}, {0, 0},
                                 {5, 5}, {15, 5}, {15, 15}, {5, 15}, {5, 5}};
  const Image8 mask = mask_of({DrawnShape::Kind::area, twice, 0}, 20, 20);
  EXPECT_EQ(mask.at(2, 10), 1);
  EXPECT_EQ(mask.at(10, 10), 0);
}

TEST(PixelsOnImage, AreMeasuredAndNotHidden) {
  Frame frame = test::frame_of(20, 10, [](int, int) { return 1.0; });
  frame.depth.at(3, 3) = 0;
  const LabelGrid grid = make_label_grid(frame, Gravity{});
  const DrawnShape all{DrawnShape::Kind::area, {{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0};
  EXPECT_EQ(pixels_on_image(grid, all).size(), 199u);
  FrameLabels labels = painted(empty_labels(grid, ""), grid, test::rectangle(grid, 10, 0, 20, 10),
                               {1}, PaintMode::over);
  labels = edited(labels, grid, set_flag, 1, PlaneFlag::hidden, true);
  EXPECT_EQ(pixels_on_image(grid, all, shown_pixels(labels)).size(), 99u);
}

/// A box of 0.2 m at 0.8 m in front of a wall at 1.2 m, seen from the sensor or from the side.
class BoxBeforeAWall : public testing::Test {
 protected:
  static bool on_box(int u, int v) { return u >= 60 && u < 100 && v >= 40 && v < 80; }
  const LabelGrid grid = make_label_grid(
      test::frame_of(160, 120, [](int u, int v) { return on_box(u, v) ? 0.8 : 1.2; }), Gravity{});

  /// Moved sideways by `x`, looking along +z; shows approximately the sensor's view.
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

TEST_F(BoxBeforeAWall, FromTheSideTheBoxHidesWallThatThroughSelects) {
  for (const bool orthographic : {false, true}) {
    const SpaceView view = view_from(orthographic ? 0.0f : 0.3f, orthographic);
    const SeenPoints seen = see(grid, view);
    // A shape on the box's left part: from the side, the wall that the sensor saw is behind it.
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

TEST_F(BoxBeforeAWall, HiddenPointsNeitherOccludeNorAreSelected) {
  std::vector<std::uint8_t> shown(grid.pixels(), 1);
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u) shown[test::pixel_at(grid, u, v)] = !on_box(u, v);
  const SeenPoints seen = see(grid, view_from(0.3f), shown);
  const SpaceSelection selection = points_in_space(seen, everything, true);
  EXPECT_EQ(selection.hidden, 0u);
  for (const std::uint32_t i : selection.pixels) EXPECT_TRUE(shown[i]);
}

TEST_F(BoxBeforeAWall, PointsBehindTheEyeOrOutOfViewHaveNoPosition) {
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
