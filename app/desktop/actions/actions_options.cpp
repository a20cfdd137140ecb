// The options, with undo: one entry for each gesture.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kMostUndo = 200;

std::pair<std::string, std::string> name_and_value(const std::string& action,
                                                   const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos)
    throw Error(fmt::format("action {}: '{}' is not NAME=VALUE", action, text));
  return {text.substr(0, at), text.substr(at + 1)};
}

/// `gesture` empty: an entry of its own.
void change_by(State& state, const planes::PipelineOptions& after, const std::string& gesture) {
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

void set(State& state, const std::string& action, const std::string& text, bool drag) {
  const auto [name, value] = name_and_value(action, text);
  planes::PipelineOptions after = state.document.options;
  planes::set_option(after, name, value);
  change_by(state, after, drag ? name : "");
}

void reset(State& state, const std::string& name) {
  const planes::PipelineOptions& now = state.document.options;
  planes::PipelineOptions defaults;
  defaults.segment = planes::profile_options(now.segment.profile);
  const planes::OptionInfo& info = planes::find_option(name);
  planes::PipelineOptions after = now;
  info.set(after, info.get(defaults));
  change_options(state, after);
}

void move_change(State& state,
                 std::vector<OptionChange>& from,
                 std::vector<OptionChange>& to,
                 planes::PipelineOptions OptionChange::*which) {
  if (const auto& gravity = from.back().gravity)  // first: it may not be writable
    keep_picked(state, gravity->recording,
                which == &OptionChange::before ? gravity->before : gravity->after);
  if (const auto& gravity = from.back().gravity)  // it may be of another one than is looked at
    say(state, fmt::format("gravity of {} is as it was {} the click",
                           gravity->recording.filename().string(),
                           which == &OptionChange::before ? "before" : "after"));
  to.push_back(from.back());
  from.pop_back();
  to.back().gesture.clear();
  state.document.options = to.back().*which;
}

}  // namespace

void change_options(State& state, const planes::PipelineOptions& after) {
  change_by(state, after, "");
}

std::vector<Action> option_actions() {
  const std::string menu = "Edit";
  return {
      {"option.undo",
       "Undo option change",
       menu,
       "Ctrl+Z",
       "",
       [](State& s, const std::string&) { move_change(s, s.undo, s.redo, &OptionChange::before); },
       [](const State& s) { return !s.undo.empty(); },
       {}},
      {"option.redo",
       "Redo option change",
       menu,
       "Ctrl+Shift+Z Ctrl+Y",
       "",
       [](State& s, const std::string&) { move_change(s, s.redo, s.undo, &OptionChange::after); },
       [](const State& s) { return !s.redo.empty(); },
       {}},
      {"option.set",
       "Set an option",
       menu,
       "E",
       "NAME=VALUE",
       [](State& s, const std::string& text) { set(s, "option.set", text, false); },
       {},
       {}},
      {"option.drag",
       "Drag an option",
       "",
       "",
       "NAME=VALUE",
       [](State& s, const std::string& text) { set(s, "option.drag", text, true); },
       {},
       {}},
      {"option.drop",
       "End dragging",
       "",
       "",
       "",
       [](State& s, const std::string&) {
         if (!s.undo.empty()) s.undo.back().gesture.clear();
       },
       {},
       {}},
      {"option.reset", "Reset an option", "", "", "NAME", reset, {}, {}},
      {"option.show",
       "Show an option",
       "",
       "",
       "NAME",
       [](State& s, const std::string& name) {
         s.view.tool_tab = "criteria";
         const planes::OptionInfo& info = planes::find_option(name);
         s.view.focus = "criteria." + info.name;
       },
       {},
       {}},
      {"option.reset_all",
       "Reset all options",
       menu,
       "Ctrl+R",
       "",
       [](State& s, const std::string&) {
         planes::PipelineOptions after;
         after.threads = s.document.options.threads;
         change_options(s, after);
       },
       {},
       {}},
      {"method.choose",
       "Method",
       menu,
       "Ctrl+M",
       fmt::format("{}", fmt::join(planes::find_option("method").choices, "|")),
       [](State& s, const std::string& text) { set(s, "option.set", "method=" + text, false); },
       {},
       {}},
      {"profile.paper",
       "Profile paper: the method as written",
       menu,
       "Ctrl+1",
       "",
       [](State& s, const std::string&) { set(s, "option.set", "profile=paper", false); },
       {},
       [](const State& s) { return s.document.options.segment.profile == planes::Profile::paper; }},
      {"profile.paper_closest",
       "Profile paper-closest: closest to the published tables",
       menu,
       "Ctrl+2",
       "",
       [](State& s, const std::string&) { set(s, "option.set", "profile=paper-closest", false); },
       {},
       [](const State& s) {
         return s.document.options.segment.profile == planes::Profile::paper_closest;
       }},
      {"profile.refined",
       "Profile refined: the default",
       menu,
       "Ctrl+3",
       "",
       [](State& s, const std::string&) { set(s, "option.set", "profile=refined", false); },
       {},
       [](const State& s) {
         return s.document.options.segment.profile == planes::Profile::refined;
       }},
  };
}

}  // namespace planescope::desktop
