// The 3D view, the image, the timeline and the frame strip, tested with scripted input without GL.

#include "app/desktop/debugger/debugger.hpp"
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
  play(R"("timeline.all", {"drag": "timeline", "from": [0.3, 0.5], "to": [0, 0.5]})");
  EXPECT_EQ(state().view.step, 0);
  play(R"({"click": "timeline", "at": [0.5, 0.5]})");
  EXPECT_NEAR(state().view.step, state().run()->steps() / 2, state().run()->steps() / 100);
  play(R"({"drag": "timeline", "from": [0.5, 0.5], "to": [1.1, 0.5]})");
  EXPECT_EQ(state().view.step, state().run()->steps());
}

TEST_F(Views, TheTimelineOpensOnTheTraversalAndFollowsTheCursor) {
  const std::int32_t steps = state().run()->steps();
  const debug::StepRange traversal = debug::traversal_of(*state().run());
  ASSERT_LT(traversal.last, steps);
  EXPECT_EQ(shown_steps(state()), traversal);
  EXPECT_EQ(state().view.step, steps) << "the cursor is on the finished planes";
  play(R"("step.previous")");
  EXPECT_TRUE(shown_steps(state()).contains(steps - 1));
  EXPECT_EQ(shown_steps(state()).count(), traversal.count());
  play(R"("timeline.range 100-140", "step.goto 140", "step.next")");
  EXPECT_TRUE(shown_steps(state()).contains(141));
  EXPECT_EQ(shown_steps(state()).count(), 41);
  play(R"("frame.next")");
  EXPECT_EQ(shown_steps(state()), debug::traversal_of(*state().run())) << "of the new frame";
}

TEST_F(Views, TheWheelZoomsTheTimelineAboutTheMouseAndTheRightButtonPansIt) {
  play(R"("timeline.all", "step.goto 0", {"wheel": "timeline", "at": [0.25, 0.5], "by": 6})");
  const debug::StepRange near = shown_steps(state());
  const std::int32_t steps = state().run()->steps();
  EXPECT_LT(near.count(), steps / 4);
  EXPECT_NEAR(near.first + 0.25 * near.count(), 0.25 * steps, 0.01 * steps);
  EXPECT_EQ(state().view.step, 0) << "the cursor stays, out of sight";
  play(R"({"drag": "timeline", "from": [0.6, 0.5], "to": [0.1, 0.5], "button": "right"})");
  const debug::StepRange panned = shown_steps(state());
  EXPECT_EQ(panned.count(), near.count());
  EXPECT_NEAR(panned.first - near.first, near.count() / 2, near.count() / 50 + 1);
  play(R"({"drag": "timeline.phases", "from": [0.1, 0.5], "to": [0.6, 0.5], "button": "middle"})");
  EXPECT_NEAR(shown_steps(state()).first, near.first, near.count() / 50 + 1);
  EXPECT_EQ(state().view.step, 0);
  play(R"({"drag": "timeline.overview", "from": [0.25, 0.5], "to": [1, 0.5]})");
  EXPECT_EQ(shown_steps(state()).last, steps);
  EXPECT_EQ(shown_steps(state()).count(), near.count());
}

TEST_F(Views, ADoubleClickFitsAPhaseOrShowsEverything) {
  const std::vector<debug::Phase> phases = debug::phases_of(*state().run());
  ASSERT_GE(phases.size(), 2u);
  const debug::StepRange all{0, state().run()->steps()};
  play(R"({"click": "timeline", "at": [0.5, 0.5], "double": true})");
  EXPECT_EQ(shown_steps(state()), all);
  const std::int32_t step = state().view.step;
  play(R"({"click": "timeline.phase.1", "double": true})");
  EXPECT_EQ(shown_steps(state()), phases[1].steps);
  EXPECT_EQ(state().view.step, step) << "the bands do not scrub";
  play(R"({"click": "timeline", "at": [0.5, 0.5]})");
  EXPECT_NEAR(state().view.step, (phases[1].steps.first + phases[1].steps.last) / 2,
              phases[1].steps.count() / 50 + 1);
  play(R"({"key": "Home"}, {"key": "Shift+]"})");
  EXPECT_EQ(shown_steps(state()), debug::traversal_of(*state().run()));
  play(R"({"key": "Shift+["})");
  EXPECT_EQ(shown_steps(state()), all);
}

TEST_F(Views, StepsByNodeAreSelectedBesideTheArrows) {
  play(R"("step.first", {"click": "timeline.unit"}, {"click": "timeline.unit.node"},
          {"key": "Right"}, {"key": "Right"})");
  ASSERT_EQ(state().view.step_unit, debug::StepUnit::node);
  EXPECT_EQ(state().event()->type, planes::EventType::decide);
  const std::int32_t second = state().view.step;
  play(R"({"key": "Left"})");
  EXPECT_LT(state().view.step, second);
  const std::int32_t first = state().view.step;
  shell.perform({"step.rate", "60"});
  shell.perform({"step.play"});
  for (int i = 0; i < 30; ++i) stage.draw_frame();
  shell.perform({"step.stop"});
  int decided = 0;
  for (std::int32_t step = first + 1; step <= state().view.step; ++step)
    decided += state().run()->event_at(step)->type == planes::EventType::decide ? 1 : 0;
  EXPECT_NEAR(decided, 30, 1) << "playing goes by node, too";
  EXPECT_EQ(state().event()->type, planes::EventType::decide);
}

TEST_F(Views, ScrubbingStopsPlaying) {
  play(R"("step.first", {"do": "step.rate", "with": "1"}, {"do": "step.play", "wait": false},
          {"click": "timeline", "at": [0.5, 0.5]})");
  EXPECT_EQ(state().view.playing.direction, 0);
}

TEST_F(Views, AClickInTheImageSelectsThePixelAndItsPlane) {
  play(R"({"click": "image", "at": [0.5, 0.65]})");
  const std::int64_t source = state().view.selected.source;
  EXPECT_NEAR(static_cast<double>(source % 640), 320, 3);
  EXPECT_NEAR(static_cast<double>(source / 640), 312, 3);
  ASSERT_GE(state().view.selected.voxel, 0);
  EXPECT_EQ(state().view.selected.node,
            state().run()->timeline.path_of_point(state().view.selected.voxel).back());
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

TEST_F(Views, TheSceneOrbitsPansAndZooms) {
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

TEST_F(Views, AClickOnTheStripShowsItsFrame) {
  play(R"({"click": "frame.1"})");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_EQ(state().run()->subject->frame.index, 1);
}

TEST(Look, HoveringDoesNotChangeTheSelection) {
  State state = run_state();
  go_to_step(state, 12);
  EXPECT_GE(state.view.selected.node, 0);
  EXPECT_EQ(look_of(state).node, -1);
  apply(state, {"select.node", "1"});
  EXPECT_EQ(look_of(state).node, 1);
}

}  // namespace
}  // namespace planescope::desktop
