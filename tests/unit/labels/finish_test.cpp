#include "core/labels/wand/wand.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "core/labels/edit/operations.hpp"
#include "core/model/error.hpp"
#include "small_frames.hpp"

namespace planescope::labels {
namespace {

using test::pixel_at;
using test::rectangle;

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
