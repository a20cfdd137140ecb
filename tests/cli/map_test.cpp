// planescope synth sequence and planescope map, as they are typed.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/io/recording.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "program.hpp"
#include "scene_files.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;

struct Map : testing::Test {
  const fs::path dir = scratch();
  const fs::path walk = dir / "walk";

  void SetUp() override {
    const Ran ran = run({"synth", "sequence", "-o", walk.string(), "--size", "80x60", "--frames",
                         "12", "--depth-only"});
    ASSERT_EQ(ran.code, 0) << ran.err;
  }
  Ran map(std::vector<std::string> args) {
    args.insert(args.begin(), {"map", walk.string(), "-o", (dir / "out").string()});
    return run(args);
  }
};

}  // namespace

TEST_F(Map, WritesMapTracksAndPoses) {
  const Ran ran = map({});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("from 12 frames, poses of the recording"), std::string::npos) << ran.out;
  const auto tracks = read_json<nlohmann::json>(dir / "out" / "tracks.json");
  EXPECT_EQ(tracks["frames"].size(), 12u);
  const auto written = read_json<nlohmann::json>(dir / "out" / "map.json");
  EXPECT_EQ(written["schema"], "planescope.map/1");
  EXPECT_EQ(written["poses"]["count"], 12);
  // poses.tum is a trajectory like any other, and gives the same map.
  fs::copy_file(dir / "out" / "poses.tum", dir / "poses.tum");
  ASSERT_EQ(map({"--poses", (dir / "poses.tum").string()}).code, 0);
  EXPECT_EQ(read_json<nlohmann::json>(dir / "out" / "map.json")["planes"], written["planes"]);
}

TEST_F(Map, PosesOfARecordingComeAlongWhenItIsConverted) {
  const fs::path copy = dir / "copy";
  ASSERT_EQ(run({"convert", walk.string(), "-o", copy.string()}).code, 0);
  const auto before = io::open_recording(walk), after = io::open_recording(copy);
  for (int i = 0; i < before->frame_count(); ++i) {
    ASSERT_TRUE(after->T_world_camera(i));
    EXPECT_TRUE(after->T_world_camera(i)->isApprox(*before->T_world_camera(i), 1e-12));
  }
}

TEST_F(Map, WhatCannotBeMappedIsRefusedInOneLine) {
  const auto expect_refused = [](const Ran& ran, const std::string& told) {
    EXPECT_EQ(ran.code, 2) << ran.out;
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_NE(ran.err.find(told), std::string::npos) << ran.err;
  };
  write_file_text(dir / "bad.tum", "0 0 0 0 0 0 0 1\n1 2\n");
  expect_refused(map({"--poses", (dir / "bad.tum").string()}), "bad.tum, line 2");
  write_file_text(dir / "later.tum", "9000 0 0 0 0 0 0 1\n");
  expect_refused(map({"--poses", (dir / "later.tum").string()}), "no pose is of any of the frames");
  expect_refused(map({"--classifier", "truth"}), "--classifier truth");
  EXPECT_FALSE(fs::exists(dir / "out"));
  std::string sidecar;
  for (const unsigned char c : read_file_bytes(walk / "planescope.json"))
    sidecar += static_cast<char>(c);
  sidecar.replace(sidecar.find("\"T_world_camera\": ["), 19, "\"T_world_camera\": [7,");
  write_file_text(walk / "planescope.json", sidecar);
  expect_refused(map({}), "\"T_world_camera\" is not usable");
}

}  // namespace planescope
