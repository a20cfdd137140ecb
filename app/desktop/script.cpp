// Reads scripts of actions and input from JSON and plays them in the window.

#include "app/desktop/script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/desktop/state/session.hpp"
#include "app/desktop/state/state.hpp"
#include "core/debug/explain/trace_text.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"
#include "render/paint.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

ImVec2 place_in(const WidgetRect& rect, const Json& share) {
  const auto at = [&](std::size_t i) { return share.at(i).get<float>(); };
  return ImVec2(rect.min.x + at(0) * (rect.max.x - rect.min.x),
                rect.min.y + at(1) * (rect.max.y - rect.min.y));
}

/// Plays one script in one shell.
class Player {
 public:
  Player(Shell& shell, Stage& stage, std::stop_token stop)
      : shell_(shell), stage_(stage), stop_(std::move(stop)) {}

  void play(const Json& step) {
    if (step.is_string()) {
      const std::string text = step;
      const std::size_t at = text.find(' ');
      shell_.perform({text.substr(0, at), at == std::string::npos ? "" : text.substr(at + 1)},
                     true);
      return settle(shell_, stage_, stop_, /*background=*/false);
    }
    if (step.contains("screenshot") || step.contains("state")) settle(shell_, stage_, stop_);
    if (step.contains("do"))
      perform(step.at("do"), step.value("with", std::string()));
    else if (step.contains("click"))
      click(step);
    else if (step.contains("drag"))
      drag(step);
    else if (step.contains("hover"))
      move_to(place_in(widget(step.at("hover")), step.value("at", kMiddle)));
    else if (step.contains("wheel"))
      wheel(step);
    else if (step.contains("key"))
      press(step.at("key"));
    else if (step.contains("type"))
      type(step.at("type"));
    else if (step.contains("drop"))
      shell_.drop(step.at("drop"), true);
    else if (step.contains("screenshot"))
      screenshot(step);
    else if (step.contains("state"))
      write_file_text(output(step.at("state")), state_text(shell_.state(), shell_.idle()));
    else if (step.contains("trace"))
      write_file_text(output(step.at("trace")), trace());
    else if (step.contains("expect"))
      expect(step.at("expect"));
    else if (step.contains("frames"))
      for (int i = step.at("frames"); i > 0; --i) stage_.draw_frame();
    else
      throw Error(
          "unknown step; expected one of do, click, drag, drop, hover, wheel, key, type, "
          "screenshot, "
          "state, trace, expect, frames");
    if (step.value("wait", true)) settle(shell_, stage_, stop_, /*background=*/false);
  }

 private:
  inline static const Json kMiddle = Json::array({0.5, 0.5});

  void perform(const std::string& action, const std::string& argument) {
    shell_.perform({action, argument}, true);
    // While typing, the window shows filter errors in place; a script's filter is complete, so
    // throw.
    const debug::FilterProblem& problem = shell_.state().view.search.problem;
    if (action == "filter.set" && !problem.message.empty())
      throw Error(fmt::format("filter '{}', at character {}: {}", argument, problem.begin + 1,
                              problem.message));
  }
  WidgetRect widget(const std::string& name) const {
    const auto found = shell_.widgets().find(name);
    if (found != shell_.widgets().end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [known, rect] : shell_.widgets()) names.push_back(known);
    const std::string near = nearest_name(name, names);
    throw Error("widget '" + name + "' is not visible" +
                (near.empty() ? std::string() : "; did you mean '" + near + "'?"));
  }
  void push(const InputEvent& event) { shell_.input().push(event); }
  void move_to(ImVec2 at) {
    push({.type = InputEvent::Type::move, .x = at.x, .y = at.y});
    stage_.draw_frame();
    stage_.draw_frame();  // the item under the mouse is only known in the next frame
  }
  void button(int which, bool down) {
    push({.type = InputEvent::Type::button, .button = which, .down = down});
    stage_.draw_frame();
  }
  void key(Key which, bool down) {
    push({.type = InputEvent::Type::key, .down = down, .key = which});
    stage_.draw_frame();
  }

  void click(const Json& step) {
    move_to(place_in(widget(step.at("click")), step.value("at", kMiddle)));
    press_button(step, [&](int which) {
      for (int i = step.value("double", false) ? 2 : 1; i > 0; --i) {
        button(which, true);
        button(which, false);
      }
    });
  }
  /// Presses the step's button while holding the key in "hold".
  template <typename Press>
  void press_button(const Json& step, const Press& press) {
    const std::string name = step.value("button", std::string("left"));
    const auto held = key_of_name(step.value("hold", std::string()));
    if (held) key(*held, true);
    press(name == "right" ? 1 : name == "middle" ? 2 : 0);
    if (held) key(*held, false);
  }
  void drag(const Json& step) {
    const WidgetRect rect = widget(step.at("drag"));
    const ImVec2 from = place_in(rect, step.value("from", kMiddle));
    ImVec2 to = from;
    if (step.contains("to")) {
      to = place_in(rect, step.at("to"));
    } else {
      to.x += step.at("by").at(0).get<float>();
      to.y += step.at("by").at(1).get<float>();
    }
    move_to(from);
    press_button(step, [&](int which) {
      button(which, true);
      constexpr int kMoves = 8;
      for (int i = 1; i <= kMoves; ++i) {
        const float t = static_cast<float>(i) / kMoves;
        push({.type = InputEvent::Type::move,
              .x = from.x + t * (to.x - from.x),
              .y = from.y + t * (to.y - from.y)});
        stage_.draw_frame();
      }
      button(which, false);
    });
  }
  void wheel(const Json& step) {
    move_to(place_in(widget(step.at("wheel")), step.value("at", kMiddle)));
    push({.type = InputEvent::Type::wheel, .x = 0, .y = step.value("by", 1.0f)});
    stage_.draw_frame();
  }
  void press(const std::string& name) {
    if (name == "?") return type("?");
    std::vector<Key> keys;
    std::string rest = name;
    for (const std::string modifier : {"Ctrl", "Shift", "Alt"})
      if (rest.starts_with(modifier + "+")) {
        keys.push_back(*key_of_name(modifier));
        rest = rest.substr(modifier.size() + 1);
      }
    const auto last = key_of_name(rest);
    if (!last) throw Error("unknown key '" + name + "'");
    keys.push_back(*last);
    for (const Key one : keys) key(one, true);
    for (auto one = keys.rbegin(); one != keys.rend(); ++one) key(*one, false);
  }
  void type(const std::string& text) {
    for (const char32_t c : render::decode_utf8(text)) {
      push({.type = InputEvent::Type::text, .character = c});
      stage_.draw_frame();
    }
  }
  void screenshot(const Json& step) {
    std::optional<WidgetRect> part;
    if (step.contains("of")) part = widget(step.at("of"));
    stage_.screenshot(output(step.at("screenshot")), part);
  }
  std::filesystem::path output(const std::string& path) const {
    shell_.state().document.check_output(path);
    return path;
  }
  std::string trace() const {
    const State& state = shell_.state();
    if (!state.run()) throw Error("no run is available, so there is no trace to write");
    const bool beside = state.results.pinned && state.run() != state.results.pinned->run.get();
    return debug::trace_text(*state.run(), beside ? state.results.pinned->run.get() : nullptr);
  }
  /// A failed expectation is checked again when background work has ended.
  void expect(const Json& facts) const {
    try {
      compare(facts);
    } catch (const ExpectationFailed&) {
      if (shell_.idle()) throw;
      settle(shell_, stage_, stop_);
      compare(facts);
    }
  }
  void compare(const Json& facts) const {
    const Json now = state_facts(shell_.state(), shell_.idle());
    for (const auto& [name, value] : facts.items()) {
      if (!now.contains(name)) throw Error("expect: unknown fact '" + name + "'");
      // Compare only the given keys of an object.
      Json found = now.at(name);
      if (name == "view" && value.is_object()) {
        found = Json::object();
        for (const auto& [key, wanted] : value.items()) found[key] = now.at(name).at(key);
      }
      if (found != value)
        throw ExpectationFailed(
            fmt::format("expected {} {}, found {}", name, value.dump(), found.dump()));
    }
  }

  Shell& shell_;
  Stage& stage_;
  std::stop_token stop_;
};

}  // namespace

void take_picture(Shell& shell, Stage& stage) {
  const std::string path = shell.take_picture_path();
  if (path.empty()) return;
  try {
    stage.screenshot(path);
    shell.show_message("picture written to " + path, false);
  } catch (const std::exception& error) {
    shell.show_message(error.what(), true);
  }
}

void take_step(Shell& shell,
               const std::function<void()>& draw,
               const std::function<Image8()>& picture) {
  constexpr int kFrames = 3;  // enough frames for lists to finish scrolling
  if (!shell.begin_step()) return;
  for (int i = 0; i < kFrames; ++i) draw();
  shell.add_step(picture());
}

void settle(Shell& shell, Stage& stage, std::stop_token stop, bool background) {
  constexpr std::chrono::milliseconds kShortest(5), kLongest(50);
  auto pause = kShortest;  // grows: without a GPU, drawing competes with the work for cores
  do {                     // the last frame may discover work that could not start before
    stage.draw_frame();
    while (!shell.idle(background)) {
      if (stop.stop_requested()) throw Cancelled();
      const bool needs_frame = shell.needs_frame();
      if (!needs_frame) std::this_thread::sleep_for(pause);
      pause = needs_frame ? kShortest : std::min(2 * pause, kLongest);
      stage.draw_frame();
    }
    stage.draw_frame();
  } while (!shell.idle(background));
}

Script Script::read(const fs::path& path) {
  auto json = read_json<Json>(path);
  if (!json.is_object() || !json.contains("actions") || !json.at("actions").is_array())
    throw Error(path.string() + R"(: not a script; expected {"actions": [...]})");
  Script script;
  script.path_ = path;
  script.actions_ = std::make_shared<const Json>(std::move(json.at("actions")));
  return script;
}

Script Script::of(const std::string& action, const std::string& with, const std::string& from) {
  Script script;
  script.path_ = from;
  script.actions_ = std::make_shared<const Json>(Json::array({{{"do", action}, {"with", with}}}));
  return script;
}

void Script::play(Shell& shell, Stage& stage, std::stop_token stop) const {
  Player player(shell, stage, stop);
  int number = 0;
  for (const Json& step : *actions_) {
    ++number;
    const auto where = [&] {
      return fmt::format("{}, action {} ({})", path_.string(), number, step.dump());
    };
    try {
      shell.forget_nothing_done();
      player.play(step);
      if (shell.state().view.did_nothing)
        fmt::print(stderr, "{}: had no effect: {}\n", where(), shell.state().view.message);
    } catch (const Json::exception& error) {
      throw Error(where() + ": " + json_problem(error));
    } catch (const ExpectationFailed& error) {
      throw ExpectationFailed(where() + ": " + error.what());
    } catch (const Error& error) {
      throw Error(where() + ": " + json_problem(error));
    }
  }
}

}  // namespace planescope::desktop
