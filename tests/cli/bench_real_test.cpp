// planescope-lab bench real, with few frames.

#include <gtest/gtest.h>

#include "cli/result_lines.hpp"
#include "cli/scene_files.hpp"
#include "support/needs_open3d.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Writes DIR/data/rec, labels of its only frame in DIR/labels/room, and DIR/list.txt.
void write_labeled(const fs::path& dir) {
  const fs::path recording = dir / "data/rec";
  write_depth_folder(recording, floor_and_wall());
  write_true_labels(recording, dir / "labels/room");
  write_text(dir / "list.txt", "# a comment\n\nroom tuning rec 0 --gravity 0,1,0 --max-range 4\n");
}

std::vector<std::string> frames_args(const fs::path& dir, const std::string& list = "list.txt") {
  return {"planescope-lab",
          "bench",
          "real",
          "--only",
          "frames",
          "--data",
          (dir / "data").string(),
          "--frames-list",
          (dir / list).string(),
          "--labels",
          (dir / "labels").string()};
}

/// The 160x120 px scene as seen by the camera of `bench real --only repeat`.
Image16 floor_and_wall_640x480() {
  const Image16 small = floor_and_wall();
  Image16 depth(640, 480);
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u) depth.at(u, v) = small.at(u / 4, v / 4);
  return depth;
}

Ran run_with(std::vector<std::string> args, const std::vector<std::string>& more) {
  args.insert(args.end(), more.begin(), more.end());
  return run(args);
}

}  // namespace

TEST(BenchReal, ScoresEveryMethodOnAListedFrame) {
  PLANESCOPE_NEEDS_OPEN3D();
  const fs::path dir = scratch();
  write_labeled(dir);
  const Ran ran = well(run_with(frames_args(dir), {}));
  EXPECT_EQ(ran.out.find(dir.string()), std::string::npos) << "no folders of this machine";
  auto results = results_of(ran.out);
  std::map<std::string, Json> scores;
  for (const Json& line : results["labelled"]) {
    EXPECT_EQ(line["name"], "room");
    EXPECT_EQ(line["half"], "tuning");
    EXPECT_EQ(line["recording"], "rec");
    scores[line["method"]] = line;
  }
  for (const char* method :
       {"ours refined gcn", "ours paper gcn", "ours paper-closest gcn", "ransac", "region-growing"})
    EXPECT_EQ(scores[method]["planes_truth"], 2) << method;
  EXPECT_EQ(scores["ours refined gcn"]["correct"], 2);
  EXPECT_EQ(results["run"].at(0)["command"],
            "planescope-lab bench real --frames-list list.txt --only frames");
}

TEST(BenchReal, TheResultsAreTheSameForAnyThreadCount) {
  PLANESCOPE_NEEDS_OPEN3D();
  const fs::path dir = scratch();
  write_labeled(dir);
  for (const char* name : {"aims_slam_realsense_640x480", "tum_fr1_rpy_kinect_640x480"})
    write_depth_folder(dir / "data" / name, floor_and_wall_640x480(), 4);
  write_text(dir / "data/tum_fr1_rpy_kinect_640x480/gravity.json", "{\"gravity\": [0, 1, 0]}");
  std::vector<std::string> args = frames_args(dir);
  const auto measure = [&](const char* only, const char* count, const char* threads) {
    args[4] = only;
    const std::string out = (dir / threads / only).string();
    well(run_with(args, {"--seeds", "7", "--count", count, "--threads", threads, "-o", out}));
  };
  for (const char* threads : {"1", "2"}) {
    measure("frames,sets", "1", threads);
    measure("repeat", "2", threads);
  }
  for (const char* only : {"frames,sets", "repeat"})
    EXPECT_EQ(read_text(dir / "1" / only / "real.jsonl"),
              read_text(dir / "2" / only / "real.jsonl"))
        << only;
  const std::string sets = (dir / "1/frames,sets/real.jsonl").string();
  std::map<std::string, int> frames;
  auto set_results = results_of(read_text(sets));
  for (const Json& line : set_results["set"]) ++frames[line["method"]];
  EXPECT_EQ(frames["ransac"], 6) << "one of three sets, clean and d435";
  const std::string tables = typeset(sets + " " + (dir / "1/repeat/real.jsonl").string());
  for (const char* part : {"Labeled real frames, half tuning: 1 frame",
                           "All depth sets, d435: 1 seed, 3 frames each", "From frame to frame: 2"})
    EXPECT_NE(tables.find(part), std::string::npos) << part << " in " << tables;
  const Json repeat = results_of(read_text(dir / "1/repeat/real.jsonl"))["repeat"].at(0);
  EXPECT_EQ(repeat["floor"].size(), 2u);
  EXPECT_EQ(repeat["neighbours"][0]["planes"], repeat["neighbours"][0]["partners"])
      << "nothing moved";
}

TEST(BenchReal, MeasuresOneHalfOfTheList) {
  const fs::path dir = scratch();
  write_labeled(dir);
  write_text(dir / "list.txt",
             "room tuning rec 0 --gravity 0,1,0\nmissing printed nowhere 0 --gravity 0,1,0\n");
  const Ran ran = well(run_with(frames_args(dir), {"--half", "tuning"}));
  auto results = results_of(ran.out);
  for (const Json& line : results["labelled"]) EXPECT_EQ(line["name"], "room");
}

TEST(BenchReal, RejectsUnknownNamesInOneLine) {
  const fs::path dir = scratch();
  write_labeled(dir);
  const std::string good = "room tuning rec 0 --gravity 0,1,0\n";
  const std::vector<std::pair<std::string, std::string>> lists = {
      {good + "a prnted rec 0\n", "line 2: unknown half 'prnted'"},
      {"#\n" + good + "a tuning rec\n", "line 3: expected NAME HALF RECORDING FRAME"},
      {good + "a tuning rec first\n", "line 2: FRAME"},
      {good + "a tuning rec -1\n", "line 2: FRAME: -1"},
      {good + "a tuning rec 0 --frames 1\n", "line 2: unknown option '--frames'"},
      {good + "a tuning rec 0 --gravity\n", "line 2: --gravity needs a value"},
      {good + "a tuning rec 0 --intrinsics 1,2\n", "line 2: --intrinsics"},
      {good + "a tuning rec 0 --max-range -1\n", "line 2: "},
      {good + good, "line 2: room appears twice"},
      {"# nothing\n", "lists no frames"},
      {"other tuning rec 0 --gravity 0,1,0\n", "no labels for frame 0"},
      {"room tuning rec 1 --gravity 0,1,0\n", "has 1 frame"},
      {"room tuning rek 0 --gravity 0,1,0\n", "rek"}};
  for (const auto& [text, part] : lists) {
    write_text(dir / "bad.txt", text);
    const Ran ran = run_with(frames_args(dir, "bad.txt"), {"-o", (dir / "out").string()});
    expect_refused(ran, part);
    EXPECT_FALSE(fs::exists(dir / "out")) << text;
  }
  const std::string out = (dir / "out").string(), data = (dir / "data").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{"-o", out}, "--frames-list"},
      {{"-o", out, "--frames-list", (dir / "list.txt").string()}, "--labels"},
      {{"-o", out, "--data", data, "--frames-list", (dir / "list.txt").string(), "--labels",
        (dir / "none").string()},
       "none is not a folder"},
      {{"-o", out, "--data", data, "--frames-list", (dir / "list.txt").string(), "--labels",
        (dir / "labels").string(), "--half", "second"},
       "unknown half 'second'"},
      {{"-o", out, "--only", "repeat", "--data", data}, "aims_slam_realsense_640x480"},
      {{"-o", out, "--only", "repeat", "--data", (dir / "none").string()}, "--data"},
      {{"-o", out, "--only", "set"}, "set"},
      {{"-o", out, "--only", "sets", "--seeds", "1,x"}, "--seeds"},
      {{"-o", out, "--only", "sets", "--seeds", "1,1"}, "twice"},
      {{"-o", out, "--only", "sets", "--count", "0"}, "--count"}};
  for (const auto& [args, part] : bad) {
    const Ran ran = run_with({"planescope-lab", "bench", "real"}, args);
    expect_refused(ran, part);
    EXPECT_FALSE(fs::exists(out)) << part;
  }
}
