// The scene and the image: viewpoints, clicks, layout, isolation, and comparison of A and B.

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "app/desktop/look.hpp"
#include "app/desktop/views.hpp"
#include "desktop_fixture.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

struct Scene : RefinedDesktop {
  void run(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument}, true);
    rest(/*background=*/false);
  }
  render::Camera camera() const { return camera_of(state()); }
  std::string facts(const std::string& name) const {
    return state_facts(state(), true).at(name).dump();
  }
  /// How far the frame's points extend from the center of the view toward its borders, without the
  /// outermost 2 %.
  double filled(double aspect) const {
    const int height = 500, width = static_cast<int>(500 * aspect);
    const render::View view = render::make_view(scene_camera(state(), aspect), width, height);
    std::vector<double> reach;
    for (const Vec3f& point : state().run()->subject->prepared.voxels.points)
      if (const auto seen = render::project(view, point))
        reach.push_back(std::max(std::abs(2 * seen->px.x() / width - 1),
                                 std::abs(2 * seen->px.y() / height - 1)));
    std::ranges::sort(reach);
    return reach[reach.size() * 49 / 50];
  }
  /// An unmeasured pixel with unmeasured neighbors.
  std::string empty_pixel() const {
    const debug::Subject& subject = *state().run()->subject;
    const auto is_empty = [&](int u, int v) {
      return subject.voxel_of_source(static_cast<std::size_t>(v * 640 + u)) == planes::kNoVoxel;
    };
    for (int v = 20; v < 460; v += 5)
      for (int u = 20; u < 620; u += 5) {
        bool all = true;
        for (int i = 0; i < 81 && all; ++i) all = is_empty(u + i % 9 - 4, v + i / 9 - 4);
        if (all) return fmt::format("{},{}", u, v);
      }
    return "";
  }
};

// ---- Framing ----

TEST_F(Scene, HomeAndSideViewsFillTheViewAtEveryAspectRatio) {
  for (const char* facing : {"camera.home", "camera.top", "camera.side", "camera.front"})
    for (const bool flat : {false, true}) {
      run(facing);
      if (state().view.orthographic != flat) run("camera.orthographic");
      for (const double aspect : {0.6, 1.0, 1.7, 2.8}) {
        EXPECT_GT(filled(aspect), 0.7) << facing << " " << aspect << " " << flat;
        EXPECT_LT(filled(aspect), 1.02) << facing << " " << aspect << " " << flat;
      }
    }
}

TEST_F(Scene, TheTopViewLooksAlongGravity) {
  run("camera.top");
  EXPECT_NEAR((camera().eye - camera().target).normalized().z(), 1, 1e-6);
  run("camera.front");
  EXPECT_NEAR((camera().eye - camera().target).normalized().z(), 0, 1e-6);
}

TEST_F(Scene, TheOrthographicViewHasTheSameScaleAtTheTarget) {
  const render::Camera before = scene_camera(state(), 1.5);
  run("camera.set", "0,0,1,2,0,0");
  run("camera.orthographic");
  const render::Camera flat = scene_camera(state(), 1.5);
  EXPECT_TRUE(flat.orthographic);
  EXPECT_NEAR(flat.ortho_height_m, 2 * std::sqrt(5.0) * std::tan(before.fov_y_deg * M_PI / 360),
              1e-9);
  run("camera.zoom", "2");
  EXPECT_NEAR(scene_camera(state(), 1.5).ortho_height_m, flat.ortho_height_m / 2, 1e-9);
}

TEST_F(Scene, CenteringTheSelectionDoesNotRotateTheView) {
  const Vec3d looked = (camera().target - camera().eye).normalized();
  const auto holds = [&](const std::vector<Vec3f>& points) {
    const double aspect = state().view.scene_aspect;
    const int width = static_cast<int>(400 * aspect);
    const render::View view = render::make_view(scene_camera(state(), aspect), width, 400);
    for (const Vec3f& point : points) {
      const auto seen = render::project(view, point);
      if (!seen || seen->px.x() < 0 || seen->px.x() > width || seen->px.y() < 0 ||
          seen->px.y() > 400)
        return false;
    }
    return true;
  };
  const debug::Run& shown = *state().run();
  const auto last = static_cast<std::int32_t>(shown.octree().nodes.size()) - 1;
  run("select.node", std::to_string(last));
  run("camera.selected");
  EXPECT_TRUE(holds(render::node_points(shown, last)));
  const double near_node = (camera().eye - camera().target).norm();
  run("select.plane", debug::plane_name(shown, 0));
  run("camera.selected");
  EXPECT_TRUE(holds(render::plane_points(shown, 0, state().view.step)));
  EXPECT_GT((camera().eye - camera().target).norm(), near_node);
  EXPECT_NEAR((camera().target - camera().eye).normalized().dot(looked), 1, 1e-9);
  run("select.voxel", "100");
  run("camera.selected");
  EXPECT_LT((camera().target - shown.subject->prepared.voxels.points[100].cast<double>()).norm(),
            0.05);
  run("select.none");
  run("mark.pixels", "300,300,340,340");
  run("camera.selected");
  EXPECT_TRUE(holds(selected_points(state())));
  EXPECT_FALSE(selected_points(state()).empty());
}

TEST_F(Scene, CameraUndoRevertsWholeDrags) {
  const render::Camera home = camera();
  play(R"({"drag": "view3d", "by": [80, 10]})");
  const render::Camera turned = camera();
  play(R"({"wheel": "view3d", "by": 2}, {"wheel": "view3d", "by": 1})");
  EXPECT_FALSE(same_camera(camera(), turned));
  play(R"({"key": "Alt+Left"})");
  EXPECT_TRUE(same_camera(camera(), turned)) << "notches in a row are one step";
  play(R"({"key": "Alt+Left"})");
  EXPECT_TRUE(same_camera(camera(), home)) << "a drag of many frames is one step";
  EXPECT_FALSE(find_action("camera.undo").can_run(state()));
  play(R"({"key": "Alt+Right"})");
  EXPECT_TRUE(same_camera(camera(), turned));
}

TEST_F(Scene, AClickDoesNotMoveTheCameraAndIsNotUndone) {
  play(R"({"click": "view3d", "at": [0.5, 0.6]})");
  EXPECT_FALSE(find_action("camera.undo").can_run(state()));
}

TEST_F(Scene, ButtonsThatDoNotFitAreInAMenu) {
  EXPECT_FALSE(shown("button.camera.top"));
  play(R"({"click": "view3d.more"}, {"click": "more.camera.top"})");
  EXPECT_EQ(state().view.facing, Facing::top);
  run("views.show", "scene");
  run("layout.set", "right=0.15");
  NoStage wide(shell, 2400, 900);
  settle(shell, wide, {}, false);
  EXPECT_TRUE(shown("button.camera.top"));
  EXPECT_FALSE(shown("view3d.more"));
}

// ---- Layout ----

TEST(Arrange, ViewsAreArrangedByPanelAndImageShape) {
  const auto views = [](Rect room, double picture) {
    return arrange(room, picture, Views::both, 0.4, 30, 4);
  };
  const Arrangement wide = views({0, 0, 1000, 400}, 4.0 / 3),
                    tall = views({0, 0, 500, 900}, 4.0 / 3);
  EXPECT_TRUE(wide.beside);
  EXPECT_FALSE(tall.beside);
  EXPECT_EQ(wide.scene->w + wide.between->w + wide.image->w, 1000);
  EXPECT_EQ(tall.scene->h + tall.between->h + tall.image->h, 900);
  EXPECT_LT(views({0, 0, 2000, 300}, 4.0 / 3).image->w, 400) << "no more than the picture fills";
  EXPECT_FALSE(views({0, 0, 1000, 400}, 0).image) << "a cloud has no picture";
  EXPECT_EQ(views({0, 0, 1000, 400}, 0).scene->w, 1000);
}

TEST_F(Scene, ASingleViewFillsThePanel) {
  const auto width = [&](const char* panel) {
    const WidgetRect& rect = shell.widgets().at(panel);
    return rect.max.x - rect.min.x;
  };
  const float middle = width("panel.timeline");
  EXPECT_LT(width("panel.view3d"), middle);
  play(R"({"key": "Shift+V"})");
  EXPECT_EQ(width("panel.view3d"), middle);
  EXPECT_FALSE(shown("panel.image"));
  play(R"({"key": "Shift+V"})");
  EXPECT_EQ(width("panel.image"), middle);
  EXPECT_FALSE(shown("panel.view3d"));
  play(R"({"key": "Shift+V"})");
  EXPECT_TRUE(shown("panel.image") && shown("panel.view3d"));
}

TEST(Cloud, LetsTheSceneFillThePanel) {
  const std::filesystem::path dir = scratch_dir(), path = dir / "floor.ply";
  std::ofstream file(path);
  file << "ply\nformat ascii 1.0\nelement vertex 2500\nproperty float x\nproperty float y\n"
          "property float z\nend_header\n";
  for (int i = 0; i < 2500; ++i) file << i % 50 * 0.02 << ' ' << i / 50 * 0.02 << " 0\n";
  file.close();
  State opened = open_state(planes::Profile::refined);
  opened.document.recordings[0] = {path, io::open_recording(path, {}), dir / "labels"};
  Desk desk(std::move(opened));
  desk.rest(/*background=*/false);
  ASSERT_TRUE(desk.state().run()) << desk.state().results.refusal;
  EXPECT_FALSE(desk.shown("panel.image"));
  const WidgetRect scene = desk.shell.widgets().at("panel.view3d");
  const WidgetRect below = desk.shell.widgets().at("panel.timeline");
  EXPECT_EQ(scene.max.x - scene.min.x, below.max.x - below.min.x);
}

// ---- Clicks ----

TEST_F(Scene, AClickOnAnEmptyPixelExplainsWhyItIsEmpty) {
  const std::string pixel = empty_pixel();
  ASSERT_NE(pixel, "");
  play(click_on(pixel));
  EXPECT_EQ(state().view.inspector_tab, "point");
  EXPECT_EQ(state().view.selected.voxel, -1);
  EXPECT_EQ(state().view.selected.node, -1);
  const std::int64_t source = state().view.selected.source;
  EXPECT_NEAR(static_cast<double>(source % 640), std::stod(pixel), 3);
}

TEST_F(Scene, AnEmptySceneLocationIsAPixelWithoutAPoint) {
  const debug::Subject& subject = *state().run()->subject;
  const render::View view = render::make_view(scene_camera(state(), 1.5), 600, 400);
  int found = 0;
  for (int y = 0; y < 400; y += 10)
    for (int x = 0; x < 600; x += 10)
      if (const auto pixel = pixel_of_nothing(subject, view, Vec2d(x, y))) {
        ++found;
        ASSERT_EQ(subject.voxel_of_source(*pixel), planes::kNoVoxel);
      }
  EXPECT_GT(found, 0);
  // A position with a visible point whose own pixel sees it is not empty.
  const auto seen = render::project(view, subject.prepared.voxels.points[5000]);
  ASSERT_TRUE(seen);
}

TEST_F(Scene, TheRightButtonOpensAContextMenu) {
  play(R"({"click": "image", "at": [0.5, 0.65], "button": "right"})");
  for (const char* entry : {"select", "why", "isolate", "frame", "measure", "bookmark", "copy"})
    EXPECT_TRUE(shown(std::string("context.") + entry)) << entry;
  EXPECT_LT(state().view.selected.voxel, 0) << "opening it selects nothing";
  play(R"({"click": "context.why"})");
  EXPECT_EQ(state().view.inspector_tab, "point");
  EXPECT_GE(state().view.selected.voxel, 0);
  EXPECT_FALSE(shown("context.why")) << "the menu is closed";
  play(R"({"click": "image", "at": [0.5, 0.65], "button": "right"}, {"click": "context.measure"})");
  EXPECT_EQ(state().view.measured.size(), 1u);
  play(R"({"drag": "image", "by": [30, 10], "button": "right"})");
  EXPECT_FALSE(shown("context.why")) << "a drag moves the image";
}

TEST_F(Scene, EveryEntryOfEveryMenuCanBeRun) {
  const std::int32_t node = state().run()->octree().nodes[0].first_child;
  const std::vector<PointedAt> things = {{{render::Picked::Kind::voxel, 500}, -1},
                                         {{render::Picked::Kind::plane, 0}, -1},
                                         {{render::Picked::Kind::node, node}, -1},
                                         {{}, 12345},
                                         {}};
  for (const PointedAt& thing : things) {
    const auto entries = context_entries(state(), thing);
    EXPECT_GE(entries.size(), 2u);
    EXPECT_NE(context_title(state(), thing), "");
    for (const ContextEntry& entry : entries) {
      if (entry.name == "floor" || entry.name == "wall") continue;  // they write a file
      for (const Command& command : entry.commands) {
        if (!find_action(command.action).can_run(state())) continue;
        EXPECT_NO_THROW(shell.perform(command, true)) << entry.title;
      }
    }
  }
}

TEST_F(Scene, APlaneIsSelectedAndCopiedFromItsMenu) {
  const std::vector<ContextEntry> entries =
      context_entries(state(), {{render::Picked::Kind::plane, 2}, -1});
  for (const ContextEntry& entry : entries)
    if (entry.name == "isolate" || entry.name == "copy")
      for (const Command& command : entry.commands) shell.perform(command, true);
  stage.draw_frame();
  EXPECT_EQ(state().view.selected.plane, 2);
  EXPECT_TRUE(state().view.isolated);
  EXPECT_EQ(std::string(ImGui::GetClipboardText()), debug::plane_name(*state().run(), 2));
}

// ---- The current node ----

TEST_F(Scene, EveryKindOfStepHasItsRowInTheTree) {
  std::set<planes::EventType> kinds, without;
  const debug::Run& shown = *state().run();
  for (std::int32_t step = 1; step < shown.steps(); ++step) {
    const planes::EventType type = shown.event_at(step)->type;
    if (!kinds.insert(type).second) continue;
    run("step.goto", std::to_string(step));
    if (state().view.selected.node < 0) without.insert(type);
    EXPECT_EQ(look_of(state()).node, -1) << "what the step is about is no choice of the user's";
  }
  EXPECT_GE(kinds.size(), 4u);
  EXPECT_TRUE(without.empty());
}

TEST_F(Scene, IsolationIsNotSaved) {
  play(R"({"key": "Z"})");
  EXPECT_TRUE(look_of(state()).isolated);
  EXPECT_EQ(facts("isolated"), "true");
  const std::filesystem::path path = dir / "session.json";
  run("session.save", path.string());
  run("isolate");
  run("session.open", path.string());
  EXPECT_FALSE(state().view.isolated);
}

// ---- Colors of planes ----

TEST_F(Scene, TemporaryPlanesHaveColorsOfTheirOwn) {
  const debug::Timeline& timeline = state().run()->timeline;
  const std::vector<int> colors = colors_of_planes(state(), *state().run_view());
  std::set<int> lasting, others;
  for (std::int32_t plane = 0; plane < timeline.plane_count(); ++plane)
    (timeline.result_of_plane(plane) > 0 ? lasting : others)
        .insert(colors[static_cast<std::size_t>(plane)]);
  ASSERT_FALSE(others.empty());
  ASSERT_LT(lasting.size(), static_cast<std::size_t>(render::kPlaneColors));
  for (const int color : others) EXPECT_FALSE(lasting.contains(color)) << color;
}

TEST_F(Scene, TruePlanesHaveTheColorsOfMatchingPlanes) {
  run("color.truth");
  const render::StepLook look = look_of(state());
  const std::vector<int> found = state().run_view()->colors.planes->own_colors();
  int detected = 0;
  for (const debug::TruthMatch& match : state().run_view()->score->planes) {
    ASSERT_LE(static_cast<std::size_t>(match.truth), look.color_of_truth.size());
    if (match.iou < debug::kDetectedIou) continue;
    ++detected;
    EXPECT_EQ(look.color_of_truth[static_cast<std::size_t>(match.truth) - 1],
              found[static_cast<std::size_t>(match.found) - 1])
        << match.truth;
  }
  EXPECT_GT(detected, 2);
}

// ---- A and B ----

struct Compared : Scene {
  void SetUp() override {
    Scene::SetUp();
    run("run.pin");
    run("option.set", "profile=paper");
  }
};

TEST_F(Compared, MatchingPlanesShareTheirColorAndNothingIsSelected) {
  EXPECT_EQ(state().view.selected.node, -1);
  EXPECT_EQ(state().view.selected.plane, -1);
  const std::vector<int> colors = colors_of_planes(state(), *state().results.current);
  const debug::Run &a = *state().results.pinned->run, &b = *state().results.current->run;
  ASSERT_EQ(colors.size(), static_cast<std::size_t>(b.timeline.plane_count()));
  const auto plane_of = [](const debug::Run& of, int id) {
    return of.timeline.plane_of_number(id);
  };
  const std::vector<int> colors_a = colors_of_planes(state(), *state().results.pinned);
  int matched = 0;
  for (const debug::PlanePair& pair : state().results.comparison->planes) {
    if (pair.a == 0 || pair.b == 0) continue;
    ++matched;
    const int color = colors[static_cast<std::size_t>(plane_of(b, pair.b))];
    EXPECT_EQ(color, colors_a[static_cast<std::size_t>(plane_of(a, pair.a))]);
  }
  const render::ColoredPlanes& of_b = *state().results.current->colors.planes;
  for (const auto& [one, other] : of_b.image.touching)
    EXPECT_NE(of_b.colors[static_cast<std::size_t>(one) - 1],
              of_b.colors[static_cast<std::size_t>(other) - 1])
        << "also of what A has not";
  EXPECT_GT(matched, 2);
}

TEST_F(Compared, EveryPanelShowsWhichRunIsDisplayed) {
  for (const char* side : {"view3d.side", "image.side", "frames.side"}) EXPECT_TRUE(shown(side));
  EXPECT_EQ(facts("shown"), "\"B\"");
  play(R"({"key": "Space"})");
  EXPECT_EQ(facts("shown"), "\"A\"");
  play(R"({"key": "Space"}, {"key": "Shift+Space"})");
  EXPECT_EQ(facts("shown"), "\"A | B\"");
  run("run.unpin");
  EXPECT_EQ(facts("shown"), "\"\"");
  EXPECT_FALSE(shown("view3d.side"));
  EXPECT_FALSE(state().view.wiper);
}

TEST_F(Compared, TheDividerCanBeDragged) {
  EXPECT_FALSE(shown("wiper"));
  run("run.wiper");
  ASSERT_TRUE(shown("wiper") && shown("wiper.image"));
  const render::Camera before = camera();
  play(R"({"drag": "wiper", "by": [60, 0]})");
  EXPECT_GT(state().view.wiper_at, 0.55);
  EXPECT_TRUE(same_camera(camera(), before)) << "the scene stays where it is";
  play(R"({"drag": "wiper.image", "by": [-40, 0]})");
  EXPECT_LT(state().view.wiper_at, 0.7);
  run("wiper.set", "7");
  EXPECT_EQ(state().view.wiper_at, 1);
}

TEST_F(Compared, TheOtherRunIsShownAtTheSameStep) {
  run("run.wiper");
  EXPECT_EQ(other_look_of(state()).step, state().results.pinned->run->steps());
  run("select.voxel", "100");
  const auto place_of = [](const debug::Run& run, int voxel) {
    return run.subject->prepared.voxels.points.at(static_cast<std::size_t>(voxel));
  };
  EXPECT_LT((place_of(*state().results.pinned->run, other_look_of(state()).voxel) -
             place_of(*state().run(), 100))
                .norm(),
            0.03)
      << "the voxel is a pixel of the other run";
  run("step.goto", "3");
  EXPECT_EQ(other_look_of(state()).step,
            debug::same_step(*state().run(), 3, *state().results.pinned->run));
  for (const debug::PlanePair& pair : state().results.comparison->planes) {
    if (pair.a == 0 || pair.b == 0) continue;
    run("step.last");
    run("select.plane", fmt::format("P{}", pair.b));
    const std::int32_t there = other_look_of(state()).plane;
    ASSERT_GE(there, 0);
    EXPECT_EQ(state().results.pinned->run->timeline.result_of_plane(there), pair.a);
  }
}

}  // namespace
}  // namespace planescope::desktop
