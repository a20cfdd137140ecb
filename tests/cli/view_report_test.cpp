// From a plane in a report to the decision in the debugger.

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"

namespace planescope::testing_cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct ViewReport : testing::Test {
  const fs::path dir = scratch();
  const fs::path sample = fs::path(PLANESCOPE_SOURCE_DIR) / "assets/sample";

  ViewReport() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    setenv("XDG_STATE_HOME", (dir / "state").c_str(), 1);
  }
  /// Makes a report; returns its report.json.
  fs::path report(const std::string& out, std::vector<std::string> args) {
    args.insert(args.begin(), "report");
    args.insert(args.end(), {"--classifier", "pca", "-o", dir / out});
    well(run(args));
    return dir / out / "report.json";
  }
  static Ran view(const std::string& target, const std::vector<std::string>& more) {
    std::vector<std::string> args{"view", "--open", target, "--offscreen", "--size", "800x500"};
    args.insert(args.end(), more.begin(), more.end());
    return run(args);
  }
  /// Opens the window and returns the state that it displays.
  Json facts(const std::string& target, std::vector<std::string> more = {}, int code = 0) {
    more.insert(more.end(), {"--state", dir / "state.json"});
    EXPECT_EQ(view(target, more).code, code);
    return Json::parse(read_text(dir / "state.json"));
  }
  void refuses(const std::string& target,
               const std::string& part,
               const std::vector<std::string>& more = {}) {
    expect_refused(view(target, more), part);
  }
};

std::vector<int> samples_of(const Json& frame) {
  std::vector<int> samples;
  const std::vector<int> runs = frame["regions"]["runs"];
  for (std::size_t i = 0; i < runs.size(); i += 2)
    samples.insert(samples.end(), static_cast<std::size_t>(runs[i + 1]), runs[i]);
  return samples;
}

/// The plane of `before` with the fewest samples on planes of `after`.
int lost_plane(const Json& before, const Json& after) {
  const std::vector<int> a = samples_of(before), b = samples_of(after);
  std::vector<double> all(before["planes"].size() + 1), kept(all.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] > 0) {
      ++all[static_cast<std::size_t>(a[i])];
      kept[static_cast<std::size_t>(a[i])] += b[i] > 0;
    }
  std::size_t lost = 1;
  for (std::size_t k = 2; k < all.size(); ++k)
    if (kept[k] * all[lost] < kept[lost] * all[k]) lost = k;
  return static_cast<int>(lost);
}

Json frame_in(const fs::path& report) {
  return Json::parse(read_text(report))["recordings"][0]["frames"][0];
}

TEST_F(ViewReport, ALostPlaneOpensTheDecisionThatLostIt) {
  const fs::path before = report("before", {sample, "--frames", "0", "--profile", "paper"});
  const fs::path after =
      report("after", {sample, "--frames", "0", "--profile", "paper", "--set", "theta_n_in=60"});
  const int lost = lost_plane(frame_in(before), frame_in(after));
  const std::string target = after.string() + "#f000/was" + std::to_string(lost);

  const Json there = facts(target, {"--baseline", before});
  EXPECT_EQ(there["recording"], sample.string());
  EXPECT_EQ(there["frame"], 0);
  EXPECT_EQ(there["pinned"], true);
  EXPECT_EQ(there["options"]["theta_n_in"], "60") << "B is the report";
  EXPECT_EQ(there["options"]["classifier"], "pca");
  const std::string event = there["event"];
  EXPECT_TRUE(has(event, "< 60")) << "case II by the option that changed: " << event;
  EXPECT_EQ(there["case"], "II");
  EXPECT_EQ(there["tab"], "point");
  EXPECT_GE(there["voxel"], 0);
  EXPECT_GT(there["marked"], 100) << "what it covered";
  const std::string message = there["message"];
  EXPECT_TRUE(has(message, "diverge at step " + there["step"].dump()));

  // The path in the report is relative to its folder.
  Json named = Json::parse(read_text(after));
  named["verdict"] = {{"baseline", "../before/report.json"}};
  write_text(after, named.dump());
  const Json again = facts(target);
  EXPECT_EQ(again["step"], there["step"]);
  EXPECT_EQ(again["message"],
            "the baseline is " + (dir / "before/report.json").string() + "; " + message);

  write_text(dir / "to_a.json", R"({"actions": ["run.restore"]})");
  EXPECT_EQ(facts(target, {"--script", dir / "to_a.json"})["options"]["theta_n_in"], "5")
      << "A is the baseline";
}

TEST_F(ViewReport, APlaneOpensTheStepThatFoundedIt) {
  const fs::path file = report("out", {sample, "--frames", "0"});
  const std::size_t planes = frame_in(file)["planes"].size();
  const Json there = facts(file.string() + "#f0/p" + std::to_string(planes));
  EXPECT_EQ(there["pinned"], false) << "there is no baseline";
  EXPECT_EQ(there["planes"], planes);
  const std::string event = there["event"], plane = there["plane"];
  EXPECT_TRUE(event.ends_with("creates " + plane)) << event << ", plane " << plane;
  EXPECT_EQ(there["tab"], "inspector");

  const Json frame = facts(file.string());
  EXPECT_EQ(frame["step"], frame["steps"]) << "no plane: as a frame opens";
}

TEST_F(ViewReport, TheBaselinesOptionsGiveIdenticalRunsAAndB) {
  const fs::path file = report("out", {sample, "--frames", "0"});
  fs::copy(file, dir / "earlier.json");
  Json earlier = Json::parse(read_text(file));
  earlier["created_utc"] = "2024-01-02T03:04:05Z";
  write_text(dir / "earlier.json", earlier.dump());
  const Json there = facts(file.string() + "#f0/was1", {"--baseline", dir / "earlier.json"});
  EXPECT_EQ(there["pinned"], true);
  const std::string message = there["message"];
  EXPECT_TRUE(message.starts_with("A and B are the same")) << message;
  EXPECT_TRUE(has(message, "plane 1"));
}

TEST_F(ViewReport, MissingItemsAreReportedInOneLine) {
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  const std::string file = report("out", {dir / "rec", "--gravity", "0,1,0"});
  refuses(file + "#f0/q1",
          "out/report.json: 'f0/q1' is not a location in a report; expected f<frame>");
  refuses(file + "#r2/f0", "report.json: has no r2; it has 1 recording");
  refuses(file + "#f7", "report.json: has no f7; its frames from rec are 0, 1");
  refuses(file + "#f0/p3", "report.json: has no p3: frame 0 has 2 planes");
  refuses(file + "#f0/was1", "the report names none; use --baseline FILE");
  refuses(file + "#f0/was1", file + " was approved as this baseline", {"--baseline", file});
  refuses(file + "#f0", "/nowhere.json", {"--baseline", "/nowhere.json"});
  refuses(file + "#f0", "remove --profile", {"--set", "theta_n_in=7"});

  Json other = Json::parse(read_text(file));
  other["created_utc"] = "2024-01-02T03:04:05Z";
  other["recordings"][0]["frames"][0]["sha256"] = std::string(64, 'a');
  other["recordings"][0]["frames"].erase(1);
  write_text(dir / "base.json", other.dump());
  const std::vector<std::string> against{"--baseline", dir / "base.json"};
  refuses(file + "#f0/was1",
          "base.json: has no was1: in recording rec, frame 0 has different input", against);
  refuses(file + "#f1/was1",
          "base.json: has no was1: in recording rec, frame 1 is not in the baseline", against);
  EXPECT_EQ(facts(file + "#f0/p1", against)["frame"], 0) << "the options are still A's";
}

TEST_F(ViewReport, OpensPathsFromTheReportsFolderThatWereTypedAboveIt) {
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  const fs::path here = fs::current_path();
  fs::current_path(dir);
  const Ran ran = run({"report", "rec", "-o", "a/out", "--no-pictures", "--gravity", "0,1,0"});
  fs::current_path(dir / "a/out");
  const Json there = facts("report.json#f1/p1");
  fs::current_path(here);
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(there["frame"], 1);
  EXPECT_EQ(there["recording"], (dir / "rec").string());
}

TEST_F(ViewReport, RecordingsWithTheSameNameAreDistinguished) {
  Image16 other = floor_and_wall();
  other.at(3, 3) += 1;
  write_depth_folder(dir / "one/rec", floor_and_wall());
  write_depth_folder(dir / "two/rec", other);
  well(run({"report", dir / "one/rec", dir / "two/rec", "-o", dir / "a/out", "--no-pictures",
            "--gravity", "0,1,0"}));
  const std::string file = dir / "a/out/report.json";
  EXPECT_EQ(facts(file + "#r2/f0", {dir / "one/rec", dir / "two/rec"})["recording"],
            (dir / "two/rec").string());
  Json typed = Json::parse(read_text(file));
  typed["recordings"][1]["path"] = "two/rec";
  write_text(file, typed.dump());
  write_depth_folder(dir / "a/two/rec", floor_and_wall());
  EXPECT_EQ(facts(file + "#r2/f0")["recording"], (dir / "two/rec").string())
      << "the one in between is another";
}

TEST_F(ViewReport, ADamagedFrameDoesNotPreventOpeningAnother) {
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  fs::resize_file(dir / "rec/depth/000001.png", 200);
  const Ran ran = run({"report", dir / "rec", "-o", dir / "out", "--no-pictures"});
  EXPECT_EQ(ran.code, 2) << ran.err;
  const std::string file = dir / "out/report.json";
  EXPECT_EQ(facts(file + "#f2/p1", {}, 2)["frame"], 2);
  EXPECT_EQ(facts(file + "#f2/p1", {dir / "rec"}, 2)["frame"], 2);
}

TEST_F(ViewReport, AnotherRecordingOrOtherWeightsAreRejectedInOneLine) {
  write_depth_folder(dir / "rec", floor_and_wall());
  const std::string file = report("out", {dir / "rec", "--gravity", "0,1,0"});
  Image16 other = floor_and_wall();
  other.at(3, 3) += 1;
  fs::rename(dir / "rec", dir / "out/rec");
  EXPECT_EQ(facts(file + "#f0/p1")["recording"], (dir / "out/rec").string()) << "beside the report";
  fs::create_directories(dir / "elsewhere");
  fs::rename(dir / "out/rec", dir / "elsewhere/rec");
  refuses(file + "#f0/p1", "its recording " + (dir / "rec").string() + " was not found there");
  EXPECT_EQ(facts(file + "#f0/p1", {dir / "elsewhere/rec"})["recording"],
            (dir / "elsewhere/rec").string());
  fs::rename(dir / "elsewhere/rec", dir / "elsewhere/renamed");
  EXPECT_EQ(facts(file + "#f0/p1", {dir / "elsewhere/renamed"})["frame"], 0) << "it was given";
  fs::rename(dir / "elsewhere/renamed", dir / "elsewhere/rec");
  write_depth_folder(dir / "rec", other);
  refuses(file + "#f0/p1", "not the recording used for " + file);

  write_depth_folder(dir / "third", other);
  refuses(file + "#f0/p1", "not the recording used for " + file, {dir / "third"});

  fs::remove_all(dir / "rec");
  fs::rename(dir / "elsewhere/rec", dir / "rec");
  write_text(dir / "mine.safetensors", "not these");
  Json weights = Json::parse(read_text(file));
  for (Json& option : weights["record"]["options"])
    if (option["name"] == "classifier") option["value"] = "../mine.safetensors";
  weights["record"]["weights"] = {{"sha256", std::string(64, 'a')}};
  write_text(file, weights.dump());
  refuses(file + "#f0/p1", "mine.safetensors: not the weights used for");
}

}  // namespace
}  // namespace planescope::testing_cli
