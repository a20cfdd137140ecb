// The plane wand, and gestures that finish a plane.

#include "core/labels/wand/wand.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <string>

#include "core/labels/edit/operations.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/model/error.hpp"
#include "core/model/random.hpp"
#include "small_frames.hpp"
#include "support/label_drafts.hpp"

namespace planescope::labels {
namespace {

using test::TrueFrame;

/// The connected part of a true plane that contains the middle pixel of its list.
PixelSet largest_part(const TrueFrame& view, int plane) {
  const auto parts = connected_parts(view.grid, pixels_of_plane(view.truth, plane), 4);
  return *std::ranges::max_element(parts, {}, &PixelSet::size);
}

TrueFrame scene(const std::string& name, std::uint64_t seed = 1) {
  const lab::Scene scene = lab::make_scene(name, seed);
  return test::view_of(scene, scene.camera);
}

TEST(Wand, OneClickSelectsAPlaneAndLittleElse) {
  for (const char* name : {"stairs", "boxes", "corner"}) {
    const TrueFrame view = scene(name);
    for (const LabelPlane& plane : view.truth.planes) {
      if (pixels_of_plane(view.truth, plane.id).size() < 6000) continue;
      const PixelSet part = largest_part(view, plane.id);
      const auto result =
          grow_plane(view.grid, nullptr, std::array{deepest_pixel(part, view.grid)}, {});
      ASSERT_TRUE(result) << name << " P" << plane.id;
      EXPECT_GT(test::iou(result->pixels, part), 0.85) << name << " P" << plane.id;
      EXPECT_EQ(result->label, plane.label) << name << " P" << plane.id;
      EXPECT_GT(result->plane.normal.dot(plane.normal), 0.999) << name << " P" << plane.id;
    }
  }
}

TEST(Wand, TheSameClickGivesTheSameAscendingMeasuredPixels) {
  const TrueFrame view = scene("boxes");
  const std::array click{deepest_pixel(largest_part(view, 1), view.grid)};
  const auto result = grow_plane(view.grid, nullptr, click, {});
  const auto again = grow_plane(view.grid, nullptr, click, {});
  ASSERT_TRUE(result && again);
  EXPECT_EQ(std::ranges::adjacent_find(result->pixels, std::ranges::greater_equal{}),
            result->pixels.end());
  for (const std::uint32_t i : result->pixels) ASSERT_TRUE(view.grid.measured[i]);
  EXPECT_EQ(result->fragment_pixels, std::vector<std::size_t>{result->pixels.size()});
  EXPECT_EQ(again->pixels, result->pixels);
  EXPECT_EQ(again->plane.normal, result->plane.normal);
}

std::optional<WandResult> grow(const LabelGrid& grid,
                               int u,
                               int v,
                               const WandOptions& options = {},
                               const FrameLabels* labels = nullptr,
                               std::string* why_not = nullptr) {
  return grow_plane(grid, labels, std::array{test::pixel_at(grid, u, v)}, options, why_not);
}

/// A floor and a wall that meet at row `crease`, without noise, 0.5 m below and 1 m ahead of the
/// camera.
LabelGrid floor_and_wall(int holes_every = 0) {
  return make_label_grid(test::frame_of(160, 120,
                                        [&](int u, int v) {
                                          if (holes_every > 0 && (u + 3 * v) % holes_every == 0)
                                            return 0.0;
                                          const double down = (v - 60) / 100.0;
                                          return down * 1.0 > 0.3 ? 0.3 / down : 1.0;
                                        }),
                         Gravity{});
}

TEST(Wand, NeitherSideOfACreaseBleedsOntoTheOther) {
  const LabelGrid grid = floor_and_wall();
  const auto floor = grow(grid, 80, 110);
  const auto wall = grow(grid, 80, 40);
  ASSERT_TRUE(floor && wall);
  EXPECT_EQ(floor->label, Label::h);
  EXPECT_EQ(wall->label, Label::v);
  // The crease at row 90 belongs to both.
  EXPECT_GE(floor->pixels.front() / 160, 90u);
  EXPECT_LE(floor->pixels.front() / 160, 91u);
  EXPECT_LE(wall->pixels.back() / 160, 90u);
  EXPECT_GE(wall->pixels.back() / 160, 89u);
  EXPECT_GT(floor->pixels.size(), 0.97 * 29 * 160);
  EXPECT_GT(wall->pixels.size(), 0.97 * 90 * 160);
}

TEST(Wand, HolesDoNotSplitASurface) {
  const LabelGrid grid = floor_and_wall(5);
  const auto wall = grow(grid, 80, 40);
  ASSERT_TRUE(wall);
  EXPECT_GT(wall->pixels.size(), 0.95 * 0.8 * 90 * 160);
}

TEST(Wand, AClickInAHoleFindsTheSurfaceAroundIt) {
  const LabelGrid grid = make_label_grid(
      test::frame_of(80, 60, [](int u, int v) { return u == 40 && v == 30 ? 0.0 : 1.0; }),
      Gravity{});
  const auto result = grow(grid, 40, 30);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pixels.size(), 80u * 60 - 1);
}

TEST(Wand, AClickOnANoisyPixelFindsTheSurfaceAndFillsTheSpeck) {
  const LabelGrid grid = make_label_grid(
      test::frame_of(80, 60, [](int u, int v) { return u == 40 && v == 30 ? 1.011 : 1.0; }),
      Gravity{});
  const auto result = grow(grid, 40, 30);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pixels.size(), 80u * 60);
}

// A wall with a dent of 30 x 20 pixels, less than one and a half tolerances deep, or with a box
// there.
LabelGrid wall_with(double out_m) {
  return make_label_grid(test::frame_of(160, 120,
                                        [=](int u, int v) {
                                          const bool dent = u >= 60 && u < 90 && v >= 50 && v < 70;
                                          return dent ? 1.0 - out_m : 1.0;
                                        }),
                         Gravity{});
}

TEST(Wand, FillsADentButNotTheHoleOfABox) {
  const LabelGrid bowed = wall_with(0.011), box = wall_with(0.02);
  const std::array click{test::pixel_at(bowed, 20, 20)};
  const auto whole = grow_plane(bowed, nullptr, click, {});
  const auto around = grow_plane(box, nullptr, click, {});
  ASSERT_TRUE(whole && around);
  EXPECT_EQ(whole->pixels.size(), 160u * 120);
  EXPECT_LE(around->pixels.size(), 160u * 120 - 30 * 20);
}

TEST(Wand, ALargeToleranceDoesNotGrowWithSmallNoise) {
  // Noise like that at 2 m, three times that at short range. The right half is 3 cm behind the
  // left.
  LabelGrid grid = make_label_grid(
      test::frame_of(160, 120, [](int u, int) { return u < 80 ? 2.0 : 2.03; }), Gravity{});
  for (float& sigma : grid.sigma_m) sigma = 0.0069f;
  WandOptions options;
  options.use_color = false;
  const std::array click{test::pixel_at(grid, 20, 60)};
  options.tolerance_m = 0.02;
  const auto found = grow_plane(grid, nullptr, click, options);
  ASSERT_TRUE(found);
  EXPECT_LE(found->pixels.size(), 85u * 120);
}

TEST(Wand, ExplainsWhyThereIsNoPlane) {
  std::string why;
  const LabelGrid hole = make_label_grid(
      test::frame_of(80, 60, [](int u, int) { return u < 40 ? 1.0 : 0.0; }), Gravity{});
  EXPECT_FALSE(grow(hole, 70, 30, {}, nullptr, &why));
  EXPECT_EQ(why, "no measurement there");
  const LabelGrid rough = make_label_grid(
      test::frame_of(80, 60, [](int u, int v) { return 1 + 0.3 * ((u * 7 + v * 13) % 10); }),
      Gravity{});
  EXPECT_FALSE(grow(rough, 40, 30, {}, nullptr, &why));
  EXPECT_EQ(why, "no plane there");
}

TEST(Wand, KeepsLabeledPixelsByDefault) {
  const LabelGrid grid = test::wall_grid(80, 60);
  const FrameLabels labels = painted(empty_labels(grid, ""), grid,
                                     test::rectangle(grid, 0, 0, 20, 60), {1}, PaintMode::over);
  WandOptions options;
  const std::array click{test::pixel_at(grid, 50, 30)};
  EXPECT_EQ(grow_plane(grid, &labels, click, options)->pixels.size(), 60u * 60);
  options.take_labeled = true;
  EXPECT_EQ(grow_plane(grid, &labels, click, options)->pixels.size(), 80u * 60);
  const FrameLabels locked = edited(labels, grid, set_flag, 1, PlaneFlag::locked, true);
  EXPECT_EQ(grow_plane(grid, &locked, click, options)->pixels.size(), 60u * 60);
  std::string why;
  EXPECT_FALSE(grow_plane(grid, &locked, std::array{test::pixel_at(grid, 8, 30)}, options, &why));
  EXPECT_EQ(why, "it already has a label");
}

TEST(Wand, LaterSeedsAddFragmentsOfTheSamePlaneAndNothingElse) {
  // A pillar in front of a wall splits it.
  const LabelGrid grid = make_label_grid(
      test::frame_of(120, 60, [](int u, int) { return u >= 50 && u < 70 ? 0.7 : 1.0; }), Gravity{});
  const std::array seeds{test::pixel_at(grid, 20, 30), test::pixel_at(grid, 100, 30),
                         test::pixel_at(grid, 60, 30)};
  const auto result = grow_plane(grid, nullptr, seeds, {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pixels.size(), 100u * 60);
  EXPECT_EQ(result->fragment_pixels, (std::vector<std::size_t>{50 * 60, 50 * 60, 0}));
}

TEST(Wand, ColorDecidesIfDepthIsRagged) {
  // A board's right border: 5 columns that neither fit it nor are far from it; two of them have the
  // board's color.
  Frame frame = test::frame_of(120, 80, [](int u, int) {
    return u < 60 ? 1.0 : u < 65 ? 1.012 : 1.3;
  });
  frame.color = Image8(120, 80, 3);
  for (int v = 0; v < 80; ++v)
    for (int u = 0; u < 120; ++u)
      for (int c = 0; c < 3; ++c) frame.color.at(u, v, c) = u < 62 ? 200 : 40;
  frame.color_aligned = true;
  const LabelGrid grid = make_label_grid(frame, Gravity{});
  WandOptions options;
  const std::array click{test::pixel_at(grid, 20, 40)};
  const auto with_color = grow_plane(grid, nullptr, click, options);
  options.use_color = false;
  const auto without = grow_plane(grid, nullptr, click, options);
  ASSERT_TRUE(with_color && without);
  EXPECT_EQ(without->pixels.size(), 60u * 80);
  EXPECT_EQ(with_color->pixels.size(), 62u * 80);
}

TEST(Wand, StaysWithinTheLassoDrawnAroundIt) {
  const LabelGrid grid = test::wall_grid();
  std::vector<std::uint8_t> within(grid.pixels(), 0);
  const PixelSet left = test::rectangle(grid, 0, 0, 20, 30);
  for (const std::uint32_t i : left) within[i] = 1;
  WandOptions options;
  options.within = within;
  const auto result = grow(grid, 10, 15, options);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->pixels, left);
  std::string why;
  EXPECT_FALSE(grow(grid, 30, 15, options, nullptr, &why));
  EXPECT_EQ(why, "it is outside the lasso");
}

using test::pixel_at;
using test::rectangle;

/// A wall at 1 m, with P1 on these pixels.
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

TEST(Finish, HolesAreFilledOnlyWithPixelsOnThePlane) {
  const auto depth = [](int u, int v) {  // a box covers the second hole
    return u >= 24 && u < 30 && v >= 10 && v < 16 ? 0.8 : 1.0;
  };
  const LabelGrid grid = make_label_grid(test::frame_of(40, 30, depth), Gravity{});
  const PixelSet hole = rectangle(grid, 8, 8, 14, 20), box = rectangle(grid, 24, 10, 30, 16);
  const Wall wall = wall_with(grid, without(without(rectangle(grid, 2, 2, 38, 28), hole), box));
  const Finish finish = fill_holes(wall.labels, wall.grid, 1, {});
  EXPECT_EQ(finish.adds, hole);
  EXPECT_TRUE(finish.takes.empty());
  const FrameLabels after = edited(wall.labels, wall.grid, finish_plane, wall.grid, 1, finish);
  EXPECT_EQ(pixels_of_plane(after, 1).size(), pixels_of_plane(wall.labels, 1).size() + hole.size());
}

TEST(Finish, AHoleWithAnotherLabelKeepsIt) {
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
  EXPECT_LT(finish.takes.size() + finish.adds.size(), 30u);  // and straight borders do not change
}

TEST(Finish, APlaneGrowsToTheNextSurface) {
  const auto depth = [](int u, int) { return u < 30 ? 1.0 : 1.3; };  // the wall ends at a step
  const LabelGrid grid = make_label_grid(test::frame_of(40, 30, depth), Gravity{});
  const Wall wall = wall_with(grid, rectangle(grid, 5, 5, 20, 20));
  const FrameLabels after = edited(wall.labels, wall.grid, finish_plane, wall.grid, 1,
                                   grow_to_border(wall.labels, wall.grid, 1, {}));
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

TEST(Finish, ALockedPlaneDoesNotChange) {
  const LabelGrid grid = test::wall_grid();
  const Wall wall = wall_with(grid, rectangle(grid, 5, 5, 20, 20));
  const FrameLabels locked = edited(wall.labels, wall.grid, set_flag, 1, PlaneFlag::locked, true);
  EXPECT_THROW(grow_to_border(locked, grid, 1, {}), Error);
  EXPECT_THROW(drop_specks(locked, grid, 1, 1), Error);
}

}  // namespace
}  // namespace planescope::labels
