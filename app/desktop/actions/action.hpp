#pragma once

// An action of the desktop: its name, its key, its place in the menu, the argument it takes, and
// what it does. Panels hand over values; text comes from keys, the palette and scripts only.

#include <algorithm>
#include <any>
#include <array>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

// ---- Commands ----------------------------------------------------------------------------------

/// An action with its argument: a value of the type that the action takes or, from outside the
/// program, text: "filter.set" with "case==III".
struct Command {
  std::string action;
  std::string argument = {};
  std::any value = {};
};

/// `value` as actions take it: whole numbers as int, other numbers as double, text as std::string,
/// everything else as it is.
template <typename T>
Command command(std::string action, const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>)
    return {std::move(action), {}, value};
  else if constexpr (std::is_integral_v<T>)
    return {std::move(action), {}, static_cast<int>(value)};
  else if constexpr (std::is_floating_point_v<T>)
    return {std::move(action), {}, static_cast<double>(value)};
  else if constexpr (std::is_convertible_v<T, std::string>)
    return {std::move(action), {}, std::string(value)};
  else
    return {std::move(action), {}, value};
}

// ---- Actions -----------------------------------------------------------------------------------

/// In which mode an action and its key work. A key of one mode goes before one that works anywhere.
enum class KeyMode : std::uint8_t { anywhere, debugger, labels };

using Condition = std::function<bool(const State&)>;

struct Action {
  std::string name;   // "step.next"
  std::string title;  // "Step forward"
  std::string menu;   // "Step"; empty: in no menu
  std::string keys;   // "Right", "Shift+F5"; several separated by spaces; empty: none
  std::string takes;  // the argument, in brackets where it is optional; empty: none
  std::string words;  // that people look it up by besides title and name
  std::function<void(State&, const Command&)> run;
  Condition enabled;  // empty: always
  Condition checked;  // empty: not a switch
  KeyMode mode = KeyMode::anywhere;
  bool key_is_argument = false;  // "3" runs it with "3"

  bool can_run(const State& state) const { return !enabled || enabled(state); }
  bool is_on(const State& state) const { return checked && checked(state); }
};

const std::vector<Action>& action_table();
/// Throws Error naming the nearest existing action.
const Action& find_action(const std::string& name);
/// Whether a key or menu must ask for its argument first.
bool needs_argument(const Action& action);
/// Null where no action has this key ("Ctrl+P") in that mode.
const Action* action_of_key(const std::string& key, Mode mode);
/// The action can be used in that mode.
bool fits(const Action& action, Mode mode);
/// The first of its keys, as menus show it; empty where it has none.
std::string first_key(const Action& action);

/// Changes the state. Throws Error on an unknown action or an invalid argument, the state
/// unchanged.
void apply(State& state, const Command& command);

/// What the palette offers: actions, and recent recordings to open.
struct Offer {
  const Action* action = nullptr;
  std::string argument, title;
};
/// Those whose titles or names fit what was typed, best first: those with each word of it as a
/// whole word, then as the start of one, then anywhere; last those with its letters in order.
std::vector<Offer> palette_offers(const State& state, const std::string& typed);

// ---- Arguments ---------------------------------------------------------------------------------

/// A type of argument: how lists show it, how it is read from text, and which values are valid now.
/// Both functions throw Error naming the action and what was expected.
template <typename T>
struct Takes {
  std::string text;  // "NODE"
  std::function<T(const State&, const std::string& action, const std::string& text)> read;
  std::function<void(const State&, const std::string& action, const T&)> check = {};
};

Takes<std::string> text(std::string shown);
Takes<double> number(std::string shown);
/// "U0,V0,U1,V1": as many numbers as the type holds.
template <std::size_t count>
Takes<std::array<double, count>> numbers(std::string shown);

struct Range {
  int low = 0, high = 0;
};
Takes<int> whole(std::string shown, std::function<Range(const State&)> range);
/// The index of an item of a list.
template <typename Items>
Takes<int> item(std::string shown, Items&& items) {
  return whole(std::move(shown), [items](const State& s) {
    return Range{0, static_cast<int>(std::size(items(s))) - 1};
  });
}

/// One of "both|scene|image".
Takes<std::string> one_of(std::string names);
int choice_argument(const std::string& action,
                    const std::string& text,
                    const std::vector<std::string>& names);
std::vector<std::string> names_of(const std::string& choices);
/// The same as an enumeration of that order.
template <typename Enum>
Takes<Enum> choice(std::string names) {
  return {names, [all = names_of(names)](const State&, const std::string& action,
                                         const std::string& text) {
            return static_cast<Enum>(choice_argument(action, text, all));
          }};
}

/// An argument with one text that means "none".
template <typename T>
Takes<std::optional<T>> or_none(Takes<T> takes, std::string none = "none") {
  Takes<std::optional<T>> some;
  some.text = takes.text;
  some.read = [read = takes.read, none](const State& state, const std::string& action,
                                        const std::string& typed) {
    return typed == none ? std::nullopt : std::optional<T>(read(state, action, typed));
  };
  if (takes.check)
    some.check = [check = takes.check](const State& state, const std::string& action,
                                       const std::optional<T>& value) {
      if (value) check(state, action, *value);
    };
  return some;
}
/// An argument that may be left out.
template <typename T>
Takes<std::optional<T>> maybe(Takes<T> takes) {
  takes.text = "[" + takes.text + "]";
  return or_none(std::move(takes), "");
}

// Text that several types are read from. All throw Error naming the action and what was expected.

int whole_argument(const std::string& action, const std::string& text, int low, int high);
/// "3" or "P3".
int plane_number_argument(const std::string& action, const std::string& text, int low, int high);
double number_argument(const std::string& action, const std::string& text);
/// "12.5,3,7" as exactly `count` numbers.
std::vector<double> numbers_argument(const std::string& action,
                                     const std::string& text,
                                     std::size_t count);

template <std::size_t count>
Takes<std::array<double, count>> numbers(std::string shown) {
  return {std::move(shown), [](const State&, const std::string& action, const std::string& text) {
            const std::vector<double> read = numbers_argument(action, text, count);
            std::array<double, count> values = {};
            std::copy(read.begin(), read.end(), values.begin());
            return values;
          }};
}

// ---- Tables of actions -------------------------------------------------------------------------

/// The value of a command. Throws where a panel hands over another type, which is a defect.
template <typename T>
T value_in(const std::any& value, const Takes<T>&) {
  return std::any_cast<T>(value);
}
template <typename T>
std::optional<T> value_in(const std::any& value, const Takes<std::optional<T>>&) {
  const T* given = std::any_cast<T>(&value);
  return given ? *given : std::any_cast<std::optional<T>>(value);
}

/// A row of a table, while it is being added.
class ActionRow {
 public:
  ActionRow(Action& action, std::string menu) : action_(action), menu_(std::move(menu)) {}

  /// In the table's menu, with these keys.
  ActionRow& key(std::string keys) {
    action_.keys = std::move(keys);
    return menu(menu_);
  }
  /// In the table's menu, without a key.
  ActionRow& menu() { return menu(menu_); }
  ActionRow& menu(std::string name) {
    action_.menu = std::move(name);
    return *this;
  }
  ActionRow& words(std::string more) {
    action_.words = std::move(more);
    return *this;
  }
  /// When it can run, in place of the table's condition.
  ActionRow& when(Condition enabled) {
    action_.enabled = std::move(enabled);
    return *this;
  }
  ActionRow& in(KeyMode mode) {
    action_.mode = mode;
    return *this;
  }
  ActionRow& key_is_argument() {
    action_.key_is_argument = true;
    return *this;
  }
  /// When the switch is on.
  ActionRow& on(Condition checked) {
    action_.checked = std::move(checked);
    return *this;
  }
  ActionRow& run(std::function<void(State&)> does) {
    action_.run = [does = std::move(does)](State& state, const Command&) { does(state); };
    return *this;
  }
  template <typename T, typename Does>
  ActionRow& run(Takes<T> takes, Does does) {
    action_.takes = takes.text;
    action_.run = [takes = std::move(takes), does = std::move(does)](State& state,
                                                                     const Command& command) {
      const T value = command.value.has_value()
                          ? value_in(command.value, takes)
                          : takes.read(state, command.action, command.argument);
      if (takes.check) takes.check(state, command.action, value);
      does(state, value);
    };
    return *this;
  }
  /// A switch: runs by flipping a flag of the view, `&ViewState::marking` or what a generic
  /// function of the view returns.
  template <typename Flag>
  ActionRow& flips(Flag flag) {
    on([flag](const State& s) { return std::invoke(flag, s.view); });
    return run([flag](State& s) { std::invoke(flag, s.view) = !std::invoke(flag, s.view); });
  }

 private:
  Action& action_;
  std::string menu_;
};

/// Actions that share a menu, a mode and when they can run.
struct ActionGroup {
  std::vector<Action>& all;
  KeyMode mode = KeyMode::anywhere;
  std::string menu = {};
  Condition when = {};

  ActionRow add(std::string name, std::string title) const {
    Action& action = all.emplace_back();
    action.name = std::move(name);
    action.title = std::move(title);
    action.mode = mode;
    action.enabled = when;
    return {action, menu};
  }
};

}  // namespace planescope::desktop
