// The 3D view, the image, the timeline and the frame strip, by scripted input with no GL.

#include "app/desktop/look.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Views : OpenDesktop {
  double camera_distance() const {
    const render::Camera camera = camera_of(state());
    return (camera.eye - camera.target).norm();
  }
};

TEST_F(Views, DraggingAlongTheTimelineScrubs) {
  play(R"({"drag": "timeline", "from": [0.3, 0.5], "to": [0, 0.5]})");
  EXPECT_EQ(state().view.step, 0);
  play(R"({"click": "timeline", "at": [0.5, 0.5]})");
  EXPECT_NEAR(state().view.step, state().run()->steps() / 2, state().run()->steps() / 100);
  play(R"({"drag": "timeline", "from": [0.5, 0.5], "to": [1.1, 0.5]})");
  EXPECT_EQ(state().view.step, state().run()->steps());
}

TEST_F(Views, ScrubbingStopsPlaying) {
  play(R"("step.first", {"do": "step.rate", "with": "1"}, {"do": "step.play", "wait": false},
          {"click": "timeline", "at": [0.5, 0.5]})");
  EXPECT_EQ(state().view.playing.direction, 0);
}

TEST_F(Views, AClickInTheImageSelectsThePixelAndWhatItIsIn) {
  play(R"({"click": "image", "at": [0.5, 0.65]})");
  const std::int64_t source = state().view.selected.source;
  EXPECT_NEAR(static_cast<double>(source % 640), 320, 3);
  EXPECT_NEAR(static_cast<double>(source / 640), 312, 3);
  EXPECT_GE(state().view.selected.voxel, 0);
  EXPECT_GE(state().view.selected.node, 0);
}

TEST_F(Views, TheWheelZoomsTheImageAboutTheMouse) {
  const WidgetRect whole = shell.widgets().at("image");
  play(R"({"click": "image", "at": [0.4, 0.6]})");
  const std::int64_t before = state().view.selected.source;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  play(R"({"wheel": "image", "at": [0.4, 0.6], "by": 4})");
  EXPECT_GT(state().view.image_zoom, 1.5);
  const WidgetRect now = shell.widgets().at("image");
  EXPECT_GT(now.max.x - now.min.x, 1.5f * (whole.max.x - whole.min.x));
  const float u = (mouse.x - now.min.x) / (now.max.x - now.min.x) * 640;
  EXPECT_NEAR(u, static_cast<float>(before % 640), 4);
  play(R"({"click": "image.fit"})");
  EXPECT_EQ(state().view.image_zoom, 1);
}

TEST_F(Views, ADragInTheImageMarksOnlyWhileMarkingIsOn) {
  const std::string drag = R"({"drag": "image", "from": [0.4, 0.6], "to": [0.6, 0.7]})";
  play(drag);
  EXPECT_TRUE(state().document.marked.empty());
  play(R"({"click": "button.mark.toggle"}, )" + drag);
  EXPECT_GT(state().document.marked.size(), 20u);
}

TEST_F(Views, TheSceneTurnsAboutItsTargetMovesAndComesNearer) {
  const render::Camera home = camera_of(state());
  play(R"({"drag": "view3d", "by": [60, 10]})");
  const render::Camera turned = camera_of(state());
  EXPECT_LT((turned.target - home.target).norm(), 1e-9);
  EXPECT_GT((turned.eye - home.eye).norm(), 0.05);
  play(R"({"drag": "view3d", "by": [60, 10], "button": "right"})");
  EXPECT_GT((camera_of(state()).target - turned.target).norm(), 0.01);
  const double before = camera_distance();
  play(R"({"wheel": "view3d", "by": 2})");
  EXPECT_LT(camera_distance(), 0.9 * before);
}

TEST_F(Views, AFrameOfTheStripIsShown) {
  play(R"({"click": "frame.1"})");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_EQ(state().run()->subject->frame.index, 1);
}

TEST(Look, WhatTheCursorIsOnIsNoChoiceOfTheUsers) {
  State state = run_state();
  go_to_step(state, 12);
  EXPECT_GE(state.view.selected.node, 0);
  EXPECT_EQ(look_of(state).node, -1);
  apply(state, {"select.node", "1"});
  EXPECT_EQ(look_of(state).node, 1);
}

}  // namespace
}  // namespace planescope::desktop
