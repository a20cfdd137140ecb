// Tests of planescope segment: output files, frame selection, and identical bytes for any threads.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/bag/message_log.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "support/needs_open3d.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

namespace {

const std::vector<std::string> kLevel = {"--gravity", "0,1,0"};

std::vector<std::string> segment_args(const std::filesystem::path& input,
                                      const std::filesystem::path& out,
                                      const std::vector<std::string>& more = kLevel) {
  std::vector<std::string> args = {"segment", input, "-o", out};
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

Json planes_of(const std::filesystem::path& out, const std::string& frame = "000000") {
  return Json::parse(read_text(out / "frames" / frame / "planes.json"));
}

}  // namespace

TEST(Segment, EveryFileOfADepthFrameContainsItsPlanes) {
  const auto dir = scratch_with_rec();
  well(run(segment_args(dir / "rec", dir / "out")));
  EXPECT_EQ(files_below(dir / "out"),
            (std::vector<std::string>{"frames/000000/cloud.ply", "frames/000000/planes.json",
                                      "frames/000000/planes.png", "frames/000000/timings.json"}));

  const Json json = planes_of(dir / "out");
  EXPECT_EQ(json["schema"], "planescope.planes/4");
  EXPECT_EQ(json["gravity"]["source"], "option");
  EXPECT_EQ(json["counts"]["pixels"], 160 * 120);
  ASSERT_EQ(json["planes"].size(), 2u);
  std::size_t points = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const Json& plane = json["planes"][k];
    EXPECT_EQ(plane["id"], k + 1);
    points += plane["points"].get<std::size_t>();
    const auto n = plane["normal"].get<std::array<double, 3>>();
    const auto c = plane["centroid"].get<std::array<double, 3>>();
    EXPECT_NEAR(n[0] * c[0] + n[1] * c[1] + n[2] * c[2], plane["offset_m"].get<double>(), 1e-6);
    if (plane["label"] == "h") {
      EXPECT_NEAR(n[2], 1, 1e-3);
      EXPECT_NEAR(plane["offset_m"].get<double>(), -0.5, 2e-3);
    } else {
      EXPECT_EQ(plane["label"], "v");
      EXPECT_NEAR(n[2], 0, 1e-3);
      EXPECT_NEAR(std::abs(plane["offset_m"].get<double>()), 1.2, 2e-3);
    }
    for (const Json& corner : plane["hull"]) {
      const auto h = corner.get<std::array<double, 3>>();
      EXPECT_NEAR(n[0] * h[0] + n[1] * h[1] + n[2] * h[2], plane["offset_m"].get<double>(), 1e-6);
    }
  }

  // Picture and cloud contain the same planes: pixels in raster order.
  const Image16 image = io::read_png_16(dir / "out/frames/000000/planes.png");
  const PointSet cloud = io::read_cloud_file(dir / "out/frames/000000/cloud.ply");
  ASSERT_EQ(image.width, 160);
  ASSERT_EQ(image.height, 120);
  ASSERT_EQ(cloud.instance.size(), image.data.size());
  std::size_t in_plane = 0;
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    EXPECT_EQ(cloud.instance[i], image.data[i]);
    in_plane += image.data[i] > 0;
  }
  EXPECT_EQ(in_plane, points);
}

TEST(Segment, ResultsAreTheSameBytesForAnyNumberOfThreads) {
  const auto dir = scratch_with_rec();
  io::write_ply(dir / "cloud.ply", floor_and_wall_cloud());
  for (const char* threads : {"1", "2", "8"}) {
    const auto out = dir / threads;
    well(run(segment_args(dir / "rec", out / "rec", {"--gravity", "0,1,0", "--threads", threads})));
    well(run(segment_args(dir / "cloud.ply", out / "cloud", {"--threads", threads})));
  }
  for (const char* file : {"rec/frames/000000/planes.json", "rec/frames/000000/cloud.ply",
                           "rec/frames/000000/planes.png", "cloud/frames/000000/planes.json",
                           "cloud/frames/000000/cloud.ply"}) {
    const std::string one = read_text(dir / "1" / file);
    EXPECT_FALSE(one.empty()) << file;
    EXPECT_TRUE(one == read_text(dir / "2" / file)) << file;
    EXPECT_TRUE(one == read_text(dir / "8" / file)) << file;
  }
}

TEST(Segment, SaturatedCountsAreDroppedAndCounted) {
  const auto dir = scratch();
  Image16 depth = floor_and_wall();
  for (int i = 0; i < 7; ++i) depth.data[1000 + i] = 65535;
  for (int i = 0; i < 5; ++i) depth.data[3000 + i] = 0;
  write_depth_folder(dir / "rec", depth);
  well(run(segment_args(dir / "rec", dir / "out")));
  const Json counts = planes_of(dir / "out")["counts"];
  EXPECT_EQ(counts["invalid"], 7);
  EXPECT_EQ(counts["no_measurement"], 5);
  EXPECT_EQ(io::read_cloud_file(dir / "out/frames/000000/cloud.ply").points.size(),
            160 * 120 - 12u);
}

TEST(Segment, ACloudKeepsTheOrderOfItsPoints) {
  const auto dir = scratch();
  PointSet set = floor_and_wall_cloud();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  set.points[17] = Vec3f(kNan, 0, 0);
  set.points[18] = Vec3f(0, std::numeric_limits<float>::infinity(), 0);
  set.points[19] = Vec3f::Zero();
  io::write_ply(dir / "cloud.ply", set);
  well(run(segment_args(dir / "cloud.ply", dir / "out", {})));
  EXPECT_EQ(files_below(dir / "out"),
            (std::vector<std::string>{"frames/000000/cloud.ply", "frames/000000/planes.json",
                                      "frames/000000/timings.json"}));
  const Json json = planes_of(dir / "out");
  EXPECT_EQ(json["counts"]["invalid"], 2);
  EXPECT_EQ(json["counts"]["no_measurement"], 1);
  EXPECT_EQ(json["gravity"]["source"], "assumed");
  const PointSet written = io::read_cloud_file(dir / "out/frames/000000/cloud.ply");
  ASSERT_EQ(written.points.size(), set.points.size());
  for (std::size_t i = 0; i < written.points.size(); ++i) {
    if (i >= 17 && i <= 19) {
      EXPECT_EQ(written.instance[i], 0);
      EXPECT_EQ(written.label[i], 0);
      continue;
    }
    EXPECT_LT((written.points[i] - set.points[i]).norm(), 1e-5) << i;
  }
}

TEST(Segment, CroppedPointsStayInTheCloudWithoutAPlane) {
  const auto dir = scratch_with_rec();
  const Ran ran = well(
      run(segment_args(dir / "rec", dir / "out", {"--gravity", "0,1,0", "--max-range", "1.1"})));
  EXPECT_TRUE(has(ran.out, "--max-range"));
  const Json counts = planes_of(dir / "out")["counts"];
  EXPECT_GT(counts["beyond_range"].get<int>(), 1000);
  const PointSet cloud = io::read_cloud_file(dir / "out/frames/000000/cloud.ply");
  ASSERT_EQ(cloud.points.size(), 160u * 120u);
  int outside = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (i / 160 > 60 && cloud.points[i].z() < -0.45) continue;  // near floor
    if (cloud.label[i] == 0) {
      EXPECT_EQ(cloud.instance[i], 0);
      ++outside;
    }
  }
  EXPECT_GT(outside, 1000);
}

TEST(Segment, FramesAreSelectedByPythonSlices) {
  const auto dir = scratch_with_rec(6);
  const std::vector<std::pair<std::string, std::vector<int>>> cases = {
      {"1:4:2", {1, 3}}, {"-2:", {4, 5}}, {"3", {3}}, {"-1", {5}}, {":1", {0}}, {"::5", {0, 5}}};
  for (const auto& [slice, expected] : cases) {
    const auto out = dir / ("out" + slice);
    const Ran ran = well(
        run(segment_args(dir / "rec", out, {"--gravity", "0,1,0", "--json", "--frames", slice})));
    EXPECT_EQ(Json::parse(ran.out)["frames"].size(), expected.size());
    for (const int i : expected)
      EXPECT_TRUE(std::filesystem::exists(out / "frames" / ("00000" + std::to_string(i)))) << slice;
  }
  const Ran none = run(segment_args(dir / "rec", dir / "none", {"--frames", "9:"}));
  expect_refused(none);
  EXPECT_FALSE(std::filesystem::exists(dir / "none"));
}

TEST(Segment, FramesOfALongerRunAreRemovedButNotOtherFiles) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  const auto segment = [&](const char* frames) {
    well(run(segment_args(dir / "rec", dir / "out", {"--also", "csv", "--frames", frames})));
  };
  segment(":");
  write_text(dir / "out/frames/000001/notes.txt", "kept");
  segment("0");
  EXPECT_TRUE(std::filesystem::exists(dir / "out/frames/000000/planes.json"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out/frames/000001/planes.json"));
  EXPECT_TRUE(std::filesystem::exists(dir / "out/frames/000001/notes.txt"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out/frames/000002"));
}

TEST(Segment, AFrameWithoutDepthIsReportedAndSkipped) {
  const auto dir = scratch();
  const Image16 good = floor_and_wall();
  write_depth_folder(dir / "rec", good, 2);
  Image16 blind(good.width, good.height);  // nothing was measured
  io::write_png(dir / "rec/depth/000001.png", blind);
  const Ran ran = well(run(segment_args(dir / "rec", dir / "out", {"--json"})));
  const Json json = Json::parse(ran.out);
  EXPECT_EQ(json["frames"].size(), 1u);
  ASSERT_EQ(json["refused"].size(), 1u);
  EXPECT_TRUE(has(json["refused"][0].get<std::string>(), "contains no depth"));
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_EQ(files_below(dir / "out").size(), 4u);

  expect_refused(run(segment_args(dir / "rec", dir / "none", {"--frames", "1"})));
  EXPECT_FALSE(std::filesystem::exists(dir / "none"));
}

TEST(Segment, ASecondRunReplacesOnlyItsFrames) {
  const auto dir = scratch_with_rec();
  std::filesystem::create_directories(dir / "out");
  write_text(dir / "out/notes.txt", "mine");
  well(run(segment_args(dir / "rec", dir / "out")));
  const std::string first = read_text(dir / "out/frames/000000/planes.json");
  well(run(segment_args(dir / "rec", dir / "out")));
  EXPECT_EQ(read_text(dir / "out/frames/000000/planes.json"), first);
  EXPECT_EQ(files_below(dir / "out").size(), 5u);
}

TEST(Segment, ARivalNeedsNoClassifierAndIsRecorded) {
  PLANESCOPE_NEEDS_OPEN3D();
  const auto dir = scratch_with_rec();
  const auto args = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> all = {"--gravity", "0,1,0", "--method", "ransac"};
    all.insert(all.end(), more.begin(), more.end());
    return segment_args(dir / "rec", dir / out, all);
  };
  // Neither weights nor truth exist: a rival does not need them.
  well(run(args("a", {"--set", "classifier=none.safetensors"})));
  well(run(args("b", {"--classifier", "truth", "--threads", "1"})));
  const Json json = planes_of(dir / "a");
  ASSERT_EQ(json["planes"].size(), 2u);
  EXPECT_EQ(json["options"]["method"], "ransac");
  EXPECT_EQ(json["options"]["ransac_theta_pf_m"], 0.01);
  EXPECT_FALSE(json["options"].contains("theta_n_in")) << "what is not its own is left out";
  EXPECT_FALSE(json["options"].contains("region_patch_px"));
  EXPECT_FALSE(json["counts"].contains("nodes_visited"));
  std::set<std::string> labels;
  for (const Json& plane : json["planes"]) labels.insert(plane["label"]);
  EXPECT_EQ(labels, (std::set<std::string>{"h", "v"}));
  EXPECT_EQ(read_text(dir / "a/frames/000000/planes.json"),
            read_text(dir / "b/frames/000000/planes.json"));
  EXPECT_EQ(read_text(dir / "a/frames/000000/cloud.ply"),
            read_text(dir / "b/frames/000000/cloud.ply"));
}

TEST(Segment, ReportsCertaintyAndFootholdsOfEachPlane) {
  const auto dir = scratch_with_rec();
  well(run(segment_args(dir / "rec", dir / "bare")));
  const Json bare = planes_of(dir / "bare");
  for (const Json& plane : bare["planes"]) {
    EXPECT_GT(plane["outline_area_m2"].get<double>(), 0.1);
    EXPECT_GE(plane["certainty"]["offset_sigma_m"].get<double>(), 0) << "0: a wall without noise";
    EXPECT_EQ(plane["certainty"]["covariance"].size(), 3u);
    EXPECT_GT(plane["surface"]["clearance_m"].get<double>(), 0.05);
    EXPECT_FALSE(plane.contains("foot"));
  }
  const Ran ran = well(
      run(segment_args(dir / "rec", dir / "foot", {"--gravity", "0,1,0", "--foot", "0.08x0.06"})));
  EXPECT_TRUE(has(ran.out, "steppable: 1 of 2 planes, "));
  const Json json = planes_of(dir / "foot");
  EXPECT_EQ(json["options"]["foot_radius_m"], 0.05) << "half of its diagonal: any yaw is allowed";
  for (const Json& plane : json["planes"]) {
    const Json& foot = plane["foot"];
    EXPECT_EQ(foot["steppable"], plane["label"] == "h") << foot["why_not"];
    EXPECT_GT(foot["area_m2"].get<double>(), 0);
    EXPECT_LT(foot["area_m2"], plane["outline_area_m2"]);
    EXPECT_GE(foot["pieces"].size(), 1u);
  }
}

TEST(Segment, RejectsAnInvalidFoot) {
  const auto dir = scratch_with_rec();
  for (const char* foot : {"0", "-1", "0.1x", "0.1x0.2x0.3", "wide", "nan"}) {
    const Ran ran = run(segment_args(dir / "rec", dir / "out", {"--foot", foot}));
    EXPECT_EQ(ran.code, 2) << foot;
    EXPECT_TRUE(has(ran.err, "--foot"));
  }
}

TEST(Segment, WritesPlanesForOtherTools) {
  const auto dir = scratch_with_rec();
  well(run(segment_args(dir / "rec", dir / "out",
                        {"--gravity", "0,1,0", "--foot", "0.05", "--also",
                         "geojson,obj,ply,planar-terrain,csv,svg"})));
  const auto frame = dir / "out/frames/000000";
  const Json planes = planes_of(dir / "out")["planes"];

  const Json geojson = Json::parse(read_text(frame / "planes.geojson"));
  EXPECT_EQ(geojson["type"], "FeatureCollection");
  ASSERT_EQ(geojson["features"].size(), 2 * planes.size()) << "an outline and a foot's space each";
  for (const Json& feature : geojson["features"])
    for (const Json& polygon : feature["geometry"]["coordinates"])
      for (const Json& ring : polygon) EXPECT_EQ(ring.front(), ring.back());

  const Json terrain = Json::parse(read_text(frame / "planar_terrain.json"));
  ASSERT_EQ(terrain["planarRegions"].size(), planes.size());
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const Json& region = terrain["planarRegions"][k];
    // The pose rotates (0, 0, 1) to the normal.
    const Json& q = region["plane_parameters"]["orientation"];
    const Eigen::Quaterniond orientation(q["w"].get<double>(), q["x"].get<double>(),
                                         q["y"].get<double>(), q["z"].get<double>());
    const Vec3d normal = orientation * Vec3d::UnitZ();
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(normal[i], planes[k]["normal"][i].get<double>(), 1e-6);
    EXPECT_EQ(region["boundary"]["outer_boundary"]["points"].size(),
              planes[k]["outline"][0]["outer"].size());
    EXPECT_EQ(region["insets"].size(), planes[k]["foot"]["area"].size());
    EXPECT_LT(region["bbox2d"]["min_x"], region["bbox2d"]["max_x"]);
  }

  const std::string csv = read_text(frame / "planes.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + static_cast<int>(planes.size()));
  EXPECT_TRUE(has(read_text(frame / "planes.obj"), "o plane_1_"));
  const std::string svg = read_text(frame / "planes.svg");
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  for (const char* reported : {"slope ", "rough ", "steps ", "support ", "clearance ",
                               "sigma: tilt ", "class=\"band\" d=", "class=\"place\" cx="})
    EXPECT_TRUE(has(svg, reported)) << reported;
  EXPECT_TRUE(read_text(frame / "planes.ply").starts_with("ply\nformat ascii 1.0\n"));

  const Ran wrong = run(segment_args(dir / "rec", dir / "no", {"--also", "shapefile"}));
  EXPECT_NE(wrong.code, 0);
  EXPECT_TRUE(has(wrong.err, "planar-terrain"));
}

TEST(Segment, AnMcapFileContainsTheRecordingAndReplacesNothing) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  well(run(segment_args(dir / "rec", dir / "planes.mcap")));
  const auto before = io::open_recording(dir / "rec");
  const auto after = io::open_recording(dir / "planes.mcap");
  ASSERT_EQ(after->frame_count(), 2);
  EXPECT_EQ(after->frame_hash(1), before->frame_hash(1));
  EXPECT_EQ(after->frame(1).intrinsics, before->frame(1).intrinsics);
  EXPECT_NEAR(after->timestamp_s(1), 1. / 30, 1e-9) << "frames without times come at 30 Hz";

  const std::string bytes = read_text(dir / "planes.mcap");
  const auto refused = [&](const std::filesystem::path& out, const std::string& why) {
    expect_refused(run(segment_args(dir / "rec", out)), why);
  };
  refused(dir / "planes.mcap", "planes.mcap: already exists; expected a new name");
  expect_refused(run(segment_args(dir / "planes.mcap", dir / "planes.mcap")), "is the recording");
  EXPECT_EQ(read_text(dir / "planes.mcap"), bytes);
  refused(dir / "rec/planes.mcap", "is in the recording");
  expect_refused(
      run(segment_args(dir / "rec", dir / "x.mcap", {"--gravity", "0,1,0", "--also", "csv"})),
      "--also writes into the folder of -o DIR, but -o is a .mcap file");
  expect_refused(run({"map", dir / "rec", "-o", dir / "x.mcap", "--window", "2"}),
                 "-o FILE.mcap cannot be combined with");
  EXPECT_EQ(files_below(dir / "rec").size(), before->frame_count() + 1u);
  EXPECT_FALSE(std::filesystem::exists(dir / "x.mcap"));
}

TEST(Segment, AnMcapFileHasDepthInMetersUnlessTheUnitIsOneMillimeter) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  well(run(segment_args(dir / "rec", dir / "planes.mcap",
                        {"--gravity", "0,1,0", "--depth-unit", "0.0002"})));
  const auto log = io::open_message_log(dir / "planes.mcap");
  const io::Message message = log->read(log->messages("/camera/depth/image_rect_raw").front());
  const std::string image(reinterpret_cast<const char*>(message.bytes.data()), 100);
  EXPECT_TRUE(has(image, "32FC1"));
}
