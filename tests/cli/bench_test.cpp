// planescope-lab bench classifier, stairs, outlines and speed, with few clouds and frames, an
// untrained network, and few rounds. Does not test durations.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/result_lines.hpp"
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

TEST(BenchClassifier, MeasuresAllRecordingsAndNetworks) {
  const Bench bench;
  write_depth_folder(bench.dir / "rec", floor_and_wall());
  const fs::path out = bench.dir / "out";
  well(bench.with({(bench.dir / "rec").string(), "--gravity", "0,1,0", "-o", out.string()}));
  EXPECT_EQ(files_below(out),
            (std::vector<std::string>{"classifier.jsonl", "classifier.timings.jsonl"}));

  auto results = results_of(read_text(out / "classifier.jsonl"));
  EXPECT_EQ(results["run"].at(0)["count"], 1);
  EXPECT_EQ(results["network"].at(0)["name"], "untrained");
  EXPECT_EQ(results["labels"].size(), 6u * 3);                    // sets x (network, PCA 8, PCA 16)
  EXPECT_EQ(results["chain"].size(), 4u * 4);                     // noises x (truth, these)
  EXPECT_GT(results["labels"][1]["level"]["inner_percent"], 99);  // PCA needs no training
  EXPECT_TRUE(results["labels"][0].contains("tilted"));

  auto timings = results_of(read_text(out / "classifier.timings.jsonl"));
  EXPECT_NE(timings["run"].at(0)["machine"]["cpu"], "");
  EXPECT_EQ(timings["reference"].size(), 3u);  // 2048, 4096, 8192 points
  const auto& frame = timings["frames"].at(0);
  EXPECT_EQ(frame["recording"], "rec");
  EXPECT_GT(frame["points"], frame["voxels"]);
  EXPECT_GT(frame["voxels"], 0);

  const std::string tables = typeset((out / "classifier.jsonl").string() + " " +
                                     (out / "classifier.timings.jsonl").string());
  for (const char* table :
       {"Correct labels", "Gravity wrong by 5 degrees", "Planes found with these labels",
        "From points to labels", "Whole frames"})
    EXPECT_NE(tables.find(table), std::string::npos) << table;
}

TEST(BenchClassifier, ResultsExceptTimesAreTheSameForAnyThreadCount) {
  const Bench bench;
  for (const char* threads : {"1", "3"}) {
    well(bench.with(
        {"--only", "accuracy,chain", "--threads", threads, "-o", (bench.dir / threads).string()}));
  }
  EXPECT_EQ(files_below(bench.dir / "1"), std::vector<std::string>{"classifier.jsonl"});
  const auto without_command = [&](const char* threads) {
    const std::string lines = read_text(bench.dir / threads / "classifier.jsonl");
    return lines.substr(lines.find('\n'));
  };
  EXPECT_EQ(without_command("1"), without_command("3"));
}

TEST(BenchClassifier, ComparesNetworks) {
  const Bench bench;
  const std::string other = (bench.dir / "other.safetensors").string();
  planes::write_weights(other, lab::random_weights(planes::network_config("compact"), 2));
  const Ran ran = well(bench.with({"--weights", other, "--only", "chain"}));
  auto results = results_of(ran.out);
  EXPECT_EQ(results["network"].size(), 2u);
  EXPECT_EQ(results["chain"].at(1)["labels"], "untrained");
  EXPECT_EQ(results["chain"].at(2)["labels"], "other");
  EXPECT_TRUE(results["labels"].empty());
}

TEST(BenchClassifier, ARecordingWithoutGravityIsReportedBeforeMeasuring) {
  const Bench bench;
  Image16 nothing = floor_and_wall();
  std::fill(nothing.data.begin(), nothing.data.end(), std::uint16_t{0});
  write_depth_folder(bench.dir / "rec", nothing);
  const Ran ran = bench.with({(bench.dir / "rec").string()});
  expect_refused(ran, "rec: ");
  EXPECT_NE(ran.err.find("contains no depth"), std::string::npos) << ran.err;
  EXPECT_EQ(ran.out, "");
}

TEST(BenchStairs, CountsCorrectStepsAndFalseFlights) {
  const Ran ran = well(run(
      {"planescope-lab", "bench", "stairs", "--classifier", "pca", "--count", "3", "--seed", "5"}));
  auto results = results_of(ran.out);
  EXPECT_EQ(results["run"].at(0)["seed"], 5);
  EXPECT_EQ(results["frame"].size(), 9u);
  for (const auto& frame : results["frame"]) {
    if (frame["set"] == "depth_boxes") {
      EXPECT_EQ(frame["flights"], 0);
    } else if (frame["found"] == frame["seen"] && frame["found"] != 0) {
      EXPECT_LT(std::abs(frame["rise_error_m"].get<double>()), 0.02);
    }
  }
  EXPECT_EQ(run({"planescope-lab", "bench", "stairs", "--method", "ransac"}).code, 2);
}

// The results in docs/footholds.md, which cover many frames, also hold for a few.
TEST(BenchOutlines, OutlinesFootholdsAndSigmasMatchTheTruth) {
  std::string first;
  for (const char* threads : {"1", "2"}) {
    const Ran ran = well(run({"planescope-lab", "bench", "outlines", "--seeds", "1", "--count", "6",
                              "--threads", threads}));
    if (first.empty()) first = ran.out;
    EXPECT_TRUE(ran.out == first) << "the same for any number of threads";
  }
  const auto frames = results_of(first)["frame"];
  EXPECT_EQ(frames.size(), 18u);
  std::vector<double> drawn, found;
  int known = 0, within[3] = {}, spaces = 0, places = 0;
  for (const auto& frame : frames) {
    const auto& foot = frame["foot"];
    spaces += foot["spaces"].get<int>();
    places += foot["places"].get<int>();
    EXPECT_EQ(foot["invalid"], 0);
    EXPECT_EQ(foot["off"], 0);
    EXPECT_GE(foot["least_covered"], 0.95);
    for (const auto& plane : frame["planes"]) {
      if (plane["true_m2"] < 0.02 || plane["found"] == 0) continue;
      drawn.push_back(plane["drawn_iou"]);
      found.push_back(plane["iou"]);
      if (found.back() < 0.5) continue;
      ++known;
      for (int i = 0; i < 3; ++i) within[i] += std::abs(plane["off_sigmas"][i].get<double>()) <= 2;
    }
  }
  EXPECT_GT(found.size(), 50u);
  for (auto* values : {&drawn, &found}) std::ranges::sort(*values);
  EXPECT_GT(drawn[drawn.size() / 2], 0.95);
  EXPECT_GT(found[found.size() / 2], 0.93);
  for (const int count : within) EXPECT_GT(count, 0.85 * known);
  EXPECT_GT(spaces, 20);
  EXPECT_GT(places, 1000);
}

// ---- Speed ----

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
  const auto dir = scratch_with_rec(2);
  well(bench_speed(dir / "out", {(dir / "rec").string(), "--gravity", "0,1,0"}));
  auto results = results_of(read_text(dir / "out/speed.jsonl"));
  EXPECT_EQ(results["subject"].at(0)["name"], "rec");
  EXPECT_EQ(results["subject"].at(0)["frames"], 2);
  EXPECT_GT(results["run"].at(0)["bytes_per_s"], 0);
  std::vector<std::string> stages;
  for (const auto& row : results["stage"]) {
    stages.push_back(row["stage"]);
    EXPECT_GT(row["floor_ms"], 0) << row["stage"];
  }
  EXPECT_EQ(stages, (std::vector<std::string>{"load", "cloud", "voxel grid", "classifier gcn",
                                              "classifier pca", "octree", "segmentation paper",
                                              "segmentation refined"}));
  EXPECT_EQ(results["method"].at(0)["method"], "region-growing");
  EXPECT_EQ(results["method"][0]["ratio"], 1);
  EXPECT_GE(results["method"].size(), 5u);
  ASSERT_EQ(results["scaling"].size(), 5u);
  EXPECT_EQ(results["scaling"][4]["x"], (std::vector<double>{1, 2}));
  EXPECT_EQ(results["stage_memory"].size(), stages.size());
  EXPECT_EQ(results["command"].size(), 2u);

  const std::string tables =
      typeset(fmt::format("{0}/out/speed.jsonl --plots {0}/plots", dir.string()));
  EXPECT_NE(tables.find("Stages and their lower bounds"), std::string::npos);
  EXPECT_NE(tables.find("scaling_threads.svg"), std::string::npos) << tables;
}

TEST(BenchSpeed, CountsTheAllocationsOfAStage) {
  const auto dir = scratch_with_rec();
  well(
      bench_speed(dir / "out", {(dir / "rec").string(), "--gravity", "0,1,0", "--only", "memory"}));
  auto results = results_of(read_text(dir / "out/speed.jsonl"));
  EXPECT_TRUE(results["stage"].empty());
  for (const auto& row : results["stage_memory"]) {
    if (row["allocations"].is_null()) GTEST_SKIP() << "this build does not count";
    EXPECT_GT(row["allocations"]["calls"], 0) << row["stage"];
    EXPECT_GT(row["allocations"]["bytes"], row["allocations"]["calls"]) << row["stage"];
  }
}

TEST(BenchSpeed, UsesASyntheticSetWithoutARecording) {
  const fs::path out = scratch() / "out";
  well(bench_speed(out, {"--only", "memory"}));
  auto results = results_of(read_text(out / "speed.jsonl"));
  EXPECT_EQ(results["subject"].at(0)["name"], "depth_stairs, d435");
  EXPECT_EQ(results["stage_memory"].at(0)["stage"], "cloud") << "nothing is loaded";
}

TEST(BenchSpeed, UnmeasurableInputIsReportedInOneLine) {
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
    expect_refused(ran);
    EXPECT_EQ(ran.out, "");
    EXPECT_FALSE(fs::exists(dir / "out")) << more[0];
  }
}
