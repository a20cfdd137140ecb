// What gestures do to labels, and edits as the differences that they make.

#include "core/labels/edit/operations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/labels/edit/edit.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/model/error.hpp"
#include "random_labels.hpp"
#include "small_frames.hpp"

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

TEST_F(Operations, PaintingMakesAPlaneFittedToItsPixels) {
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
  const FrameLabels told = with_gravity(labels, picked);
  EXPECT_EQ(told.gravity.source, GravitySource::picked);
  EXPECT_EQ(find_plane(told, 1)->label, Label::v);
  EXPECT_EQ(told.hv.data[pixels[0]], 2);
  EXPECT_EQ(find_plane(told, 2)->label, Label::h) << "a person's word stays";
}

TEST_F(Operations, AClassThatIsGivenWinsOverTheTilt) {
  const FrameLabels labels =
      painted(blank, grid, rectangle(grid, 4, 4, 14, 14), {1, Label::h}, PaintMode::over);
  EXPECT_EQ(labels.planes[0].label, Label::h);
  EXPECT_EQ(labels.hv.at(5, 5), 1);
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

TEST_F(Operations, AddingTakesOnlyWhatHadNoLabel) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = painted(labels, grid, rectangle(grid, 5, 0, 15, 10), {2}, PaintMode::add);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 100u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 50u);
}

TEST_F(Operations, SubtractingTakesOffThePaintsOwnLabelAlone) {
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

TEST_F(Operations, IgnoredAndClassAloneAreNoPlanes) {
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
  labels = with_flag(labels, 1, PlaneFlag::locked, true);
  EXPECT_EQ(with_plane(labels, 1, rectangle(grid, 10, 0, 20, 10)).plane.data, labels.plane.data);
  EXPECT_EQ(with_plane(labels, 2, rectangle(grid, 0, 0, 10, 10)).plane.data, labels.plane.data);
  EXPECT_TRUE(with_plane(labels, 2, rectangle(grid, 0, 0, 10, 10)).planes.size() == 1);
  EXPECT_THROW(with_class(labels, 1, Label::h), Error);
  EXPECT_THROW(without_plane(labels, 1), Error);
  EXPECT_THROW(split_by_parts(labels, grid, 1, 0), Error);
  EXPECT_FALSE(with_flag(labels, 1, PlaneFlag::locked, false).planes[0].locked);
}

TEST_F(Operations, HiddenPlanesLoseNoPixel) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = with_flag(labels, 1, PlaneFlag::hidden, true);
  labels = with_plane(labels, 2, rectangle(grid, 0, 0, 20, 10));
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 100u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 100u);
}

TEST_F(Operations, TouchingACarriedPlaneSettlesIt) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels.planes[0].confidence = 0.4;
  EXPECT_EQ(with_plane(labels, 2, rectangle(grid, 20, 0, 30, 10)).planes[0].confidence, 0.4);
  EXPECT_EQ(with_plane(labels, 1, rectangle(grid, 10, 0, 12, 10)).planes[0].confidence, 1);
  EXPECT_EQ(with_class(labels, 1, Label::h).planes[0].confidence, 1);
}

TEST_F(Operations, TheSmallestFreeNumberIsGivenAway) {
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
      with_class(with_plane(blank, 1, rectangle(grid, 0, 0, 5, 5)), 1, Label::h);
  EXPECT_EQ(labels.planes[0].label, Label::h);
  EXPECT_EQ(std::ranges::count(labels.hv.data, 1), 25);
  EXPECT_THROW(with_class(labels, 2, Label::h), Error);
}

TEST_F(Operations, JoinedPlanesAreOne) {
  FrameLabels labels =
      painted(blank, grid, rectangle(grid, 0, 0, 5, 5), {1, Label::h}, PaintMode::over);
  labels = with_plane(labels, 2, rectangle(grid, 20, 0, 25, 5));
  labels = joined(labels, grid, 1, 2);
  ASSERT_EQ(labels.planes.size(), 1u);
  EXPECT_EQ(labels.planes[0].fragments, 2);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 50u);
  EXPECT_EQ(std::ranges::count(labels.hv.data, 1), 50);
  EXPECT_THROW(joined(labels, grid, 1, 2), Error);
}

TEST_F(Operations, SplittingByPartsKeepsTheNumberForTheLargest) {
  PixelSet pixels = rectangle(grid, 0, 0, 5, 5);
  for (const std::uint32_t pixel : rectangle(grid, 20, 0, 30, 10)) pixels.push_back(pixel);
  const FrameLabels labels = split_by_parts(with_plane(blank, 4, pixels), grid, 4, 0.001);
  ASSERT_EQ(labels.planes.size(), 2u);
  EXPECT_EQ(pixels_of_plane(labels, 4).size(), 100u);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 25u);
  EXPECT_EQ(labels.planes[0].fragments, 1);
}

TEST_F(Operations, SmallPartsGoWithTheNearestLargeOne) {
  PixelSet pixels = rectangle(grid, 0, 0, 10, 10);
  for (const std::uint32_t pixel : rectangle(grid, 28, 0, 40, 10)) pixels.push_back(pixel);
  for (const std::uint32_t pixel : rectangle(grid, 12, 4, 14, 6)) pixels.push_back(pixel);
  const FrameLabels labels = split_by_parts(with_plane(blank, 1, pixels), grid, 1, 0.005);
  EXPECT_EQ(pixels_of_plane(labels, 1).size(), 120u);
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 104u);
}

TEST_F(Operations, PartsMeetAcrossWhatWasNotMeasured) {
  const LabelGrid gap = make_label_grid(
      test::frame_of(40, 20, [](int u, int) { return u == 10 || u == 11 ? 0.0 : 1.0; }), Gravity{});
  const FrameLabels labels =
      painted(empty_labels(gap, ""), gap, rectangle(gap, 0, 0, 20, 10), {1}, PaintMode::over);
  EXPECT_EQ(split_by_parts(labels, gap, 1, 0, 2).planes.size(), 1u);
  EXPECT_EQ(split_by_parts(labels, gap, 1, 0, 1).planes.size(), 2u);
}

TEST_F(Operations, ACutTakesWhatLiesToTheRightOfIt) {
  const FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 20, 10));
  const auto down = sides_of_line(grid.width, grid.height, {12, 0}, {12, 20});
  const FrameLabels cut = split_by_side(labels, grid, 1, down);
  EXPECT_EQ(pixels_of_plane(cut, 1), rectangle(grid, 12, 0, 20, 10));
  EXPECT_EQ(pixels_of_plane(cut, 2), rectangle(grid, 0, 0, 12, 10));  // right of the way down
  const auto beside = sides_of_line(grid.width, grid.height, {30, 0}, {30, 20});
  EXPECT_EQ(split_by_side(labels, grid, 1, beside).planes.size(), 1u);
}

TEST_F(Operations, ASegmentationReplacesAllButIgnoredPixelsAndLockedAndHiddenPlanes) {
  FrameLabels labels = with_plane(blank, 1, rectangle(grid, 0, 0, 10, 10));
  labels = with_plane(labels, 2, rectangle(grid, 10, 0, 20, 10));
  labels = with_flag(labels, 1, PlaneFlag::locked, true);
  const PixelSet ignored = rectangle(grid, 0, 15, 10, 20);
  labels = painted(labels, grid, ignored, {kPlaneIgnore}, PaintMode::over);
  std::vector<std::int32_t> plane_of(grid.pixels(), 0);
  for (const std::uint32_t pixel : rectangle(grid, 5, 0, 30, 10)) plane_of[pixel] = 1;
  for (const std::uint32_t pixel : rectangle(grid, 0, 10, 30, 20)) plane_of[pixel] = 2;
  const Label classes[] = {Label::h, Label::unknown};
  labels = from_segmentation(labels, grid, plane_of, classes);
  ASSERT_EQ(labels.planes.size(), 3u);
  EXPECT_EQ(pixels_of_plane(labels, 1), rectangle(grid, 0, 0, 10, 10));
  EXPECT_EQ(pixels_of_plane(labels, 2).size(), 300 - ignored.size());
  EXPECT_EQ(pixels_of_plane(labels, kPlaneIgnore), ignored);
  EXPECT_EQ(pixels_of_plane(labels, 3), rectangle(grid, 10, 0, 30, 10));  // 1 was taken
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
    revert_edit(labels, edit);
    ASSERT_NO_FATAL_FAILURE(expect_same(labels, before)) << step;
    apply_edit(labels, edit);
  }
}

TEST(LabelEdits, NothingChangedIsAnEmptyEdit) {
  Random random(2);
  const FrameLabels labels = after_random_gesture(blank_labels(8, 6), random);
  EXPECT_TRUE(make_edit(0, "nothing", labels, labels).empty());
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

TEST(LabelEdits, TheOrderInWhichPlanesWereListedIsNoChange) {
  FrameLabels before = blank_labels(8, 6);
  before.planes = {LabelPlane{.id = 9}, LabelPlane{.id = 2}};
  FrameLabels after = before;
  std::swap(after.planes[0], after.planes[1]);
  EXPECT_TRUE(make_edit(0, "sorted", before, after).empty());
}

using test::pixel_at;

/// A wall 1 m away with P1 on those pixels.
struct Wall {
  LabelGrid grid;
  FrameLabels labels;
};
Wall wall_with(LabelGrid grid, const PixelSet& pixels) {
  FrameLabels labels =
      painted(empty_labels(grid, "hash"), grid, pixels, {.plane = 1}, PaintMode::over);
  return {std::move(grid), std::move(labels)};
}

PixelSet without(PixelSet pixels, const PixelSet& less) {
  std::erase_if(pixels, [&](std::uint32_t i) { return std::ranges::binary_search(less, i); });
  return pixels;
}

TEST(Finish, HolesAreFilledWithWhatLiesOnThePlaneAndNothingElse) {
  const auto depth = [](int u, int v) {  // a box stands in the second hole
    return u >= 24 && u < 30 && v >= 10 && v < 16 ? 0.8 : 1.0;
  };
  const LabelGrid grid = make_label_grid(test::frame_of(40, 30, depth), Gravity{});
  const PixelSet hole = rectangle(grid, 8, 8, 14, 20), box = rectangle(grid, 24, 10, 30, 16);
  const Wall wall = wall_with(grid, without(without(rectangle(grid, 2, 2, 38, 28), hole), box));
  const Finish finish = fill_holes(wall.labels, wall.grid, 1, {});
  EXPECT_EQ(finish.adds, hole);
  EXPECT_TRUE(finish.takes.empty());
  const FrameLabels after = finished(wall.labels, wall.grid, 1, finish);
  EXPECT_EQ(pixels_of_plane(after, 1).size(), pixels_of_plane(wall.labels, 1).size() + hole.size());
}

TEST(Finish, AHoleThatHasAnotherLabelKeepsIt) {
  const LabelGrid grid = test::wall_grid();
  const PixelSet hole = rectangle(grid, 8, 8, 14, 20);
  Wall wall = wall_with(grid, without(rectangle(grid, 2, 2, 38, 28), hole));
  wall.labels = painted(wall.labels, grid, hole, {.plane = kPlaneIgnore}, PaintMode::over);
  EXPECT_TRUE(fill_holes(wall.labels, wall.grid, 1, {}).empty());
}

TEST(Finish, ASmoothedBorderLosesItsTeethAndItsNotches) {
  const LabelGrid grid = test::wall_grid();
  const PixelSet tooth = rectangle(grid, 18, 5, 19, 10), notch = rectangle(grid, 25, 10, 26, 14);
  PixelSet pixels = without(rectangle(grid, 2, 10, 38, 28), notch);
  std::ranges::copy(tooth, std::back_inserter(pixels));
  std::ranges::sort(pixels);
  const Wall wall = wall_with(grid, pixels);
  const Finish finish = smooth_border(wall.labels, wall.grid, 1, {});
  PixelSet lost, filled;
  std::ranges::set_intersection(finish.takes, tooth, std::back_inserter(lost));
  std::ranges::set_intersection(finish.adds, notch, std::back_inserter(filled));
  EXPECT_GE(lost.size(), 4u);
  EXPECT_GE(filled.size(), 3u);
  EXPECT_LT(finish.takes.size() + finish.adds.size(), 30u);  // and straight borders stay
}

TEST(Finish, APlaneGrowsToWhereAnotherSurfaceBegins) {
  const auto depth = [](int u, int) { return u < 30 ? 1.0 : 1.3; };  // the wall ends at a step
  const LabelGrid grid = make_label_grid(test::frame_of(40, 30, depth), Gravity{});
  const Wall wall = wall_with(grid, rectangle(grid, 5, 5, 20, 20));
  const FrameLabels after =
      finished(wall.labels, wall.grid, 1, grow_to_border(wall.labels, wall.grid, 1, {}));
  for (int u = 0; u < 40; ++u) EXPECT_EQ(after.plane.at(u, 25), u < 30 ? 1 : 0) << "column " << u;
}

TEST(Finish, SpecksBelowASizeAreDroppedAndTheLargestPartIsKept) {
  const LabelGrid grid = test::wall_grid();  // a pixel is 1 cm2
  PixelSet pixels = rectangle(grid, 0, 0, 10, 10);
  std::ranges::copy(rectangle(grid, 20, 0, 22, 2), std::back_inserter(pixels));    // 4 cm2
  std::ranges::copy(rectangle(grid, 30, 20, 36, 26), std::back_inserter(pixels));  // 36 cm2
  std::ranges::sort(pixels);
  const Wall wall = wall_with(grid, pixels);
  EXPECT_EQ(drop_specks(wall.labels, grid, 1, 10e-4).takes, rectangle(grid, 20, 0, 22, 2));
  EXPECT_EQ(drop_specks(wall.labels, grid, 1, 1).takes.size(), 4u + 36u);
}

TEST(Finish, ALockedPlaneIsLeftAlone) {
  const LabelGrid grid = test::wall_grid();
  const Wall wall = wall_with(grid, rectangle(grid, 5, 5, 20, 20));
  const FrameLabels locked = with_flag(wall.labels, 1, PlaneFlag::locked, true);
  EXPECT_THROW(grow_to_border(locked, grid, 1, {}), Error);
  EXPECT_THROW(drop_specks(locked, grid, 1, 1), Error);
}

}  // namespace
}  // namespace planescope::labels
