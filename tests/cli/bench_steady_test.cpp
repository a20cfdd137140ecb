// planescope-lab bench steady, on a small recording.

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
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

const Json& row_of(const Json& json, const std::string& change, const std::string& method) {
  for (const Json& row : json["rows"])
    if (row["change"] == change && row["method"] == method) return row;
  throw std::runtime_error("no row " + change + ", " + method);
}

}  // namespace

TEST(BenchSteady, AStillCameraBeforeAFloorAndAWallKeepsBoth) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  const Ran ran =
      bench_steady(dir / "rec", {"--gravity", "0,1,0", "--max-range", "4", "--frames", ":",
                                 "--turns", "2", "-o", (dir / "out").string(), "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(files_below(dir / "out"), (std::vector<std::string>{"steady.json", "steady.md"}));
  EXPECT_EQ(ran.out, read_text(dir / "out/steady.json"));
  EXPECT_EQ(ran.out.find(dir.string()), std::string::npos) << "no folders of this machine";
  const Json json = Json::parse(ran.out);
  EXPECT_EQ(json["command"],
            "planescope-lab bench steady rec --turns 2 --frames : --gravity 0,1,0 --max-range 4");
  for (const char* method : {"ours refined", "region-growing"}) {
    const Json& next = row_of(json, "next frame", method);
    EXPECT_EQ(next["n"], 2) << "the last frame has no next one";
    EXPECT_EQ(next["self_pq"]["mean"], 1.0) << method;
    EXPECT_EQ(next["lost_percent"]["mean"], 0.0) << method;
    EXPECT_EQ(next["big_lost_percent"]["mean"], 0.0) << method;
    EXPECT_EQ(next["undecided_big_percent"]["mean"], 0.0) << method;
  }
  const Json& turned = row_of(json, "gravity turned", "ours refined");
  EXPECT_EQ(turned["n"], 3);
  EXPECT_EQ(turned["planes"]["mean"], 2.0);
  EXPECT_EQ(turned["label_changes"]["mean"], 0.0);
  EXPECT_TRUE(turned["label_changes_deg"].is_null()) << "of no change";
  const Json& rounded = row_of(json, "intrinsics to 6 digits", "ours paper");
  EXPECT_EQ(rounded["changed"]["mean"], 0.0) << "they have fewer digits";
  EXPECT_EQ(rounded["report_errors"]["mean"], 0.0);
  EXPECT_EQ(row_of(json, "dither of 5 %", "ours refined")["n"], 3);
  EXPECT_EQ(json["frames"].size(), json["rows"].size());
}

TEST(BenchSteady, ARealPanKeepsItsPlanes) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Ran ran =
      bench_steady(fs::path(data) / "aims_slam_realsense_640x480",
                   {"--only", "gravity,focal,dither", "--turns", "5", "--method", "ours",
                    "--profile", "refined", "--intrinsics", "383.8,383.8,321.7,236.8", "--gravity",
                    "0.168,0.925,0.341", "--max-range", "4", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json json = Json::parse(ran.out);
  for (const char* change :
       {"gravity turned", "fx x (1 + 1e-7)", "fx x (1 + 1e-5)", "fx, fy x (1 + 1e-6)"}) {
    const Json& row = row_of(json, change, "ours refined");
    EXPECT_EQ(row["n"], 5);
    EXPECT_EQ(row["changed"]["mean"], 0.0) << change;
    EXPECT_EQ(row["report_errors"]["mean"], 0.0) << change;
    EXPECT_EQ(row["self_pq"]["mean"], 1.0) << change;
  }
  EXPECT_GE(row_of(json, "dither of 5 %", "ours refined")["self_pq"]["mean"], 0.8);
}

// A hand-held camera that turns fast: what is decided stays from one frame to the next.
TEST(BenchSteady, DecidedPlanesStayInTheNextFrame) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Ran ran = bench_steady(fs::path(data) / "tum_fr1_rpy_kinect_640x480",
                               {"--only", "next", "--method", "ours", "--profile", "refined",
                                "--intrinsics", "591.1,590.1,331,234", "--depth-unit", "0.0002",
                                "--gravity", "none", "--max-range", "4", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json row = row_of(Json::parse(ran.out), "next frame", "ours refined");
  EXPECT_EQ(row["n"], 38);
  EXPECT_GE(row["self_pq"]["mean"], 0.70);
  EXPECT_LE(row["big_lost_percent"]["mean"], 11);
  EXPECT_LE(row["decided_big_lost_percent"]["mean"], 3);
  EXPECT_LE(row["undecided_big_percent"]["mean"], 25);
}

TEST(BenchSteady, IsTheSameForAnyNumberOfThreads) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  for (const char* threads : {"1", "3"}) {
    const Ran ran =
        bench_steady(dir / "rec", {"--frames", "::2", "--gravity", "0,1,0", "--turns", "2",
                                   "--threads", threads, "-o", (dir / threads).string()});
    ASSERT_EQ(ran.code, 0) << ran.err;
  }
  for (const char* file : {"steady.json", "steady.md"})
    EXPECT_EQ(read_text(dir / "1" / file), read_text(dir / "3" / file)) << file;
}

TEST(BenchSteady, PosesMoveTheLabelsToTheNextFrame) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  const auto compared_planes = [&](const std::string& second_pose,
                                   const std::vector<std::string>& more) {
    write_text(dir / "rec/poses.tum", "5.1 0 0 0 0 0 0 1\n" + second_pose);
    std::vector<std::string> args = {"--only",  "next",      "--method", "ours",  "--profile",
                                     "refined", "--gravity", "0,1,0",    "--json"};
    args.insert(args.end(), more.begin(), more.end());
    const Ran ran = bench_steady(dir / "rec", args);
    EXPECT_EQ(ran.code, 0) << ran.err;
    const Json json = Json::parse(ran.out);
    EXPECT_EQ(json["rows"].size(), 1u);
    EXPECT_EQ(json["recordings"][0]["poses"], more.empty());
    return json["rows"][0]["planes"]["mean"].get<double>();
  };
  EXPECT_EQ(compared_planes("5.2 0 0 0 0 0 0 1\n", {}), 2);
  const std::string turned_away = "5.2 0 0 0 0 1 0 0\n";  // by 180 degrees: nothing is in common
  EXPECT_EQ(compared_planes(turned_away, {}), 0);
  EXPECT_EQ(compared_planes(turned_away, {"--poses", "none"}), 2);
}

TEST(BenchSteady, MeasuresOnlyWhatIsAskedFor) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const Ran ran = bench_steady(
      dir / "rec", {"--only", "focal,rounded", "--method", "region-growing", "--gravity", "none"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  for (const char* part : {"fx x (1 + 1e-7)", "fx, fy x (1 + 1e-6)", "intrinsics to 6 digits"})
    EXPECT_NE(ran.out.find(part), std::string::npos) << part;
  for (const char* part : {"ours", "gravity turned", "dither of", "next frame"})
    EXPECT_EQ(ran.out.find(part), std::string::npos) << part;
}

TEST(BenchSteady, RefusesBadInputInOneLine) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  write_text(dir / "poses.tum", "1 0 0 0 0 0 0 1\n");
  const std::string rec = (dir / "rec").string(), out = (dir / "out").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{(dir / "none").string()}, "none"},
      {{rec, "--only", "fokal"}, "'fokal' is not a part"},
      {{rec, "--only", "gravity", "--gravity", "none"}, "--gravity none"},
      {{rec, "--classifier", "truth"}, "--classifier truth"},
      {{rec, "--turns", "0"}, "--turns"},
      {{rec, "--poses", (dir / "poses.tum").string()}, "1 pose; expected 2, one for each frame"},
      {{rec, rec, "--poses", (dir / "poses.tum").string()}, "belongs to one recording"},
      {{rec, "--frames", "1", "--only", "next"}, "nothing to measure"}};
  for (const auto& [args, part] : bad) {
    std::vector<std::string> all = {"planescope-lab", "bench", "steady", "-o", out};
    all.insert(all.end(), args.begin(), args.end());
    const Ran ran = run(all);
    EXPECT_EQ(ran.code, 2) << part;
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_NE(ran.err.find(part), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(out)) << part;
  }
}
