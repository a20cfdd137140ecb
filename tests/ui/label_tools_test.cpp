// The tools of label mode: gestures in both views, the wand, keys, finishing a surface.

#include <algorithm>
#include <cmath>

#include "app/desktop/look.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct LabelTools : LabelDesktop {
  std::size_t labeled() const {
    return labels().plane.data.size() -
           static_cast<std::size_t>(std::ranges::count(labels().plane.data, 0));
  }
  labels::PixelSet stroke_pixels() const {
    labels::PixelSet pixels;
    for (const labels::LabelRun& run : view().stroke->runs)
      for (std::uint32_t i = 0; i < run.count; ++i) pixels.push_back(run.first + i);
    return pixels;
  }
  void key(const std::string& name) { play(R"({"key": ")" + name + R"("})"); }
  /// Moves the mouse to a position on the image, in fractions of its size.
  void move(float x, float y) {
    const WidgetRect image = window.shell.widgets().at("image");
    window.shell.input().push({.type = InputEvent::Type::move,
                               .x = image.min.x + x * (image.max.x - image.min.x),
                               .y = image.min.y + y * (image.max.y - image.min.y)});
    window.stage.draw_frame();
    window.stage.draw_frame();
  }
  void button(bool down) {
    window.shell.input().push({.type = InputEvent::Type::button, .down = down});
    window.stage.draw_frame();
  }
};

const std::string kStroke = "image over 20 300,330 360,330";

TEST_F(LabelTools, AStrokeCreatesAPlaneInOneUndoStepAndActivatesIt) {
  window.run("label.stroke", kStroke);
  const std::size_t first = pixels_of(1);
  EXPECT_GT(first, 1000u);
  EXPECT_EQ(view().plane, 1);
  EXPECT_EQ(store().history(1).front().title, "Brush P1");
  window.run("label.stroke", "image over 20 200,330");
  EXPECT_GT(pixels_of(1), first);
  window.run("label.undo");
  EXPECT_EQ(pixels_of(1), first);
  window.run("label.undo");
  EXPECT_EQ(labeled(), 0u);
  EXPECT_TRUE(labels().planes.empty());
  window.run("label.redo");
  EXPECT_EQ(pixels_of(1), first);
}

TEST_F(LabelTools, AddingKeepsOtherLabelsAndSubtractingRemovesOnlyItsOwn) {
  window.run("label.stroke", kStroke);
  const std::size_t first = pixels_of(1);
  window.run("label.plane", "2");
  window.run("label.stroke", "image add 30 300,330 360,330");
  EXPECT_GT(pixels_of(2), 500u);
  window.run("label.stroke", "image subtract 200 320,330");
  EXPECT_EQ(pixels_of(1), first);
  EXPECT_EQ(pixels_of(2), 0u);
  EXPECT_EQ(window.refusal("label.stroke", "image subtract 10 320,330"),
            "P2 has no pixels to remove");
}

TEST_F(LabelTools, IgnoreEraseAndClassOnlyCanBePainted) {
  window.run("label.ignore");
  window.run("label.stroke", kStroke);
  EXPECT_GT(pixels_of(kPlaneIgnore), 1000u);
  EXPECT_TRUE(labels().planes.empty());
  window.run("label.erase");
  window.run("label.stroke", kStroke);
  EXPECT_EQ(labeled(), 0u);
  window.run("label.class_only", "v");
  window.run("label.stroke", kStroke);
  EXPECT_EQ(labeled(), 0u);
  EXPECT_GT(std::ranges::count(labels().hv.data, 2), 1000);
}

TEST_F(LabelTools, APreviewShowsTheChangesOfTheStroke) {
  window.run("label.preview", kStroke);
  const labels::PixelSet shown = stroke_pixels();
  window.run("label.stroke", kStroke);
  EXPECT_FALSE(view().stroke);
  EXPECT_EQ(labels::pixels_of_plane(labels(), 1), shown);
}

TEST_F(LabelTools, StrokesInSpaceIncludeHiddenPointsOnlyOnRequest) {
  window.run("camera.side");
  const std::string stroke = "space:800x600 over 80 300,400 500,400";
  window.run("label.preview", stroke);
  const std::size_t hidden = view().hover_hidden, visible = stroke_pixels().size();
  EXPECT_GT(hidden, 100u);
  EXPECT_GT(visible, 100u);
  key("X");
  window.run("label.preview", stroke);
  const labels::PixelSet before = stroke_pixels();
  EXPECT_EQ(before.size(), visible + hidden);
  window.run("label.stroke", stroke);
  EXPECT_EQ(pixels_of(1), visible + hidden);
  window.run("label.undo");
  window.run("camera.orbit", "40,0");
  window.run("label.preview", stroke);
  EXPECT_NE(stroke_pixels(), before) << "it follows the camera";
}

TEST_F(LabelTools, EachWandClickCreatesAPlaneUnlessShiftIsHeld) {
  window.run("label.wand", "320,330");
  ASSERT_TRUE(view().wand.found) << view().wand.why_not;
  const labels::PixelSet shown = view().wand.found->pixels;
  EXPECT_EQ(labeled(), 0u);
  key("Enter");
  EXPECT_EQ(labels::pixels_of_plane(labels(), 1), shown);
  EXPECT_EQ(labels().planes[0].origin, LabelOrigin::wand);
  EXPECT_TRUE(view().wand.seeds.empty());
  const std::size_t first = shown.size();
  window.run("label.stroke", "image subtract 40 320,330");
  EXPECT_LT(pixels_of(1), first);
  window.run("label.wand.add", "320,330");
  window.run("label.accept");
  EXPECT_EQ(labels().planes.size(), 1u);
  window.run("label.stroke", "image subtract 40 320,330");
  window.run("label.wand", "320,330");
  window.run("label.accept");
  EXPECT_EQ(labels().planes.size(), 2u);
  EXPECT_EQ(view().plane, 2);
}

TEST_F(LabelTools, TheWandUsesItsToleranceAndEscapeCancelsIt) {
  window.run("label.wand", "320,330");
  ASSERT_TRUE(view().wand.found);
  const auto before = view().wand.found;
  key("]");
  EXPECT_GT(view().wand_options.tolerance_m, labels::WandOptions{}.tolerance_m);
  EXPECT_NE(view().wand.found, before);
  key("Escape");
  EXPECT_TRUE(view().wand.seeds.empty());
  key("Enter");
  EXPECT_EQ(labeled(), 0u);
}

TEST_F(LabelTools, EnterClosesAPolygonAndBackspaceRemovesItsCorners) {
  window.run("label.tool", "polygon");
  for (const char* corner : {"image 300,300", "image 360,300", "image 360,360", "image 0,0"})
    window.run("label.corner", corner);
  key("Backspace");
  ASSERT_TRUE(view().polygon);
  EXPECT_EQ(view().polygon->corners.size(), 3u);
  key("Enter");
  EXPECT_FALSE(view().polygon);
  EXPECT_NEAR(static_cast<double>(pixels_of(1)), 60 * 60 / 2, 150);
  window.run("label.corner", "image 1,1");
  key("Escape");
  EXPECT_FALSE(view().polygon);
}

TEST_F(LabelTools, APolygonInSpaceIsDiscardedWhenTheViewMoves) {
  for (const char* corner : {"space:800x600 300,300", "space:800x600 500,300"})
    window.run("label.corner", corner);
  window.run("camera.orbit", "30,0");
  window.run("label.corner", "space:800x600 400,400");
  EXPECT_EQ(view().polygon->corners.size(), 1u);
}

TEST_F(LabelTools, ACutSplitsTheActivePlaneInBothViews) {
  window.run("label.area", "image 300,300 360,300 360,360 300,360");
  const std::size_t whole = pixels_of(1);
  window.run("label.cut", "image 330,0 330,479");
  EXPECT_EQ(labels().planes.size(), 2u);
  EXPECT_EQ(pixels_of(1) + pixels_of(2), whole);
  EXPECT_NEAR(static_cast<double>(pixels_of(1)), static_cast<double>(whole) / 2,
              static_cast<double>(whole) / 8);
  window.run("label.undo");
  // The home view has nearly the camera's direction: left and right are the same.
  window.run("label.cut", "image 330,0 330,1");
  EXPECT_EQ(labels().planes.size(), 2u);
  window.run("label.undo");
  window.run("label.cut", "space:800x600 0,0 0,600");
  EXPECT_EQ(labels().planes.size(), 1u);
  EXPECT_EQ(state().view.message, "all of P1 is on one side of the line");
}

TEST_F(LabelTools, AreSelectedByTheirKeys) {
  const std::pair<const char*, LabelTool> tools[] = {
      {"B", LabelTool::brush},         {"R", LabelTool::rectangle}, {"L", LabelTool::lasso},
      {"Shift+L", LabelTool::polygon}, {"Shift+S", LabelTool::cut}, {"W", LabelTool::wand}};
  for (const auto& [name, tool] : tools) {
    key(name);
    EXPECT_EQ(view().tool, tool) << name;
  }
  key("7");
  EXPECT_EQ(view().plane, 7);
  window.run("label.stroke", kStroke);
  EXPECT_EQ(pixels_of(7), labeled());
  key("3");
  window.run("label.stroke", "image over 20 200,330");
  key("Tab");
  EXPECT_EQ(view().plane, 7);
  key("Tab");
  EXPECT_EQ(view().plane, 3);
  key("Shift+Tab");
  EXPECT_EQ(view().plane, 7);
  key("N");
  EXPECT_EQ(view().plane, 0);
  window.run("label.hover", "200,330");
  key("P");
  EXPECT_EQ(view().plane, 3);
  key("0");
  EXPECT_EQ(view().paints, Paints::erase);
  key("I");
  EXPECT_EQ(view().paints, Paints::ignore);
  key("I");
  EXPECT_EQ(view().paints, Paints::plane);
}

TEST_F(LabelTools, TabSelectsTheNextPlaneAndDoesNotFocusASlider) {
  window.run("label.stroke", kStroke);
  window.run("label.plane", "2");
  window.run("label.stroke", "image over 20 200,330");
  play(R"({"drag": "image.opacity", "from": [0.5, 0.5], "to": [0.6, 0.5]}, {"key": "Tab"})");
  EXPECT_EQ(view().plane, 1);
  EXPECT_FALSE(ImGui::GetIO().WantTextInput);
  key("B");
  EXPECT_EQ(view().tool, LabelTool::brush);
}

TEST_F(LabelTools, ABrushDraggedOverTheImagePaints) {
  key("B");
  play(R"({"drag": "image", "from": [0.45, 0.68], "to": [0.55, 0.68]})");
  const std::size_t painted = pixels_of(1);
  EXPECT_GT(painted, 500u);
  EXPECT_EQ(store().undo_count(), 1u);
  play(R"({"drag": "image", "from": [0.45, 0.68], "to": [0.55, 0.68], "hold": "Alt"})");
  EXPECT_LT(pixels_of(1), painted / 4);
}

TEST_F(LabelTools, EscapeCancelsAStroke) {
  key("B");
  move(0.45f, 0.68f);
  button(true);
  move(0.55f, 0.68f);
  EXPECT_TRUE(view().stroke);
  key("Escape");
  EXPECT_FALSE(view().stroke);
  move(0.5f, 0.7f);
  button(false);
  window.stage.draw_frame();
  EXPECT_EQ(labeled(), 0u);
}

TEST_F(LabelTools, AStrokeReleasedWithAnotherToolIsDiscarded) {
  for (const char* away : {"W", "Ctrl+L"}) {
    key("B");
    move(0.45f, 0.68f);
    button(true);
    move(0.55f, 0.68f);
    key(away);
    button(false);
    window.stage.draw_frame();
    key(away == std::string("W") ? "B" : away);
    window.stage.draw_frame();
    EXPECT_EQ(labeled(), 0u) << away;
  }
}

TEST_F(LabelTools, ARectangleCanBeDraggedInSpace) {
  key("R");
  play(R"({"drag": "view3d", "from": [0.45, 0.5], "to": [0.6, 0.65]})");
  EXPECT_GT(labeled(), 500u);
  EXPECT_EQ(store().history(1).front().title, "Rectangle P1");
}

TEST_F(LabelTools, AWandClickPreviewsAPlaneAndADoubleClickCreatesIt) {
  play(R"({"click": "image", "at": [0.5, 0.68]})");
  EXPECT_TRUE(view().wand.found) << view().wand.why_not;
  key("Escape");
  play(R"({"click": "view3d", "at": [0.5, 0.6]})");
  EXPECT_TRUE(view().wand.found) << view().wand.why_not;
  key("Escape");
  play(R"({"click": "image", "at": [0.5, 0.68], "double": true})");
  EXPECT_EQ(labels().planes.size(), 1u);
  EXPECT_TRUE(view().wand.seeds.empty());
}

TEST_F(LabelTools, TheMousePositionIsShownInBothViews) {
  play(R"({"hover": "image", "at": [0.5, 0.68]})");
  EXPECT_NEAR(static_cast<double>(view().hover % 640), 320, 2);
  EXPECT_NEAR(static_cast<double>(view().hover / 640), 326, 2);
  play(R"({"hover": "view3d", "at": [0.5, 0.6]})");
  EXPECT_GE(view().hover, 0);
  play(R"({"hover": "menu.Labels"})");
  EXPECT_EQ(view().hover, -1);
}

TEST_F(LabelTools, TheWheelChangesTheBrushAndZoomsWithCtrlOrAnotherTool) {
  key("B");
  const double brush = view().brush_px, zoom = state().view.image_zoom;
  play(R"({"wheel": "image", "by": 2})");
  EXPECT_GT(view().brush_px, 1.2 * brush);
  EXPECT_EQ(state().view.image_zoom, zoom);
  key("R");
  play(R"({"wheel": "image", "by": 2})");
  EXPECT_GT(state().view.image_zoom, zoom);
}

TEST_F(LabelTools, RejectInvalidGestures) {
  for (const char* text :
       {"", "image", "image over", "screen 1,2", "space:0x5 1,2", "space:9 1,2", "image 1,2,3",
        "image up 1,2", "image over -3 1,2", "image over 8 nan,1", "space:99999999x2 1,2"})
    EXPECT_THROW(window.run("label.stroke", text), Error) << text;
  EXPECT_THROW(window.run("label.area", "image 1,2 3,4"), Error);
  EXPECT_THROW(window.run("label.wand", "9999,1"), Error);
  EXPECT_THROW(window.run("label.cut", "image 1,2 3,4"), Error);  // no active plane
  EXPECT_EQ(labeled(), 0u);
}

TEST_F(LabelTools, AcceptAnyArgumentWithoutACrash) {
  window.run("label.stroke", kStroke);
  const State fresh = state();
  for (const Action& action : action_table()) {
    if (action.mode != KeyMode::labels) continue;
    for (const std::string argument : {"", "0", "1", "-1", "99999999", "x", "1,2", "P1", "none",
                                       "space:8x8 1,2", "image 1,2 3,4", "image subtract 5 -9,1e5",
                                       "space:8x8 add 3 1,2 3,4 5,6", "space:1x4000 1,2 1,2 1,2"}) {
      State changed = fresh;
      try {
        apply(changed, {action.name, argument});
      } catch (const Error&) {
      }
    }
  }
}

// Gestures that finish a surface: each has a preview and is one step of undo.

struct LabelFinish : LabelDesktop {
  /// Labels the floor of the sample with the wand, with a hole of 20 x 20 pixels.
  void floor_with_a_hole() {
    window.run("label.wand", "320,330");
    window.run("label.accept");
    window.run("label.erase");
    window.run("label.area", "image over 310,295 330,295 330,315 310,315");
    window.run("label.erase");
    window.run("label.plane", "1");
  }
};

TEST_F(LabelFinish, HolesArePreviewedThenFilledInOneStepOfUndo) {
  floor_with_a_hole();
  const std::size_t before = pixels_of(1), steps = store().undo_count();
  window.run("label.fill");
  EXPECT_GE(view().finish->changed_pixels(), 400u);
  const std::vector<labels::LabelRun> shown = view().finish->runs;
  const auto whole = state().labels();
  window.run("label.cancel");
  EXPECT_FALSE(view().finish);
  EXPECT_EQ(pixels_of(1), before);
  window.run("label.fill");
  window.run("label.accept");
  EXPECT_FALSE(view().finish);
  EXPECT_GE(pixels_of(1), before + 400);
  EXPECT_EQ(labels::make_edit(0, "", *whole, labels()).runs, shown) << "what was shown";
  EXPECT_EQ(store().undo_count(), steps + 1);
  window.run("label.undo");
  EXPECT_EQ(pixels_of(1), before);
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

TEST_F(LabelFinish, SpecksBelowASizeAreRemovedAndThePlaneStays) {
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

TEST_F(LabelFinish, AltDragDrawsTheLassoOfTheWand) {
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
      EXPECT_GT(tints[i].a, 0);  // pixels of the plane itself, to be trimmed
    }
  }
  EXPECT_GT(before, 10u);
  EXPECT_GT(behind, 10u);
}

}  // namespace
}  // namespace planescope::desktop
