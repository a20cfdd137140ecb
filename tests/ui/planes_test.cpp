// Finished planes in the window: footholds, steppable planes, stairs; tested with scripted input
// without GL.

#include <algorithm>
#include <limits>

#include "app/desktop/debugger/debugger.hpp"
#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/state/session.hpp"
#include "desktop_fixture.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

/// The sample's stairs, with the profile that finds all of them.
struct Planes : RefinedDesktop {
  void give_foot() { play(R"({"do": "option.set", "with": "foot_radius_m=0.08"})"); }
  /// The largest plane of a class, by its number in the trace.
  std::int32_t largest(Label label) const {
    const debug::Run& run = *state().run();
    for (const planes::PlaneRegion& plane : run.segmentation.planes)
      if (plane.label == label) return run.timeline.plane_of_number(plane.id);
    return -1;
  }
  std::string value_of(std::int32_t plane, const std::string& name) const {
    for (const PlaneLine& line : plane_lines(state(), plane))
      if (line.name == name) return line.value;
    return "";
  }
};

TEST_F(Planes, HaveOutlinesOnceAFrameIsShown) {
  const auto scene = look_of(state()).planes;
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->shapes.size(), state().run()->segmentation.planes.size());
  for (const render::PlaneShape& shape : scene->shapes) {
    EXPECT_FALSE(shape.rings.empty());
    EXPECT_FALSE(shape.triangles.empty());
  }
  ASSERT_TRUE(state().run_view()->outlines);
  EXPECT_FALSE(state().run_view()->outlines->shapes.at(0).rings.empty()) << "with the run itself";
}

TEST_F(Planes, AreTheOnlyLayerOfANewFrame) {
  const render::StepLook look = look_of(state());
  EXPECT_EQ(look.step, state().run()->steps());
  EXPECT_EQ(look.color_by, render::ColorBy::planes);
  const render::DrawList list = render::scene_step(*state().run(), look);
  EXPECT_TRUE(list.boxes.empty());
  EXPECT_TRUE(list.arrows.empty());
  EXPECT_EQ(list.points.size(), 1u) << "no voxel stands out";
  EXPECT_EQ(list.labels.size(), state().run()->segmentation.planes.size()) << "each name once";
  play(R"("step.previous")");
  EXPECT_TRUE(look_of(state()).show_current);
  play(R"({"key": "End"}, {"key": "V"}, {"key": "Y"}, {"key": "W"}, {"key": "B"})");
  const render::StepLook shown = look_of(state());
  EXPECT_TRUE(shown.show_normals && shown.show_settled && !shown.show_names && !shown.show_points);
}

TEST_F(Planes, FootAndStairOptionsDoNotChangeARun) {
  const auto run = state().run_view()->run;
  EXPECT_TRUE(look_of(state()).planes->foot.empty());
  give_foot();
  EXPECT_EQ(state().run_view()->run, run);
  const auto scene = look_of(state()).planes;
  ASSERT_EQ(scene->foot.size(), run->segmentation.planes.size());
  EXPECT_GT(std::ranges::count(scene->steppable, true), 0);
  EXPECT_EQ(stairs_entries(state()).size(), 1u);
  play(R"({"do": "option.set", "with": "stairs_rise_max_m=0.1"}, {"expect": {"flights": 0}})");
  EXPECT_EQ(state().run_view()->run, run);
  EXPECT_TRUE(stairs_entries(state()).empty());
  play(R"("option.undo", {"expect": {"flights": 1}})");
}

TEST_F(Planes, LayersAreToggledByKeyMenuAndButtonAndRemembered) {
  EXPECT_FALSE(look_of(state()).show_foot);
  play(
      R"({"key": "Shift+F"}, {"click": "view3d.more"}, {"click": "more.show.stairs"}, {"key": "7"})");
  EXPECT_TRUE(look_of(state()).show_foot);
  EXPECT_TRUE(look_of(state()).show_stairs);
  const std::filesystem::path path = dir / "s.json";
  save_session(state(), path);
  State other;
  open_session(other, path.string());
  EXPECT_TRUE(other.view.show_foot);
  EXPECT_TRUE(other.view.show_stairs);
  EXPECT_EQ(other.view.color_by, render::ColorBy::steppable);
  play(R"({"click": "menu.View"}, {"click": "menu.show.foot"})");
  EXPECT_FALSE(look_of(state()).show_foot);
}

TEST_F(Planes, FootAndStairOptionsAreInThePanel) {
  play(R"({"do": "tab.tool", "with": "criteria"},
          {"do": "option.show", "with": "foot_radius_m"})");
  EXPECT_TRUE(shown("criteria.section.foot"));
  EXPECT_TRUE(shown("criteria.section.stairs"));
  EXPECT_TRUE(shown("criteria.foot_radius_m.slider"));
  EXPECT_FALSE(shown("criteria.foot_max_rough_m")) << "no foot, no limits";
  play(R"({"click": "criteria.foot_radius_m.slider", "at": [0.6, 0.5]})");
  const double radius_m = state().document.options.foot.radius_m;
  EXPECT_GT(radius_m, 0.03);
  EXPECT_LT(radius_m, 0.3) << "as wide as feet are";
  EXPECT_TRUE(shown("criteria.foot_max_rough_m"));
}

TEST_F(Planes, ShowWhyTheyAreNotSteppable) {
  const std::int32_t floor = largest(Label::h), wall = largest(Label::v);
  EXPECT_EQ(verdict_text(state(), floor), "") << "no foot is given";
  give_foot();
  EXPECT_EQ(verdict_text(state(), floor), "steppable");
  EXPECT_EQ(verdict_text(state(), wall).find("not steppable: upright, v"), 0u);
  EXPECT_TRUE(has(describe_plane(state(), wall), "\nnot steppable: upright"));
  play(R"({"do": "option.set", "with": "foot_max_rough_m=0.0001"})");
  const std::string rough = verdict_text(state(), floor);
  EXPECT_EQ(rough.find("not steppable: "), 0u) << rough;
  EXPECT_TRUE(has(rough, "mm rough, limit 0.1"));
}

TEST_F(Planes, AVoxelShowsItsPlanesVerdictOnRequest) {
  give_foot();
  const auto& plane_of = state().run()->segmentation.plane_of;
  const int wall = state().run()->timeline.result_of_plane(largest(Label::v));
  const auto voxel =
      static_cast<std::int32_t>(std::ranges::find(plane_of, wall) - plane_of.begin());
  EXPECT_FALSE(has(describe_voxel(state(), voxel), "steppable"));
  play(R"("color.steppable")");
  EXPECT_TRUE(has(describe_voxel(state(), voxel), "not steppable: upright"));
}

TEST_F(Planes, TheInspectorShowsMeasuresOfAFinishedPlane) {
  give_foot();
  const std::int32_t floor = largest(Label::h);
  play(R"({"do": "select.plane", "with": ")" + debug::plane_name(*state().run(), floor) + "\"}");
  EXPECT_TRUE(shown("inspector.verdict"));
  for (const auto& [name, part] : {std::pair{"area", "m²"},
                                   {"slope", "°"},
                                   {"rough", "mm, steps of"},
                                   {"support", "%"},
                                   {"uncertainty", "offset"},
                                   {"clearance", "mm"},
                                   {"foot space", "convex piece"}})
    EXPECT_TRUE(has(value_of(floor, name), part)) << name;
  EXPECT_EQ(value_of(floor, "height"), "0 mm") << "it is the floor";
  play(R"("step.first")");
  EXPECT_TRUE(plane_lines(state(), floor).empty()) << "nothing of the future";
}

TEST_F(Planes, AFlightIsListedWithItsStepsAndSelectsItsPlanes) {
  play(R"({"click": "tab.stairs"})");
  EXPECT_TRUE(shown("stairs.0"));
  const StairsEntry flight = stairs_entries(state()).at(0);
  EXPECT_EQ(flight.title.find("4 steps up, rise 15"), 0u) << flight.title;
  EXPECT_TRUE(has(flight.lines.at(0), " mm wide, from P")) << flight.lines[0];
  EXPECT_EQ(flight.lines.at(1).find("step 1: rise 15"), 0u) << flight.lines[1];
  EXPECT_TRUE(has(flight.lines.at(2), "mm, going 2")) << flight.lines[2];
  const std::string tread = debug::plane_name(*state().run(), flight.planes.at(1));
  play(R"({"click": "stairs.0.)" + tread + "\"}");
  EXPECT_EQ(state().view.selected.plane, flight.planes[1]);
}

TEST_F(Planes, ALevelWithoutAStepShowsTheReason) {
  play(R"({"do": "option.set", "with": "stairs_rise_max_m=0.1"})");
  std::size_t reported = 0;
  for (std::int32_t p = 0; p < state().run()->timeline.plane_count(); ++p)
    for (const std::string& text : no_steps_of(state(), p)) {
      EXPECT_TRUE(has(text, "no step: "));
      EXPECT_TRUE(has(text, debug::plane_name(*state().run(), p))) << "by the window's names";
      ++reported;
    }
  EXPECT_GT(reported, 0u);
}

TEST_F(Planes, UseTheFinalFootAfterQuickChanges) {
  give_foot();
  play(R"({"do": "option.set", "with": "foot_radius_m=0.3", "wait": false},
          {"frames": 1, "wait": false},
          {"do": "option.set", "with": "foot_radius_m=0.08"})");
  EXPECT_EQ(state().planes()->key, planes_key(state().document.options));
}

TEST_F(Planes, HaveTheSameFootInBothRunsAndWhenOptionsReturnToA) {
  give_foot();
  play(R"("run.pin", {"do": "option.set", "with": "theta_n_out=9"}, "run.restore")");
  EXPECT_EQ(state().document.options.segment.theta_n_out, 5);
  EXPECT_EQ(state().document.options.foot.radius_m, 0.08);
}

TEST_F(Planes, OfAPinnedRunAreAnalyzedWhileItIsFlashed) {
  play(R"("run.pin", {"do": "option.set", "with": "theta_n_out=9"})");
  const auto b = look_of(state()).planes;
  play(R"("run.flash")");
  ASSERT_TRUE(state().planes());
  EXPECT_EQ(state().planes()->of, state().results.pinned);
  EXPECT_NE(look_of(state()).planes, b);
  play(R"("run.flash")");
  EXPECT_EQ(look_of(state()).planes, b) << "kept";
}

TEST_F(Planes, AreListedInASortableFilterableTableLinkedToTheScene) {
  play(R"({"do": "tab.inspector", "with": "planes"})");
  const std::size_t all = state().run()->segmentation.planes.size();
  ASSERT_EQ(plane_rows(state()).size(), all);
  EXPECT_EQ(plane_rows(state()).front().id, 1) << "as planes.json has them";
  play(R"({"click": "planes.sort.tilt"})");
  std::vector<PlaneRow> rows = plane_rows(state());
  EXPECT_GT(rows.front().tilt_deg, 80);
  EXPECT_LT(rows.back().tilt_deg, 10);
  play(R"({"click": "planes.sort.tilt"})");
  EXPECT_LT(plane_rows(state()).front().tilt_deg, 10) << "the other way round";
  play(R"({"do": "planes.filter", "with": "upright m²"})");
  rows = plane_rows(state());
  ASSERT_FALSE(rows.empty());
  EXPECT_LT(rows.size(), all);
  for (const PlaneRow& row : rows) EXPECT_EQ(row.label, Label::v);
  play(fmt::format(R"({{"click": "planes.{}"}})", rows[0].id));
  EXPECT_EQ(state().view.selected.plane, rows[0].plane);
  EXPECT_EQ(look_of(state()).plane, rows[0].plane) << "in the scene too";
}

TEST(PlaneTable, MarksUndecidedPlanesBesideTheirMargin) {
  PlaneRow row;
  row.margin = std::numeric_limits<double>::infinity();
  EXPECT_EQ(plane_columns().back().text(row), "–");
  row.margin = 0.75;
  EXPECT_EQ(plane_columns().back().text(row), "0.75");
  row.margin = 0.03;
  row.undecided = true;
  EXPECT_EQ(plane_columns().back().text(row), "0.03 ~");
  EXPECT_TRUE(planes_csv({row}).ends_with(",0.03,true\n"));
}

TEST_F(Planes, AreCopiedAsCsvInTheOrderOfTheTable) {
  play(R"({"do": "planes.sort", "with": "area"}, "planes.copy")");
  const std::string csv = ImGui::GetClipboardText();
  EXPECT_EQ(csv.find("id,class,area_m2,tilt_deg,rms_m,points,support,steppable,margin,undecided\n"),
            0u);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')),
            state().run()->segmentation.planes.size() + 1);
  const PlaneRow largest = plane_rows(state()).front();
  EXPECT_TRUE(has(
      csv, fmt::format("\n{},{},{},", largest.id, to_string(largest.label, ""), largest.area_m2)));
}

}  // namespace
}  // namespace planescope::desktop
