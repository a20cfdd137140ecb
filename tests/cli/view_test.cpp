// Tests of planescope view without a display.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/result_lines.hpp"

namespace planescope::testing_cli {
namespace {

namespace fs = std::filesystem;

struct View : testing::Test {
  View() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    setenv("XDG_STATE_HOME", (scratch() / "state").c_str(), 1);
  }
  fs::path write(const fs::path& path, const std::string& text) {
    std::ofstream(path) << text;
    return path;
  }
};

TEST_F(View, WithoutADisplayOneLineSuggestsHeadlessCommands) {
  for (const std::vector<std::string>& args : {std::vector<std::string>{}, {"view"}}) {
    const Ran ran = run(args);
    EXPECT_EQ(ran.code, 3);
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_TRUE(has(ran.err, "planescope report"));
    EXPECT_TRUE(has(ran.err, "--screenshot"));
  }
}

TEST_F(View, DrawsTheWindowWithoutADisplayAndReportsItsState) {
  const fs::path dir = scratch();
  const fs::path script = write(dir / "script.json", R"({"actions": [
      "filter.set case==IV", "filter.next", {"expect": {"case": "IV"}}]})");
  well(run({"view", "--classifier", "pca", "--script", script, "--screenshot", dir / "a.png",
            "--state", dir / "a.json", "--size", "1000x640"}));
  EXPECT_EQ(read_text(dir / "a.png").substr(1, 3), "PNG");
  const auto facts = nlohmann::json::parse(read_text(dir / "a.json"));
  EXPECT_EQ(facts.at("case"), "IV");
  EXPECT_EQ(facts.at("filter"), "case==IV");
  EXPECT_FALSE(fs::exists(dir / "state")) << "the picture's window remembers nothing";
}

TEST_F(View, AFailedExpectationIsExitCodeOne) {
  const fs::path dir = scratch();
  const fs::path script =
      write(dir / "script.json", R"({"actions": ["step.first", {"expect": {"step": 5}}]})");
  const Ran ran = run({"view", "--classifier", "pca", "--offscreen", "--script", script});
  EXPECT_EQ(ran.code, 1);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_TRUE(has(ran.err, "expected step 5, found 0"));
}

TEST_F(View, BadInputIsReportedInOneLine) {
  const fs::path dir = scratch();
  const fs::path bad = write(dir / "bad.json", "{\"schema\": ");
  const fs::path out = dir / "a.png";
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"view", "--open", bad, "--screenshot", out},
        {"view", "--open", dir / "absent.json", "--screenshot", out},
        {"view", "--script", bad, "--screenshot", out},
        {"view", "/nowhere/at/all", "--screenshot", out},
        {"view", "--size", "10x10", "--screenshot", out},
        {"view", "--scale", "0", "--screenshot", out},
        {"view", "--screenshot", "/nowhere/at/all.png"}}) {
    expect_refused(run(args));
  }
}

TEST_F(View, ListsItsActionsWithTheirKeys) {
  const Ran ran = well(run({"view", "--actions"}));
  EXPECT_TRUE(has(ran.out, "step.next"));
  EXPECT_TRUE(has(ran.out, "Shift+Right"));
}

TEST_F(View, TheWindowsSpeedIsComparedWithAnEmptyWindow) {
  const fs::path dir = scratch();
  well(run({"planescope-lab", "bench", "desktop", "--classifier", "pca", "--steps", "20", "--size",
            "800x500", "-o", dir / "out"}));
  auto results = results_of(read_text(dir / "out" / "desktop.jsonl"));
  ASSERT_EQ(results["times"].size(), 4u);
  EXPECT_EQ(results["times"][0]["what"], "empty window");
  for (const auto& times : results["times"]) {
    EXPECT_FALSE(times["ms"].empty());
    for (const double ms : times["ms"]) EXPECT_GT(ms, 0) << times["what"];
  }
}

}  // namespace
}  // namespace planescope::testing_cli
