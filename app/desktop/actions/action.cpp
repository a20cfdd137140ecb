// Table of desktop actions: lookup by name and key, palette search, and argument parsing.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "app/desktop/actions/actions.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// Returns 3 if the word is a whole word of the text, 2 if a prefix of one, 1 if anywhere in it, 0
/// otherwise.
int fit_of_word(const std::string& word, const std::string& text) {
  int best = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool starts = at == 0 || !is_letter(text[at - 1]);
    const bool ends = end == text.size() || !is_letter(text[end]);
    best = std::max(best, starts && ends ? 3 : starts ? 2 : 1);
  }
  return best;
}

/// Ranks by the worst word, then by all words; -1: not even the letters occur in order.
int fit_of(const std::vector<std::string>& words, const std::string& text) {
  int least = 3, sum = 0;
  for (const std::string& word : words) {
    const int fit = fit_of_word(word, text);
    least = std::min(least, fit);
    sum += fit;
  }
  if (least > 0) return 1000 * least + sum;
  std::size_t from = 0;
  for (const std::string& word : words)
    for (const char c : word) {
      from = text.find(c, from);
      if (from++ == std::string::npos) return -1;
    }
  return sum;
}

void check_whole(const std::string& action, int value, const Range& range) {
  if (value >= range.low && value <= range.high) return;
  throw Error(range.high < range.low
                  ? fmt::format("action {}: no item {}: the list is empty", action, value)
                  : fmt::format("action {}: {} is out of range; expected {} to {}", action, value,
                                range.low, range.high));
}

}  // namespace

// ---- Table -------------------------------------------------------------------------------------

const std::vector<Action>& action_table() {
  static const std::vector<Action> table = [] {
    std::vector<Action> all;
    for (const auto add :
         {add_document_actions, add_label_mode_actions, add_view_actions, add_camera_actions,
          add_step_actions, add_search_actions, add_selection_actions, add_option_actions,
          add_compare_actions, add_label_tool_actions, add_label_draw_actions,
          add_label_plane_actions, add_review_actions, add_learning_actions, add_gravity_actions,
          add_measure_actions, add_track_actions})
      add(all);
    return all;
  }();
  return table;
}

const Action& find_action(const std::string& name) {
  std::vector<std::string> names;
  for (const Action& action : action_table()) {
    if (action.name == name) return action;
    names.push_back(action.name);
  }
  const std::string near = nearest_name(name, names);
  throw Error("unknown action '" + name + "'" +
              (near.empty() ? std::string("; `planescope view --actions` lists all actions")
                            : "; did you mean '" + near + "'?"));
}

bool needs_argument(const Action& action) {
  return !action.takes.empty() && action.takes[0] != '[';
}

bool fits(const Action& action, Mode mode) {
  return action.mode == KeyMode::anywhere ||
         (action.mode == KeyMode::labels) == (mode == Mode::labels);
}

const Action* action_of_key(const std::string& key, Mode mode) {
  const Action* anywhere = nullptr;
  for (const Action& action : action_table()) {
    if (!fits(action, mode)) continue;
    for (const std::string& one : split(action.keys, ' ')) {
      if (one != key) continue;
      if (action.mode != KeyMode::anywhere) return &action;
      anywhere = &action;
    }
  }
  return anywhere;
}

std::string first_key(const Action& action) { return action.keys.substr(0, action.keys.find(' ')); }

void apply(State& state, const Command& command) {
  const Action& action = find_action(command.action);
  if (action.takes.empty() && !command.argument.empty())
    throw Error(fmt::format("action {}: unexpected argument '{}'; expected none", action.name,
                            command.argument));
  if (!action.can_run(state))
    throw Error(fmt::format("action {}: not currently available", action.name));
  action.run(state, command);
  drop_done_hint(state);
}

std::vector<Offer> palette_offers(const State& state, const std::string& typed) {
  std::string american = lower_case(typed);
  for (std::size_t at; (at = american.find("colour")) != std::string::npos;)
    american.replace(at, 6, "color");
  const std::vector<std::string> wanted = words_of(american);
  std::vector<std::pair<int, Offer>> found;
  const auto add = [&](Offer offer, const std::string& text) {
    const int fit = fit_of(wanted, lower_case(text));
    if (fit >= 0) found.emplace_back(fit, std::move(offer));
  };
  for (const Action& action : action_table())
    if (fits(action, state.view.mode))
      add({&action, "", action.title}, action.title + "  " + action.name + "  " + action.words);
  for (const std::filesystem::path& path : state.document.recent) {
    const std::string title = "Open recent: " + path.filename().string();
    add({&find_action("recording.open"), path.string(), title}, title);
  }
  std::ranges::stable_sort(found, std::ranges::greater(), &std::pair<int, Offer>::first);
  std::vector<Offer> offers;
  for (auto& [fit, offer] : found) offers.push_back(std::move(offer));
  return offers;
}

// ---- Arguments ---------------------------------------------------------------------------------

Takes<std::string> text(std::string shown) {
  return {std::move(shown),
          [](const State&, const std::string&, const std::string& typed) { return typed; }};
}

Takes<double> number(std::string shown) {
  return {std::move(shown), [](const State&, const std::string& action, const std::string& typed) {
            return number_argument(action, typed);
          }};
}

Takes<int> whole(std::string shown, std::function<Range(const State&)> range) {
  return {std::move(shown),
          [](const State&, const std::string& action, const std::string& typed) {
            return parse_integer(typed, "action " + action);
          },
          [range = std::move(range)](const State& state, const std::string& action, int value) {
            check_whole(action, value, range(state));
          }};
}

Takes<std::string> one_of(std::string names) {
  return {names, [](const State&, const std::string&, const std::string& typed) { return typed; },
          [all = names_of(names)](const State&, const std::string& action,
                                  const std::string& name) { choice_argument(action, name, all); }};
}

std::vector<std::string> names_of(const std::string& choices) { return split(choices, '|'); }

int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return static_cast<int>(i);
  throw Error(fmt::format("action {}: unknown value '{}'; expected {}", action, text,
                          fmt::join(names, " or ")));
}

int whole_argument(const std::string& action, const std::string& text, int low, int high) {
  const int value = parse_integer(text, "action " + action);
  check_whole(action, value, {low, high});
  return value;
}

int plane_number_argument(const std::string& action, const std::string& text, int low, int high) {
  return whole_argument(action, text.starts_with("P") ? text.substr(1) : text, low, high);
}

double number_argument(const std::string& action, const std::string& text) {
  return parse_number(text, "action " + action);
}

std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ',')) numbers.push_back(number_argument(action, part));
  if (numbers.size() != count)
    throw Error(fmt::format("action {}: '{}' has {} numbers; expected {}", action, text,
                            numbers.size(), count));
  return numbers;
}

// ---- Status bar --------------------------------------------------------------------------------

bool has_run(const State& state) { return state.run() != nullptr; }

void say(State& state, std::string message, bool is_error) {
  state.view.message = std::move(message);
  state.view.message_is_error = is_error;
  state.view.did_nothing = false;
  state.view.hint_done = nullptr;
}

void say_hint(State& state, std::string hint, std::function<bool(const State&)> done) {
  say(state, std::move(hint));
  state.view.hint_done = std::move(done);
}

void drop_done_hint(State& state) {
  if (state.view.hint_done && state.view.hint_done(state)) say(state, "");
}

void say_nothing_done(State& state, std::string why, bool is_error) {
  say(state, std::move(why), is_error);
  state.view.did_nothing = true;
}

}  // namespace planescope::desktop
