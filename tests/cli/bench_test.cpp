// planescope-lab bench classifier, with few clouds and an untrained network.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/lab/training/train.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;

namespace {

struct Bench {
  fs::path dir = scratch();
  std::string weights = (dir / "untrained.safetensors").string();

  Bench() {
    planes::write_weights(weights, lab::random_weights(planes::network_config("compact"), 1));
  }

  Ran with(std::vector<std::string> more) const {
    std::vector<std::string> args = {"planescope-lab", "bench", "classifier", "--weights", weights,
                                     "--count",        "1",     "--rounds",   "1"};
    args.insert(args.end(), more.begin(), more.end());
    return run(args);
  }
};

}  // namespace

TEST(BenchClassifier, MeasuresEverythingThatItIsGiven) {
  const Bench bench;
  write_depth_folder(bench.dir / "rec", floor_and_wall());
  const fs::path out = bench.dir / "out";
  const Ran ran =
      bench.with({(bench.dir / "rec").string(), "--gravity", "0,1,0", "-o", out.string()});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(files_below(out),
            (std::vector<std::string>{"classifier.json", "classifier.md", "classifier.timings.json",
                                      "classifier.timings.md"}));

  const auto results = nlohmann::json::parse(read_text(out / "classifier.json"));
  EXPECT_EQ(results["count"], 1);
  EXPECT_EQ(results["networks"][0]["name"], "untrained");
  EXPECT_EQ(results["labels"].size(), 6u * 3);                    // sets x (network, PCA 8, PCA 16)
  EXPECT_EQ(results["chain"].size(), 4u * 4);                     // noises x (truth and these)
  EXPECT_GT(results["labels"][1]["level"]["inner_percent"], 99);  // PCA needs no training
  EXPECT_TRUE(results["labels"][0].contains("tilted"));

  const auto timings = nlohmann::json::parse(read_text(out / "classifier.timings.json"));
  EXPECT_NE(timings["machine"]["cpu"], "");
  EXPECT_EQ(timings["reference"].size(), 3u);  // 2048, 4096, 8192 points
  const auto& frame = timings["frames"][0];
  EXPECT_EQ(frame["recording"], "rec");
  EXPECT_GT(frame["points"], frame["voxels"]);
  EXPECT_GT(frame["voxels"], 0);

  for (const char* table : {"Labels that are right", "Gravity wrong by 5 degrees",
                            "The planes that follow", "From points to labels", "Whole frames"})
    EXPECT_NE(ran.out.find(table), std::string::npos) << table;
}

TEST(BenchClassifier, WhatDoesNotDependOnTimeIsTheSameForAnyThreadCount) {
  const Bench bench;
  for (const char* threads : {"1", "3"}) {
    const Ran ran = bench.with(
        {"--only", "accuracy,chain", "--threads", threads, "-o", (bench.dir / threads).string()});
    ASSERT_EQ(ran.code, 0) << ran.err;
  }
  EXPECT_EQ(files_below(bench.dir / "1"),
            (std::vector<std::string>{"classifier.json", "classifier.md"}));
  for (const char* file : {"classifier.json", "classifier.md"})
    EXPECT_EQ(read_text(bench.dir / "1" / file), read_text(bench.dir / "3" / file)) << file;
}

TEST(BenchClassifier, PutsNetworksSideBySide) {
  const Bench bench;
  const std::string other = (bench.dir / "other.safetensors").string();
  planes::write_weights(other, lab::random_weights(planes::network_config("compact"), 2));
  const Ran ran = bench.with({"--weights", other, "--only", "chain", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["networks"].size(), 2u);
  EXPECT_EQ(json["chain"][1]["labels"], "untrained");
  EXPECT_EQ(json["chain"][2]["labels"], "other");
  EXPECT_FALSE(json.contains("labels"));
}

TEST(BenchClassifier, ARecordingWithoutGravityIsNamedBeforeAnythingIsMeasured) {
  const Bench bench;
  Image16 nothing = floor_and_wall();
  std::fill(nothing.data.begin(), nothing.data.end(), std::uint16_t{0});
  write_depth_folder(bench.dir / "rec", nothing);
  const Ran ran = bench.with({(bench.dir / "rec").string()});
  EXPECT_EQ(ran.code, 2);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_NE(ran.err.find("rec: "), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("holds no depth"), std::string::npos) << ran.err;
  EXPECT_EQ(ran.out, "");
}

TEST(BenchStairs, CountsRightStepsAndFlightsWhereThereAreNone) {
  const fs::path dir = scratch(), out = dir / "out";
  const Ran ran = run({"planescope-lab", "bench", "stairs", "--classifier", "pca", "--count", "3",
                       "--seed", "5", "-o", out.string()});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(files_below(out), (std::vector<std::string>{"stairs.json", "stairs.md"}));
  EXPECT_NE(ran.out.find("depth_boxes"), std::string::npos);
  const auto json = nlohmann::json::parse(read_text(out / "stairs.json"));
  EXPECT_EQ(json["seed"], 5);
  for (const char* set : {"depth_stairs", "depth_descent"}) {
    ASSERT_EQ(json[set].size(), 3u);
    for (const auto& frame : json[set]) {
      if (frame["found"] != frame["seen"] || frame["found"] == 0) continue;
      EXPECT_LT(std::abs(frame["rise_error_m"].get<double>()), 0.02);
    }
  }
  for (const auto& frame : json["depth_boxes"]) EXPECT_EQ(frame["flights"], 0);
  EXPECT_EQ(run({"planescope-lab", "bench", "stairs", "--method", "ransac"}).code, 2);
}
