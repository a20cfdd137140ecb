// Actions as functions of the state, and scripts made of actions.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "app/desktop/debugger/debugger.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/script.hpp"
#include "app/desktop/shell.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "desktop_fixture.hpp"
#include "render/palette.hpp"
#include "support/refusal.hpp"

namespace planescope::desktop {
namespace {

const planes::TraceEvent& event_of(const State& state) { return *state.event(); }

TEST(Actions, HaveUniqueNamesAndKeys) {
  std::set<std::string> names, keys;  // keys: with their mode
  for (const Action& action : action_table()) {
    EXPECT_TRUE(names.insert(action.name).second) << action.name;
    EXPECT_FALSE(action.title.empty()) << action.name;
    const bool of_a_gesture = action.name == "option.drop";
    if (action.takes.empty() && !of_a_gesture) {
      EXPECT_FALSE(action.menu.empty()) << action.name;
      EXPECT_FALSE(action.keys.empty()) << action.name;
    }
    if (action.keys.empty()) continue;
    for (const std::string& key : split(action.keys, ' ')) {
      const bool labels = action.mode == KeyMode::labels;
      EXPECT_TRUE(keys.insert(key + (labels ? " labels" : "")).second)
          << key << " of " << action.name;
      EXPECT_EQ(action_of_key(key, labels ? Mode::labels : Mode::debugger), &action);
      std::string last = key;
      for (const std::string modifier : {"Ctrl+", "Shift+", "Alt+"})
        if (last.starts_with(modifier)) last = last.substr(modifier.size());
      EXPECT_TRUE(key_of_name(last)) << key;
    }
  }
}

TEST(Actions, AcceptAnyArgumentWithOrWithoutAFrame) {
  State open = run_state();
  open.document.recordings[0].label_dir = scratch_dir();  // do not change the sample's labels
  for (const State& fresh : {State(), open})
    for (const Action& action : action_table())
      for (const std::string argument : {"", "0", "1", "-1", "99999999", "nonsense", "1,2",
                                         "1,2,3,4", "1,2,3,4,5,6", "=", "a=b", "P1"}) {
        if (action.name == "session.save") continue;
        State state = fresh;
        try {
          apply(state, {action.name, argument});
        } catch (const Error&) {
        }
      }
}

TEST(Actions, WriteNothingIntoTheRecording) {
  State state = run_state();
  OpenRecording& open = state.document.recordings[0];
  const std::map<std::string, std::string> files = {
      {"picture.save", "w.png"}, {"steps.save", "s.png"}, {"session.save", "s.json"}};
  for (const auto& [name, file] : files) {
    const std::filesystem::path out = open.path / "depth" / file;
    const std::string said = message_of([&, &action = name] {
      apply(state, {action, out.string()});
    });
    EXPECT_TRUE(has(said, out.string() + ": is in the recording")) << name << ": " << said;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  EXPECT_TRUE(!state.view.saving && state.view.picture_to.empty());
  open.label_dir = open.path / "depth";
  EXPECT_TRUE(has(message_of([&] { apply(state, {"label.mode", ""}); }), "is in the recording"));
  EXPECT_TRUE(!open.labels && state.view.mode == Mode::debugger);
}

TEST(Stepping, GoesForwardAndBackAndStopsAtTheEnds) {
  State state = run_state();
  apply(state, {"step.previous"});
  EXPECT_EQ(state.view.step, 0);
  apply(state, {"step.next"});
  EXPECT_EQ(state.view.step, 1);
  EXPECT_EQ(event_of(state).type, planes::EventType::visit);
  EXPECT_EQ(state.view.selected.node, 0);
  apply(state, {"step.last"});
  EXPECT_EQ(state.view.step, state.run()->steps());
  apply(state, {"step.next"});
  EXPECT_EQ(state.view.step, state.run()->steps());
  apply(state, {"step.first"});
  EXPECT_EQ(state.view.step, 0);
}

TEST(Stepping, ToTheNextNodeOfThisCaseVisitsAllAndReturns) {
  State state = run_state();
  apply(state, {"step.goto", "2"});  // the root's decision
  const auto wanted = event_of(state).node_case;
  const auto visited_by = [&](const char* action) {
    std::vector<int> steps = {state.view.step};
    while (true) {
      apply(state, {action});
      if (state.view.step == steps.back()) return steps;
      steps.push_back(state.view.step);
    }
  };
  const std::vector<int> forwards = visited_by("step.next_case");
  int count = 0;
  for (const planes::TraceEvent& event : state.run()->trace.events)
    count += event.type == planes::EventType::decide && event.node_case == wanted ? 1 : 0;
  EXPECT_EQ(static_cast<int>(forwards.size()), count);
  std::vector<int> back = visited_by("step.previous_case");
  std::ranges::reverse(back);
  EXPECT_EQ(forwards, back);
}

TEST(Stepping, BackFromTheEndColorsTheTraversalByCaseUntilTheEnd) {
  using render::ColorBy;
  State state = run_state();
  const auto back_into_the_traversal = [&] {
    apply(state, {"step.last"});
    apply(state, {"step.unit", "node"});
    apply(state, {"step.previous"});
  };
  apply(state, {"step.last"});
  apply(state, {"step.previous"});
  EXPECT_EQ(state.view.color_by, ColorBy::planes) << "leftovers are of planes";
  back_into_the_traversal();
  EXPECT_EQ(state.view.color_by, ColorBy::cases);
  EXPECT_TRUE(has(state.view.message, "press 2"));
  apply(state, {"step.last"});
  EXPECT_EQ(state.view.color_by, ColorBy::planes);
  EXPECT_TRUE(state.view.message.empty()) << "the hint is over";
  apply(state, {"step.goto", "20"});
  EXPECT_EQ(state.view.color_by, ColorBy::planes) << "a jump is not a step";
  back_into_the_traversal();
  apply(state, {"color.planes"});
  apply(state, {"step.previous"});
  back_into_the_traversal();
  EXPECT_EQ(state.view.color_by, ColorBy::planes) << "the user wants them so";
}

TEST(Stepping, ByNodeOrPlaneVisitsEachOfThemOnce) {
  for (const planes::Profile profile : {planes::Profile::paper, planes::Profile::refined}) {
    State state = run_state(profile);
    const planescope::debug::Run& run = *state.run();
    for (const std::string unit : {"node", "plane"}) {
      apply(state, {"step.unit", unit});
      std::vector<std::int32_t> forwards, back;
      for (apply(state, {"step.first"}); state.view.step < run.steps(); apply(state, {"step.next"}))
        forwards.push_back(state.view.step);
      for (apply(state, {"step.last"}); state.view.step > 0;)
        apply(state, {"step.previous"}), back.push_back(state.view.step);
      std::ranges::reverse(back);
      EXPECT_EQ(forwards, back) << unit;
      if (unit == "node") {
        EXPECT_EQ(forwards.size(), 1 + run.octree().nodes.size());
        continue;
      }
      std::set<std::int32_t> alive;  // changes only at these steps
      std::size_t at = 0;
      for (std::int32_t step = 1; step < run.steps(); ++step) {
        std::set<std::int32_t> now;
        for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane)
          if (const auto* change = run.timeline.plane_at(plane, step); change && change->alive)
            now.insert(plane);
        while (at < forwards.size() && forwards[at] < step) ++at;
        const bool stops = at < forwards.size() && forwards[at] == step;
        EXPECT_TRUE(stops || now == alive) << step;
        alive = std::move(now);
      }
    }
  }
}

TEST(Stepping, TheTimelineZoomsAboutTheCursor) {
  State state = run_state();
  apply(state, {"step.goto", "200"});
  const std::string range = "timeline.range";
  apply(state, {range, "100-299"});
  apply(state, {"timeline.zoom_in"});
  EXPECT_EQ(shown_steps(state), (debug::StepRange{150, 249}));
  apply(state, {"timeline.zoom_out"});
  EXPECT_EQ(shown_steps(state), (debug::StepRange{100, 299}));
  for (const char* wrong : {"", "5", "9-5", "0-99999999", "1-2-3", "a-b"})
    EXPECT_THROW(apply(state, {range, wrong}), Error) << wrong;
  EXPECT_EQ(shown_steps(state), (debug::StepRange{100, 299}));
}

TEST(Searching, NextAndPreviousMatchWalkTheMatches) {
  State state = run_state();
  apply(state, {"filter.set", "case==IV && depth>=3"});
  ASSERT_GT(state.view.search.matches.size(), 2u);
  apply(state, {"filter.next"});
  EXPECT_EQ(state.view.step, state.view.search.matches[0]);
  apply(state, {"filter.next"});
  EXPECT_EQ(state.view.step, state.view.search.matches[1]);
  apply(state, {"filter.previous"});
  EXPECT_EQ(state.view.step, state.view.search.matches[0]);
  EXPECT_EQ(event_of(state).node_case, 4);
  apply(state, {"filter.previous"});
  EXPECT_EQ(state.view.step, state.view.search.matches.back()) << "round the beginning";
  apply(state, {"filter.next"});
  EXPECT_EQ(state.view.step, state.view.search.matches[0]) << "round the end";
}

TEST(Breakpoints, StopARunInBothDirections) {
  State state = run_state();
  apply(state, {"break.on", "case==IV"});
  apply(state, {"run.forward"});
  const int first = state.view.step;
  EXPECT_EQ(event_of(state).node_case, 4);
  apply(state, {"run.forward"});
  EXPECT_GT(state.view.step, first);
  apply(state, {"run.back"});
  EXPECT_EQ(state.view.step, first);
  apply(state, {"break.enable", "0"});
  apply(state, {"run.forward"});
  EXPECT_EQ(state.view.step, state.run()->steps());
}

TEST(Options, AreUndonePerGesture) {
  State state = run_state();
  const int before = state.document.options.segment.theta_n_out;
  for (const char* value : {"6", "7", "8", "9"})
    apply(state, {"option.drag", std::string("theta_n_out=") + value});
  apply(state, {"option.drop"});
  apply(state, {"option.drag", "theta_n_out=12"});
  apply(state, {"option.drop"});
  EXPECT_EQ(state.undo.size(), 2u);
  apply(state, {"option.undo"});
  EXPECT_EQ(state.document.options.segment.theta_n_out, 9);
  apply(state, {"option.undo"});
  EXPECT_EQ(state.document.options.segment.theta_n_out, before);
  apply(state, {"option.redo"});
  EXPECT_EQ(state.document.options.segment.theta_n_out, 9);
}

TEST(Options, OutOfRangeChangeNothingAndResetToTheProfilesDefault) {
  State state = open_state();
  EXPECT_THROW(apply(state, {"option.set", "theta_coplane=7"}), Error);
  EXPECT_THROW(apply(state, {"option.set", "theta_coplan=0.7"}), Error);
  EXPECT_TRUE(state.undo.empty());
  EXPECT_EQ(state.document.options.segment.theta_coplane, 0.85);
  apply(state, {"option.set", "leftover_distance_m=0.02"});
  apply(state, {"option.reset", "leftover_distance_m"});
  EXPECT_EQ(state.document.options.segment.leftover_distance_m, 0.005);
}

TEST(Marking, GathersTheVoxelsOfARectangle) {
  State state = run_state();
  apply(state, {"mark.pixels", "300,300,340,340"});
  const std::size_t some = state.document.marked.size();
  EXPECT_GT(some, 3u);
  apply(state, {"mark.pixels", "300,300,340,340"});
  EXPECT_EQ(state.document.marked.size(), some);
  EXPECT_EQ(state.view.message, "already marked");
  apply(state, {"mark.clear"});
  EXPECT_TRUE(state.document.marked.empty());
}

TEST(Bookmarks, RestoreStepSelectionAndFilter) {
  State state = run_state();
  apply(state, {"filter.set", "merge"});
  apply(state, {"filter.next"});
  apply(state, {"bookmark.add", "here"});
  const int step = state.view.step, node = state.view.selected.node;
  apply(state, {"filter.clear"});
  apply(state, {"step.first"});
  apply(state, {"bookmark.go", "here"});
  EXPECT_EQ(state.view.step, step);
  EXPECT_EQ(state.view.selected.node, node);
  EXPECT_EQ(state.view.search.text, "merge");
}

TEST(Pinning, KeepsColorsWhenTheStripRunsWithOtherOptions) {
  State state = run_state();
  auto view = std::make_shared<RunView>(*state.results.current);
  const auto colored = [&](int shift) {
    render::ColoredPlanes planes = render::color_planes(render::plane_image(*view->run));
    for (int& color : planes.colors) color = (color + shift) % render::kPlaneColors + 1;
    return std::make_shared<const render::ColoredPlanes>(std::move(planes));
  };
  view->colors = {colored(0), "options of A"};
  state.results.current = view;
  state.results.strip.resize(1);
  state.results.strip[0].colors = {colored(1), "options of A"};
  const std::vector<int> shown = colors_of_planes(state, *view);
  EXPECT_EQ(shown, render::trace_colors(*view->run, colored(1)->own_colors()));
  apply(state, {"run.pin"});
  state.results.strip[0].colors = {colored(2), "options of B"};
  EXPECT_EQ(colors_of_planes(state, *state.results.pinned), shown);
}

/// Position of an action in the palette's list.
std::ptrdiff_t place_of(const std::string& name, const std::string& typed) {
  const std::vector<Offer> found = palette_offers({}, typed);
  return std::ranges::find_if(found, [&](const Offer& o) { return o.action->name == name; }) -
         found.begin();
}

TEST(Palette, FindsActionsByTheStartsOfTheirWords) {
  const State state;
  const auto first = [&](const std::string& typed) {
    return palette_offers(state, typed).front().action->name;
  };
  EXPECT_EQ(first("next match"), "filter.next");
  EXPECT_EQ(first("look above"), "camera.top");
  EXPECT_TRUE(palette_offers(state, "qqqqzz").empty());
  State labelling;
  labelling.view.mode = Mode::labels;
  const std::size_t everywhere = palette_offers(state, "").size();
  EXPECT_LT(everywhere, action_table().size());
  EXPECT_EQ(
      everywhere + palette_offers(labelling, "").size(),
      action_table().size() + static_cast<std::size_t>(std::count_if(
                                  action_table().begin(), action_table().end(),
                                  [](const Action& a) { return a.mode == KeyMode::anywhere; })));
}

TEST(Palette, FindsActionsBySynonyms) {
  for (const char* word : {"grey", "gray", "why", "lost"})
    EXPECT_LT(place_of("lost.show", word), 4);
  EXPECT_LT(place_of("option.undo", "undo"), 4);
  EXPECT_LT(place_of("picture.save", "screenshot"), 4);
  EXPECT_LT(place_of("intrinsics.edit", "calibration"), 4);
}

TEST(Palette, RanksWholeWordsBeforeStartsBeforeInnerMatches) {
  const struct {
    const char *typed, *first, *later;
  } cases[] = {{"plane", "select.plane", "planes.sort"},
               // "steppable" only starts with it
               {"step", "step.next", "color.steppable"},
               // "mark" is not the start of a word in "Bookmark"
               {"mark", "mark.toggle", "bookmark.add"},
               {"mar", "mark.clear", "bookmark.add"},
               // The worst match of the words decides.
               {"fix marked", "fix.marked", "fix.plane"}};
  for (const auto& [typed, first, later] : cases)
    EXPECT_LT(place_of(first, typed), place_of(later, typed)) << typed;
}

TEST(Camera, OrbitsAtTheSameDistanceAndStaysUpright) {
  render::Camera camera;
  camera.eye = Vec3d(-2, 0, 1);
  for (int i = 0; i < 40; ++i) camera = orbited(camera, 13, 7);
  EXPECT_NEAR((camera.eye - camera.target).norm(), std::sqrt(5.0), 1e-9);
  EXPECT_GT(camera.up.z(), 0.9);
  EXPECT_NEAR((zoomed(camera, 2).eye - camera.target).norm(), std::sqrt(5.0) / 2, 1e-9);
}

struct Scripts : OpenDesktop {
  std::string refusal(const std::string& actions) {
    try {
      play(actions);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Scripts, PerformActionsAndExpectFacts) {
  play(R"("step.first", {"do": "step.next"}, {"expect": {"step": 1}})");
  EXPECT_THROW(play(R"({"expect": {"step": 7}})"), ExpectationFailed);
}

TEST_F(Scripts, PressKeysAndTypeText) {
  play(R"({"key": "Home"}, {"key": "Right"}, {"key": "Right"}, {"expect": {"step": 2}},
          {"key": "Ctrl+P"}, {"type": "last step"}, {"key": "Enter"})");
  EXPECT_EQ(state().view.step, state().run()->steps());
  EXPECT_FALSE(state().view.show_palette);
}

TEST_F(Scripts, AKeyPromptsForTheArgumentOfItsAction) {
  play(R"({"key": "G"}, {"type": "17"}, {"key": "Enter"}, {"expect": {"step": 17}})");
  EXPECT_FALSE(state().view.show_palette);
  EXPECT_NE(refusal(R"("step.goto")"), "") << "a script has nobody to ask";
}

TEST_F(Scripts, WithErrorsReportTheActionAndTheNearestName) {
  EXPECT_TRUE(has(refusal(R"("step.nxt")"), "step.next"));
  EXPECT_TRUE(has(refusal(R"("step.next", {"click": "tab.histogram"})"), "tab.histograms"));
  EXPECT_TRUE(has(refusal(R"("step.next", {"click": "x"})"), "action 2"));
  for (const char* wrong :
       {R"({"expect": {"stop": 7}})", R"({"dance": 1})", R"({"key": "Hyper"})", "{"})
    EXPECT_NE(refusal(wrong), "") << wrong;
  std::ofstream(dir / "no_list.json") << R"({"actions": {}})";
  EXPECT_THROW(Script::read(dir / "no_list.json"), Error);
}

}  // namespace
}  // namespace planescope::desktop
