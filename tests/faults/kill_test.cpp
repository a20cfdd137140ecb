// Kills main commands at random moments or before random calls, and checks the next run.
// PLANESCOPE_KILLS is the number of kills per command, PLANESCOPE_SEED determines the moments.

#include <gtest/gtest.h>
#include <sys/time.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/model/random.hpp"
#include "faults/commands.hpp"
#include "faults/fault.hpp"

namespace planescope::faults {
namespace {

namespace fs = std::filesystem;
using testing_cli::Ran;
using testing_cli::read_text;

constexpr int kKilled = 128 + SIGALRM;

int number(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

/// Kills the program like `kill -9`, without notice: nothing handles SIGALRM.
Ran run_and_kill(const Words& words, double after_s) {
  return testing_cli::run(words, [after_s] {
    itimerval timer{};
    const auto microseconds = static_cast<long>(after_s * 1e6) + 1;
    timer.it_value = {microseconds / 1000000, microseconds % 1000000};
    setitimer(ITIMER_REAL, &timer, nullptr);
  });
}

class Kill : public testing::Test {
 protected:
  void SetUp() override {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    setenv("XDG_STATE_HOME", (dir / "state").c_str(), 1);
    fs::create_directories(work);
  }
  void TearDown() override { fs::remove_all(dir); }

  void begin_anew() {
    fs::remove_all(work);
    fs::copy(start, work, fs::copy_options::recursive);
  }

  /// Runs the command on the files in `work`, without interruption.
  void keep_good(const Words& words) {
    fs::copy(work, start, fs::copy_options::recursive);
    before = snapshot(work);
    const auto begun = std::chrono::steady_clock::now();
    const Ran good = testing_cli::run(words);
    lasts_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    ASSERT_EQ(good.code, 0) << good.err;
    wanted = snapshot(work);
    if (!can_preload()) return;
    begin_anew();
    calls = run_counted(words, work).calls;
  }

  /// A random moment, or the beginning of a random call that changes files.
  struct Moment {
    double after_s = 0;
    std::optional<Fault> call;

    std::string text() const {
      return call ? "before " + call->kind + " " + std::to_string(call->at)
                  : "after " + std::to_string(after_s) + " s";
    }
  };
  Moment moment(bool at_call, Random& random) {
    Moment chosen{random.uniform() * lasts_s, {}};
    std::vector<std::string> kinds;
    for (const char* kind : {"open", "write", "rename", "remove", "mkdir"})
      if (calls[kind] > 0) kinds.push_back(kind);
    if (!at_call || kinds.empty()) return chosen;
    const auto below = [&](std::size_t count) {
      return static_cast<std::uint32_t>(random.uniform() * static_cast<double>(count));
    };
    const std::string& kind = kinds[below(kinds.size())];
    chosen.call = Fault{kind, 1 + below(calls[kind]), kKill};
    return chosen;
  }

  /// `again`: the words of the run after; none where nothing is left to do.
  void kill_often(const std::string& name,
                  int kills,
                  const std::function<Words()>& words,
                  const std::function<Words()>& again) {
    Random random(static_cast<std::uint64_t>(number("PLANESCOPE_SEED", 1)));
    kills = number("PLANESCOPE_KILLS", kills);
    int killed = 0, wrong = 0;
    for (int i = 0; i < kills; ++i) {
      const Moment when = moment(i % 2 == 1, random);
      SCOPED_TRACE(name + " killed " + when.text());
      begin_anew();
      const Ran first = when.call ? run_faulted(words(), work, *when.call).ran
                                  : run_and_kill(words(), when.after_s);
      const int code = when.call ? 128 + SIGKILL : kKilled;
      ASSERT_TRUE(first.code == code || first.code == 0) << first.code << first.err;
      killed += first.code == code;
      const Snapshot found = snapshot(work);
      const std::string harm = damage(settled(found), settled(before), settled(wanted));
      EXPECT_EQ(harm, "");
      if (check) check(found);
      const Words next_words = again();
      const Ran next = next_words.empty() ? Ran{0, {}, {}} : testing_cli::run(next_words);
      Snapshot end = settled(snapshot(work));
      if (next_words.empty()) end = without_unfinished_work(end);
      const std::string differ = differences(end, settled(wanted));
      EXPECT_EQ(next.code, 0) << next.err;
      EXPECT_EQ(differ, "") << next.err;
      wrong += !harm.empty() || next.code != 0 || !differ.empty();
    }
    std::printf("| %s is killed | %d | %d | %d |\n", name.c_str(), kills, killed, wrong);
  }

  /// Without files that vary from run to run.
  Snapshot settled(Snapshot files) const {
    std::erase_if(files, [&](const auto& file) {
      return std::ranges::any_of(
          varies, [&](const std::string& name) { return file.first.starts_with(name); });
    });
    return files;
  }

  void kill_command(const std::string& name, int kills, const Words& more_again) {
    const Command command = main_command(name);
    command.prepare(work);
    varies = command.varies;
    keep_good(command.words(work));
    const auto words = [&] { return command.words(work); };
    const auto again = [&] {
      Words same = words();
      same.insert(same.end(), more_again.begin(), more_again.end());
      return same;
    };
    kill_often(name, kills, words, again);
  }

  const fs::path dir = testing_cli::scratch(), work = dir / "work", start = dir / "start";
  Snapshot before, wanted;
  std::map<std::string, std::uint32_t> calls;  // by kind, of the undisturbed run
  std::vector<std::string> varies;
  std::function<void(const Snapshot&)> check;  // of the folder after the kill
  double lasts_s = 0;
};

TEST_F(Kill, ASegmentRunIsRepeatedToTheSameFiles) { kill_command("segment", 5, {}); }
TEST_F(Kill, AReportIsResumedToTheSameFiles) { kill_command("report", 5, {"--resume"}); }
TEST_F(Kill, AReportWithPicturesIsResumedToTheSameFiles) {
  kill_command("pictures", 1, {"--resume"});
}
TEST_F(Kill, AReportWithTracksIsResumedToTheSameFiles) { kill_command("tracks", 10, {"--resume"}); }
TEST_F(Kill, PlanesOfAMapAreFoundAgain) { kill_command("tracked", 10, {}); }
TEST_F(Kill, ASearchOfOptionsIsResumedToTheSameProfile) { kill_command("tune", 10, {}); }

// Files take their places one after the other. What is killed in between leaves old and new ones,
// which never pass for one map.
TEST_F(Kill, AMapWithItsMeshIsTheOldOneTheNewOneOrRefused) {
  const std::string kinds[] = {"map/map.json", "map/tracks.json", "map/poses.tum", "map/planes/"};
  const auto same = [&](const Snapshot& found, const Snapshot& other) {
    return std::ranges::all_of(found, [&](const auto& file) {
      const bool counts = std::ranges::any_of(
          kinds, [&](const std::string& kind) { return file.first.starts_with(kind); });
      const auto at = other.find(file.first);
      return !counts || (at != other.end() && at->second == file.second);
    });
  };
  check = [&](const Snapshot& found) {
    const Snapshot map = without_unfinished_work(found);
    if (same(map, before) || same(map, wanted)) return;
    const Ran use = testing_cli::run({"segment", work / "rec", "--map", work / "map", "-o",
                                      dir / "use", "--gravity", "0,1,0", "--frames", "0:3"});
    EXPECT_EQ(use.code, 2);
    EXPECT_TRUE(testing_cli::is_one_line(use.err)) << use.err;
  };
  kill_command("map", 10, {});
}

TEST_F(Kill, AConversionIsAllThereOrMadeAgain) {
  const Command command = main_command("recast");
  command.prepare(work);
  const auto words = [&] { return command.words(work); };
  keep_good(words());
  kill_often("convert", 10, words,
             [&] { return fs::exists(work / "out.mcap") ? Words{} : words(); });
}

TEST_F(Kill, AnApprovalIsRepeatedToTheSameBaseline) { kill_command("approve", 4, {}); }

TEST_F(Kill, ATrainingIsResumedToTheSameWeights) {
  const Command command = main_command("train");
  command.prepare(work);
  varies = command.varies;
  const Words longer = {"--steps", "40", "--epoch", "4"};
  const auto words = [&] {
    Words all = command.words(work);
    const auto at = std::ranges::find(all, "--steps");
    std::copy(longer.begin(), longer.end(), at);
    return all;
  };
  keep_good(words());
  kill_often("train", 3, words, [&] {
    Words all = words();
    if (fs::exists(work / "out.checkpoint")) all.push_back("--resume");
    return all;
  });
}

// ---- Labels ----

constexpr int kStrokes = 6;

/// Draws gesture `number`, then writes a file that acknowledges it.
std::string gesture(int number, const fs::path& reported) {
  const int x = 30 + 15 * number;
  return R"({"do": "label.plane", "with": "0"}, {"do": "label.stroke", "with": "image over 6 )" +
         std::to_string(x) + ",40 " + std::to_string(x) + R"(,90"}, {"state": ")" +
         reported.string() + "." + std::to_string(number) + "\"}, ";
}

TEST_F(Kill, NoAcknowledgedGestureIsLost) {
  const fs::path script = dir / "script.json", reported = dir / "told";
  const Words view = {"view",     (work / "rec").string(), "--labels",    (work / "drawn").string(),
                      "--script", script.string(),         "--offscreen", "--size",
                      "640x400"};
  /// Draws the gestures from `first` to the end.
  const auto draw_from = [&](int first) {
    std::string actions = R"({"actions": ["label.mode", )";
    for (int i = first; i < kStrokes; ++i) actions += gesture(i, reported);
    testing_cli::write_text(script, actions + R"("label.save"]})");
  };
  const auto acknowledged = [&] {
    int count = 0;
    while (fs::exists(reported.string() + "." + std::to_string(count))) ++count;
    return count;
  };
  const auto forget = [&] {
    for (int i = 0; i < kStrokes; ++i) fs::remove(reported.string() + "." + std::to_string(i));
  };
  main_command("eval").prepare(work);
  draw_from(0);
  keep_good(view);
  ASSERT_EQ(acknowledged(), kStrokes);

  Random random(static_cast<std::uint64_t>(number("PLANESCOPE_SEED", 1)));
  const int kills = number("PLANESCOPE_KILLS", 2);
  int killed = 0, wrong = 0;
  for (int i = 0; i < kills; ++i) {
    const double after_s = random.uniform(0.3, 1.0) * lasts_s;
    SCOPED_TRACE("killed after " + std::to_string(after_s) + " s");
    begin_anew();
    forget();
    draw_from(0);
    const Ran first = run_and_kill(view, after_s);
    ASSERT_TRUE(first.code == kKilled || first.code == 0) << first.code << first.err;
    killed += first.code == kKilled;
    const int saved_before = acknowledged();
    testing_cli::write_text(script, R"({"actions": ["label.mode", {"state": ")" +
                                        (dir / "seen.json").string() + "\"}]}");
    const Ran look = testing_cli::run(view);
    ASSERT_EQ(look.code, 0) << look.err;
    const int kept = nlohmann::json::parse(read_text(dir / "seen.json")).at("label_undo");
    EXPECT_GE(kept, saved_before);
    EXPECT_LE(kept, saved_before + 1);
    draw_from(kept);
    const Ran next = testing_cli::run(view);
    EXPECT_EQ(next.code, 0) << next.err;
    const std::string differ = differences(snapshot(work), wanted);
    EXPECT_EQ(differ, "") << next.err;
    wrong += kept < saved_before || next.code != 0 || !differ.empty();
  }
  std::printf("| labels are drawn, it is killed | %d | %d | %d |\n", kills, killed, wrong);
}

}  // namespace
}  // namespace planescope::faults
