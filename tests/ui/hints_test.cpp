// Hints disappear once their suggestion is followed; markings are reported and visible.

#include <algorithm>

#include "app/desktop/look.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Hint {
  Command asks;               // shows the hint
  std::string says;           // part of its text
  std::vector<Command> does;  // follows its suggestion
};

TEST(Hints, DisappearOnceTheirSuggestionIsFollowed) {
  State fresh = run_state();
  fresh.document.recordings[0].label_dir = scratch_dir();
  apply(fresh, {"step.last"});
  const std::vector<Hint> hints = {
      {{"point.life"}, "no point is selected", {{"select.voxel", "7"}}},
      {{"break.node"}, "no node is selected", {{"select.node", "1"}}},
      {{"break.point"}, "no point is selected", {{"select.voxel", "7"}}},
      {{"break.filter"}, "no filter is set", {{"filter.set", "merge"}}},
      {{"filter.next"}, "no filter is set", {{"filter.set", "merge"}}},
      {{"step.decision"}, "no node is selected", {{"select.node", "1"}}},
      {{"camera.selected"}, "nothing is selected", {{"select.plane", "P1"}}},
      {{"fix.search"}, "nothing to recover", {{"mark.pixels", "300,300,340,340"}}},
      {{"fix.search"}, "nothing to recover", {{"fix.plane", "1"}}},
      {{"measure.end", "320,300"}, "click the other end", {{"measure.end", "voxel 7"}}},
  };
  for (const Hint& hint : hints) {
    State state = fresh;
    apply(state, hint.asks);
    EXPECT_TRUE(has(state.view.message, hint.says))
        << hint.asks.action << ": " << state.view.message;
    EXPECT_FALSE(state.view.message_is_error);
    apply(state, {"step.goto", "3"});
    apply(state, {"select.none"});
    if (hint.asks.action == "measure.end") continue;  // Escape also leaves it
    State other = fresh;
    apply(other, hint.asks);
    apply(other, {"theme.toggle"});
    EXPECT_TRUE(has(other.view.message, hint.says)) << "not done yet";
    for (const Command& command : hint.does) apply(other, command);
    EXPECT_FALSE(has(other.view.message, hint.says)) << hint.asks.action;
  }
}

TEST_F(OpenDesktop, AHintAboutARunDisappearsWithTheRun) {
  run("run.pin");
  EXPECT_EQ(state().view.message, "A pinned: change an option to make B");
  run("option.set", "theta_n_in=40");
  EXPECT_NE(state().results.pinned, state().results.current);
  EXPECT_FALSE(has(state().view.message, "A pinned"));
}

TEST(Hints, AboutAFixMentionLabelsOnlyIfThereAreAny) {
  State state = open_state();
  state.document.recordings[0].label_dir = scratch_dir();  // without labels
  Desk desk(std::move(state));
  desk.rest();
  ASSERT_FALSE(desk.state().run()->subject->voxel_truth.known());
  desk.shell.perform({"fix.search"}, true);
  EXPECT_FALSE(has(desk.state().view.message, "truth"));
  EXPECT_TRUE(has(desk.state().view.message, "mark a region"));
  desk.shell.perform({"mark.pixels", "300,300,310,310"}, true);
  desk.run("fix.search");
  EXPECT_EQ(desk.state().results.fix.target.name, "marked region");
  EXPECT_EQ(desk.state().results.fix.target.wish, debug::Wish::plane);
  EXPECT_TRUE(desk.state().results.fix.finished);
}

TEST(Marking, BeyondTheRangeReportsThePixelsAndTheOption) {
  State state = run_state();
  const debug::Subject& subject = *state.run()->subject;
  // A row of the image in which a pixel beyond the range follows a pixel within.
  const Image16& depth = subject.frame.depth;
  int v = 0, from = -1, to = -1;
  for (int y = 0; y < depth.height && to < 0; ++y)
    for (int x = 10; x + 10 < depth.width && to < 0; ++x) {
      int near = 0, far = 0;
      for (int d = -10; d < 10; ++d) {
        const std::uint16_t count = depth.at(x + d, y);
        const std::uint32_t voxel =
            subject.voxel_of_source(static_cast<std::size_t>(y) * depth.width + x + d);
        const bool is_far = count != 0 && count != 65535 && voxel == planes::kNoVoxel;
        (d < 0 ? near : far) += d < 0 ? voxel != planes::kNoVoxel : is_far;
      }
      if (near == 10 && far == 10) v = y, from = x - 10, to = x + 10;
    }
  ASSERT_GE(to, 0) << "the sample has such a place";
  const auto box = [v](int u0, int u1) { return fmt::format("{},{},{},{}", u0, v, u1, v + 1); };
  apply(state, {"mark.pixels", box(from, to)});
  EXPECT_TRUE(has(state.view.message, "50 % of what was measured there is beyond the range"));
  EXPECT_FALSE(state.view.message_is_error);
  apply(state, {"mark.clear"});
  apply(state, {"mark.pixels", box(from + 10, to)});
  EXPECT_TRUE(has(state.view.message, "max_range_m"));
  EXPECT_TRUE(state.view.message_is_error);
  EXPECT_TRUE(state.document.marked.empty());
}

TEST(Marking, IsVisibleInBothViewsWithAnyColors) {
  State state = run_state();
  apply(state, {"step.last"});
  for (const char* color : {"color.planes", "color.depth", "color.camera"}) {
    apply(state, {color, ""});
    apply(state, {"mark.clear"});
    const auto scene = [&] { return render::scene_step(*state.run(), look_of(state)); };
    const auto image = [&] {
      return render::image_step(*state.run(), look_of(state), render::Backdrop::color, 0);
    };
    const render::DrawList before = scene();
    const Image8 below = image();
    apply(state, {"mark.pixels", "300,300,340,340"});
    const render::DrawList after = scene();
    std::size_t changed = 0;
    for (std::size_t i = 0; i < after.points[0].colors.size(); ++i)
      changed += after.points[0].colors[i] != before.points[0].colors[i];
    EXPECT_EQ(changed, state.document.marked.size()) << color;
    EXPECT_EQ(after.legend.back().text, fmt::format("marked  {}", state.document.marked.size()));
    const Image8 above = image();
    EXPECT_NE(above.at(320, 320, 2), below.at(320, 320, 2)) << "without any overlay";
  }
}

TEST_F(LabelDesktop, TheKeySheetOpensWithAQuestionMarkHereToo) {
  play(R"({"key": "?"})");
  EXPECT_TRUE(state().view.show_keys);
  EXPECT_TRUE(window.shows("keys.label.tool.wand")) << "with the keys of this mode";
  EXPECT_FALSE(window.shows("keys.step.next"));
  play(R"({"key": "Escape"})");
  EXPECT_FALSE(state().view.show_keys);
}

}  // namespace
}  // namespace planescope::desktop
