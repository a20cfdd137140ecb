// Labels as they are drawn: colours, what stands out, what is left out.

#include "render/label_scene.hpp"

#include <gtest/gtest.h>

#include "core/labels/edit/operations.hpp"
#include "core/labels/edit/selection.hpp"
#include "render/palette.hpp"

namespace planescope::render {
namespace {

/// A wall of 40 x 30 pixels, one of which was not measured; P1 on its left half, P2 at its right
/// edge.
struct LabelScene : testing::Test {
  labels::LabelGrid grid;
  std::vector<Vec3f> world;
  std::shared_ptr<FrameLabels> labels;

  void SetUp() override {
    Frame frame;
    frame.depth = Image16(40, 30, 1, 1000);
    frame.depth.at(0, 0) = 0;
    frame.depth_unit_m = 0.001;
    frame.intrinsics.width = 40;
    frame.intrinsics.height = 30;
    frame.intrinsics.fx = frame.intrinsics.fy = 40;
    frame.intrinsics.cx = 20;
    frame.intrinsics.cy = 15;
    Gravity gravity;
    gravity.direction = Vec3d::UnitY();
    grid = labels::make_label_grid(frame, gravity);
    world = grid.points;
    labels::PixelSet left, right;
    for (std::uint32_t i = 0; i < 40 * 30; ++i) (i % 40 < 20 ? left : right).push_back(i);
    std::erase_if(right, [](std::uint32_t i) { return i % 40 < 35; });
    labels = std::make_shared<FrameLabels>(labels::empty_labels(grid, "hash"));
    *labels = labels::painted(*labels, grid, left, {.plane = 1}, labels::PaintMode::over);
    *labels = labels::painted(*labels, grid, right, {.plane = 2}, labels::PaintMode::over);
  }
  LabelLook look() const {
    LabelLook look;
    look.labels = labels;
    return look;
  }
  DrawPoints points() const {
    DrawPoints points = label_points(grid, world, labels::shown_pixels(*labels));
    color_label_points(points, label_ground(grid, Backdrop::color), grid, look());
    return points;
  }
  std::vector<Rgba> tints(const LabelLook& of) const { return label_tints(grid, of, 1); }
  static std::size_t at(int u, int v) { return static_cast<std::size_t>(v * 40 + u); }
};

TEST_F(LabelScene, DrawsEveryMeasuredPointAndNamesItsPixel) {
  const DrawPoints drawn = points();
  ASSERT_EQ(drawn.positions.size(), grid.measured_count);
  ASSERT_EQ(drawn.colors.size(), drawn.positions.size());
  for (std::size_t k = 0; k < drawn.ids.size(); ++k)
    EXPECT_EQ(drawn.positions[k], world[drawn.ids[k] - 1]);
}

TEST_F(LabelScene, LeavesHiddenPlanesOut) {
  *labels = labels::with_flag(*labels, 2, labels::PlaneFlag::hidden, true);
  EXPECT_EQ(points().positions.size(),
            grid.measured_count - labels::pixels_of_plane(*labels, 2).size());
  EXPECT_EQ(tints(look())[at(38, 5)].a, 0);
  EXPECT_EQ(label_places(*labels, grid).size(), 1u);
}

TEST_F(LabelScene, TellsPlanesApartAndTheActiveOneFromTheOthers) {
  LabelLook active = look();
  active.plane = 1;
  const std::vector<Rgba> tint = tints(active);
  EXPECT_EQ(tint[at(25, 5)].a, 0) << "unlabelled";
  EXPECT_EQ(tint[at(5, 5)].r, plane_color(1).r);
  EXPECT_EQ(tint[at(38, 5)].r, plane_color(2).r);
  EXPECT_GT(tint[at(5, 5)].a, tint[at(38, 5)].a);
}

TEST_F(LabelScene, ShowsClassesInTheirColours) {
  *labels = labels::with_class(*labels, 1, Label::h);
  LabelLook classes = look();
  classes.show_class = true;
  EXPECT_EQ(tints(classes)[at(5, 5)].b, label_color(Label::h).b);
  EXPECT_EQ(tints(classes)[at(38, 5)].b, label_color(Label::v).b);
}

TEST_F(LabelScene, APreviewIsSeenHoweverFaintLabelsAre) {
  LabelLook shown = look();
  const labels::PixelSet preview{static_cast<std::uint32_t>(at(5, 5)), 99999};
  shown.preview = preview;
  const std::vector<Rgba> faint = label_tints(grid, shown, 0);
  EXPECT_GT(faint[at(5, 5)].a, 150);
  EXPECT_EQ(faint[at(6, 5)].a, 0);
  const Rgba adds = faint[at(5, 5)];
  shown.preview_takes = true;
  EXPECT_NE(label_tints(grid, shown, 0)[at(5, 5)], adds);
}

TEST_F(LabelScene, PaintsOutlinesBetweenPlanesButNotAroundHoles) {
  Image8 picture = label_ground(grid, Backdrop::color);
  const Image8 ground = picture;
  paint_labels(picture, grid, look(), 0);
  EXPECT_NE(picture.at(19, 5), ground.at(19, 5));
  EXPECT_EQ(picture.at(0, 1), ground.at(0, 1));
  EXPECT_EQ(picture.at(10, 5), ground.at(10, 5));
}

TEST_F(LabelScene, NamesStandDeepInTheirPlanes) {
  const std::vector<LabelPlace> places = label_places(*labels, grid);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(static_cast<double>(places[0].pixel % 40), 10, 5);
  EXPECT_NEAR(static_cast<double>(places[1].pixel % 40), 37, 1);
}

}  // namespace
}  // namespace planescope::render
