// Tests of the scene, image and picking of a single step.

#include "render/step_scene.hpp"

#include <algorithm>
#include <memory>
#include <set>

#include "core/debug/replay/run.hpp"
#include "gl_fixture.hpp"
#include "render/palette.hpp"
#include "render/scenes.hpp"
#include "support/render_depth.hpp"

namespace planescope::render {
namespace {

/// A depth frame of two steps, run with a trace.
std::shared_ptr<const debug::Run> stairs_run(
    planes::Profile profile = planes::Profile::paper_closest) {
  std::vector<test::Parallelogram> scene = {{{-1, -2, 0}, {4, 0, 0}, {0, 4, 0}}};
  test::add_box(scene, {0.7, -0.3, 0}, {0.8, 0.6, 0.17});
  test::add_box(scene, {1.0, -0.3, 0.17}, {0.5, 0.6, 0.17});
  test::Camera camera;
  Frame frame = test::render_depth(scene, camera);
  frame.gravity = Gravity{test::true_gravity(camera), GravitySource::imu, 1, ""};
  planes::PipelineOptions options;
  options.segment = planes::profile_options(profile);
  const auto classifier = planes::make_pca_classifier();
  return debug::make_run(
      debug::make_subject(std::move(frame), std::nullopt, options, classifier.get()), options);
}

/// The run with only the first `step` events.
debug::Run stopped_at(const debug::Run& run, std::int32_t step) {
  debug::Run stopped = run;
  planes::Trace& trace = stopped.trace;
  trace.events.resize(static_cast<std::size_t>(step));
  const auto later = [&](const auto& record) { return record.change.step > step; };
  std::erase_if(trace.points, later);
  std::erase_if(trace.planes, later);
  for (auto* at : {&trace.queued_at, &trace.visited_at, &trace.decided_at})
    std::erase_if(*at, [&](std::int32_t k) { return k > step; });
  std::vector<planes::OctreeNode>& nodes = stopped.segmentation.octree.nodes;
  nodes.resize(trace.queued_at.size());
  for (std::size_t n = trace.decided_at.size(); n < nodes.size(); ++n) {
    nodes[n].decided = planes::Case::none;
    nodes[n].at_max_depth = nodes[n].by_label = false;
    nodes[n].first_child = -1;
    nodes[n].child_count = 0;
  }
  stopped.segmentation.plane_of.clear();
  stopped.segmentation.planes.clear();
  stopped.facts.clear();
  stopped.timeline = debug::Timeline(stopped.trace, stopped.segmentation);
  return stopped;
}

/// The first step whose event is of this type.
std::int32_t first_step(const debug::Run& run, planes::EventType type) {
  for (std::int32_t k = 1; k <= run.steps(); ++k)
    if (run.event_at(k)->type == type) return k;
  return -1;
}

StepLook look_at(std::int32_t step, ColorBy color_by = ColorBy::cases) {
  StepLook look;
  look.step = step;
  look.color_by = color_by;
  return look;
}

/// The last step, without its highlight.
StepLook at_end(const debug::Run& run, ColorBy color_by = ColorBy::cases) {
  StepLook look = look_at(run.steps(), color_by);
  look.show_current = false;
  return look;
}

const DrawLabel* label(const DrawList& list, const std::string& text) {
  const auto found = std::ranges::find(list.labels, text, &DrawLabel::text);
  return found == list.labels.end() ? nullptr : &*found;
}

/// The scene without names of planes, which show the final id from the start.
DrawList without_names(DrawList list) {
  for (DrawLabel& label : list.labels) label.text = label.text.starts_with('P') ? "P" : label.text;
  return list;
}

TEST(StepScene, OnlyNamesOfPlanesDependOnTheFuture) {
  for (const planes::Profile profile : {planes::Profile::refined, planes::Profile::paper}) {
    const auto run = stairs_run(profile);
    for (int part = 0; part <= 12; ++part) {
      const std::int32_t step = run->steps() * part / 12;
      SCOPED_TRACE(step);
      const auto stopped = stopped_at(*run, step);
      for (const ColorBy by : {ColorBy::cases, ColorBy::planes}) {
        EXPECT_TRUE(without_names(scene_step(*run, look_at(step, by))) ==
                    without_names(scene_step(stopped, look_at(step, by))));
        EXPECT_EQ(image_step(*run, look_at(step, by), Backdrop::depth, 0.5).data,
                  image_step(stopped, look_at(step, by), Backdrop::depth, 0.5).data);
      }
    }
  }
}

/// Whether a color is the expected one or that of its stripes.
bool is_with_stripes(Rgba color, Rgba expected, const StepLook& look) {
  return color == expected ||
         color == mix(expected, theme_colors(look.theme).background_bottom, 0.5);
}

TEST(StepScene, BeforeTheFirstEventAllVoxelsWaitAndMarkedOnesAreHighlighted) {
  const auto run = stairs_run();
  StepLook look = look_at(0);
  const DrawList list = scene_step(*run, look);
  const auto& colors = list.points[0].colors;
  EXPECT_EQ(std::ranges::count(colors, colors[0]), std::ssize(colors));
  EXPECT_TRUE(list.polygons.empty());
  ASSERT_EQ(list.boxes.size(), 1u);
  EXPECT_EQ(picked(list.boxes[0].id).index, 0);
  look.node = static_cast<std::int32_t>(run->octree().nodes.size()) - 1;
  EXPECT_TRUE(scene_step(*run, look) == list) << "a node that is not there yet";
  look.marked = {3, 5};
  const auto marked = scene_step(*run, look).points[0].colors;
  EXPECT_EQ(marked[3], marked[5]);
  EXPECT_FALSE(marked[3] == marked[4]);
}

TEST(StepScene, SettledVoxelsHaveTheColorOfTheirCaseAtTheEnd) {
  const auto run = stairs_run();
  StepLook look = at_end(*run);
  const DrawList list = scene_step(*run, look);
  for (std::size_t v = 0; v < run->subject->voxel_count(); ++v) {
    const std::int32_t node =
        run->timeline.node_of_point(static_cast<std::int32_t>(v), run->steps());
    const Rgba expected = case_color(run->octree().nodes[static_cast<std::size_t>(node)].decided);
    ASSERT_TRUE(is_with_stripes(list.points[0].colors[v], expected, look)) << v;
  }
}

TEST(StepScene, PlanesAppearWhenFoundedInTheirOwnColor) {
  const auto run = stairs_run();
  const std::int32_t step = first_step(*run, planes::EventType::found);
  EXPECT_TRUE(scene_step(*run, look_at(step - 1)).polygons.empty());
  const DrawList list = scene_step(*run, look_at(step));
  ASSERT_EQ(list.polygons.size(), 1u);
  EXPECT_NE(label(list, "P1"), nullptr);
  Rgba fill = list.polygons[0].fill;
  fill.a = 255;
  EXPECT_EQ(fill, plane_color(1));
}

TEST(StepScene, ADividedNodeShowsItsChildrenWithoutTheWholeQueue) {
  const auto run = stairs_run();
  std::int32_t step = first_step(*run, planes::EventType::decide);
  while (run->octree().nodes[static_cast<std::size_t>(run->event_at(step)->node)].first_child < 0)
    ++step;
  StepLook look = look_at(step);
  look.show_queue = look.show_settled = false;
  const planes::OctreeNode& node =
      run->octree().nodes[static_cast<std::size_t>(run->event_at(step)->node)];
  std::set<std::int32_t> boxes;
  for (const DrawBox& box : scene_step(*run, look).boxes) boxes.insert(picked(box.id).index);
  for (std::int32_t child = 0; child < node.child_count; ++child)
    EXPECT_TRUE(boxes.contains(node.first_child + child)) << child;
  look.show_current = false;
  EXPECT_TRUE(scene_step(*run, look).boxes.empty());
}

TEST(StepScene, PointsNamesAndNormalsAreSeparateLayers) {
  const auto run = stairs_run();
  StepLook look = at_end(*run);
  const DrawList all = scene_step(*run, look);
  EXPECT_NE(label(all, "P1"), nullptr);
  EXPECT_FALSE(all.arrows.empty());
  look.show_normals = false;
  EXPECT_TRUE(scene_step(*run, look).arrows.empty());
  EXPECT_NE(label(scene_step(*run, look), "P1"), nullptr);
  look.show_names = false;
  EXPECT_EQ(label(scene_step(*run, look), "P1"), nullptr);
  look.plane = 0;
  EXPECT_NE(label(scene_step(*run, look), "P1"), nullptr) << "selected";
  look.show_points = false;
  EXPECT_TRUE(scene_step(*run, look).points.empty());
  EXPECT_FALSE(scene_step(*run, look).polygons.empty());
}

/// An analysis of the run's planes: all have the same shape; only the first is steppable.
std::shared_ptr<const PlaneScene> known_planes(const debug::Run& run) {
  auto scene = std::make_shared<PlaneScene>();
  const std::size_t count = run.segmentation.planes.size();
  const std::vector<Vec3f> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const PlaneShape shape = {
      .rings = {corners[0], corners[1]}, .unknown = {}, .corners = corners, .triangles = {0, 1, 2}};
  scene->shapes.assign(count, shape);
  scene->foot.assign(count, {.rings = {corners[0], corners[1]}, .pieces = {corners}});
  scene->steppable.assign(count, false);
  scene->steppable.at(0) = true;
  scene->complete = true;
  planes::Flight flight;
  flight.steps.resize(2);
  scene->stairs.flights = {flight};
  return scene;
}

bool legend_says(const DrawList& list, const std::string& text) {
  return std::ranges::any_of(list.legend, [&](const LegendEntry& entry) {
    return entry.text.find(text) != std::string::npos;
  });
}

TEST(StepScene, FinishedPlanesAreDrawnByOutlineAndGrowingOnesByHull) {
  const auto run = stairs_run();
  StepLook look = at_end(*run);
  look.planes = known_planes(*run);
  const DrawList list = scene_step(*run, look);
  ASSERT_EQ(list.polygons.size(), run->segmentation.planes.size());
  for (const DrawPolygon& polygon : list.polygons) EXPECT_EQ(polygon.triangles.size(), 3u);
  look.step -= 1;
  const DrawList before = scene_step(*run, look);
  ASSERT_FALSE(before.polygons.empty());
  for (const DrawPolygon& polygon : before.polygons) {
    EXPECT_TRUE(polygon.triangles.empty());
    EXPECT_EQ(polygon.id, 0u) << "not picked";
    EXPECT_LT(polygon.fill.a, list.polygons[0].fill.a) << "fainter";
  }
}

TEST(StepScene, FootSpaceAndStairsAreSeparateLayers) {
  const auto run = stairs_run();
  StepLook look = look_at(run->steps());
  look.planes = known_planes(*run);
  const DrawList plain = scene_step(*run, look);
  look.show_foot = true;
  const DrawList foot = scene_step(*run, look);
  EXPECT_EQ(foot.polygons.size(), plain.polygons.size() + look.planes->foot.size());
  look.show_foot = false;
  look.show_stairs = true;
  const DrawList stairs = scene_step(*run, look);
  EXPECT_NE(label(stairs, "rise 0 mm"), nullptr);
  EXPECT_EQ(label(stairs, "P1"), nullptr) << "names would stand among them";
  look.step = 0;
  EXPECT_EQ(label(scene_step(*run, look), "rise 0 mm"), nullptr) << "of finished planes alone";
  PlaneScene flat = *look.planes;
  flat.stairs = {};
  look.planes = std::make_shared<const PlaneScene>(flat);
  look.step = run->steps();
  const DrawList none = scene_step(*run, look);
  EXPECT_NE(label(none, "P1"), nullptr);
  EXPECT_TRUE(legend_says(none, "no stairs, kerb, or ramp"));
}

TEST(StepScene, VoxelsShowWhetherTheirPlaneIsSteppable) {
  const auto run = stairs_run();
  StepLook look = at_end(*run, ColorBy::steppable);
  EXPECT_TRUE(legend_says(scene_step(*run, look), "computing …"));
  look.planes = known_planes(*run);
  const DrawList list = scene_step(*run, look);
  for (std::size_t v = 0; v < run->subject->voxel_count(); ++v) {
    const std::int32_t id = run->segmentation.plane_of[v];
    const Rgba expected = id > 0 ? verdict_color(id == 1) : leftover_color();
    ASSERT_TRUE(is_with_stripes(list.points[0].colors[v], expected, look)) << v;
  }
  EXPECT_TRUE(legend_says(list, "steppable  1"));
  look.step = 1;
  EXPECT_TRUE(legend_says(scene_step(*run, look), "at the last step"));
}

TEST(StepScene, WithoutAFootTheLegendExplainsHowToSetOne) {
  const auto run = stairs_run();
  StepLook look = look_at(run->steps());
  PlaneScene none = *known_planes(*run);
  none.foot.clear();
  none.steppable.clear();
  look.planes = std::make_shared<const PlaneScene>(none);
  EXPECT_FALSE(legend_says(scene_step(*run, look), "foot_radius_m"));
  look.show_foot = true;
  EXPECT_TRUE(legend_says(scene_step(*run, look), "foot_radius_m"));
  look.color_by = ColorBy::steppable;
  EXPECT_TRUE(legend_says(scene_step(*run, look), "foot_radius_m"));
}

TEST(StepScene, TheSelectionIsNamedAndKeepsItsColorWhileTheRestRecedes) {
  const auto run = stairs_run();
  StepLook look = at_end(*run);
  const DrawList plain = scene_step(*run, look);
  look.node = run->octree().nodes[0].first_child;
  look.plane = 0;
  look.voxel = 17;
  const DrawList list = scene_step(*run, look);
  for (const char* name : {"P1", "voxel 17"}) {
    ASSERT_NE(label(list, name), nullptr) << name;
    EXPECT_EQ(label(list, name)->color, label(list, "voxel 17")->color);
  }
  EXPECT_NE(label(list, "node " + std::to_string(look.node)), nullptr);
  EXPECT_GT(list.lines.size(), plain.lines.size());
  const planes::OctreeNode& node = run->octree().nodes[static_cast<std::size_t>(look.node)];
  std::set<std::uint32_t> concerned = {17};
  for (std::uint32_t i = node.begin; i < node.end; ++i) concerned.insert(run->octree().order[i]);
  for (std::uint32_t v = 0; v < run->subject->voxel_count(); ++v) {
    if (v == 17) continue;
    const bool is_concerned =
        concerned.contains(v) ||
        run->timeline.point_at(static_cast<std::int32_t>(v), look.step).plane == 0;
    EXPECT_EQ(list.points[0].colors[v] == plain.points[0].colors[v], is_concerned) << v;
  }
  look.node = 0;  // the root, so that nothing recedes
  look.voxel = look.plane = -1;
  EXPECT_EQ(scene_step(*run, look).points[0].colors, plain.points[0].colors);
}

TEST(StepScene, TheNodeOfEveryKindOfStepIsHighlighted) {
  const auto run = stairs_run();
  int kinds = 0;
  for (int type = 0; type <= static_cast<int>(planes::EventType::refine); ++type) {
    const std::int32_t step = first_step(*run, static_cast<planes::EventType>(type));
    const std::int32_t node = step > 0 ? debug::node_at_step(*run, step) : -1;
    if (node <= 0) continue;
    ++kinds;
    StepLook look = look_at(step);
    const auto lit = scene_step(*run, look).points[0].colors;
    look.show_current = false;
    const auto plain = scene_step(*run, look).points[0].colors;
    const auto light = [](Rgba color) { return color.r + color.g + color.b; };
    const planes::TraceEvent& event = *run->event_at(step);
    if (event.node >= 0 || event.point >= 0) {
      const planes::OctreeNode& of = run->octree().nodes[static_cast<std::size_t>(node)];
      const std::uint32_t inside = run->octree().order[of.begin];
      EXPECT_GT(light(lit[inside]), light(plain[inside])) << "event type " << type;
    }
    std::size_t receded = 0;
    for (std::size_t v = 0; v < lit.size(); ++v) {
      if (light(lit[v]) >= light(plain[v])) continue;
      ++receded;
      const auto plane = run->timeline.point_at(static_cast<std::int32_t>(v), step).plane;
      ASSERT_FALSE(plane >= 0 && plane == event.plane) << "event type " << type;
    }
    EXPECT_GT(receded, 0u) << "event type " << type;
  }
  EXPECT_GE(kinds, 3);
}

TEST(StepScene, OnlyTheIsolatedPlaneIsDrawn) {
  const auto run = stairs_run();
  StepLook look = at_end(*run, ColorBy::planes);
  look.isolated = true;
  EXPECT_EQ(scene_step(*run, look).points[0].positions.size(), run->subject->voxel_count())
      << "nothing is selected";
  look.plane = 0;
  const DrawList list = scene_step(*run, look);
  EXPECT_EQ(list.points[0].positions.size(), plane_points(*run, 0, look.step).size());
  EXPECT_EQ(list.points[0].ids.size(), list.points[0].positions.size());
  for (const DrawPolygon& polygon : list.polygons)
    EXPECT_TRUE(polygon.id == 0 || picked(polygon.id).index == 0);
  const Image8 alone = image_step(*run, look, Backdrop::depth, 0.5);
  look.isolated = false;
  const Image8 among = image_step(*run, look, Backdrop::depth, 0.5);
  for (std::size_t i = 0; i < alone.pixels(); ++i)
    if (const std::uint32_t voxel = run->subject->voxel_of_source(i);
        voxel != planes::kNoVoxel &&
        run->timeline.point_at(static_cast<std::int32_t>(voxel), look.step).plane > 0) {
      ASSERT_LE(alone.data[3 * i], std::max<int>(among.data[3 * i], 40)) << i;
    }
}

TEST(StepScene, PlanesHaveTheGivenColors) {
  const auto run = stairs_run();
  StepLook look = at_end(*run, ColorBy::planes);
  look.color_of_plane.assign(static_cast<std::size_t>(run->timeline.plane_count()), 7);
  const auto colors = scene_step(*run, look).points[0].colors;
  for (std::size_t v = 0; v < colors.size(); ++v)
    if (run->timeline.point_at(static_cast<std::int32_t>(v), look.step).plane >= 0) {
      ASSERT_EQ(colors[v], plane_color(7));
    }
}

bool differs(const Image8& a, const Image8& b, std::size_t pixel) {
  return !std::equal(&a.data[3 * pixel], &a.data[3 * pixel] + 3, &b.data[3 * pixel]);
}

TEST(StepImage, PaintsMeasuredPixelsOnly) {
  const auto run = stairs_run();
  const Image8 before = image_backdrop(*run->subject, Backdrop::depth);
  const Image8 after =
      image_step(*run, look_at(run->steps(), ColorBy::planes), Backdrop::depth, 0.5);
  int painted = 0;
  for (std::size_t i = 0; i < before.pixels(); ++i) {
    const bool changed = differs(before, after, i);
    painted += changed;
    if (changed) {
      ASSERT_NE(run->subject->voxel_of_source(i), planes::kNoVoxel) << i;
    }
  }
  EXPECT_GT(painted, 10'000);
}

TEST(StepImage, SelectedNodeIsVisibleWithoutAnOverlay) {
  const auto run = stairs_run();
  StepLook look = look_at(run->steps());
  look.show_planes = look.show_current = false;
  look.node = run->octree().nodes[0].first_child;
  const Image8 before = image_backdrop(*run->subject, Backdrop::depth);
  const Image8 after = image_step(*run, look, Backdrop::depth, 0);
  const planes::OctreeNode& node = run->octree().nodes[static_cast<std::size_t>(look.node)];
  std::set<std::uint32_t> inside(run->octree().order.begin() + node.begin,
                                 run->octree().order.begin() + node.end);
  std::size_t changed = 0, kept = 0;  // number of pixels inside
  for (std::size_t i = 0; i < before.pixels(); ++i) {
    const std::uint32_t voxel = run->subject->voxel_of_source(i);
    if (voxel == planes::kNoVoxel) continue;
    if (inside.count(voxel) == 0)
      ASSERT_FALSE(differs(before, after, i)) << i;
    else
      ++(differs(before, after, i) ? changed : kept);
  }
  EXPECT_GT(changed, 100u);
  EXPECT_LE(kept, changed / 100) << "a pixel may have the color that marks it";
}

struct StepPicking : GlTest {};

TEST_F(StepPicking, IdsIdentifyVoxelsNodesAndPlanes) {
  const auto run = stairs_run();
  StepLook look = look_at(run->steps());
  const DrawList list = scene_step(*run, look);
  const Camera camera = frame_camera(run->subject->prepared, run->segmentation, 1.5);
  const auto ids = renderer().render_ids(list, camera, 600, 400);
  std::set<std::int32_t> voxels, nodes, planes;
  for (const std::uint32_t id : ids.data) {
    const Picked what = picked(id);
    if (what.kind == Picked::Kind::voxel) voxels.insert(what.index);
    if (what.kind == Picked::Kind::node) nodes.insert(what.index);
    if (what.kind == Picked::Kind::plane) planes.insert(what.index);
  }
  EXPECT_GT(voxels.size(), run->subject->voxel_count() / 2);
  EXPECT_LT(*voxels.rbegin(), static_cast<std::int32_t>(run->subject->voxel_count()));
  EXPECT_FALSE(nodes.empty() && planes.empty());
  EXPECT_EQ(picked(0).kind, Picked::Kind::nothing);
}

TEST_F(StepPicking, TheNearestObjectIsPickedButPointsBeforeTheirBoxAndPlane) {
  const auto run = stairs_run();
  StepLook look = look_at(run->steps());
  look.show_queue = false;
  const DrawList list = scene_step(*run, look);
  const Camera camera = frame_camera(run->subject->prepared, run->segmentation, 1.5);
  DrawList bare = list;
  bare.boxes.clear();
  bare.polygons.clear();
  const auto all = renderer().render_ids(list, camera, 300, 200);
  const auto voxels = renderer().render_ids(bare, camera, 300, 200);
  std::size_t points = 0, kept = 0;
  for (std::size_t i = 0; i < all.data.size(); ++i) {
    if (voxels.data[i] == 0) continue;
    ++points;
    kept += all.data[i] == voxels.data[i];
    const Picked what = picked(all.data[i]);
    if (what.kind == Picked::Kind::plane) {
      ASSERT_NE(run->timeline.point_at(picked(voxels.data[i]).index, look.step).plane, what.index);
    }
  }
  EXPECT_GT(kept, points * 9 / 10);
}

}  // namespace
}  // namespace planescope::render
