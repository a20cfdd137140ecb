// Actions on options and their undo history, A/B comparison, and fixes.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

// ---- Options -----------------------------------------------------------------------------------

OptionValue read_option(const State&, const std::string& action, const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos)
    throw Error(fmt::format("action {}: '{}' is not NAME=VALUE", action, text));
  return {text.substr(0, at), text.substr(at + 1)};
}

/// Adds an undo step, or extends the last one of the same gesture; an empty `gesture` always adds
/// one.
void change_by(State& state, const planes::PipelineOptions& after, const std::string& gesture) {
  constexpr std::size_t kMostUndo = 200;
  const bool goes_on =
      !gesture.empty() && !state.undo.empty() && state.undo.back().gesture == gesture;
  if (goes_on)
    state.undo.back().after = after;
  else
    state.undo.push_back({state.document.options, after, gesture, {}});
  if (state.undo.size() > kMostUndo) state.undo.erase(state.undo.begin());
  state.redo.clear();
  state.document.options = after;
}

void set_option(State& state, const OptionValue& option, bool drag = false) {
  planes::PipelineOptions after = state.document.options;
  planes::set_option(after, option.name, option.value);
  change_by(state, after, drag ? option.name : "");
}

void reset_option(State& state, const std::string& name) {
  planes::PipelineOptions defaults, after = state.document.options;
  defaults.segment = planes::profile_options(after.segment.profile);
  const planes::OptionInfo& info = planes::find_option(name);
  info.set(after, info.get(defaults));
  change_options(state, after);
}

void move_change(State& state,
                 std::vector<OptionChange>& from,
                 std::vector<OptionChange>& to,
                 bool back) {
  if (const auto& gravity = from.back().gravity) {
    // Do this first, because the file may not be writable. It may belong to another recording.
    keep_picked(state, gravity->recording, back ? gravity->before : gravity->after);
    say(state, fmt::format("gravity for {} restored to its value {} the click",
                           gravity->recording.filename().string(), back ? "before" : "after"));
  }
  to.push_back(from.back());
  from.pop_back();
  to.back().gesture.clear();
  state.document.options = back ? to.back().before : to.back().after;
}

// ---- A and B -----------------------------------------------------------------------------------

bool has_current(const State& state) { return state.results.current != nullptr; }
bool has_pinned(const State& state) { return state.results.pinned != nullptr; }
bool has_truth(const State& state) {
  return has_current(state) && state.results.current->run->subject->voxel_truth.known();
}

/// Keeps foot and stairs options: they do not affect runs, so A and B share them.
void restore(State& state) {
  planes::PipelineOptions after = state.results.pinned->run->options;
  after.foot = state.document.options.foot;
  after.stairs = state.document.options.stairs;
  change_options(state, after);
}

void pin(State& state) {
  unflash(state);
  state.results.pinned_colors = shown_colors(state, *state.results.current);
  state.results.pinned = state.results.current;
  state.view.against = Against::pinned;
  state.view.tool_tab = "compare";
  say_hint(state, "A pinned: change an option to make B",
           [](const State& s) { return s.results.pinned != s.results.current; });
}

void unpin(State& state) {
  unflash(state);
  state.results.pinned = nullptr;
  state.view.wiper = false;
  if (state.view.against == Against::pinned) state.view.against = Against::nothing;
}

/// `profile` is a name or a file. The current run becomes A.
void compare_profile(State& state, const std::string& profile) {
  planes::PipelineOptions after = state.document.options;
  planes::set_profile(after, profile);
  pin(state);
  change_options(state, after);
  say(state, fmt::format("A has the previous options; B has profile {}", profile));
}

void flash(State& state) {
  const debug::Run* before = state.run();
  state.view.flash = !state.view.flash;
  if (before) follow_run(state, *before);
}

void go_to_difference(State& state) {
  if (!state.results.comparison || !state.results.pinned)
    return say_hint(state, "nothing to compare with: pin a run as A, then change an option",
                    [](const State& now) { return now.results.comparison != nullptr; });
  const debug::Comparison& c = *state.results.comparison;
  const std::int32_t step = state.view.flash ? c.diverging_step_a : c.diverging_step_b;
  if (step == planes::kNever)
    return say(state, "A and B make the same decisions from the first event to the last");
  go_to_step(state, step);
}

// ---- Fixes -------------------------------------------------------------------------------------

void search_fix(State& state) {
  const debug::Run& run = *state.results.current->run;
  if (!run.is_ours()) return say(state, "fixes are available only for method ours");
  FixSearch begun;
  const bool labeled = run.subject->voxel_truth.known();
  begun.target = labeled && state.view.truth_plane > 0
                     ? debug::target_of_truth(run, state.view.truth_plane)
                     : debug::FixTarget{.voxels = state.document.marked,
                                        .name = "marked region",
                                        .wish = debug::Wish::plane};
  state.view.tool_tab = "fix";
  if (begun.target.voxels.empty())
    return say_hint(
        state,
        labeled ? "nothing to recover: choose a plane of the ground truth, or mark a region"
                : "nothing to recover: mark a region of the image (M)",
        [](const State& s) { return !s.document.marked.empty() || s.results.fix.running; });
  begun.running = true;
  state.results.fix = begun;
}

PointWish read_wish(const State& state, const std::string& action, const std::string& text) {
  const std::string with = "with ";
  if (text.starts_with(with)) {
    const auto voxels = static_cast<int>(state.run()->subject->voxel_count());
    return {debug::Wish::joined, whole_argument(action, text.substr(with.size()), 0, voxels - 1)};
  }
  if (text == "own") return {debug::Wish::own_plane};
  if (text == "none") return {debug::Wish::no_plane};
  if (text.empty() || text == "plane") return {};
  throw Error("action fix.point: unknown value '" + text +
              "'; expected plane, own, none, or with VOXEL");
}

void ask_of_selected(State& state, const PointWish& wish) {
  const int voxel = state.view.selected.voxel;
  if (voxel < 0) throw Error("action fix.point: no point is selected");
  ask_of_point(state, {static_cast<std::uint32_t>(voxel), wish.wish, wish.with});
}

void search_farther(State& state) {
  FixSearch& fix = state.results.fix;
  if (fix.asked) return ask_of_point(state, PointAsked(*fix.asked), true);
  FixSearch farther;
  farther.target = fix.target;
  farther.target.far = farther.running = true;
  fix = farther;
}

void check_fix(State& state, int index) {
  FixSearch& fix = state.results.fix;
  fix.checked = index;
  fix.check_begun = false;
  fix.effects.clear();
}

}  // namespace

void change_options(State& state, const planes::PipelineOptions& after) {
  change_by(state, after, "");
}

void ask_of_point(State& state, const PointAsked& asked, bool far) {
  FixSearch& fix = state.results.fix;
  state.view.preview.reset();
  const std::shared_ptr<const RunView>& current = state.results.current;
  if (!current || !current->run->is_ours())
    return say(state, "fixes are available only for method ours");
  if (state.run() != current->run.get())
    return say(state, "fixes are available only for B, but A is shown; press Space to switch");
  const bool is_asked =
      fix.running ? !fix.begun || fix.of == current : fix.finished && fix.of == current;
  if (is_asked && fix.asked == asked && fix.target.far == far) return;
  fix = {};
  fix.asked = asked;
  fix.target.far = far;
  fix.running = true;
}

void add_option_actions(std::vector<Action>& all) {
  const ActionGroup edit{all, KeyMode::debugger, "Edit"};
  const Takes<OptionValue> option{"NAME=VALUE", read_option};
  edit.add("option.undo", "Undo option change")
      .key("Ctrl+Z")
      .words("undo revert back")
      .when([](const State& s) { return !s.undo.empty(); })
      .run([](State& s) { move_change(s, s.undo, s.redo, true); });
  edit.add("option.redo", "Redo option change")
      .key("Ctrl+Shift+Z Ctrl+Y")
      .words("redo again")
      .when([](const State& s) { return !s.redo.empty(); })
      .run([](State& s) { move_change(s, s.redo, s.undo, false); });
  edit.add("option.set", "Set an option").key("E").run(option, [](State& s, const OptionValue& o) {
    set_option(s, o);
  });
  edit.add("option.drag", "Drag an option").run(option, [](State& s, const OptionValue& o) {
    set_option(s, o, true);
  });
  edit.add("option.drop", "End dragging").run([](State& s) {
    if (!s.undo.empty()) s.undo.back().gesture.clear();
  });
  edit.add("option.reset", "Reset an option").run(text("NAME"), reset_option);
  edit.add("option.show", "Show an option").run(text("NAME"), [](State& s, const auto& name) {
    s.view.tool_tab = "criteria";
    s.view.focus = "criteria." + planes::find_option(name).name;
  });
  edit.add("option.reset_all", "Reset all options")
      .key("Ctrl+R")
      .words("defaults")
      .run([](State& s) {
        planes::PipelineOptions after;
        after.threads = s.document.options.threads;
        change_options(s, after);
      });
  edit.add("method.choose", "Method")
      .key("Ctrl+M")
      .run(text(fmt::format("{}", fmt::join(planes::find_option("method").choices, "|"))),
           [](State& s, const std::string& method) {
             set_option(s, {"method", method});
           });
  const auto add_profile = [&](const char* name, const char* title, const char* key,
                               planes::Profile profile) {
    edit.add(name, title)
        .key(key)
        .on([profile](const State& s) { return s.document.options.segment.profile == profile; })
        .run([profile](State& s) {
          set_option(s, {"profile", planes::to_string(profile)});
        });
  };
  using planes::Profile;
  add_profile("profile.paper", "Profile paper: the method as written", "Ctrl+1", Profile::paper);
  add_profile("profile.paper_closest", "Profile paper-closest: closest to the published tables",
              "Ctrl+2", Profile::paper_closest);
  add_profile("profile.refined", "Profile refined: the default", "Ctrl+3", Profile::refined);
}

void add_compare_actions(std::vector<Action>& all) {
  const ActionGroup compare{all, KeyMode::debugger, "Compare"};
  const ActionGroup of_b{all, KeyMode::debugger, "Compare", has_current};
  const ActionGroup of_a{all, KeyMode::debugger, "Compare", has_pinned};
  of_b.add("run.pin", "Pin this run as A").key("A").run(pin);
  of_b.add("compare.profile", "Compare with a profile as B")
      .menu()
      .run(text("NAME|FILE"), compare_profile);
  of_a.add("run.unpin", "Unpin A").key("Shift+A").run(unpin);
  of_a.add("run.flash", "Switch between A and B")
      .key("Space")
      .on([](const State& s) { return s.view.flash; })
      .run(flash);
  of_a.add("run.wiper", "Wipe between A and B").key("Shift+Space").flips(&ViewState::wiper);
  compare.add("wiper.set", "Move the divider between A and B")
      .run(number("SHARE"),
           [](State& s, double share) { s.view.wiper_at = std::clamp(share, 0.0, 1.0); });
  of_a.add("run.restore", "Restore the options of A").key("Ctrl+Shift+A").run(restore);
  compare.add("compare.against", "Compare with")
      .key("C")
      .run(choice<Against>("nothing|pinned|truth"), [](State& s, Against against) {
        s.view.against = against;
        s.view.tool_tab = "compare";
      });
  of_b.add("compare.diverging", "Go to the first different event").key("D").run(go_to_difference);

  const auto fixes = item(
      "NUMBER", [](const State& s) -> auto& { return s.results.fix.fixes; });
  of_b.add("fix.plane", "Find a fix for a true plane")
      .key("Ctrl+X")
      .when(has_truth)
      .run(whole("TRUTH_PLANE",
                 [](const State& s) {
                   return Range{0, s.results.current->run->subject->voxel_truth.plane_count};
                 }),
           [](State& s, int plane) {
             s.view.truth_plane = plane;
             search_fix(s);
           });
  of_b.add("fix.search", "Find a fix").key("X").words("why lost repair remedy").run(search_fix);
  of_b.add("fix.marked", "Find a fix for the marked region").key("Shift+X").run([](State& s) {
    s.view.truth_plane = 0;
    search_fix(s);
  });
  of_b.add("fix.point", "Find a fix for the selected point")
      .menu()
      .words("why lost grey gray repair remedy")
      .run(Takes<PointWish>{"plane|own|none|with VOXEL", read_wish}, ask_of_selected);
  compare.add("fix.far", "Search a wider range")
      .key("Alt+X")
      .when([](const State& s) {
        return s.results.fix.finished && s.results.current && s.results.fix.of == s.results.current;
      })
      .run(search_farther);
  compare.add("fix.preview", "Preview a fix")
      .run(maybe(fixes), [](State& s, const std::optional<int>& index) {
        s.view.preview.reset();
        if (!index) return;
        const debug::Fix& fix = s.results.fix.fixes[static_cast<std::size_t>(*index)];
        s.view.preview = {fix.option, fix.after};
      });
  compare.add("fix.cancel", "Stop the search")
      .key("Shift+K")
      .when([](const State& s) { return s.results.fix.running; })
      .run([](State& s) { s.results.fix.running = false; });
  compare.add("fix.check", "Check a fix on all labeled frames").run(fixes, check_fix);
  compare.add("fix.apply", "Apply a fix").run(fixes, [](State& s, int index) {
    const debug::Fix fix = s.results.fix.fixes[static_cast<std::size_t>(index)];
    s.view.preview.reset();
    set_option(s, {fix.option, fix.after});
  });
}

}  // namespace planescope::desktop
