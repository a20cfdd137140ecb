// Panels of the debugger, tested with scripted clicks without a window or GL.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/desktop/debugger/debugger.hpp"
#include "app/desktop/state/state.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Panels : OpenDesktop {
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
  /// Presses and releases a key before a frame is drawn, like a fast tap.
  void tap(Key key, int times = 1) {
    for (; times > 0; --times)
      for (const bool down : {true, false})
        shell.input().push({.type = InputEvent::Type::key, .down = down, .key = key});
    rest();
  }
  void type(const std::string& text) {
    for (const char c : text)
      shell.input().push({.type = InputEvent::Type::text, .character = static_cast<char32_t>(c)});
    rest();
  }
};

TEST_F(Panels, QuickTapsAreNeverLost) {
  perform("step.first");
  tap(Key::right, 20);
  EXPECT_EQ(state().view.step, 20);
}

TEST_F(Panels, TabsFollowClicksAndActions) {
  click("tab.histograms");
  EXPECT_EQ(state().view.tool_tab, "histograms");
  perform("tab.tool", "criteria");
  EXPECT_TRUE(shown("criteria.theta_n_out"));
}

TEST_F(Panels, DraggingASliderRunsTheFrameAndIsOneUndoStep) {
  perform("step.goto", "30");
  const int node = state().view.selected.node;
  const auto before = state().results.current;
  const WidgetRect rect = shell.widgets().at("criteria.theta_n_out.slider");
  const float y = (rect.min.y + rect.max.y) / 2;
  move(ImVec2(rect.min.x + 0.2f * (rect.max.x - rect.min.x), y));
  button(true);
  for (float share = 0.2f; share < 0.8f; share += 0.05f)
    move(ImVec2(rect.min.x + share * (rect.max.x - rect.min.x), y));
  button(false);
  rest();
  EXPECT_NE(state().results.current, before);
  EXPECT_GT(state().document.options.segment.theta_n_out, 15);
  EXPECT_EQ(state().undo.size(), 1u);
  EXPECT_EQ(state().view.selected.node, node);
  perform("option.undo");
  EXPECT_EQ(state().document.options.segment.theta_n_out, 5);
  EXPECT_EQ(state().run()->trace.events.size(), before->run->trace.events.size());
}

TEST_F(Panels, AValueCanBeTypedIntoAnOption) {
  click("criteria.theta_n_out");
  type("9");
  tap(Key::enter);
  EXPECT_EQ(state().document.options.segment.theta_n_out, 9);
  click("criteria.theta_n_out.reset");
  EXPECT_EQ(state().document.options.segment.theta_n_out, 5);
}

TEST_F(Panels, KeysTypedIntoATextAreNotShortcuts) {
  shell.perform({"step.first"});
  click("criteria.theta_n_out");
  tap(static_cast<Key>('L'));
  tap(Key::right);
  EXPECT_EQ(state().view.step, 0);
  EXPECT_EQ(state().view.playing.direction, 0);
}

TEST_F(Panels, ACriterionShowsItsSlider) {
  shell.perform({"tab.tool", "histograms"});
  perform("step.goto", "2");
  click("check.node.0");
  EXPECT_EQ(state().view.tool_tab, "criteria");
  EXPECT_TRUE(shown("criteria.theta_n_out"));
}

TEST_F(Panels, ASplitterMovesAndNoPanelVanishes) {
  const ImVec2 at = middle("splitter.right");
  const float before = shell.widgets().at("panel.inspector").min.x;
  move(at);
  button(true);
  move(ImVec2(at.x - 150, at.y));
  button(false);
  rest();
  EXPECT_LT(shell.widgets().at("panel.inspector").min.x, before - 100);
  perform("layout.set", "right=0.9");
  for (const char* panel : {"frames", "view3d", "image", "events", "inspector", "tools"}) {
    const WidgetRect& rect = shell.widgets().at(std::string("panel.") + panel);
    EXPECT_GT(rect.max.x - rect.min.x, 30) << panel;
  }
}

TEST_F(Panels, EscapeClosesThePaletteWhileTyping) {
  perform("palette");
  type("x");
  ASSERT_TRUE(shown("palette.text"));
  tap(Key::escape);
  EXPECT_FALSE(state().view.show_palette);
  EXPECT_FALSE(shown("palette.text"));
}

TEST_F(Panels, EscapeClosesOnlyTheOpenMenu) {
  perform("select.node", "3");
  click("menu.Step");
  EXPECT_TRUE(shown("menu.step.first"));
  tap(Key::escape);
  EXPECT_FALSE(shown("menu.step.first"));
  EXPECT_EQ(state().view.selected.node, 3);
  tap(Key::escape);
  EXPECT_EQ(state().view.selected.node, -1);
}

TEST_F(Panels, ADialogStaysOpenWithTheReasonForAWrongPath) {
  perform("recording.open");
  play(R"({"type": "/there/is/nothing"}, {"key": "Enter"})");
  EXPECT_TRUE(state().view.show_palette);
  EXPECT_TRUE(shown("palette.problem"));
  EXPECT_EQ(state().document.recordings.size(), 1u);
}

TEST_F(Panels, APathIsCompletedFromExistingFiles) {
  std::filesystem::create_directories(dir / "recording_one");
  std::ofstream(dir / "other.txt") << "";
  perform("palette.ask", "recording.open");
  type((dir / "rec").string());
  ASSERT_TRUE(shown("palette.path.0"));
  EXPECT_FALSE(shown("palette.path.1"));
}

TEST_F(Panels, FramesArePlayedUpToTheLast) {
  play(R"("frame.play")");
  EXPECT_FALSE(state().view.playing_frames);
  EXPECT_EQ(state().document.frame, state().document.current()->recording->frame_count() - 1);
  EXPECT_EQ(state().run()->subject->frame.index, state().document.frame) << "and it has its planes";
}

TEST_F(Panels, AtRestNothingIsDrawn) {
  EXPECT_TRUE(shell.idle());
  shell.perform({"step.previous"});
  EXPECT_FALSE(shell.idle());
  rest();
  EXPECT_TRUE(shell.idle());
}

struct SearchPanels : OpenDesktop {
  const planescope::debug::Run& run() const { return *state().run(); }
  std::vector<std::int32_t> numbers_of(const std::string& prefix) const {
    std::vector<std::int32_t> numbers;
    for (const auto& [widget, rect] : shell.widgets()) {
      if (!widget.starts_with(prefix)) continue;
      std::int32_t number = -1;
      std::from_chars(widget.data() + prefix.size(), widget.data() + widget.size(), number);
      numbers.push_back(number);
    }
    return numbers;
  }
};

TEST_F(SearchPanels, EnterInAFilterGoesToItsNextMatch) {
  play(R"("step.first", {"click": "events.filter"}, {"type": "case==IV"}, {"key": "Enter"})");
  ASSERT_FALSE(state().view.search.matches.empty());
  EXPECT_EQ(state().view.step, state().view.search.matches.front());
  EXPECT_TRUE(shown("events.step." + std::to_string(state().view.step)));
}

TEST_F(SearchPanels, TabInsertsTheSelectedCompletion) {
  play(R"({"click": "events.filter"}, {"type": "dep"}, {"key": "Tab"}, {"type": ">3"})");
  EXPECT_EQ(state().view.search.text, "depth>3");
  EXPECT_TRUE(state().view.search.filter.has_value());
}

TEST_F(SearchPanels, AClickedCompletionIsInsertedAndTypingContinuesAfterIt) {
  play(R"({"click": "events.filter"}, {"type": "merge && off"},
          {"click": "events.filter.completion.offset"}, {"type": ">0.01"})");
  EXPECT_EQ(state().view.search.text, "merge && offset>0.01");
}

TEST_F(SearchPanels, AFilterSetElsewhereAppearsInTheFocusedBox) {
  play(R"({"click": "events.filter"}, {"type": "dep"}, "filter.set merge", "filter.focus",
          {"key": "End"}, {"type": "||found"})");
  EXPECT_EQ(state().view.search.text, "merge||found");
}

TEST_F(SearchPanels, AnInvalidFilterIsReportedAndTheListStaysComplete) {
  play(R"("filter.only", {"click": "events.filter"}, {"type": "dpeth>3"})");
  EXPECT_FALSE(state().view.search.problem.message.empty());
  EXPECT_TRUE(state().view.search.matches.empty());
  EXPECT_EQ(state().view.search.problem.begin, 0u);
  EXPECT_EQ(state().view.search.problem.end, 5u);
  EXPECT_FALSE(numbers_of("events.step.").empty());
}

TEST_F(SearchPanels, OnlyMatchesShowsNothingElse) {
  play(R"("filter.set decide && case==IV", {"click": "events.only"})");
  const auto& matches = state().view.search.matches;
  const auto steps = numbers_of("events.step.");
  EXPECT_GT(steps.size(), 3u);
  for (const std::int32_t step : steps)
    EXPECT_TRUE(std::binary_search(matches.begin(), matches.end(), step));
}

TEST_F(SearchPanels, OnlyVisibleEventsAreDrawn) {
  ASSERT_GT(run().steps(), 3000);
  EXPECT_LT(numbers_of("events.step.").size(), 60u);
  EXPECT_LT(numbers_of("octree.node.").size(), 60u);
}

TEST_F(SearchPanels, ManyEventsOfAKindAreOneFoldableLine) {
  const debug::Run& run = *state().run();
  const std::vector<EventRow> rows = event_groups(run);
  ASSERT_LT(rows.size(), static_cast<std::size_t>(run.steps()));
  EXPECT_EQ(rows.front().kind, EventRow::Kind::stage);
  EXPECT_STREQ(rows.front().title, "traversal");
  const auto group = std::ranges::find(rows, EventRow::Kind::group, &EventRow::kind);
  ASSERT_NE(group, rows.end());
  EXPECT_GE(group->last - group->first, 2);
  EXPECT_TRUE(has(group_text(run, *group), " points "));
  std::int32_t next = 1;  // each step once, in order
  for (const EventRow& row : rows) {
    if (row.kind == EventRow::Kind::stage) continue;
    EXPECT_EQ(row.first, next);
    next = row.last + 1;
  }
  EXPECT_EQ(next, run.steps() + 1);
  perform("step.goto", std::to_string(group->last));
  const std::string widget = fmt::format("events.group.{}", group->first);
  ASSERT_TRUE(shown(widget));
  EXPECT_FALSE(shown(fmt::format("events.step.{}", group->first)));
  play(R"({"click": ")" + widget + R"("}, {"wheel": "panel.events", "by": -1})");
  EXPECT_TRUE(shown(fmt::format("events.step.{}", group->first)));
  play(R"({"click": ")" + widget + "\"}");
  EXPECT_FALSE(shown(fmt::format("events.step.{}", group->first)));
}

TEST_F(SearchPanels, ARowGoesToItsStepAndItsGutterSetsABreakpoint) {
  play(R"({"do": "step.goto", "with": "20"}, {"click": "events.step.21"})");
  EXPECT_EQ(state().view.step, 21);
  play(R"({"click": "events.break.20"})");
  ASSERT_EQ(state().document.breakpoints.size(), 1u);
  EXPECT_EQ(state().document.breakpoints[0].index, run().event_at(20)->node);
  play(R"("step.first", "run.forward")");
  EXPECT_EQ(run().event_at(state().view.step)->node, run().event_at(20)->node);
  play(R"({"click": "events.break.20"})");
  EXPECT_TRUE(state().document.breakpoints.empty());
}

TEST_F(SearchPanels, BreakpointsAreDisabledAndRemovedInTheirLine) {
  play(R"("break.on merge", {"click": "events.breakpoint.0"})");
  EXPECT_FALSE(state().document.breakpoints[0].enabled);
  play(R"({"click": "events.breakpoint.0.remove"})");
  EXPECT_TRUE(state().document.breakpoints.empty());
}

TEST_F(SearchPanels, AClickSelectsANodeAndADoubleClickCentersIt) {
  play(R"("step.first", "octree.search 0", {"click": "octree.node.0", "double": true})");
  EXPECT_EQ(state().view.selected.node, 0);
  EXPECT_EQ(state().view.step, run().timeline.decided_at()[0]);
}

TEST_F(SearchPanels, ANodeSelectedElsewhereIsScrolledIntoView) {
  play(R"("step.last", "select.node 300")");
  EXPECT_TRUE(shown("octree.node.300"));
  play(R"({"click": "octree.search"}, {"type": "7"})");
  EXPECT_EQ(numbers_of("octree.node."), std::vector<std::int32_t>{7});
}

TEST_F(SearchPanels, ATriangleFoldsANodeUntilASelectionUnfoldsIt) {
  play(R"("step.last", "select.node 0", {"click": "octree.fold.0"})");
  EXPECT_TRUE(shown("octree.node.1"));
  play(R"({"click": "octree.fold.0"})");
  EXPECT_FALSE(shown("octree.node.1"));
  play(R"("select.node 900")");
  EXPECT_TRUE(shown("octree.node.900"));
}

TEST_F(SearchPanels, BuiltInFiltersAreValidForBothProfiles) {
  for (const char* profile : {"paper", "refined"}) {
    play(fmt::format(R"({{"do": "option.set", "with": "profile={}"}})", profile));
    for (int i = 0; i < 7; ++i) {  // the last one requires ground truth
      play(fmt::format(R"({{"click": "events.ready"}}, {{"click": "events.ready.{}"}})", i));
      EXPECT_TRUE(state().view.search.filter) << profile << i;
      EXPECT_TRUE(state().view.search.problem.message.empty())
          << state().view.search.text << ": " << state().view.search.problem.message;
    }
  }
}

struct AnalysisPanels : Panels {
  const debug::Histogram& histogram(const std::string& quantity) const {
    for (const debug::Histogram& h : state().results.current->histograms)
      if (h.quantity == quantity) return h;
    throw std::runtime_error("no histogram of " + quantity);
  }
};

TEST_F(AnalysisPanels, ALineOfAHistoryGoesToItsStepAndTheHistoryStays) {
  play(R"({"do": "select.pixel", "with": "320,300"}, "point.life")");
  const std::size_t source = 300 * 640 + 320;
  const std::vector<debug::HistoryEvent> life = debug::history_of(*state().run(), source);
  ASSERT_EQ(life[3].stage, "node");
  play(R"({"click": "point.life.3"})");
  EXPECT_EQ(state().view.step, life[3].step);
  play(R"({"click": "point.life.4"})");
  EXPECT_EQ(state().view.step, life[4].step);
}

/// Selects a voxel without a plane that a change of one option would assign to a plane.
const debug::Fix& select_lost(OpenDesktop& desktop) {
  const debug::Run& run = *desktop.state().run();
  for (std::uint32_t voxel = 0; voxel < run.subject->voxel_count(); voxel += 7) {
    if (run.segmentation.plane_of[voxel] > 0) continue;
    desktop.shell.perform({"select.voxel", std::to_string(voxel)});
    settle(desktop.shell, desktop.stage, {});
    EXPECT_TRUE(desktop.state().results.fix.finished);
    if (!desktop.state().results.fix.fixes.empty())
      return desktop.state().results.fix.fixes.front();
  }
  throw std::runtime_error("no lost point comes back");
}

TEST_F(AnalysisPanels, AClickOnAPointWithoutAPlaneShowsTheReasonAndFixes) {
  const debug::Fix fix = select_lost(*this);
  const std::uint32_t voxel = state().results.fix.asked->voxel;
  EXPECT_TRUE(shown("answer.cause") || shown("answer.effect"));
  ASSERT_TRUE(shown("fix.apply.0"));
  const auto run = state().results.current;
  // A preview while the button is held, which does not change options.
  move(middle("fix.preview.0"));
  button(true);
  rest();
  EXPECT_GT(state().run()->segmentation.plane_of[voxel], 0);
  EXPECT_TRUE(state().undo.empty());
  button(false);
  rest();
  EXPECT_FALSE(state().view.preview);
  EXPECT_EQ(state().run()->segmentation.plane_of[voxel], 0);
  EXPECT_NE(state().results.current, run) << "it is run again";
  EXPECT_FALSE(has(state().view.message, "Ctrl+Z")) << "nothing was changed";
  EXPECT_TRUE(shown("fix.preview.0")) << "another one can be looked at";
  play(R"({"click": "fix.apply.0"})");
  EXPECT_EQ(planes::find_option(fix.option).get(state().document.options), fix.after);
  EXPECT_EQ(state().undo.size(), 1u);
  EXPECT_GT(state().run()->segmentation.plane_of[voxel], 0);
  EXPECT_EQ(static_cast<int>(state().run()->segmentation.planes.size()), fix.planes_after);
  EXPECT_FALSE(shown("fix.apply.0")) << "it is in a plane";
}

TEST_F(AnalysisPanels, AStoppedSearchCanBeRepeated) {
  select_lost(*this);
  shell.perform({"fix.far"});
  perform("fix.cancel");
  EXPECT_FALSE(state().results.fix.finished);
  play(R"({"click": "answer.search"})");
  EXPECT_TRUE(state().results.fix.finished);
}

TEST_F(AnalysisPanels, ResultsDisappearWithTheirVoxels) {
  select_lost(*this);
  play(R"("tab.tool fix", {"do": "option.set", "with": "voxel_size_m=0.04"})");
  EXPECT_FALSE(state().results.fix.of);
  perform("fix.far");
  EXPECT_FALSE(state().results.fix.finished) << "there is nothing to search farther for";
}

TEST_F(AnalysisPanels, AReasonInTheSummaryMarksItsPointsAndExplainsThem) {
  perform("select.none");
  const debug::FrameSummary& summary = state().results.current->summary;
  const auto lost = std::ranges::find_if(
      summary.lost, [](const debug::Lost& reason) { return reason.middle >= 0; });
  ASSERT_NE(lost, summary.lost.end());
  play(fmt::format(R"({{"click": "lost.{}"}})", lost - summary.lost.begin()));
  EXPECT_EQ(state().document.marked, lost->voxels);
  EXPECT_EQ(state().view.selected.voxel, lost->middle);
  EXPECT_EQ(state().results.fix.asked->voxel, lost->middle);
  EXPECT_TRUE(state().results.fix.finished);
  EXPECT_TRUE(shown("answer.cause"));
  // The link to a decision keeps the point.
  play(R"({"click": "answer.cause"})");
  EXPECT_LT(state().view.step, state().run()->steps());
  EXPECT_EQ(state().view.selected.voxel, lost->middle);
}

TEST_F(AnalysisPanels, AChangeOfAnOptionIsReportedWithItsEffect) {
  play(R"({"do": "option.set", "with": "theta_n_in=40"})");
  const std::string message = state().view.message;
  EXPECT_TRUE(message.starts_with("Minimum inliers 5 → 40 · planes ")) << message;
  EXPECT_TRUE(has(message, " · Ctrl+Z"));
}

TEST_F(AnalysisPanels, WishesForAPlaneAreInItsMenu) {
  const debug::Run& run = *state().run();
  const auto in_plane = std::ranges::find(run.segmentation.plane_of, 1);
  const auto voxel = in_plane - run.segmentation.plane_of.begin();
  shell.perform({"select.voxel", std::to_string(voxel)});
  EXPECT_FALSE(state().results.fix.asked) << "it is in a plane";
  for (const auto& [text, wish] :
       {std::pair{"own", debug::Wish::own_plane}, std::pair{"none", debug::Wish::no_plane},
        std::pair{"with 0", debug::Wish::joined}}) {
    perform("fix.point", text);
    EXPECT_EQ(state().results.fix.asked->wish, wish);
    EXPECT_TRUE(state().results.fix.finished);
    EXPECT_EQ(state().results.fix.target.wish, wish);
  }
  shell.perform({"fix.point", "round"});
  EXPECT_TRUE(has(state().view.message, "expected plane, own, none, or with VOXEL"));
}

TEST_F(AnalysisPanels, ADragOverBarsMakesAFilter) {
  play(R"({"do": "tab.tool", "with": "histograms"},
          {"drag": "histograms.n_out", "from": [0.5, 0.5], "to": [0.9, 0.5]})");
  EXPECT_EQ(state().view.search.text.rfind("n_out>=", 0), 0u) << state().view.search.text;
  EXPECT_TRUE(state().view.search.filter);
  EXPECT_FALSE(state().view.search.matches.empty());
  EXPECT_TRUE(state().undo.empty());
}

TEST_F(AnalysisPanels, ADraggedThresholdStaysUnderTheMouse) {
  const debug::Histogram before = histogram("n_in");
  const HistogramAxis axis(before);
  const double from = axis.share(before.threshold);
  play(R"({"do": "tab.tool", "with": "histograms"})");
  play(fmt::format(R"({{"drag": "histograms.n_in", "from": [{}, 0.5], "to": [0.5, 0.5]}})", from));
  EXPECT_EQ(state().document.options.segment.theta_n_in, std::lround(axis.value(0.5)));
  EXPECT_EQ(state().undo.size(), 1u) << "one gesture";
}

TEST_F(AnalysisPanels, APinnedRunIsComparedWithTheNext) {
  play(R"({"do": "tab.tool", "with": "compare"}, {"click": "compare.pin"},
          {"do": "option.set", "with": "theta_n_in=8"}, {"click": "compare.diverging"})");
  ASSERT_TRUE(state().results.comparison);
  const debug::Comparison& comparison = *state().results.comparison;
  EXPECT_EQ(state().view.step, comparison.diverging_step_b);
  const int node = state().view.selected.node;
  play(R"({"click": "compare.flash"})");
  EXPECT_EQ(state().view.selected.node, node);
  EXPECT_TRUE(state().view.flash);
  EXPECT_EQ(state().run(), state().results.pinned->run.get());
  play(R"({"click": "compare.restore"})");
  EXPECT_EQ(state().document.options.segment.theta_n_in, 5);
}

TEST_F(AnalysisPanels, AFixIsFoundAndApplied) {
  perform("tab.tool", "fix");
  std::vector<debug::TruthMatch> matches = state().results.current->score->planes;
  std::sort(matches.begin(), matches.end(),
            [](const debug::TruthMatch& a, const debug::TruthMatch& b) { return a.iou < b.iou; });
  for (const debug::TruthMatch& match : matches) {
    ASSERT_LT(match.iou, 0.8) << "no lost plane that one change recovers";
    play(fmt::format(R"({{"do": "fix.plane", "with": "{}"}})", match.truth));
    ASSERT_TRUE(state().results.fix.finished);
    if (state().results.fix.fixes.empty()) continue;
    const debug::Fix fix = state().results.fix.fixes.front();
    play(R"({"click": "fix.check.0"})");
    EXPECT_EQ(state().results.fix.effects.size(), 3u) << "labelled frames of the sample";
    play(R"({"click": "fix.apply.0"})");
    EXPECT_EQ(planes::find_option(fix.option).get(state().document.options), fix.after);
    EXPECT_EQ(state().results.current->score->detected, fix.score.detected);
    return;
  }
}

}  // namespace
}  // namespace planescope::desktop
