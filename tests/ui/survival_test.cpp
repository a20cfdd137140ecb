// Inputs that must not crash the window: odd frames and real recordings.

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

State state_of(const fs::path& path, planes::Profile profile = planes::Profile::paper) {
  State state = open_state(profile);
  state.document.recordings = {
      {path, io::open_recording(path, {}), labels::default_label_dir(path)}};
  return state;
}

/// Opens every panel, with the cursor at both ends and in the middle.
void look_around(Desk& desk) {
  desk.rest();
  for (const char* tab : {"inspector", "point", "bookmarks"})
    for (const char* tool : {"criteria", "histograms", "compare", "fix"})
      for (const char* step : {"step.first", "step.next", "step.last"}) {
        desk.shell.perform({"tab.inspector", tab});
        desk.shell.perform({"tab.tool", tool});
        desk.shell.perform({step, ""});
        desk.rest();
      }
}

fs::path depth_folder(const fs::path& dir, std::uint16_t value) {
  fs::create_directories(dir / "depth");
  Image16 depth(64, 48);
  std::fill(depth.data.begin(), depth.data.end(), value);
  io::write_png(dir / "depth" / "000000.png", depth);
  std::ofstream(dir / "planescope.json")
      << R"({"schema": "planescope.recording/1", "depth_unit_m": 0.001, "gravity": [0, 1, 0],
             "intrinsics": {"width": 64, "height": 48, "fx": 60, "fy": 60, "cx": 32, "cy": 24}})";
  return dir;
}

TEST(Survival, AFrameWithNoValidDepthIsShown) {
  Desk desk(state_of(depth_folder(scratch_dir(), 0)));
  look_around(desk);
  ASSERT_TRUE(desk.state().run() || !desk.state().results.refusal.empty());
  if (desk.state().run()) {
    EXPECT_EQ(desk.state().run()->subject->voxel_count(), 0u);
  }
}

TEST(Survival, AFrameWithoutPlanesIsShown) {
  State state = state_of(depth_folder(scratch_dir(), 1200));
  apply(state, {"option.set", "theta_n_in=100000"});
  Desk desk(std::move(state));
  look_around(desk);
  ASSERT_TRUE(desk.state().run());
  EXPECT_EQ(desk.state().run()->segmentation.planes.size(), 0u);
}

TEST(Survival, ADisappearingRecordingIsReported) {
  const fs::path dir = scratch_dir() / "gone";
  fs::copy(sample_path(), dir, fs::copy_options::recursive);
  Desk desk(state_of(dir));
  desk.rest();
  ASSERT_TRUE(desk.state().run());
  fs::remove_all(dir);
  desk.perform("frame.next");
  EXPECT_TRUE(has(desk.state().results.refusal, "gone"));
  look_around(desk);
}

TEST(Survival, ClosingWhileAJobRunsWaitsForNothing) {
  for (int frames : {0, 1, 3}) {
    Shell shell(open_state(), nullptr, [] {});
    for (int i = 0; i < frames; ++i) shell.frame(800, 600, 1, 0.01);
  }
}

TEST(Survival, AGridOfTwoMillimetersWithTwoHundredThousandPointsIsShown) {
  const fs::path path = scratch_dir() / "dense.ply";
  PointSet set;
  std::uint32_t random = 1;
  const auto next = [&] {
    random = random * 1664525u + 1013904223u;
    return static_cast<float>(random >> 8) / static_cast<float>(1u << 24);
  };
  for (int i = 0; i < 200000; ++i)
    set.points.push_back(Vec3f(1 + 0.02f * next(), 0.02f * next(), 0.02f * next()));
  io::write_ply(path, set);
  State state = state_of(path);
  apply(state, {"option.set", "voxel_size_m=0.002"});
  Desk desk(std::move(state));
  desk.rest();
  ASSERT_TRUE(desk.state().run()) << desk.state().results.refusal;
  EXPECT_LE(desk.state().run()->subject->voxel_count(), 1331u);
  look_around(desk);
}

TEST(Survival, ALongRecordingShowsItsFrameAtOnceAndItsStripCanBeStopped) {
  const fs::path dir = depth_folder(scratch_dir(), 1200);
  for (int i = 1; i < 300; ++i)
    fs::copy_file(dir / "depth" / "000000.png",
                  dir / "depth" / (std::to_string(1000000 + i).substr(1) + ".png"));
  Desk desk(state_of(dir));
  const int frames = static_cast<int>(desk.state().document.current()->recording->frame_count());
  ASSERT_EQ(frames, 300);
  while (!desk.state().run() && desk.state().results.refusal.empty()) desk.stage.draw_frame();
  EXPECT_LT(desk.state().results.strip_done, frames);
  // it fills without user input
  while (desk.state().results.strip_done < 3) desk.stage.draw_frame();
  desk.perform("strip.cancel");
  EXPECT_LT(desk.state().results.strip_done, frames);
  EXPECT_TRUE(desk.state().results.strip[0].ready);
}

TEST(Survival, TinyAndHugeWindowsDrawEveryPanel) {
  Desk desk(open_state());
  desk.rest();
  for (const char* share : {"0.3", "0", "0.9"})
    for (const char* tool : {"criteria", "histograms", "compare", "fix"}) {
      for (const char* name : {"left", "right", "bottom", "image", "octree", "tools"})
        desk.shell.perform({"layout.set", std::string(name) + "=" + share}, true);
      desk.shell.perform({"tab.tool", tool}, true);
      for (const auto& [width, height] : {std::pair{320, 200}, {640, 400}, {7680, 4320}, {1, 1}})
        for (const float scale : {1.0f, 2.0f})
          for (int i = 0; i < 2; ++i) desk.shell.frame(width, height, scale, 0.01);
    }
}

struct Real {
  const char* path;
  const char* gravity = "";  // empty: estimated
};

struct RealRecordings : testing::TestWithParam<Real> {};

TEST_P(RealRecordings, CanBeSteppedThroughAndSearched) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const std::filesystem::path path = std::filesystem::path(data) / GetParam().path;
  State state = state_of(path, planes::Profile::refined);
  state.view.tool_tab = "histograms";
  if (*GetParam().gravity)
    apply(state, {"option.set", std::string("gravity=") + GetParam().gravity});
  Desk desk(std::move(state));
  desk.rest();
  ASSERT_TRUE(desk.state().run()) << desk.state().results.refusal;
  const planes::Segmentation& found = desk.state().run()->segmentation;
  EXPECT_GT(found.planes.size() + found.minor.size(), 0u);
  for (const Command& command : std::vector<Command>{{"step.first"},
                                                     {"filter.set", "case==IV"},
                                                     {"filter.next"},
                                                     {"run.pin"},
                                                     {"profile.paper"},
                                                     {"compare.diverging"},
                                                     {"run.flash"},
                                                     {"step.last"},
                                                     {"option.undo"}}) {
    desk.run(command.action, command.argument);
  }
  EXPECT_EQ(desk.state().document.options.segment.profile, planes::Profile::refined);
}

INSTANTIATE_TEST_SUITE_P(
    Recordings,
    RealRecordings,
    testing::Values(Real{"realsense_sdk_bag/single_depth_color_640x480.bag", "0,1,0"},
                    Real{"felixchenfy_d4xx_640x480"},
                    Real{"rs_viewer_raw_export_848x480"},
                    Real{"cape_tunnel_structure_640x480"},
                    Real{"stairs_kinect2_512x424/0000_cloud.pcd", ""}),
    [](const auto& test) { return std::filesystem::path(test.param.path).begin()->string(); });

}  // namespace
}  // namespace planescope::desktop
