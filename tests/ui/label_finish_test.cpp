// The label mode's gestures that finish a surface: each shown first, each one step of undo.

#include <cmath>

#include "app/desktop/look.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct LabelFinish : LabelDesktop {
  std::size_t pixels_of(int plane) const { return labels::pixels_of_plane(labels(), plane).size(); }
  const LabelView& view() const { return state().view.label; }
  std::size_t undo_steps() const { return window.store().undo_count(); }
  /// The floor of the sample by the wand, with a hole of 20 x 20 pixels in it.
  void floor_with_a_hole() {
    window.run("label.wand", "320,330");
    window.run("label.accept");
    window.run("label.erase");
    window.run("label.area", "image over 310,295 330,295 330,315 310,315");
    window.run("label.erase");
    window.run("label.plane", "1");
  }
};

TEST_F(LabelFinish, HolesAreShownThenFilledInOneStepOfUndo) {
  floor_with_a_hole();
  const std::size_t before = pixels_of(1), steps = undo_steps();
  window.run("label.fill");
  EXPECT_GE(view().finish->finish.adds.size(), 400u);
  EXPECT_EQ(pixels_of(1), before);
  window.run("label.accept");
  EXPECT_FALSE(view().finish);
  EXPECT_GE(pixels_of(1), before + 400);
  EXPECT_EQ(undo_steps(), steps + 1);
  window.run("label.undo");
  EXPECT_EQ(pixels_of(1), before);
}

TEST_F(LabelFinish, EscapeLeavesWhatIsShown) {
  floor_with_a_hole();
  const std::size_t before = pixels_of(1);
  window.run("label.fill");
  window.run("label.cancel");
  EXPECT_FALSE(view().finish);
  window.run("label.accept");
  EXPECT_EQ(pixels_of(1), before);
  EXPECT_EQ(state().view.message, "nothing to accept");
}

TEST_F(LabelFinish, AStrokeGrowsToTheBorderOfItsSurface) {
  window.run("label.stroke", "image over 20 300,330 360,330");
  const std::size_t stroke = pixels_of(1);
  window.run("label.grow");
  window.run("label.accept");
  const std::size_t grown = pixels_of(1);
  EXPECT_GT(grown, 4 * stroke);
  window.run("label.plane.new");
  window.run("label.erase");
  window.run("label.wand", "320,330");
  const std::size_t wand = view().wand.found->pixels.size();
  EXPECT_NEAR(static_cast<double>(grown), static_cast<double>(wand),
              0.1 * static_cast<double>(wand));
}

TEST_F(LabelFinish, SpecksBelowASizeGoAndThePlaneStays) {
  floor_with_a_hole();
  window.run("label.plane", "2");
  window.run("label.stroke", "image over 20 150,330");
  window.run("label.stroke", "image over 1 320,330");
  const std::size_t all = pixels_of(2);
  window.run("label.specks", "5");
  window.run("label.accept");
  EXPECT_LT(pixels_of(2), all);
  EXPECT_GT(pixels_of(2), all / 2);
  window.run("label.specks");
  EXPECT_FALSE(view().finish);
  EXPECT_EQ(state().view.message, "P2 has no specks below 20 cm²");
}

TEST_F(LabelFinish, TheWandStaysInItsLassoUntilItsPlaneIsAccepted) {
  window.run("label.wand", "320,330");
  const std::size_t all = view().wand.found->pixels.size();
  window.run("label.wand.within", "image 300,300 360,300 360,360 300,360");
  const labels::PixelSet inside = view().wand.found->pixels;
  EXPECT_LT(inside.size(), all);
  for (const std::uint32_t pixel : inside) {
    EXPECT_TRUE(pixel % 640 >= 300 && pixel % 640 < 360);
    EXPECT_TRUE(pixel / 640 >= 300 && pixel / 640 < 360);
  }
  window.run("label.accept");
  EXPECT_EQ(labels::pixels_of_plane(labels(), 1), inside);
  EXPECT_EQ(view().bound, nullptr);
}

TEST_F(LabelFinish, AltAndADragDrawTheLassoWithTheWandInHand) {
  const auto camera = state().view.camera;
  play(R"({"drag": "image", "from": [0.4, 0.6], "to": [0.6, 0.8], "hold": "Alt"})");
  EXPECT_EQ(state().view.camera.has_value(), camera.has_value());
  EXPECT_NE(view().bound, nullptr);
  play(R"({"key": "Escape"})");
  EXPECT_EQ(view().bound, nullptr);
}

TEST_F(LabelFinish, DistancesToTheActivePlaneAreShownWithTheirScale) {
  window.run("label.wand", "320,330");
  window.run("label.accept");
  EXPECT_FALSE(residual_of(state()));
  window.run("label.residual");
  const std::optional<render::Residual> residual = residual_of(state());
  ASSERT_TRUE(residual);
  EXPECT_EQ(residual->name, "P1");
  EXPECT_DOUBLE_EQ(residual->most_m, 2 * view().wand_options.tolerance_m);
  const LabelFrame& frame = *state().label_frame();
  const std::vector<render::Rgba> tints =
      render::label_tints(frame.grid, label_look_of(state()), 0.5);
  std::size_t before = 0, behind = 0;
  for (const std::uint32_t i : labels::pixels_of_plane(labels(), 1)) {
    const double d = residual->distance_m(frame.grid.points[i]) / residual->most_m;
    if (d > 0.3 && d < 1) before += tints[i].r > tints[i].b;
    if (d < -0.3 && d > -1) behind += tints[i].b > tints[i].r;
    if (std::abs(d) > 1) {
      EXPECT_GT(tints[i].a, 0);  // its own: to be trimmed
    }
  }
  EXPECT_GT(before, 10u);
  EXPECT_GT(behind, 10u);
}

}  // namespace
}  // namespace planescope::desktop
