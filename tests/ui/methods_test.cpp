// Other methods in the debugger: their planes, comparison with ours, and returning to ours.

#include <nlohmann/json.hpp>

#include "app/desktop/state/state.hpp"
#include "desktop_fixture.hpp"
#include "support/needs_open3d.hpp"

namespace planescope::desktop {
namespace {

struct Methods : OpenDesktop {
  void perform(const std::string& action, const std::string& argument = {}) {
    run(action, argument);
    EXPECT_FALSE(state().view.message_is_error) << message();
  }
};

TEST_F(Methods, ARivalShowsItsPlanesAndHasNoSteps) {
  PLANESCOPE_NEEDS_OPEN3D();
  perform("method.choose", "ransac");
  const planescope::debug::Run& run = *state().run();
  EXPECT_FALSE(run.is_ours());
  EXPECT_GT(run.segmentation.planes.size(), 2u);
  EXPECT_EQ(run.steps(), 0);
  EXPECT_EQ(state_facts(state(), true)["method"], "ransac");
  ASSERT_TRUE(state().run_view()->score.has_value()) << "it is scored against the truth";
  EXPECT_GT(state().run_view()->score->mean_iou, 0.3);
  perform("select.plane", "P1");
  EXPECT_EQ(state().view.selected.plane, 0);
  perform("select.pixel", "320,400");
  EXPECT_EQ(state().view.selected.node, -1) << "there is no octree";
  perform("fix.search");
  EXPECT_TRUE(has(message(), "method ours"));
}

TEST_F(Methods, OursAndARivalAreComparedPlaneByPlane) {
  PLANESCOPE_NEEDS_OPEN3D();
  const std::int32_t steps = state().run()->steps();
  const auto planes = state().run()->segmentation.plane_of;
  perform("run.pin");
  perform("method.choose", "ransac");
  ASSERT_NE(state().results.comparison, nullptr);
  const debug::Comparison& comparison = *state().results.comparison;
  EXPECT_FALSE(comparison.planes.empty());
  EXPECT_GT(comparison.compared_sources, 1000u);
  EXPECT_TRUE(comparison.nodes.empty());
  EXPECT_TRUE(has(comparison.divergence, "ransac"));
  perform("run.flash");
  EXPECT_EQ(state().run()->steps(), steps) << "A is ours";
  perform("run.flash");
  perform("compare.against", "truth");
  EXPECT_FALSE(state().results.comparison->planes.empty());
  perform("option.undo");
  EXPECT_EQ(state().run()->steps(), steps);
  EXPECT_EQ(state().run()->segmentation.plane_of, planes) << "ours again, as it was";
}

TEST_F(Methods, ItsOptionsReplaceOurs) {
  PLANESCOPE_NEEDS_OPEN3D();
  perform("method.choose", "ransac");
  EXPECT_TRUE(shown("criteria.ransac_theta_pf_m.slider"));
  EXPECT_FALSE(shown("criteria.theta_n_in.slider"));
  EXPECT_FALSE(shown("criteria.region_patch_px.slider"));
  const std::size_t planes = state().run()->segmentation.planes.size();
  perform("option.set", "ransac_min_points=2000");
  EXPECT_LT(state().run()->segmentation.planes.size(), planes);
  perform("method.choose", "ours");
  EXPECT_TRUE(shown("criteria.theta_n_in.slider"));
}

TEST_F(Methods, EveryPanelAndEveryKeyWorksWithARival) {
  PLANESCOPE_NEEDS_OPEN3D();
  perform("method.choose", "ransac");
  perform("select.pixel", "320,400");
  for (const char* tab : {"inspector", "point", "bookmarks"}) perform("tab.inspector", tab);
  for (const char* tool : {"criteria", "histograms", "compare", "fix"}) perform("tab.tool", tool);
  for (const Action& action : action_table()) {
    const bool debugger = action.mode == KeyMode::debugger || action.name.starts_with("color.");
    if (!debugger || !action.takes.empty()) continue;
    if (action.enabled && !action.enabled(state())) continue;
    SCOPED_TRACE(action.name);
    shell.perform({action.name, ""});
    stage.draw_frame();
    if (state().document.options.method == planes::Method::ours) perform("method.choose", "ransac");
  }
}

TEST(MethodsInLabels, FirstLabelsCanBeFromARival) {
  PLANESCOPE_NEEDS_OPEN3D();
  LabelWindow window(scratch_dir() / "labels");
  window.run("method.choose", "ransac");
  window.run("label.take");
  EXPECT_TRUE(window.state().view.message.starts_with("Start from the algorithm (ransac)"));
  EXPECT_EQ(window.labels().planes.size(), window.state().run()->segmentation.planes.size());
}

TEST(MethodsAtFirst, OursIsClassifiedAfterOpeningWithARival) {
  PLANESCOPE_NEEDS_OPEN3D();
  State first = open_state();
  first.document.options.method = planes::Method::ransac;
  Desk desk(std::move(first));
  desk.rest();
  EXPECT_EQ(desk.state().run()->steps(), 0);
  desk.perform("method.choose", "ours");
  ASSERT_NE(desk.state().run(), nullptr) << desk.state().results.refusal;
  EXPECT_GT(desk.state().run()->steps(), 0);
}

}  // namespace
}  // namespace planescope::desktop
