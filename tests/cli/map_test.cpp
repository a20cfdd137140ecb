// The commands planescope synth sequence and planescope map.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/io/recording.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope {

using namespace testing_cli;

namespace {

namespace fs = std::filesystem;

struct Map : testing::Test {
  const fs::path dir = scratch();
  const fs::path walk = dir / "walk";

  void SetUp() override { write_walk("320x240"); }
  void write_walk(const std::string& size) {
    fs::remove_all(walk);
    well(run({"synth", "sequence", "-o", walk, "--size", size, "--frames", "12", "--depth-only"}));
  }
  Ran map(std::vector<std::string> args) {
    args.insert(args.begin(), {"map", walk, "-o", dir / "out"});
    return run(args);
  }
};

}  // namespace

TEST_F(Map, WritesMapTracksAndPoses) {
  const Ran ran = well(map({}));
  EXPECT_TRUE(has(ran.out, "from 12 frames, poses of the recording"));
  const auto tracks = read_json<nlohmann::json>(dir / "out" / "tracks.json");
  EXPECT_EQ(tracks["frames"].size(), 12u);
  const auto written = read_json<nlohmann::json>(dir / "out" / "map.json");
  EXPECT_EQ(written["schema"], "planescope.map/4");
  EXPECT_EQ(written["poses"]["count"], 12);
  EXPECT_GT(io::read_png_rgb(dir / "out" / "map.png").width, 100);
  EXPECT_FALSE(fs::exists(dir / "out" / "left.jsonl"));
  EXPECT_FALSE(fs::exists(dir / "out" / "pace.json"));
  EXPECT_FALSE(fs::exists(dir / "out" / "mesh.ply"));
  // poses.tum can be used as a trajectory.
  fs::copy_file(dir / "out" / "poses.tum", dir / "poses.tum");
  well(map({"--poses", dir / "poses.tum"}));
  EXPECT_EQ(read_json<nlohmann::json>(dir / "out" / "map.json")["planes"].size(),
            written["planes"].size());
}

TEST_F(Map, WithAWindowKeepsOnlyThePlanesNearTheCamera) {
  const Ran ran = well(map({"--follow", "--window", "3"}));
  const auto pace = read_json<nlohmann::json>(dir / "out" / "pace.json");
  EXPECT_EQ(pace["schema"], "planescope.pace/1");
  EXPECT_EQ(pace["frames"], 12);
  EXPECT_GE(pace["taken"], 1);
  EXPECT_TRUE(has(ran.out, " of 12 frames at 15.0 Hz"));
  // Planes behind the camera at the end have left the map, with their areas.
  std::ifstream left(dir / "out" / "left.jsonl");
  std::string line;
  ASSERT_TRUE(std::getline(left, line));
  const auto piece = nlohmann::json::parse(line);
  EXPECT_GE(piece["track"], 1);
  EXPECT_FALSE(piece["outline"].empty());

  // A later map replaces all files of the earlier one, and no others.
  write_file_text(dir / "out" / "planes" / "notes.png", "mine");
  well(map({"--frames", ":6"}));
  EXPECT_FALSE(fs::exists(dir / "out" / "pace.json"));
  EXPECT_FALSE(fs::exists(dir / "out" / "left.jsonl"));
  EXPECT_FALSE(fs::exists(dir / "out" / "planes" / "000011.png"));
  EXPECT_TRUE(fs::exists(dir / "out" / "planes" / "000005.png"));
  EXPECT_TRUE(fs::exists(dir / "out" / "planes" / "notes.png"));
}

TEST_F(Map, OfAMethodWithoutCandidatesFollowsTheCameraToo) {
  well(map({"--follow", "--profile", "paper"}));
  EXPECT_EQ(read_json<nlohmann::json>(dir / "out" / "pace.json")["frames"], 12);
}

TEST_F(Map, SkipsDamagedMissingAndUnorderedFrames) {
  write_file_text(walk / "depth" / "000004.png", "no PNG");
  fs::remove(walk / "depth" / "000009.png");
  auto sidecar = read_json<nlohmann::ordered_json>(walk / "planescope.json");
  std::swap(sidecar["frames"][6]["timestamp_s"], sidecar["frames"][7]["timestamp_s"]);
  write_file_text(walk / "planescope.json", sidecar.dump());
  const Ran ran = map({});
  EXPECT_EQ(ran.code, 2) << ran.err;
  EXPECT_TRUE(has(ran.err, "frame 4: "));
  EXPECT_TRUE(has(
      ran.err, "1 of the 12 frames in planescope.json have no depth image; the first is 000009"));
  EXPECT_TRUE(has(ran.err, "timestamps decrease at frame 7"));
  const auto tracks = read_json<nlohmann::json>(dir / "out" / "tracks.json");
  ASSERT_EQ(tracks["frames"].size(), 11u);
  EXPECT_TRUE(tracks["frames"][4]["track_of_plane"].empty());
  EXPECT_FALSE(tracks["frames"][5]["track_of_plane"].empty());
  const auto written = read_json<nlohmann::json>(dir / "out" / "map.json");
  EXPECT_EQ(written["told"].size(), 2u);
  EXPECT_FALSE(written["planes"].empty());
}

TEST_F(Map, HasAMeshOfItsSurfaces) {
  const Ran ran = map({"--mesh", "0.03"});
  if (ran.err.find("built without Open3D") != std::string::npos) GTEST_SKIP() << ran.err;
  ASSERT_EQ(ran.code, 0) << ran.err;
  const PointSet mesh = io::read_cloud_file(dir / "out" / "mesh.ply");
  ASSERT_GT(mesh.points.size(), 1000u);
  // In the map's world, the floor is at 0.
  const auto on_floor =
      std::ranges::count_if(mesh.points, [](const Vec3f& p) { return std::abs(p.z()) < 0.03F; });
  EXPECT_GT(on_floor, std::ssize(mesh.points) / 10);
}

TEST_F(Map, OfShardsEqualsTheMapOfOneRun) {
  well(map({}));
  const std::string parts = (dir / "parts").string();
  for (const char* shard : {"1/3", "2/3", "3/3"})
    well(run({"map", walk, "-o", parts, "--shard", shard}));
  const std::string joined = (dir / "joined").string();
  well(run({"map", walk, "-o", joined, "--join", parts}));
  for (const char* file : {"map.json", "tracks.json", "poses.tum", "map.png"})
    EXPECT_EQ(read_file_bytes(fs::path(joined) / file), read_file_bytes(dir / "out" / file))
        << file;
  // Parts with other options, damaged parts, and missing parts.
  const auto refusal = [&](std::vector<std::string> more) {
    std::vector<std::string> args = {"map", walk, "-o", joined, "--join", parts};
    args.insert(args.end(), more.begin(), more.end());
    return run(args);
  };
  std::string refusals;
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--max-range", "2"}, {"--depth-unit", "0.0005"}})
    refusals += refusal(other).err;
  for (const char* what :
       {"different options: max_range_m is 1.5; expected 2", "different options: camera is 320x240",
        "unit 0.001 m; expected 320x240"})
    EXPECT_TRUE(has(refusals, what)) << what << " in " << refusals;
  expect_refused(refusal({"--window", "3"}), "--join cannot be combined with");
  const fs::path part = fs::path(parts) / "observed" / "000007.cbor";
  const std::vector<unsigned char> whole = read_file_bytes(part);
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 7) {
    std::vector<unsigned char> damaged = whole;
    damaged[at] ^= 1;
    write_file_bytes(part, damaged);
    expect_refused(refusal({}), "000007.cbor: damaged");
  }
  write_file_text(part, "damaged");
  expect_refused(refusal({}), "000007.cbor: damaged");
  const std::string deep(2'000'000, '\x81');  // lists in lists
  write_file_text(part, deep + sha256_hex(deep));
  expect_refused(refusal({}), "000007.cbor: damaged");
  fs::copy_file(part.parent_path() / "000008.cbor", part, fs::copy_options::overwrite_existing);
  expect_refused(refusal({}), "000007.cbor: contains frame 8; expected frame 7");
  fs::remove(part);
  expect_refused(refusal({}), "000007.cbor: is missing");
}

TEST_F(Map, OfShardsReportsUnreadableFrames) {
  write_file_text(walk / "depth" / "000004.png", "no PNG");
  const std::string parts = (dir / "parts").string();
  for (const char* shard : {"1/2", "2/2"}) {
    const Ran ran = run({"map", walk, "-o", parts, "--shard", shard});
    EXPECT_EQ(ran.code, shard[0] == '1' ? 2 : 0) << shard << ran.err;
    EXPECT_EQ(ran.err.find("frame 4: ") != std::string::npos, shard[0] == '1') << ran.err;
  }
  const Ran joined = map({"--join", parts});
  EXPECT_EQ(joined.code, 2);
  EXPECT_TRUE(has(joined.err, "frame 4: "));
  EXPECT_TRUE(fs::exists(dir / "out" / "map.json"));
}

TEST_F(Map, OfEveryMethodProvidesPlanesToSegment) {
  for (const std::vector<std::string>& method : {std::vector<std::string>{"--profile", "paper"},
                                                 {"--method", "ransac"},
                                                 {"--method", "region-growing"},
                                                 {}}) {
    ASSERT_EQ(map(method).code, 0) << testing::PrintToString(method);
    std::vector<std::string> args = {"segment", walk, "-o", dir / "planes", "--map", dir / "out"};
    args.insert(args.end(), method.begin(), method.end());
    const Ran ran = run(args);
    EXPECT_EQ(ran.code, 0) << testing::PrintToString(method) << ran.err;
  }
}

TEST_F(Map, ProvidesTracksToSegment) {
  well(map({"--frames", "0:10"}));
  const std::string known = (dir / "out").string();
  const auto segment = [&](std::vector<std::string> more) {
    std::vector<std::string> args = {"segment", walk, "-o", dir / "planes", "--map", known};
    args.insert(args.end(), more.begin(), more.end());
    return run(args);
  };
  const Ran ran = segment({"--frames", "8:"});
  EXPECT_EQ(ran.code, 2) << "a frame is missing";
  EXPECT_TRUE(has(ran.err, "rejected: frame 10: not in the map "));
  const auto tracks = read_json<nlohmann::json>(dir / "out" / "tracks.json");
  for (const int frame : {8, 9}) {
    const fs::path folder = dir / "planes" / "frames" / fmt::format("{:06}", frame);
    const auto reported = read_json<nlohmann::json>(folder / "planes.json");
    std::vector<int> of_planes;
    for (const auto& plane : reported["planes"]) of_planes.push_back(plane["track"]);
    EXPECT_FALSE(of_planes.empty());
    EXPECT_EQ(nlohmann::json(of_planes), tracks["frames"][frame]["track_of_plane"]);
    const Image16 ids = io::read_png_16(folder / "planes.png"),
                  of_pixel = io::read_png_16(folder / "tracks.png");
    // Segment finds the same planes that the map stored.
    const fs::path stored_file = dir / "out" / "planes" / fmt::format("{:06}.png", frame);
    Image16 stored = io::read_png_16(stored_file);
    for (std::uint16_t& id : stored.data)
      if (id > of_planes.size()) id = 0;  // minor
    EXPECT_EQ(stored.data, ids.data) << frame;
    for (std::size_t i = 0; i < ids.data.size(); ++i)
      EXPECT_EQ(of_pixel.data[i], ids.data[i] > 0 ? of_planes[ids.data[i] - 1] : 0);
  }
  expect_refused(segment({"--max-range", "2"}),
                 "different options: max_range_m is 1.5; expected 2");
  const fs::path other = dir / "other";
  fs::copy(walk, other, fs::copy_options::recursive);
  const Ran refused = run({"segment", other, "-o", dir / "x", "--map", known});
  EXPECT_TRUE(has(refused.err, "belongs to recording \"walk\"; expected \"other\""));
  expect_refused(segment({"--frames", "11"}), "not in the map ");
  const fs::path stored = dir / "out" / "planes";
  fs::copy_file(stored / "000008.png", stored / "000009.png", fs::copy_options::overwrite_existing);
  expect_refused(segment({"--frames", "9"}), "000009.png: does not match ");
  fs::remove(stored / "000009.png");
  expect_refused(segment({"--frames", "9"}), "000009.png: ");
  // Another map in the same folder removes all files of the first.
  well(map({"--frames", "0:3"}));
  EXPECT_TRUE(fs::exists(stored / "000002.png"));
  EXPECT_FALSE(fs::exists(stored / "000008.png"));
  fs::copy_file(dir / "out" / "poses.tum", dir / "out" / "tracks.json",
                fs::copy_options::overwrite_existing);
  expect_refused(segment({}), "tracks.json: does not match ");
  write_file_text(dir / "out" / "tracks.json", "{\"schema\": \"planescope.tracks/1\"}");
  expect_refused(segment({}), "tracks.json: ");
  fs::remove(dir / "out" / "map.json");
  expect_refused(segment({}), "map.json: no such file");
}

TEST_F(Map, ReportsUnusablePoses) {
  well(map({}));
  std::string kitti, millimetres;
  for (int i = 0; i < 12; ++i) {
    kitti += "1 0 0 0 0 1 0 0 0 0 1 0\n";
    millimetres += fmt::format("{} {} 0 0 0 0 0 1\n", i / 15.0, 3000 * i);
  }
  const std::string good = read_text(dir / "out" / "map.json");
  const auto reported = [&](const std::string& poses, int code,
                            const std::vector<std::string>& more) {
    write_file_text(dir / "poses.txt", poses);
    std::vector<std::string> args = {"--poses", dir / "poses.txt"};
    args.insert(args.end(), more.begin(), more.end());
    const Ran ran = map(args);
    EXPECT_EQ(ran.code, code) << ran.err;
    return ran.err + ran.out;
  };
  // A map without planes is an error and replaces nothing.
  const std::string empty = reported(millimetres, 2, {});
  EXPECT_TRUE(has(empty, "may not contain T_world_camera in meters"));
  EXPECT_TRUE(
      has(empty, "not written: no plane was seen in at least 3 frames; the input has 12 frames"));
  EXPECT_EQ(read_text(dir / "out" / "map.json"), good);
  // So is a map that few frames fit: T_camera_world instead of T_world_camera is a common mistake.
  std::string inverse;
  const auto recording = io::open_recording(walk);
  for (int i = 0; i < recording->frame_count(); ++i) {
    const Pose pose = recording->T_world_camera(i)->inverse();
    const Vec3d t = pose.translation();
    const Eigen::Quaterniond q(pose.linear());
    inverse += fmt::format("{} {} {} {} {} {} {} {}\n", recording->timestamp_s(i), t.x(), t.y(),
                           t.z(), q.x(), q.y(), q.z(), q.w());
  }
  EXPECT_TRUE(has(reported(inverse, 2, {}), "not written: "));
  EXPECT_EQ(read_text(dir / "out" / "map.json"), good);
  // Poses of the whole recording also work for a subset of frames.
  EXPECT_TRUE(has(reported(kitti, 2, {"--frames", "3:8"}), "the input has 5 frames"));
}

TEST_F(Map, UsesPoseIForFrameIWithoutTimes) {
  auto sidecar = read_json<nlohmann::ordered_json>(walk / "planescope.json");
  std::string poses;
  std::vector<double> x_of;
  for (std::size_t i = 0; i < sidecar["frames"].size(); ++i) {
    poses += fmt::format("{}", 1000 + 0.125 * static_cast<double>(i));
    x_of.push_back(sidecar["frames"][i]["T_world_camera"][0]);
    for (const double number : sidecar["frames"][i]["T_world_camera"])
      poses += fmt::format(" {}", number);
    poses += "\r\n";
  }
  sidecar.erase("frames");
  write_file_text(walk / "planescope.json", sidecar.dump());
  const std::string file = (dir / "given.tum").string();
  write_file_text(file, poses);
  const Ran ran = well(map({"--poses", file, "--frames", "::2", "--max-range", "4"}));
  const std::string notice = "frames have no times: pose i in " + file + " is used for frame i";
  EXPECT_TRUE(has(ran.err, notice));
  EXPECT_TRUE(has(ran.out, "from 6 frames"));
  const auto tracks = read_json<nlohmann::json>(dir / "out" / "tracks.json");
  EXPECT_EQ(tracks["frames"][3]["frame"], 6);
  EXPECT_EQ(tracks["frames"][3]["timestamp_s"], 1000.75);
  std::istringstream made(read_text(dir / "out" / "poses.tum"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(made, line);)
    if (!line.starts_with('#')) lines.push_back(line);
  ASSERT_EQ(lines.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i)  // time and x
    EXPECT_TRUE(lines[i].starts_with(
        fmt::format("{} {} ", 1000 + 0.25 * static_cast<double>(i), x_of[2 * i])))
        << lines[i];
  // Shards divide the selected frames.
  const std::string parts = (dir / "parts").string();
  for (const char* shard : {"1/2", "2/2"}) {
    const Ran part = well(run({"map", walk, "-o", parts, "--poses", file, "--frames", "::2",
                               "--max-range", "4", "--shard", shard}));
    EXPECT_TRUE(has(part.out, "3 frames of shard"));
    EXPECT_TRUE(has(part.err, notice));
  }
  const auto whole = read_file_bytes(dir / "out" / "tracks.json");
  well(map({"--poses", file, "--frames", "::2", "--max-range", "4", "--join", parts}));
  EXPECT_EQ(read_file_bytes(dir / "out" / "tracks.json"), whole);
  // In the folder's poses.tum, the first column can only be times.
  fs::copy_file(file, walk / "poses.tum");
  const Ran info = run({"info", walk});
  EXPECT_TRUE(has(info.out, "8.00 frames per second, no gaps, from poses.tum"));
  EXPECT_TRUE(has(map({"--follow"}).err, "has no poses"));
}

TEST_F(Map, DoesNotReplaceTheUsersFiles) {
  const auto refusal = [&](const fs::path& out) { return run({"map", walk, "-o", out}); };
  expect_refused(refusal(walk), "walk: is the recording");
  fs::create_directories(dir / "mine");
  write_file_text(dir / "mine" / "poses.tum", "measured by hand");
  expect_refused(refusal(dir / "mine"),
                 "mine/poses.tum: already exists, but is not part of an earlier map");
  EXPECT_EQ(read_text(dir / "mine" / "poses.tum"), "measured by hand");
  for (const char* name : {"mesh.ply", "left.jsonl"}) {
    fs::rename(dir / "mine" / "poses.tum", dir / "poses.tum");
    write_file_text(dir / "mine" / name, "scanned by hand");
    expect_refused(refusal(dir / "mine"), std::string(name) + ": already exists");
    EXPECT_EQ(read_text(dir / "mine" / name), "scanned by hand");
    fs::remove(dir / "mine" / name);
    fs::rename(dir / "poses.tum", dir / "mine" / "poses.tum");
  }
  fs::create_directories(dir / "other" / "tracks.json");
  write_file_text(dir / "other" / "tracks.json" / "note.txt", "mine");
  expect_refused(refusal(dir / "other"), "tracks.json: already exists, but is not");
  EXPECT_EQ(read_text(dir / "other" / "tracks.json" / "note.txt"), "mine");
  EXPECT_FALSE(fs::exists(dir / "other" / "map.json")) << "all or nothing";
}

TEST_F(Map, ThatFailsKeepsThePreviousOne) {
  well(map({"--window", "3"}));
  const auto left = read_file_bytes(dir / "out" / "left.jsonl");
  write_file_text(dir / "out" / "mesh.ply", "of before");
  ASSERT_EQ(map({"--poses", dir / "none.tum"}).code, 2);
  EXPECT_EQ(read_file_bytes(dir / "out" / "left.jsonl"), left);
  EXPECT_TRUE(fs::exists(dir / "out" / "mesh.ply"));
  // A complete map replaces it.
  well(map({}));
  EXPECT_FALSE(fs::exists(dir / "out" / "left.jsonl"));
  EXPECT_FALSE(fs::exists(dir / "out" / "mesh.ply"));
}

TEST_F(Map, WithItsOwnGravityProvidesTheSamePlanesToSegment) {
  const std::vector<std::string> gravity = {"--gravity", "0,0.85,0.53"};
  well(map(gravity));
  const Ran ran = well(run(
      {"segment", walk, "-o", dir / "planes", "--map", dir / "out", "--gravity", "0,0.85,0.53"}));
  EXPECT_FALSE(has(ran.err, "rejected"));
}

TEST_F(Map, OfAReportShowsTracksOfEachFrame) {
  const fs::path report = dir / "report";
  const auto run_report = [&](std::vector<std::string> more) {
    std::vector<std::string> args = {"report", walk, "-o", report, "--tracks", "--no-pictures"};
    args.insert(args.end(), more.begin(), more.end());
    return run(args);
  };
  well(run_report({}));
  const auto json = read_json<nlohmann::json>(report / "report.json");
  int breaks = 0;
  for (const auto& frame : json["recordings"][0]["frames"]) {
    ASSERT_TRUE(frame.contains("track_breaks")) << frame["index"];
    breaks += frame["track_breaks"].get<int>();
  }
  // Rules apply to them, over the recording.
  const std::string rule =
      R"({"schema": "planescope.rules/1", "rules": [{"metric": "track_breaks", "scope": "recording", "at_most": )";
  write_file_text(dir / "rules.json", rule + std::to_string(breaks) + "}]}");
  well(run_report({"--rules", dir / "rules.json"}));
  write_file_text(dir / "rules.json", rule + std::to_string(breaks - 1) + "}]}");
  EXPECT_EQ(run_report({"--rules", dir / "rules.json"}).code, 1);
  // Comparison with an identical baseline.
  fs::copy_file(report / "report.json", dir / "baseline.json");
  write_file_text(
      dir / "rules.json",
      R"({"schema": "planescope.rules/1", "rules": [{"metric": "track_breaks_change", "at_most": 0}]})");
  const Ran again =
      well(run_report({"--rules", dir / "rules.json", "--baseline", dir / "baseline.json"}));
  EXPECT_FALSE(has(again.err, "rule not applied"));
  const Ran shard = run_report({"--shard", "1/2"});
  EXPECT_EQ(shard.code, 2);
  EXPECT_TRUE(has(shard.err, "--tracks needs all frames"));
}

TEST_F(Map, PosesAreConvertedWithTheRecording) {
  const fs::path copy = dir / "copy";
  well(run({"convert", walk, "-o", copy}));
  const auto before = io::open_recording(walk), after = io::open_recording(copy);
  for (int i = 0; i < before->frame_count(); ++i) {
    ASSERT_TRUE(after->T_world_camera(i));
    EXPECT_TRUE(after->T_world_camera(i)->isApprox(*before->T_world_camera(i), 1e-12));
  }
}

TEST_F(Map, UnmappableInputIsRejectedInOneLine) {
  write_file_text(dir / "bad.tum", "0 0 0 0 0 0 0 1\n1 2\n");
  expect_refused(map({"--poses", dir / "bad.tum"}), "bad.tum, line 2");
  write_file_text(dir / "later.tum", "9000 0 0 0 0 0 0 1\n");
  expect_refused(map({"--poses", dir / "later.tum"}), "no pose is close in time to a frame");
  write_file_text(dir / "ms.tum", "0 0 0 0 0 0 0 1\n1000 0 0 0 0 0 0 1\n");
  expect_refused(map({"--poses", dir / "ms.tum"}),
                 "ms.tum: the pose at 0 s is the nearest one to both frame 0 and frame 1");
  write_file_text(dir / "far.tum", "0 0 0 0 0 0 0 1\n0.1 1e9 0 0 0 0 0 1\n");
  expect_refused(map({"--poses", dir / "far.tum"}), "far.tum, line 2: the pose is 1e+09");
  expect_refused(map({"--window", "-1"}), "--window");
  expect_refused(map({"--window", "0.01"}),
                 "--window: 0.01 is out of range; expected 0 (no limit) or at least 0.5");
  expect_refused(map({"--classifier", "truth"}), "--classifier truth");
  EXPECT_FALSE(fs::exists(dir / "out"));
  fs::copy_file(walk / "planescope.json", dir / "sidecar.json");
  std::string sidecar;
  for (const unsigned char c : read_file_bytes(walk / "planescope.json"))
    sidecar += static_cast<char>(c);
  sidecar.replace(sidecar.find("\"T_world_camera\": ["), 19, "\"T_world_camera\": [7,");
  write_file_text(walk / "planescope.json", sidecar);
  expect_refused(map({}), ".T_world_camera is ");
  auto leap = read_json<nlohmann::ordered_json>(dir / "sidecar.json");
  leap["frames"][5]["T_world_camera"][0] = 1e9;
  write_file_text(walk / "planescope.json", leap.dump());
  expect_refused(map({}), "walk: the pose of frame 5 is 1e+09 m from");
  const fs::path cloudy = fs::path(PLANESCOPE_SOURCE_DIR) / "assets" / "sample";
  expect_refused(run({"map", cloudy, "-o", dir / "out", "--follow"}), "has no poses");
}

}  // namespace planescope
