// planescope convert keeps all data in another format.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/recording.hpp"
#include "core/labels/model/grid.hpp"
#include "core/labels/model/label_files.hpp"

namespace planescope {

using namespace testing_cli;

namespace {

namespace fs = std::filesystem;

struct Convert : testing::Test {
  const fs::path dir = scratch();
  const fs::path sample = fs::path(PLANESCOPE_SOURCE_DIR) / "assets" / "sample";

  Ran convert(std::vector<std::string> args) {
    args.insert(args.begin(), "convert");
    return run(args);
  }
};

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.depth.data, b.depth.data);
  EXPECT_EQ(a.depth_unit_m, b.depth_unit_m);
  EXPECT_EQ(a.intrinsics, b.intrinsics);
  EXPECT_EQ(a.timestamp_s, b.timestamp_s);
  EXPECT_EQ(a.color.data, b.color.data);
  EXPECT_EQ(a.color_aligned, b.color_aligned);
  ASSERT_EQ(a.gravity.has_value(), b.gravity.has_value());
  if (a.gravity) {
    EXPECT_EQ(a.gravity->direction, b.gravity->direction);
  }
}

}  // namespace

TEST_F(Convert, AFolderHasTheSameFramesColorsTimesAndLabels) {
  const fs::path out = dir / "out";
  const Ran ran = well(convert({sample, "-o", out}));
  EXPECT_TRUE(has(ran.out, "3 of 3 frames"));
  const auto before = io::open_recording(sample), after = io::open_recording(out);
  ASSERT_EQ(after->frame_count(), before->frame_count());
  for (int i = 0; i < before->frame_count(); ++i) {
    SCOPED_TRACE(i);
    expect_same(before->frame(i), after->frame(i));
    const auto labels =
        labels::read_frame_labels(labels::default_label_dir(out), i, after->frame_hash(i).c_str());
    EXPECT_TRUE(labels);
  }
  const Ran from_sample = run({"segment", sample, "--gravity", "0,0.9,0.4", "-o", dir / "a"});
  const Ran from_out = run({"segment", out, "--gravity", "0,0.9,0.4", "-o", dir / "b"});
  ASSERT_EQ(from_sample.code + from_out.code, 0) << from_out.err;
  EXPECT_EQ(read_text(dir / "a/frames/000001/planes.json"),
            read_text(dir / "b/frames/000001/planes.json"));
}

TEST_F(Convert, OnlyTheSelectedFramesWithTheirLabels) {
  const fs::path out = dir / "out";
  well(convert({sample, "-o", out, "--frames", "2"}));
  const auto before = io::open_recording(sample), after = io::open_recording(out);
  ASSERT_EQ(after->frame_count(), 1);
  EXPECT_EQ(after->frame_hash(0), before->frame_hash(2));
  EXPECT_TRUE(
      labels::read_frame_labels(labels::default_label_dir(out), 0, before->frame_hash(2).c_str()));
}

TEST_F(Convert, TumNamesItsFilesByTime) {
  const fs::path out = dir / "tum";
  well(convert({sample, "-o", out, "--to", "tum"}));
  EXPECT_EQ(read_text(out / "depth.txt"),
            "# timestamp filename\n0.000000 depth/0.000000.png\n1.000000 depth/1.000000.png\n"
            "2.000000 depth/2.000000.png\n");
  const auto before = io::open_recording(sample), after = io::open_recording(out);
  ASSERT_EQ(after->frame_count(), 3);
  for (int i = 0; i < 3; ++i) expect_same(before->frame(i), after->frame(i));
}

TEST_F(Convert, McapHasTheSameFramesColorsTimesLabelsAndPlanes) {
  const fs::path out = dir / "out.mcap";
  const Ran ran = well(convert({sample, "-o", out}));
  EXPECT_TRUE(has(ran.out, "3 of 3 frames"));
  EXPECT_TRUE(has(ran.out, "with labels for 3, read back and bit-identical"));
  const auto before = io::open_recording(sample), after = io::open_recording(out);
  EXPECT_EQ(after->info().format, "realsense-ros ROS 2 bag (MCAP)");
  EXPECT_TRUE(after->info().warnings.empty());
  ASSERT_EQ(after->frame_count(), 3);
  for (int i = 0; i < 3; ++i) expect_same(before->frame(i), after->frame(i));
  expect_refused(convert({sample, "-o", out}), "already exists");
  expect_refused(convert({sample, "-o", dir / "x", "--to", "mcap"}),
                 "expected a name that ends in .mcap");
  // Convert back to a folder: its planes are the same as those of the original.
  well(convert({out, "-o", dir / "back"}));
  for (const char* from : {"out.mcap", "back"})
    well(run({"segment", dir / from, "--gravity", "0,0.9,0.4", "--frames", "1", "-o",
              (dir / (std::string(from) + ".planes")).string()}));
  const auto planes = [&](const char* from) {
    std::string text = read_text(dir / (std::string(from) + ".planes/frames/000001/planes.json"));
    const std::size_t name = text.find("\"name\"");
    // a number in one, a file name in the other
    return text.erase(name, text.find('\n', name) - name);
  };
  EXPECT_EQ(planes("out.mcap"), planes("back"));
}

TEST_F(Convert, CloudsKeepTheirPointsTruthAndPosition) {
  fs::create_directories(dir / "clouds");
  PointSet set = floor_and_wall_cloud();
  set.origin = Vec3d(430'000, 5'400'000, 120);
  io::write_ply(dir / "clouds" / "a.ply", set);
  const fs::path out = dir / "out";
  well(convert({dir / "clouds", "-o", out, "--to", "pcd"}));
  const PointSet before = *io::open_recording(dir / "clouds")->frame(0).cloud;
  const PointSet after = *io::open_recording(out)->frame(0).cloud;
  EXPECT_EQ(after.label, before.label);
  EXPECT_EQ(after.instance, before.instance);
  ASSERT_EQ(after.points.size(), before.points.size());
  for (std::size_t i = 0; i < after.points.size(); i += 97)
    EXPECT_EQ(after.origin + after.points[i].cast<double>(),
              before.origin + before.points[i].cast<double>());
  expect_refused(convert({dir / "clouds", "-o", dir / "no", "--to", "tum"}),
                 "expected output as .ply or .pcd");
}

TEST_F(Convert, DepthConvertsToACloudOfMeasuredPixels) {
  const fs::path out = dir / "one.ply";
  expect_refused(convert({sample, "-o", out}), "cannot contain all 3 frames");
  const Ran ran = well(convert({sample, "-o", out, "--frames", "1"}));
  EXPECT_TRUE(has(ran.err, "z in the point clouds is the camera's viewing direction"));
  const Frame depth = io::open_recording(sample)->frame(1);
  const PointSet cloud = *io::open_recording(out)->frame(0).cloud;
  EXPECT_EQ(cloud.points.size(), static_cast<std::size_t>(std::ranges::count_if(
                                     depth.depth.data, [](auto d) { return d > 0 && d < 65535; })));
  EXPECT_EQ(cloud.rgb.size(), 3 * cloud.points.size());
}

TEST_F(Convert, DepthInMetersConvertsToCloudsButNotToRoundedImages) {
  const fs::path in = fs::path(PLANESCOPE_SOURCE_DIR) / "tests/fuzz/corpus/mcap/meters";
  expect_refused(convert({in, "-o", dir / "x"}), "depth is in meters (32FC1)");
  expect_refused(convert({in, "-o", dir / "x.mcap"}), "expected output as .ply or .pcd");
  well(convert({in, "-o", dir / "x.ply"}));
  EXPECT_EQ(io::open_recording(dir / "x.ply")->frame(0).cloud->points.size(), 24U * 16 - 1);
  const auto json = nlohmann::json::parse(well(run({"info", "--json", in})).out)["recordings"][0];
  EXPECT_EQ(json["depth"]["unit_m"], 0.001);
  EXPECT_EQ(json["topics"][0], "/camera/depth/image_rect_raw");
  EXPECT_EQ(json["first_frame"]["counts_65535"], 0);
}

TEST_F(Convert, ASingleFileCloudKeepsItsLabelsAndOverwritesNothing) {
  const fs::path in = dir / "a.ply", out = dir / "b.pcd";
  io::write_ply(in, floor_and_wall_cloud());
  const auto before = io::open_recording(in);
  const labels::LabelGrid grid = labels::make_label_grid(before->frame(0), Gravity{});
  labels::write_frame_labels(labels::default_label_dir(in), 0,
                             labels::empty_labels(grid, before->frame_hash(0)));
  write_text(dir / "b.pcd.planescope.json", "{}");
  expect_refused(convert({in, "-o", out}), "b.pcd.planescope.json: already exists");
  EXPECT_FALSE(fs::exists(out));
  fs::remove(dir / "b.pcd.planescope.json");

  const Ran ran = well(convert({in, "-o", out}));
  EXPECT_TRUE(has(ran.out, "with labels for 1, read back"));
  const auto after = io::open_recording(out);
  EXPECT_TRUE(
      labels::read_frame_labels(labels::default_label_dir(out), 0,
                                {after->frame_hash(0), after->frame(0).cloud->points.size()}));
}

TEST_F(Convert, NothingIsOverwrittenAndFailuresLeaveNoFiles) {
  fs::create_directories(dir / "full");
  write_text(dir / "full" / "mine.txt", "mine");
  expect_refused(convert({sample, "-o", dir / "full"}), "already exists");
  expect_refused(convert({sample, "-o", dir / "x.bag"}), "writing .bag files is not supported");
  expect_refused(convert({sample, "-o", dir / "x", "--to", "avi"}),
                 "expected folder, tum, mcap, ply, or pcd");
  EXPECT_EQ(files_below(dir), std::vector<std::string>{"full/mine.txt"});
}

}  // namespace planescope
