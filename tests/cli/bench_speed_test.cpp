// planescope-lab bench speed, with few rounds and small clouds. How long things take is not tested.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;

namespace {

Ran bench_speed(const fs::path& out, std::vector<std::string> more) {
  std::vector<std::string> args = {
      "planescope-lab", "bench", "speed",      "--rounds",  "1", "--most-points",
      "1000",           "-o",    out.string(), "--threads", "2"};
  args.insert(args.end(), more.begin(), more.end());
  return run(args);
}

}  // namespace

TEST(BenchSpeed, MeasuresEveryPartOfARecording) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  const Ran ran = bench_speed(dir / "out", {(dir / "rec").string(), "--gravity", "0,1,0"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(files_below(dir / "out"), (std::vector<std::string>{"index.html", "speed.json"}));

  const auto json = nlohmann::json::parse(read_text(dir / "out/speed.json"));
  EXPECT_EQ(json["schema"], "planescope.bench.speed/1");
  EXPECT_EQ(json["recordings"][0]["name"], "rec");
  EXPECT_EQ(json["recordings"][0]["frames"], 2);
  EXPECT_GT(json["bytes_per_s"], 0);
  std::vector<std::string> stages;
  for (const auto& row : json["stages"]) {
    stages.push_back(row["stage"]);
    EXPECT_GT(row["floor_ms"], 0) << row["stage"];
  }
  EXPECT_EQ(stages, (std::vector<std::string>{"load", "cloud", "voxel grid", "classifier gcn",
                                              "classifier pca", "octree", "segmentation paper",
                                              "segmentation refined"}));
  EXPECT_EQ(json["frames"][0]["method"], "region-growing");
  EXPECT_EQ(json["frames"][0]["ratio"], 1);
  EXPECT_GE(json["frames"].size(), 5u);
  ASSERT_EQ(json["scaling"].size(), 5u);
  EXPECT_EQ(json["scaling"][4]["x"], (std::vector<double>{1, 2}));
  EXPECT_EQ(json["stage_memory"].size(), stages.size());
  EXPECT_EQ(json["commands"].size(), 2u);

  EXPECT_NE(ran.out.find("Stages beside their floors"), std::string::npos);
  const std::string page = read_text(dir / "out/index.html");
  EXPECT_NE(page.find("<svg"), std::string::npos);
}

TEST(BenchSpeed, CountsTheAllocationsOfAStage) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const Ran ran = bench_speed(
      dir / "out", {(dir / "rec").string(), "--gravity", "0,1,0", "--only", "memory", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_TRUE(json["stages"].empty());
  for (const auto& row : json["stage_memory"]) {
    if (row["allocations"].is_null()) GTEST_SKIP() << "this build does not count";
    EXPECT_GT(row["allocations"]["calls"], 0) << row["stage"];
    EXPECT_GT(row["allocations"]["bytes"], row["allocations"]["calls"]) << row["stage"];
  }
}

TEST(BenchSpeed, TakesASyntheticSetWhereNoRecordingIsGiven) {
  const fs::path out = scratch() / "out";
  const Ran ran = bench_speed(out, {"--only", "memory", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["recordings"][0]["name"], "depth_stairs, d435");
  EXPECT_EQ(json["stage_memory"][0]["stage"], "cloud") << "nothing is loaded";
}

TEST(BenchSpeed, WhatCannotBeMeasuredIsOneLine) {
  const fs::path dir = scratch();
  Image16 nothing = floor_and_wall();
  std::fill(nothing.data.begin(), nothing.data.end(), std::uint16_t{0});
  write_depth_folder(dir / "empty", nothing);
  write_text(dir / "file", "");
  const std::vector<std::vector<std::string>> cases = {
      {(dir / "empty").string(), "--gravity", "0,1,0"},
      {"--only", "frames", (dir / "nowhere").string()},
      {"--only", "everything"},
      {"--weights", "pca"},
      {"--rounds", "0"},
  };
  const Ran taken = bench_speed(dir / "file", {});
  EXPECT_EQ(taken.code, 2);
  EXPECT_NE(taken.err.find("is not a folder"), std::string::npos) << taken.err;
  for (const auto& more : cases) {
    const Ran ran = bench_speed(dir / "out", more);
    EXPECT_EQ(ran.code, 2) << more[0];
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_FALSE(fs::exists(dir / "out")) << more[0];
  }
}
