// Real recordings in the desktop: opened, stepped through, searched, with every panel drawn.

#include <cstdlib>

#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Real {
  const char* path;
  const char* gravity;  // empty: found by itself
};

struct RealRecordings : testing::TestWithParam<Real> {};

TEST_P(RealRecordings, AreSteppedThroughAndSearched) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const std::filesystem::path path = std::filesystem::path(data) / GetParam().path;
  State state = open_state(planes::Profile::refined);
  state.document.recordings = {
      {path, io::open_recording(path, {}), labels::default_label_dir(path)}};
  state.view.tool_tab = "histograms";
  if (*GetParam().gravity)
    apply(state, {"option.set", std::string("gravity=") + GetParam().gravity});
  Shell shell(std::move(state), nullptr, [] {});
  NoStage stage(shell);
  settle(shell, stage, {});
  ASSERT_TRUE(shell.state().run()) << shell.state().results.refusal;
  EXPECT_GT(shell.state().run()->segmentation.planes.size(), 0u);
  for (const Command& command : std::vector<Command>{{"step.first", ""},
                                                     {"filter.set", "case==IV"},
                                                     {"filter.next", ""},
                                                     {"run.pin", ""},
                                                     {"profile.paper", ""},
                                                     {"compare.diverging", ""},
                                                     {"run.flash", ""},
                                                     {"step.last", ""},
                                                     {"option.undo", ""}}) {
    shell.perform(command, true);
    settle(shell, stage, {});
  }
  EXPECT_EQ(shell.state().document.options.segment.profile, planes::Profile::refined);
}

INSTANTIATE_TEST_SUITE_P(Recordings,
                         RealRecordings,
                         testing::Values(Real{"realsense_sdk_bag/single_depth_color_640x480.bag",
                                              "0,1,0"},
                                         Real{"felixchenfy_d4xx_640x480", ""},
                                         Real{"rs_viewer_raw_export_848x480", ""},
                                         Real{"cape_tunnel_structure_640x480", ""},
                                         Real{"stairs_kinect2_512x424/0000_cloud.pcd", ""}));

}  // namespace
}  // namespace planescope::desktop
