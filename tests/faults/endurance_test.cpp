// Memory over many frames, and two processes that write to one folder. scripts/endurance runs
// 20,000 frames.

#include <gtest/gtest.h>

#include <future>

#include "cli/program.hpp"
#include "faults/commands.hpp"
#include "faults/fault.hpp"

namespace planescope::faults {
namespace {

namespace fs = std::filesystem;
using testing_cli::Ran;

// ---- Memory ----

constexpr int kFrames = 500, kFewFrames = 100;
// A frame that stayed in memory would take 40 kB or more: 6 of depth, 34 of points.
constexpr double kMostKbPerFrame = 16;

class Endurance : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_preload()) GTEST_SKIP() << "a sanitizer takes memory of its own";
    testing_cli::well(testing_cli::run({"synth", "sequence", "-o", rec, "--size", "64x48",
                                        "--frames", std::to_string(kFrames), "--depth-only"}));
  }
  void TearDown() override { fs::remove_all(dir); }

  void expect_flat_memory(const Words& words) const {
    // Both see the whole walk: a larger world takes more memory.
    const auto peak_kb = [&](int frames) {
      const Ran ran =
          testing_cli::run(words + Words{rec, "-o", dir / std::to_string(frames), "--threads", "2",
                                         "--frames", "::" + std::to_string(kFrames / frames)});
      EXPECT_EQ(ran.code, 0) << ran.err;
      return static_cast<double>(ran.peak_kb);
    };
    const double slope = (peak_kb(kFrames) - peak_kb(kFewFrames)) / (kFrames - kFewFrames);
    std::printf("%s: %.0f kB per 1,000 frames\n", words[0].c_str(), 1000 * slope);
    EXPECT_LT(slope, kMostKbPerFrame);
  }

  const fs::path dir = testing_cli::scratch(), rec = dir / "rec";
};

TEST_F(Endurance, AReportKeepsNoFrameInMemory) { expect_flat_memory({"report", "--no-pictures"}); }
TEST_F(Endurance, AMapKeepsNoFrameInMemory) { expect_flat_memory({"map"}); }

// ---- Side by side ----

class SideBySide : public testing::Test {
 protected:
  void SetUp() override { setenv("XDG_STATE_HOME", (dir / "state").c_str(), 1); }
  void TearDown() override { fs::remove_all(dir); }

  /// Runs both at the same time. What does not succeed is refused with one line that holds `why`.
  void run_both(const Words& a, const Words& b, const std::string& why) {
    std::future<Ran> other = std::async(std::launch::async, [&] { return testing_cli::run(a); });
    const Ran one = testing_cli::run(b);
    ran = {other.get(), one};
    for (const Ran& each : ran)
      if (each.code != 0) testing_cli::expect_refused(each, why);
    EXPECT_TRUE(ran[0].code == 0 || ran[1].code == 0) << ran[0].err << ran[1].err;
  }

  const fs::path dir = testing_cli::scratch(), work = dir / "work";
  std::vector<Ran> ran;
};

TEST_F(SideBySide, TwoReportsInOneFolderAreOneReport) {
  const Command command = main_command("report");
  command.prepare(work);
  const Words words = command.words(work);
  testing_cli::well(testing_cli::run(words));
  const Snapshot wanted = snapshot(work);
  for (int i = 0; i < 4; ++i) {
    run_both(words, words, "another report is being written there: held by");
    EXPECT_EQ(differences(snapshot(work), wanted), "");
  }
}

TEST_F(SideBySide, TwoImportsOfLabelsAreOneImport) {
  const Command command = main_command("import");
  command.prepare(work);
  const Words words = command.words(work);
  fs::remove_all(work / "mine");
  testing_cli::well(testing_cli::run(words));
  const Snapshot wanted = snapshot(work);
  for (int i = 0; i < 4; ++i) {
    fs::remove_all(work / "mine");
    run_both(words, words, "held by");  // is or was
    EXPECT_EQ(differences(snapshot(work), wanted), "");
  }
}

TEST_F(SideBySide, TwoMapsInOneFolderAreOneOfThem) {
  const Command command = main_command("map");
  command.prepare(work);
  const Words first = command.words(work), second = first + Words{"--voxel", "0.04"};
  std::vector<Snapshot> wanted;
  for (const Words& words : {first, second}) {
    testing_cli::well(testing_cli::run(words));
    wanted.push_back(snapshot(work / "map"));
  }
  ASSERT_NE(wanted[0], wanted[1]);
  for (int i = 0; i < 4; ++i) {
    run_both(first, second, "");
    EXPECT_EQ(ran[0].code + ran[1].code, 0);
    const Snapshot found = snapshot(work / "map");
    EXPECT_TRUE(found == wanted[0] || found == wanted[1])
        << "of the first: " << differences(found, wanted[0])
        << "of the second: " << differences(found, wanted[1]);
  }
}

}  // namespace
}  // namespace planescope::faults
