// A/B, and what would fix this.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

bool has_current(const State& state) { return state.results.current != nullptr; }
bool has_pinned(const State& state) { return state.results.pinned != nullptr; }
bool has_truth(const State& state) {
  return has_current(state) && state.results.current->run->subject->voxel_truth.known();
}

/// A foot and stairs stay: they are no run's own, both A and B are told of by the same.
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

/// `profile`: a name, or a file of one's own. What is looked at becomes A.
void compare_profile(State& state, const std::string& profile) {
  planes::PipelineOptions after = state.document.options;
  planes::set_profile(after, profile);
  pin(state);
  change_options(state, after);
  say(state, fmt::format("A is as it was, B has the profile {}", profile));
}

void flash(State& state) {
  const debug::Run* before = state.run();
  state.view.flash = !state.view.flash;
  if (before) follow_run(state, *before);
}

void search_fix(State& state) {
  FixSearch& fix = state.results.fix;
  const debug::Run& run = *state.results.current->run;
  if (!run.is_ours()) return say(state, "fixes are sought among the options of method ours");
  FixSearch begun;
  const bool labelled = run.subject->voxel_truth.known();
  begun.target = labelled && state.view.truth_plane > 0
                     ? debug::target_of_truth(run, state.view.truth_plane)
                     : debug::FixTarget{.voxels = state.document.marked,
                                        .name = "marked region",
                                        .wish = debug::Wish::plane};
  if (begun.target.voxels.empty()) {
    state.view.tool_tab = "fix";
    return say_hint(
        state,
        labelled ? "nothing to recover: choose a plane of the ground truth, or mark a region"
                 : "nothing to recover: mark a region of the image (M)",
        [](const State& s) { return !s.document.marked.empty() || s.results.fix.running; });
  }
  begun.running = true;
  fix = begun;
  state.view.tool_tab = "fix";
}

/// "own", "none", "plane", or "with VOXEL".
PointAsked asked_in(const State& state, const std::string& text) {
  const int voxel = state.view.selected.voxel;
  if (voxel < 0) throw Error("action fix.point: no point is selected");
  PointAsked asked{.voxel = static_cast<std::uint32_t>(voxel)};
  const std::string with = "with ";
  if (text.starts_with(with)) {
    const auto voxels = static_cast<int>(state.run()->subject->voxel_count());
    asked.with = whole_argument("fix.point", text.substr(with.size()), 0, voxels - 1);
    asked.wish = debug::Wish::joined;
  } else if (text == "own") {
    asked.wish = debug::Wish::own_plane;
  } else if (text == "none") {
    asked.wish = debug::Wish::no_plane;
  } else if (!text.empty() && text != "plane") {
    throw Error("action fix.point: '" + text + "': expected plane, own, none or with VOXEL");
  }
  return asked;
}

}  // namespace

void ask_of_point(State& state, const PointAsked& asked, bool far) {
  FixSearch& fix = state.results.fix;
  state.view.preview.reset();
  const std::shared_ptr<const RunView>& current = state.results.current;
  if (!current || !current->run->is_ours())
    return say(state, "fixes are sought among the options of method ours");
  if (state.run() != current->run.get())
    return say(state, "A is shown: fixes are sought for B (Space)");
  const bool is_asked =
      fix.running ? !fix.begun || fix.of == current : fix.finished && fix.of == current;
  if (is_asked && fix.asked == asked && fix.target.far == far) return;
  fix = {};
  fix.asked = asked;
  fix.target.far = far;
  fix.running = true;
}

std::vector<Action> compare_actions() {
  const std::string menu = "Compare";
  return {
      {"run.pin",
       "Pin this run as A",
       menu,
       "A",
       "",
       [](State& s, const std::string&) { pin(s); },
       has_current,
       {}},
      {"compare.profile",
       "Compare with a profile as B",
       menu,
       "",
       "NAME|FILE",
       [](State& s, const std::string& profile) { compare_profile(s, profile); },
       has_current,
       {}},
      {"run.unpin",
       "Unpin A",
       menu,
       "Shift+A",
       "",
       [](State& s, const std::string&) {
         unflash(s);
         s.results.pinned = nullptr;
         s.view.wiper = false;
         if (s.view.against == Against::pinned) s.view.against = Against::nothing;
       },
       has_pinned,
       {}},
      {"run.flash", "Switch between A and B", menu, "Space", "",
       [](State& s, const std::string&) { flash(s); }, has_pinned,
       [](const State& s) { return s.view.flash; }},
      {"run.wiper", "Wipe between A and B", menu, "Shift+Space", "",
       [](State& s, const std::string&) { s.view.wiper = !s.view.wiper; }, has_pinned,
       [](const State& s) { return s.view.wiper; }},
      {"wiper.set",
       "Move the divider between A and B",
       "",
       "",
       "SHARE",
       [](State& s, const std::string& text) {
         s.view.wiper_at = std::clamp(number_argument("wiper.set", text), 0.0, 1.0);
       },
       {},
       {}},
      {"run.restore",
       "Restore the options of A",
       menu,
       "Ctrl+Shift+A",
       "",
       [](State& s, const std::string&) { restore(s); },
       has_pinned,
       {}},
      {"compare.against",
       "Compare with",
       menu,
       "C",
       "nothing|pinned|truth",
       [](State& s, const std::string& text) {
         s.view.against = static_cast<Against>(
             choice_argument("compare.against", text, {"nothing", "pinned", "truth"}));
         s.view.tool_tab = "compare";
       },
       {},
       {}},
      {"compare.diverging",
       "Go to the first different event",
       menu,
       "D",
       "",
       [](State& s, const std::string&) {
         if (!s.results.comparison || !s.results.pinned)
           return say_hint(s, "nothing to compare with: pin a run as A, then change an option",
                           [](const State& now) { return now.results.comparison != nullptr; });
         const auto& c = *s.results.comparison;
         const std::int32_t step = s.view.flash ? c.diverging_step_a : c.diverging_step_b;
         if (step == planes::kNever)
           return say(s, "A and B decide alike from the first event to the last");
         go_to_step(s, step);
       },
       has_current,
       {}},
      {"fix.plane",
       "Find a fix for a true plane",
       menu,
       "Ctrl+X",
       "TRUTH_PLANE",
       [](State& s, const std::string& text) {
         const int planes = s.results.current->run->subject->voxel_truth.plane_count;
         s.view.truth_plane = whole_argument("fix.plane", text, 0, planes);
         search_fix(s);
       },
       has_truth,
       {}},
      {"fix.search",
       "Find a fix",
       menu,
       "X",
       "",
       [](State& s, const std::string&) { search_fix(s); },
       has_current,
       {}},
      {"fix.marked",
       "Find a fix for the marked region",
       menu,
       "Shift+X",
       "",
       [](State& s, const std::string&) {
         s.view.truth_plane = 0;
         search_fix(s);
       },
       has_current,
       {}},
      {"fix.point",
       "Find a fix for the selected point",
       menu,
       "",
       "plane|own|none|with VOXEL",
       [](State& s, const std::string& text) { ask_of_point(s, asked_in(s, text)); },
       has_current,
       {}},
      {"fix.far",
       "Search a wider range",
       menu,
       "Alt+X",
       "",
       [](State& s, const std::string&) {
         FixSearch& fix = s.results.fix;
         if (fix.asked) return ask_of_point(s, *fix.asked, true);
         FixSearch farther;
         farther.target = fix.target;
         farther.target.far = farther.running = true;
         fix = farther;
       },
       [](const State& s) {
         return s.results.fix.finished && s.results.current &&
                s.results.fix.of == s.results.current;
       },
       {}},
      {"fix.preview",
       "Preview a fix",
       "",
       "",
       "[NUMBER]",
       [](State& s, const std::string& text) {
         s.view.preview.reset();
         if (text.empty()) return;
         const debug::Fix& fix = item_argument("fix.preview", text, s.results.fix.fixes);
         s.view.preview = {fix.option, fix.after};
       },
       {},
       {}},
      {"fix.cancel",
       "Stop the search",
       menu,
       "Shift+K",
       "",
       [](State& s, const std::string&) { s.results.fix.running = false; },
       [](const State& s) { return s.results.fix.running; },
       {}},
      {"fix.check",
       "Check a fix on all labeled frames",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         FixSearch& fix = s.results.fix;
         fix.checked =
             static_cast<int>(&item_argument("fix.check", text, fix.fixes) - fix.fixes.data());
         fix.check_begun = false;
         fix.effects.clear();
       },
       {},
       {}},
      {"fix.apply",
       "Apply a fix",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         const debug::Fix fix = item_argument("fix.apply", text, s.results.fix.fixes);
         planes::PipelineOptions after = s.document.options;
         planes::set_option(after, fix.option, fix.after);
         s.view.preview.reset();
         change_options(s, after);
       },
       {},
       {}},
  };
}

}  // namespace planescope::desktop
