// Label mode on a cloud: tools in space, no image, undo, review, errors.

#include "app/desktop/look.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "desktop_fixture.hpp"
#include "render/draw_list.hpp"
#include "support/small_clouds.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

/// A file with two steps behind a floor.
const fs::path& stair_file() {
  static const fs::path path = [] {
    const fs::path file = fs::path(testing::TempDir()) /
                          ("planescope_ui_stairs." + std::to_string(::getpid()) + ".ply");
    io::write_ply(file, *test::stair_cloud().frame.cloud);
    return file;
  }();
  return path;
}

struct LabelClouds : LabelDesktop {
  const test::TrueCloud cloud = test::stair_cloud();

  LabelClouds() : LabelDesktop([](const fs::path&) { return stair_file(); }) {
    window.run("camera.top");
  }
  static void TearDownTestSuite() { fs::remove(stair_file()); }

  /// Screen position of a point of the cloud in a view of 800x800, as an argument.
  std::string seen(const Vec3f& place) const {
    const LabelFrame& frame = *state().label_frame();
    const render::View view = render::make_view(scene_camera(state(), 1), 800, 800);
    const auto point =
        render::project(view, (frame.T_world_sensor * place.cast<double>()).cast<float>());
    return fmt::format("{:.1f},{:.1f}", point->px.x(), point->px.y());
  }
  void wand_at(const Vec3f& place) { window.run("label.wand", "space:800x800 " + seen(place)); }
};

TEST_F(LabelClouds, AreDrawnOnlyInSpaceAndTheWandSelectsATread) {
  EXPECT_FALSE(window.shows("panel.image"));
  EXPECT_TRUE(window.shows("panel.view3d"));
  wand_at({0.5f, 1.15f, 0.2f});
  window.run("label.accept");
  ASSERT_EQ(labels().planes.size(), 1u);
  EXPECT_EQ(labels().planes[0].label, Label::h);
  EXPECT_NEAR(static_cast<double>(pixels_of(1)), static_cast<double>(cloud.on(3).size()), 60);
  EXPECT_NE(state().view.message.find(" points"), std::string::npos) << state().view.message;
}

TEST(LabelSparseClouds, AClickBetweenTheirPointsSelectsThemInsteadOfPointsBehind) {
  PointSet set;
  const auto add_sheet = [&](float z, float step) {
    for (float x = 0; x < 1; x += step)
      for (float y = 0; y < 1; y += step) set.points.emplace_back(x, y, z);
    return set.points.size();
  };
  const std::size_t sparse = add_sheet(1.5f, 0.03f);
  add_sheet(0.5f, 0.008f);
  const fs::path dir = scratch_dir();
  io::write_ply(dir / "sheets.ply", set);
  LabelWindow window{dir / "labels", dir / "sheets.ply"};
  window.run("camera.top");
  const LabelFrame& frame = *window.state().label_frame();
  const render::View view = render::make_view(scene_camera(window.state(), 1), 800, 800);
  const Vec3d between(0.495, 0.495, 1.5);
  const auto at = render::project(view, (frame.T_world_sensor * between).cast<float>());
  window.run("label.wand", fmt::format("space:800x800 {:.1f},{:.1f}", at->px.x(), at->px.y()));
  ASSERT_TRUE(window.state().view.label.wand.found);
  EXPECT_EQ(window.state().view.label.wand.found->pixels.size(), sparse);
}

TEST_F(LabelClouds, ALassoSelectsVisiblePointsAndThroughSelectsHiddenOnes) {
  const auto lasso = "space:800x800 over " + seen({0.1f, 0.7f, 0}) + " " + seen({0.9f, 0.7f, 0}) +
                     " " + seen({0.9f, 1.25f, 0.2f}) + " " + seen({0.1f, 1.25f, 0.2f});
  window.run("label.tool.lasso");
  window.run("label.area", lasso);
  const std::size_t seen_points = pixels_of(1);
  EXPECT_GT(seen_points, 500u);
  window.run("label.undo");
  EXPECT_TRUE(labels().planes.empty());
  window.run("label.through");
  window.run("label.area", lasso);
  EXPECT_GT(pixels_of(1), seen_points) << "the riser below the nosing, too";
}

TEST_F(LabelClouds, BrushCutAndFinishingGesturesAreOneStepOfUndoEach) {
  window.run("label.stroke",
             "space:800x800 20 " + seen({0.3f, 0.5f, 0}) + " " + seen({0.7f, 0.5f, 0}));
  const std::size_t stroke = pixels_of(1);
  EXPECT_GT(stroke, 20u);
  window.run("label.grow");
  window.run("label.accept");
  EXPECT_NEAR(static_cast<double>(pixels_of(1)), static_cast<double>(cloud.on(1).size()), 120);
  window.run("label.cut", "space:800x800 " + seen({0.5f, 0, 0}) + " " + seen({0.5f, 0.99f, 0}));
  EXPECT_EQ(labels().planes.size(), 2u);
  EXPECT_EQ(store().undo_count(), 3u);
  for (int i = 0; i < 3; ++i) window.run("label.undo");
  EXPECT_TRUE(labels().planes.empty());
}

TEST_F(LabelClouds, ReportUnsupportedActionsInOneLine) {
  EXPECT_EQ(window.refusal("label.wand", "3,4"), "a cloud has no image; expected space:WxH");
  EXPECT_EQ(window.refusal("label.area", "image over 1,1 5,1 5,5"),
            "a cloud has no image; expected space:WxH");
  EXPECT_NE(window.refusal("label.carry").find("labels for clouds cannot be carried"),
            std::string::npos);
}

}  // namespace
}  // namespace planescope::desktop
