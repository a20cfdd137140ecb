// Tests of values and colors at a step, and of the label scene.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/labels/edit/operations.hpp"
#include "core/labels/edit/selection.hpp"
#include "render/palette.hpp"
#include "render/step_scene.hpp"
#include "support/box_scene.hpp"
#include "support/label_drafts.hpp"
#include "support/render_depth.hpp"

namespace planescope::render {
namespace {

/// A level floor 1 m below a camera that looks down at it, and a step of 20 cm on it.
std::shared_ptr<const debug::Run> step_run(bool knows_gravity = true) {
  std::vector<test::Parallelogram> scene = {{{-1, -2, 0}, {4, 0, 0}, {0, 4, 0}}};
  test::add_box(scene, {0.7, -0.5, 0}, {0.8, 1, 0.2});
  test::Camera camera;
  Frame frame = test::render_depth(scene, camera);
  if (knows_gravity) frame.gravity = Gravity{test::true_gravity(camera), GravitySource::imu, 1, ""};
  planes::PipelineOptions options;
  options.segment = planes::profile_options(planes::Profile::refined);
  if (!knows_gravity) options.gravity.mode = planes::GravityMode::none;
  const auto classifier = planes::make_pca_classifier();
  return debug::make_run(
      debug::make_subject(std::move(frame), std::nullopt, options, classifier.get()), options);
}

StepLook look_by(const debug::Run& run, ColorBy by) {
  StepLook look;
  look.step = run.steps();
  look.color_by = by;
  look.show_current = false;
  return look;
}

std::vector<float> values_of(const debug::Run& run, const StepLook& look) {
  return voxel_values(step_state(run, look));
}

TEST(StepState, OfADepthImageShowsJoinedPlanes) {
  const auto run = test::box_run();
  StepLook look = look_by(*run, ColorBy::planes);
  for (const std::int32_t plane : step_state(*run, look).plane_of)
    ASSERT_TRUE(plane == StepState::kLeftover || run->timeline.result_of_plane(plane) > 0);
  for (const int tenths : {0, 5, 9}) {
    look.step = run->steps() * tenths / 10;
    std::size_t in_planes = 0;
    for (const std::int32_t plane : step_state(*run, look).plane_of) {
      if (plane < 0) continue;
      ++in_planes;
      ASSERT_TRUE(run->timeline.plane_at(plane, look.step)->alive) << "at step " << look.step;
    }
    EXPECT_EQ(in_planes > 0, tenths > 0);
  }
}

TEST(StepValues, DepthIsTheCamerasMeasurement) {
  const auto run = step_run();
  const std::vector<float> values = values_of(*run, look_by(*run, ColorBy::depth));
  const Image16& depth = run->subject->frame.depth;
  int compared = 0;
  for (std::size_t pixel = 0; pixel < depth.pixels(); pixel += 101) {
    const std::uint32_t voxel = run->subject->voxel_of_source(pixel);
    if (voxel == planes::kNoVoxel) continue;
    const double measured_m = depth.data[pixel] * run->subject->frame.depth_unit_m;
    EXPECT_NEAR(values[voxel], measured_m, 2 * run->subject->prepared.voxels.size_m + 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

TEST(StepValues, HeightShowsTheRiseOfAStep) {
  const auto run = step_run();
  std::vector<float> values = values_of(*run, look_by(*run, ColorBy::height));
  const auto [low, high] = std::ranges::minmax(values);
  EXPECT_NEAR(high - low, 0.2, 0.02);
  EXPECT_EQ(why_no_values(*run, look_by(*run, ColorBy::height)), "");
}

TEST(StepValues, HeightIsUnknownWithoutGravity) {
  const auto run = step_run(false);
  const StepLook look = look_by(*run, ColorBy::height);
  EXPECT_NE(why_no_values(*run, look).find("gravity"), std::string::npos);
  for (const float value : values_of(*run, look)) ASSERT_TRUE(std::isnan(value));
  const StepState state = step_state(*run, look);
  const Rgba waiting = highlight_colors(look.theme).waiting;
  for (const Rgba color : voxel_colors(state)) ASSERT_EQ(color, waiting);
}

TEST(StepColors, DeadEndsAreStripedAndOtherCasesAreNot) {
  const auto run = step_run();
  const StepLook look = look_by(*run, ColorBy::cases);
  const StepState state = step_state(*run, look);
  const std::vector<Rgba> colors = voxel_colors(state);
  // number of voxels in the case's color, and in others
  std::map<planes::Case, std::array<int, 2>> count;
  for (std::size_t v = 0; v < colors.size(); ++v) {
    const planes::Case decided = state.case_of[v];
    if (decided != planes::Case::none) ++count[decided][colors[v] == case_color(decided) ? 0 : 1];
  }
  ASSERT_GT(count[planes::Case::II][0], 0);
  EXPECT_GT(count[planes::Case::II][1], 0);
  EXPECT_EQ(count[planes::Case::IV][1], 0);
  EXPECT_GT(count[planes::Case::IV][0], 0);
}

TEST(StepValues, RmsIsThatOfThePointsPlane) {
  const auto run = step_run();
  const StepLook look = look_by(*run, ColorBy::rms);
  const StepState state = step_state(*run, look);
  const std::vector<float> values = voxel_values(state);
  int in_planes = 0;
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (state.plane_of[v] < 0) continue;
    EXPECT_FLOAT_EQ(
        values[v],
        static_cast<float>(run->timeline.plane_at(state.plane_of[v], look.step)->fit.rms_m()));
    ++in_planes;
  }
  EXPECT_GT(in_planes, 100);
  StepLook before = look;
  before.step = 0;
  EXPECT_NE(why_no_values(*run, before), "");
}

TEST(StepValues, DistanceIsSignedAndToTheSelectedPlane) {
  const auto run = step_run();
  StepLook look = look_by(*run, ColorBy::distance);
  const StepState state = step_state(*run, look);
  // The lower of the level planes is the floor; the step is in front of it.
  std::int32_t floor = -1;
  double lowest = 1e9;
  for (std::int32_t plane = 0; plane < run->timeline.plane_count(); ++plane) {
    if (run->timeline.result_of_plane(plane) == 0) continue;
    const PlaneFit& fit = run->timeline.plane_at(plane, look.step)->fit;
    if (run->timeline.label_of_plane(plane) == Label::h && fit.centroid.z() < lowest) {
      lowest = fit.centroid.z();
      floor = plane;
    }
  }
  ASSERT_GE(floor, 0);
  for (const float value : values_of(*run, look))  // each to its own plane
    EXPECT_FALSE(std::abs(value) > 0.05);          // or NaN
  look.plane = floor;
  const std::vector<float> values = values_of(*run, look);
  EXPECT_NEAR(*std::ranges::max_element(values), 0.2, 0.02);
  EXPECT_GT(*std::ranges::min_element(values), -0.05);
  EXPECT_NE(color_scale(*run, look).what.find(debug::plane_name(*run, floor)), std::string::npos);
  // Beyond the scale and not on the plane: no color of the scale.
  const std::vector<Rgba> colors = voxel_colors(state);
  const auto top = static_cast<std::size_t>(std::ranges::max_element(values) - values.begin());
  EXPECT_EQ(colors[top], highlight_colors(look.theme).waiting);
}

TEST(StepValues, TheRangeIsTheSameAtEveryStepAndIgnoresOutliers) {
  const auto run = step_run();
  for (const ColorBy by : {ColorBy::depth, ColorBy::height, ColorBy::rms, ColorBy::distance}) {
    StepLook look = look_by(*run, by);
    const ColorScale at_end = color_scale(*run, look);
    look.step = run->steps() / 2;
    EXPECT_EQ(color_scale(*run, look), at_end);
    look.range = ValueRange{0.1, 0.4};
    EXPECT_EQ(color_scale(*run, look).range, (ValueRange{0.1, 0.4}));
  }
  std::vector<float> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5F + 0.001F * static_cast<float>(i);
  values[0] = 40;  // an outlier
  values[1] = std::nanf("");
  const ValueRange range = robust_range(values);
  EXPECT_NEAR(range.low_m, 0.5, 0.051);
  EXPECT_NEAR(range.high_m, 1.5, 0.051);
}

// ---- Label scene: colors, highlights, hidden parts ----

/// A wall of 40 x 30 pixels, one of them unmeasured; P1 on its left half, P2 at its right edge.
struct LabelScene : testing::Test {
  labels::LabelGrid grid;
  std::vector<Vec3f> world;
  std::shared_ptr<FrameLabels> labels;

  void SetUp() override {
    Frame frame;
    frame.depth = Image16(40, 30, 1, 1000);
    frame.depth.at(0, 0) = 0;
    frame.depth_unit_m = 0.001;
    frame.intrinsics.width = 40;
    frame.intrinsics.height = 30;
    frame.intrinsics.fx = frame.intrinsics.fy = 40;
    frame.intrinsics.cx = 20;
    frame.intrinsics.cy = 15;
    Gravity gravity;
    gravity.direction = Vec3d::UnitY();
    grid = labels::make_label_grid(frame, gravity);
    world = grid.points;
    labels::PixelSet left, right;
    for (std::uint32_t i = 0; i < 40 * 30; ++i) (i % 40 < 20 ? left : right).push_back(i);
    std::erase_if(right, [](std::uint32_t i) { return i % 40 < 35; });
    labels = std::make_shared<FrameLabels>(labels::empty_labels(grid, "hash"));
    *labels = labels::painted(*labels, grid, left, {.plane = 1}, labels::PaintMode::over);
    *labels = labels::painted(*labels, grid, right, {.plane = 2}, labels::PaintMode::over);
  }
  LabelLook look() const {
    LabelLook look;
    look.labels = labels;
    return look;
  }
  DrawPoints points() const {
    DrawPoints points = label_points(grid, world, labels::shown_pixels(*labels));
    color_label_points(points, label_ground(grid, Backdrop::color), grid, look());
    return points;
  }
  std::vector<Rgba> tints(const LabelLook& of) const { return label_tints(grid, of, 1); }
  static std::size_t at(int u, int v) { return static_cast<std::size_t>(v * 40 + u); }
};

TEST_F(LabelScene, DrawsEveryMeasuredPointWithItsPixelId) {
  const DrawPoints drawn = points();
  ASSERT_EQ(drawn.positions.size(), grid.measured_count);
  ASSERT_EQ(drawn.colors.size(), drawn.positions.size());
  for (std::size_t k = 0; k < drawn.ids.size(); ++k)
    EXPECT_EQ(drawn.positions[k], world[drawn.ids[k] - 1]);
}

TEST_F(LabelScene, SkipsHiddenPlanes) {
  *labels = labels::edited(*labels, grid, labels::set_flag, 2, labels::PlaneFlag::hidden, true);
  EXPECT_EQ(points().positions.size(),
            grid.measured_count - labels::pixels_of_plane(*labels, 2).size());
  EXPECT_EQ(tints(look())[at(38, 5)].a, 0);
  EXPECT_EQ(label_places(*labels, grid).size(), 1u);
}

TEST_F(LabelScene, DistinguishesPlanesAndHighlightsTheActiveOne) {
  LabelLook active = look();
  active.plane = 1;
  const std::vector<Rgba> tint = tints(active);
  EXPECT_EQ(tint[at(25, 5)].a, 0) << "unlabelled";
  EXPECT_EQ(tint[at(5, 5)].r, plane_color(1).r);
  EXPECT_EQ(tint[at(38, 5)].r, plane_color(2).r);
  EXPECT_GT(tint[at(5, 5)].a, tint[at(38, 5)].a);
}

TEST_F(LabelScene, ShowsClassesInTheirColors) {
  *labels = labels::edited(*labels, grid, labels::set_class, 1, Label::h);
  LabelLook classes = look();
  classes.show_class = true;
  EXPECT_EQ(tints(classes)[at(5, 5)].b, label_color(Label::h).b);
  EXPECT_EQ(tints(classes)[at(38, 5)].b, label_color(Label::v).b);
}

TEST_F(LabelScene, APreviewIsVisibleOverFaintLabels) {
  LabelLook shown = look();
  const labels::PixelSet preview{static_cast<std::uint32_t>(at(5, 5)), 99999};
  shown.preview = preview;
  const std::vector<Rgba> faint = label_tints(grid, shown, 0);
  EXPECT_GT(faint[at(5, 5)].a, 150);
  EXPECT_EQ(faint[at(6, 5)].a, 0);
  const Rgba adds = faint[at(5, 5)];
  shown.preview_takes = true;
  EXPECT_NE(label_tints(grid, shown, 0)[at(5, 5)], adds);
}

TEST_F(LabelScene, PaintsOutlinesBetweenPlanesButNotAroundHoles) {
  Image8 picture = label_ground(grid, Backdrop::color);
  const Image8 ground = picture;
  paint_labels(picture, grid, look(), 0);
  EXPECT_NE(picture.at(19, 5), ground.at(19, 5));
  EXPECT_EQ(picture.at(0, 1), ground.at(0, 1));
  EXPECT_EQ(picture.at(10, 5), ground.at(10, 5));
}

TEST_F(LabelScene, NamesAreWellInsideTheirPlanes) {
  const std::vector<LabelPlace> places = label_places(*labels, grid);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(static_cast<double>(places[0].pixel % 40), 10, 5);
  EXPECT_NEAR(static_cast<double>(places[1].pixel % 40), 37, 1);
}

}  // namespace
}  // namespace planescope::render
