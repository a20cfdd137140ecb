// planescope-lab bench steady, on a small recording.

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "cli/result_lines.hpp"
#include "cli/scene_files.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

Ran bench_steady(const fs::path& recording, const std::vector<std::string>& more) {
  std::vector<std::string> args = {"planescope-lab", "bench", "steady", recording.string()};
  args.insert(args.end(), more.begin(), more.end());
  return run(args);
}

/// Pairs of a method for a change.
std::vector<Json> pairs_of(const std::string& lines,
                           const std::string& change,
                           const std::string& method) {
  std::vector<Json> pairs = results_of(lines)["pair"];
  std::erase_if(pairs, [&](const Json& pair) {
    return pair["change"] != change || pair["method"] != method;
  });
  EXPECT_FALSE(pairs.empty()) << change << ", " << method;
  return pairs;
}

/// Share of planes with at least 3000 compared pixels that have no partner.
double big_lost(const std::vector<Json>& pairs, const char* which) {
  double lost = 0, all = 0;
  for (const Json& pair : pairs) {
    lost += pair[which]["big_lost"].get<double>();
    all += pair[which]["big"].get<double>();
  }
  return lost / all;
}

double self_pq(const Json& pair) {
  return 2 * pair["all"]["iou_sum"].get<double>() /
         (pair["all"]["planes"].get<double>() + pair["second_planes"].get<double>());
}

}  // namespace

TEST(BenchSteady, ACameraAtRestKeepsFloorAndWall) {
  const auto dir = scratch_with_rec(3);
  well(bench_steady(dir / "rec", {"--gravity", "0,1,0", "--max-range", "4", "--frames", ":",
                                  "--turns", "2", "-o", (dir / "out").string()}));
  EXPECT_EQ(files_below(dir / "out"), std::vector<std::string>{"steady.jsonl"});
  const std::string lines = read_text(dir / "out/steady.jsonl");
  EXPECT_EQ(lines.find(dir.string()), std::string::npos) << "no folders of this machine";
  EXPECT_EQ(results_of(lines)["run"].at(0)["command"],
            "planescope-lab bench steady rec --turns 2 --frames : --gravity 0,1,0 --max-range 4");
  for (const char* method : {"ours refined", "region-growing"}) {
    const std::vector<Json> next = pairs_of(lines, "next frame", method);
    EXPECT_EQ(next.size(), 2u) << "the last frame has no next one";
    for (const Json& pair : next) {
      EXPECT_EQ(self_pq(pair), 1) << method;
      EXPECT_EQ(pair["all"]["planes"], pair["all"]["partners"]) << method;
      EXPECT_EQ(pair["all"]["big_lost"], 0) << method;
      EXPECT_EQ(pair["all"]["big"], pair["decided"]["big"]) << method;
    }
  }
  const std::vector<Json> turned = pairs_of(lines, "gravity turned", "ours refined");
  EXPECT_EQ(turned.size(), 6u) << "two of each frame";
  for (const Json& pair : turned) {
    EXPECT_EQ(pair["all"]["planes"], 2);
    EXPECT_EQ(pair["label_changes"], 0);
  }
  for (const Json& pair : pairs_of(lines, "intrinsics to 6 digits", "ours paper")) {
    EXPECT_EQ(pair["changed"], 0) << "they have fewer digits";
    EXPECT_EQ(pair["report_errors"], 0);
  }
  EXPECT_EQ(pairs_of(lines, "dither of 5 %", "ours refined").size(), 9u);
  const std::string table = typeset((dir / "out/steady.jsonl").string());
  EXPECT_NE(table.find("1.000 +- 0.000"), std::string::npos) << table;
}

TEST(BenchSteady, ARealPanKeepsItsPlanes) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Ran ran =
      well(bench_steady(fs::path(data) / "aims_slam_realsense_640x480",
                        {"--only", "gravity,focal,dither", "--turns", "5", "--method", "ours",
                         "--profile", "refined", "--intrinsics", "383.8,383.8,321.7,236.8",
                         "--gravity", "0.168,0.925,0.341", "--max-range", "4"}));
  for (const char* change :
       {"gravity turned", "fx x (1 + 1e-7)", "fx x (1 + 1e-5)", "fx, fy x (1 + 1e-6)"}) {
    std::set<int> frames;
    for (const Json& pair : pairs_of(ran.out, change, "ours refined")) {
      frames.insert(pair["frame"].get<int>());
      EXPECT_EQ(pair["changed"], 0) << change;
      EXPECT_EQ(pair["report_errors"], 0) << change;
      EXPECT_EQ(self_pq(pair), 1) << change;
    }
    EXPECT_EQ(frames.size(), 5u);
  }
  double sum = 0;
  const std::vector<Json> dithered = pairs_of(ran.out, "dither of 5 %", "ours refined");
  for (const Json& pair : dithered) sum += self_pq(pair);
  EXPECT_GE(sum, 0.8 * static_cast<double>(dithered.size()));
}

// A hand-held camera that turns fast: decided planes persist in the next frame.
TEST(BenchSteady, DecidedPlanesPersistInTheNextFrame) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Ran ran = well(bench_steady(
      fs::path(data) / "tum_fr1_rpy_kinect_640x480",
      {"--only", "next", "--method", "ours", "--profile", "refined", "--intrinsics",
       "591.1,590.1,331,234", "--depth-unit", "0.0002", "--gravity", "none", "--max-range", "4"}));
  const std::vector<Json> pairs = pairs_of(ran.out, "next frame", "ours refined");
  EXPECT_EQ(pairs.size(), 38u);
  double pq = 0, big = 0, decided = 0;
  for (const Json& pair : pairs) {
    pq += self_pq(pair) / 38;
    big += pair["all"]["big"].get<double>();
    decided += pair["decided"]["big"].get<double>();
  }
  EXPECT_GE(pq, 0.70);
  EXPECT_LE(big_lost(pairs, "all"), 0.11);
  EXPECT_LE(big_lost(pairs, "decided"), 0.03);
  EXPECT_LE((big - decided) / big, 0.25);
}

TEST(BenchSteady, ResultsAreTheSameForAnyNumberOfThreads) {
  const auto dir = scratch_with_rec(3);
  for (const char* threads : {"1", "3"}) {
    well(bench_steady(dir / "rec", {"--frames", "::2", "--gravity", "0,1,0", "--turns", "2",
                                    "--threads", threads, "-o", (dir / threads).string()}));
  }
  EXPECT_EQ(read_text(dir / "1/steady.jsonl"), read_text(dir / "3/steady.jsonl"));
}

TEST(BenchSteady, PosesTransferLabelsToTheNextFrame) {
  const auto dir = scratch_with_rec(2);
  const auto compared_planes = [&](const std::string& second_pose,
                                   const std::vector<std::string>& more) {
    write_text(dir / "rec/poses.tum", "5.1 0 0 0 0 0 0 1\n" + second_pose);
    std::vector<std::string> args = {"--only",    "next",    "--method",  "ours",
                                     "--profile", "refined", "--gravity", "0,1,0"};
    args.insert(args.end(), more.begin(), more.end());
    const Ran ran = well(bench_steady(dir / "rec", args));
    auto results = results_of(ran.out);
    EXPECT_EQ(results["recording"].at(0)["poses"], more.empty());
    return results["pair"].at(0)["all"]["planes"].get<int>();
  };
  EXPECT_EQ(compared_planes("5.2 0 0 0 0 0 0 1\n", {}), 2);
  const std::string turned_away = "5.2 0 0 0 0 1 0 0\n";  // by 180 degrees: no overlap
  EXPECT_EQ(compared_planes(turned_away, {}), 0);
  EXPECT_EQ(compared_planes(turned_away, {"--poses", "none"}), 2);
}

TEST(BenchSteady, MeasuresOnlyTheSelectedRows) {
  const auto dir = scratch_with_rec();
  const Ran ran = well(bench_steady(
      dir / "rec", {"--only", "focal,rounded", "--method", "region-growing", "--gravity", "none"}));
  for (const char* part : {"fx x (1 + 1e-7)", "fx, fy x (1 + 1e-6)", "intrinsics to 6 digits"})
    EXPECT_NE(ran.out.find(part), std::string::npos) << part;
  for (const char* part : {"ours", "gravity turned", "dither of", "next frame"})
    EXPECT_EQ(ran.out.find(part), std::string::npos) << part;
}

TEST(BenchSteady, RejectsBadInputInOneLine) {
  const auto dir = scratch_with_rec(2);
  write_text(dir / "poses.tum", "1 0 0 0 0 0 0 1\n");
  const std::string rec = (dir / "rec").string(), out = (dir / "out").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{(dir / "none").string()}, "none"},
      {{rec, "--only", "fokal"}, "'fokal' is not a part"},
      {{rec, "--only", "gravity", "--gravity", "none"}, "--gravity none"},
      {{rec, "--classifier", "truth"}, "--classifier truth"},
      {{rec, "--turns", "0"}, "--turns"},
      {{rec, "--poses", (dir / "poses.tum").string()}, "1 pose; expected 2, one for each frame"},
      {{rec, rec, "--poses", (dir / "poses.tum").string()}, "2 recordings; expected one"},
      {{rec, "--frames", "1", "--only", "next"}, "nothing to measure"}};
  for (const auto& [args, part] : bad) {
    std::vector<std::string> all = {"planescope-lab", "bench", "steady", "-o", out};
    all.insert(all.end(), args.begin(), args.end());
    const Ran ran = run(all);
    expect_refused(ran, part);
    EXPECT_FALSE(fs::exists(out)) << part;
  }
}
