// The event list and the octree view by scripted clicks, with no window and no GL.

#include <algorithm>
#include <charconv>
#include <fstream>

#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct SearchPanels : OpenDesktop {
  const planescope::debug::Run& run() const { return *state().run(); }
  bool shown(const std::string& widget) const { return shell.widgets().contains(widget); }
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

TEST_F(SearchPanels, AFilterIsTypedAndEnterGoesToItsNextMatch) {
  play(R"("step.first", {"click": "events.filter"}, {"type": "case==IV"}, {"key": "Enter"})");
  ASSERT_FALSE(state().view.search.matches.empty());
  EXPECT_EQ(state().view.step, state().view.search.matches.front());
  EXPECT_TRUE(shown("events.step." + std::to_string(state().view.step)));
}

TEST_F(SearchPanels, TabTakesTheCompletionThatIsChosen) {
  play(R"({"click": "events.filter"}, {"type": "dep"}, {"key": "Tab"}, {"type": ">3"})");
  EXPECT_EQ(state().view.search.text, "depth>3");
  EXPECT_TRUE(state().view.search.filter.has_value());
}

TEST_F(SearchPanels, AClickedCompletionIsTakenAndTypingGoesOnBehindIt) {
  play(R"({"click": "events.filter"}, {"type": "merge && off"},
          {"click": "events.filter.completion.offset"}, {"type": ">0.01"})");
  EXPECT_EQ(state().view.search.text, "merge && offset>0.01");
}

TEST_F(SearchPanels, AFilterThatIsSetElsewhereShowsInTheBoxBeingTypedIn) {
  play(R"({"click": "events.filter"}, {"type": "dep"}, "filter.set merge", "filter.focus",
          {"key": "End"}, {"type": "||found"})");
  EXPECT_EQ(state().view.search.text, "merge||found");
}

TEST_F(SearchPanels, AWrongFilterFindsNothingAndTheListStaysWhole) {
  play(R"("filter.only", {"click": "events.filter"}, {"type": "dpeth>3"})");
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

TEST_F(SearchPanels, OfThousandsOfEventsOnlyThoseInSightAreDrawn) {
  ASSERT_GT(run().steps(), 3000);
  EXPECT_LT(numbers_of("events.step.").size(), 60u);
  EXPECT_LT(numbers_of("octree.node.").size(), 60u);
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

TEST_F(SearchPanels, BreakpointsAreSwitchedOffAndRemovedInTheirLine) {
  play(R"("break.on merge", {"click": "events.breakpoint.0"})");
  EXPECT_FALSE(state().document.breakpoints[0].enabled);
  play(R"({"click": "events.breakpoint.0.remove"})");
  EXPECT_TRUE(state().document.breakpoints.empty());
}

TEST_F(SearchPanels, ANodeIsSelectedByAClickAndSoughtOutByTwo) {
  play(R"("step.first", "octree.search 0", {"click": "octree.node.0", "double": true})");
  EXPECT_EQ(state().view.selected.node, 0);
  EXPECT_EQ(state().view.step, run().timeline.decided_at()[0]);
}

TEST_F(SearchPanels, ANodeSelectedElsewhereComesIntoSight) {
  play(R"("step.last", "select.node 300")");
  EXPECT_TRUE(shown("octree.node.300"));
  play(R"({"click": "octree.search"}, {"type": "7"})");
  EXPECT_EQ(numbers_of("octree.node."), std::vector<std::int32_t>{7});
}

TEST_F(SearchPanels, ATriangleOpensAndClosesANodeUntilASelectionLeadsThroughIt) {
  play(R"("step.last", "select.node 0", {"click": "octree.fold.0"})");
  EXPECT_TRUE(shown("octree.node.1"));
  play(R"({"click": "octree.fold.0"})");
  EXPECT_FALSE(shown("octree.node.1"));
  play(R"("select.node 900")");
  EXPECT_TRUE(shown("octree.node.900"));
}

}  // namespace
}  // namespace planescope::desktop
