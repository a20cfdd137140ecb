// Panels by scripted clicks, with no window and no GL.

#include <nlohmann/json.hpp>

#include "app/desktop/state/state_facts.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Panels : OpenDesktop {
  bool shown(const std::string& widget) const { return shell.widgets().count(widget) > 0; }
  ImVec2 middle(const std::string& widget) const {
    const WidgetRect& rect = shell.widgets().at(widget);
    return ImVec2((rect.min.x + rect.max.x) / 2, (rect.min.y + rect.max.y) / 2);
  }
  void move(ImVec2 at) {
    shell.input().push({.type = InputEvent::Type::move, .x = at.x, .y = at.y});
    stage.draw_frame();
    stage.draw_frame();
  }
  void button(bool down) {
    shell.input().push({.type = InputEvent::Type::button, .down = down});
    stage.draw_frame();
  }
  void click(const std::string& widget) {
    ASSERT_TRUE(shown(widget)) << widget;
    move(middle(widget));
    button(true);
    button(false);
    settle(shell, stage, {});
  }
  void tap(Key key) {
    // Down and up before a frame is drawn, as a quick finger does it.
    shell.input().push({.type = InputEvent::Type::key, .down = true, .key = key});
    shell.input().push({.type = InputEvent::Type::key, .down = false, .key = key});
    settle(shell, stage, {});
  }
};

TEST_F(Panels, QuickTapsAreNeverLost) {
  shell.perform({"step.first", ""});
  for (int i = 0; i < 20; ++i) {
    shell.input().push({.type = InputEvent::Type::key, .down = true, .key = Key::right});
    shell.input().push({.type = InputEvent::Type::key, .down = false, .key = Key::right});
  }
  settle(shell, stage, {});
  EXPECT_EQ(state().view.step, 20);
}

TEST_F(Panels, TheMenuDoesWhatItSays) {
  click("menu.Step");
  click("menu.step.first");
  EXPECT_EQ(state().view.step, 0);
}

TEST_F(Panels, TabsFollowClicksAndActions) {
  click("tab.histograms");
  EXPECT_EQ(state().view.tool_tab, "histograms");
  shell.perform({"tab.tool", "criteria"});
  settle(shell, stage, {});
  EXPECT_TRUE(shown("criteria.theta_n_out"));
}

TEST_F(Panels, DraggingASliderRunsTheFrameAgainAndIsOneUndo) {
  shell.perform({"step.goto", "30"});
  settle(shell, stage, {});
  const int node = state().view.selected.node;
  const auto before = state().results.current;
  const WidgetRect rect = shell.widgets().at("criteria.theta_n_out.slider");
  const float y = (rect.min.y + rect.max.y) / 2;
  move(ImVec2(rect.min.x + 0.2f * (rect.max.x - rect.min.x), y));
  button(true);
  for (float share = 0.2f; share < 0.8f; share += 0.05f)
    move(ImVec2(rect.min.x + share * (rect.max.x - rect.min.x), y));
  button(false);
  settle(shell, stage, {});
  EXPECT_NE(state().results.current, before);
  EXPECT_GT(state().document.options.segment.theta_n_out, 15);
  EXPECT_EQ(state().undo.size(), 1u);
  EXPECT_EQ(state().view.selected.node, node);
  shell.perform({"option.undo", ""});
  settle(shell, stage, {});
  EXPECT_EQ(state().document.options.segment.theta_n_out, 5);
  EXPECT_EQ(state().run()->trace.events.size(), before->run->trace.events.size());
}

TEST_F(Panels, AValueIsTypedIntoAnOption) {
  click("criteria.theta_n_out");
  for (const char c : std::string("9"))
    shell.input().push({.type = InputEvent::Type::text, .character = static_cast<char32_t>(c)});
  tap(Key::enter);
  EXPECT_EQ(state().document.options.segment.theta_n_out, 9);
  click("criteria.theta_n_out.reset");
  EXPECT_EQ(state().document.options.segment.theta_n_out, 5);
}

TEST_F(Panels, KeysTypedIntoATextAreNotShortcuts) {
  shell.perform({"step.first", ""});
  click("criteria.theta_n_out");
  tap(static_cast<Key>('L'));
  tap(Key::right);
  EXPECT_EQ(state().view.step, 0);
  EXPECT_EQ(state().view.playing.direction, 0);
}

TEST_F(Panels, ACriterionLeadsToItsSlider) {
  shell.perform({"tab.tool", "histograms"});
  shell.perform({"step.goto", "2"});
  settle(shell, stage, {});
  click("check.node.0");
  EXPECT_EQ(state().view.tool_tab, "criteria");
  EXPECT_TRUE(shown("criteria.theta_n_out"));
}

TEST_F(Panels, ASplitterMovesItsShareAndNoPanelVanishes) {
  const ImVec2 at = middle("splitter.right");
  const float before = shell.widgets().at("panel.inspector").min.x;
  move(at);
  button(true);
  move(ImVec2(at.x - 150, at.y));
  button(false);
  settle(shell, stage, {});
  EXPECT_LT(shell.widgets().at("panel.inspector").min.x, before - 100);
  shell.perform({"layout.set", "right=0.9"});
  settle(shell, stage, {});
  for (const char* panel : {"frames", "view3d", "image", "events", "inspector", "tools"}) {
    const WidgetRect& rect = shell.widgets().at(std::string("panel.") + panel);
    EXPECT_GT(rect.max.x - rect.min.x, 30) << panel;
  }
}

TEST_F(Panels, TheKeySheetOpensWithAQuestionMarkAndClosesWithEscape) {
  shell.input().push({.type = InputEvent::Type::text, .character = U'?'});
  settle(shell, stage, {});
  EXPECT_TRUE(shown("keys"));
  tap(Key::escape);
  EXPECT_FALSE(shown("keys"));
}

TEST_F(Panels, ThePaletteClosesWithEscapeWhileOneTypes) {
  shell.perform({"palette", ""});
  settle(shell, stage, {});
  shell.input().push({.type = InputEvent::Type::text, .character = U'x'});
  settle(shell, stage, {});
  ASSERT_TRUE(shown("palette.text"));
  tap(Key::escape);
  EXPECT_FALSE(state().view.show_palette);
  EXPECT_FALSE(shown("palette.text"));
}

TEST_F(Panels, AtRestNothingIsDrawn) {
  EXPECT_TRUE(shell.idle());
  shell.perform({"step.previous", ""});
  EXPECT_FALSE(shell.idle());
  settle(shell, stage, {});
  EXPECT_TRUE(shell.idle());
}

}  // namespace
}  // namespace planescope::desktop
