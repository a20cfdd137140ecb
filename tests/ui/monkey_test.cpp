// A monkey at the window: random actions, clicks, drags and keys, mostly nonsense. Nothing may end
// the program, and memory and the number of open files must level off. It records its steps in
// monkey.json, which `planescope view --offscreen --script` can replay.
//
// PLANESCOPE_MONKEY=COUNT[,SEED]: number of steps; the default fits into CI.

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/desktop/window.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/random.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

template <typename Items>
auto one_of(Random& random, const Items& items) {
  return items[static_cast<std::size_t>(random.integer(0, static_cast<int>(items.size()) - 1))];
}

/// Usually valid for a frame of 640x480 and its run, sometimes far outside.
std::string number(Random& random) {
  static const std::vector<std::string> kOdd = {
      "-1", "0", "1e9", "-0.5", "nan", "inf", "99999999999999999999", "x", ""};
  if (random.integer(0, 19) == 0) return one_of(random, kOdd);
  const int most = one_of(random, std::vector<int>{1, 3, 12, 300, 4000});
  return random.integer(0, 3) == 0 ? fmt::format("{:.3f}", random.uniform() * most)
                                   : std::to_string(random.integer(0, most));
}

std::string pixel(Random& random) {
  return fmt::format("{},{}", random.integer(-5, 650), random.integer(-5, 490));
}

std::string pixels(Random& random, int most) {
  std::string text = pixel(random);
  for (int i = random.integer(0, most); i > 0; --i) text += " " + pixel(random);
  return text;
}

class Monkey {
 public:
  Monkey(fs::path dir, std::uint64_t seed) : dir_(std::move(dir)), random_(seed) {
    // Labels of opened recordings are saved beside them.
    fs::copy(sample_path(), dir_ / "sample", fs::copy_options::recursive);
  }

  /// The next step of a script. Its targets may be missing.
  Json step(const Widgets& widgets) {
    const int kind = random_.integer(0, 99);
    if (kind < 65 || widgets.empty()) return action();
    if (kind < 93) {
      auto widget = widgets.begin();
      std::advance(widget, random_.integer(0, static_cast<int>(widgets.size()) - 1));
      const Json at = {random_.uniform(), random_.uniform()};
      if (kind < 82) return {{"click", widget->first}, {"at", at}, {"button", button()}};
      if (kind < 88) return {{"wheel", widget->first}, {"by", random_.integer(-3, 3)}};
      const Json by = {random_.integer(-200, 200), random_.integer(-200, 200)};
      return {{"drag", widget->first}, {"from", at}, {"by", by}, {"button", button()}};
    }
    if (kind < 97) return {{"key", key()}};
    return {{"type", one_of(random_, kTexts)}};
  }

 private:
  Json action() {
    const Action action = one_of(random_, actions());
    return {{"do", action.name}, {"with", argument(action)}};
  }
  static const std::vector<Action>& actions() {
    static const std::vector<Action> all = [] {
      std::vector<Action> kept;
      for (const Action& action : action_table())
        // At a low rate, playing takes as long as it does for a user.
        if (action.name != "quit" && action.name != "step.rate") kept.push_back(action);
      return kept;
    }();
    return all;
  }
  std::string button() {
    return one_of(random_, std::vector<std::string>{"left", "left", "right"});
  }
  std::string key() {
    for (int i = 0; i < 20; ++i) {
      const Action action = one_of(random_, actions());
      if (!action.keys.empty()) return one_of(random_, split(action.keys, ' '));
    }
    return "Escape";
  }

  std::string argument(const Action& action) {
    std::string takes = action.takes;
    if (takes.empty()) return "";
    if (takes.front() == '[' && random_.integer(0, 1) == 0) return "";
    if (takes.find("PATH") != std::string::npos || takes.find("FOLDER") != std::string::npos)
      return path(action.name);
    if (takes.find("VIEW") != std::string::npos)
      return fmt::format("image {}{}", takes.find("RADIUS") != std::string::npos ? "8 " : "",
                         pixels(random_, 6));
    if (takes.find("FILTER") != std::string::npos) return one_of(random_, kTexts);
    if (takes == "NAME=VALUE" || takes == "NAME=SHARE")
      return one_of(random_, planes::option_table()).name + "=" + number(random_);
    if (takes == "ACTION") return one_of(random_, actions()).name;
    if (takes.find("U0,V0") != std::string::npos) return pixel(random_) + "," + pixel(random_);
    if (takes.find("EYE") != std::string::npos) {
      std::string text = number(random_);
      for (int i = 0; i < 5; ++i) text += "," + number(random_);
      return text;
    }
    if (takes.find("ZOOM") != std::string::npos) return number(random_) + "," + pixel(random_);
    if (takes.find(',') != std::string::npos) return pixel(random_);
    if (takes.find('|') != std::string::npos) return one_of(random_, split(takes, '|'));
    if (takes.find("NAME") != std::string::npos) return one_of(random_, kTexts);
    return number(random_);
  }
  std::string path(const std::string& action) {
    if (action == "recording.open")
      return random_.integer(0, 3) == 0 ? (dir_ / "none").string() : (dir_ / "sample").string();
    return (dir_ / one_of(random_, std::vector<std::string>{"a.json", "b.json", "none/c"}))
        .string();
  }

  inline static const std::vector<std::string> kTexts = {"case==III",
                                                         "case==III && depth>=5",
                                                         "event==merge",
                                                         "points>100 || !(depth<3)",
                                                         "((",
                                                         "plane==1",
                                                         "42",
                                                         "a",
                                                         "truth.wrong==1",
                                                         "\xc3\xa4\xe2\x82\xac",
                                                         "",
                                                         "theta"};

  fs::path dir_;
  Random random_;
};

struct Held {
  double memory_mb = 0;  // resident, including memory that malloc keeps
  double in_use_mb = 0;  // the allocated part of it
  int files = 0;
};

Held held_now() {
  Held held;
  std::ifstream("/proc/self/statm") >> held.memory_mb >> held.memory_mb;  // pages: all, resident
  held.memory_mb *= static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
  const struct mallinfo2 info = ::mallinfo2();
  held.in_use_mb = static_cast<double>(info.uordblks + info.hblkhd) / (1 << 20);
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/self/fd")) ++held.files;
  return held;
}

TEST(Monkey, FindsNoCrashAndNoGrowth) {
  int count = 120;
  std::uint64_t seed = 1;
  if (const char* asked = std::getenv("PLANESCOPE_MONKEY")) {
    const auto parts = split(asked, ',');
    count = parse_integer(parts[0], "PLANESCOPE_MONKEY");
    if (parts.size() > 1) seed = static_cast<std::uint64_t>(parse_integer(parts[1], "the seed"));
  }
  const fs::path dir = scratch_dir();
  std::unique_ptr<Offscreen> window;
  try {
    window = std::make_unique<Offscreen>(open_state_with_labels(dir / "labels"), 900, 600, 1.0F);
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  settle(window->shell(), *window, {}, false);
  window->shell().perform({"step.rate", "100000"}, true);
  Monkey monkey(dir, seed);
  std::ofstream log(dir / "monkey.json");
  log << "{\"actions\": [\n";
  int refused = 0;
  Held warm;
  for (int i = 0; i < count; ++i) {
    const Json step = monkey.step(window->shell().widgets());
    log << (i > 0 ? ",\n" : "") << step.dump(-1, ' ', true) << std::flush;
    try {
      play_actions(window->shell(), *window, dir, step.dump(-1, ' ', true));
    } catch (const Error&) {
      ++refused;  // an error of one line, with the state unchanged
    }
    if (i == count / 2) warm = held_now();
    if (count >= 2000 && i % 500 == 0)
      fmt::print("{} actions, {} refused, {:.0f} MB in use, {:.0f} MB resident, {} files\n", i,
                 refused, held_now().in_use_mb, held_now().memory_mb, held_now().files);
  }
  log << "\n]}\n";
  const Held end = held_now();
  EXPECT_LT(refused, count) << "nothing was done at all";
  EXPECT_LE(end.files, warm.files + 8);
  if (count >= 2000) {
    EXPECT_LT(end.memory_mb, 1.25 * warm.memory_mb + 50);
  }
  RecordProperty("refused", refused);
}

}  // namespace
}  // namespace planescope::desktop
