// Tests of the label audit: findings, clutter and statistics.

#include "core/labels/review/audit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "core/labels/model/pixel_sets.hpp"
#include "small_frames.hpp"
#include "support/render_depth.hpp"

namespace planescope::labels {
namespace {

/// A floor and a wall, seen with a D435's noise and labeled correctly.
class AuditTest : public testing::Test {
 protected:
  void SetUp() override { look(0.06); }

  void look(double noise_px, double wall_m = 1.6) {
    const std::vector<test::Parallelogram> scene = {{{0.2, -3, 0}, {wall_m - 0.2, 0, 0}, {0, 6, 0}},
                                                    {{wall_m, -3, 0}, {0, 6, 0}, {0, 0, 3}}};
    test::Camera camera;
    camera.noise_px = noise_px;
    const Frame frame = test::render_depth(scene, camera);
    Gravity gravity;
    gravity.direction = test::true_gravity(camera);
    grid = make_label_grid(frame, gravity);
    labels = empty_labels(grid, std::string(64, 'a'));
    const Pose T_world_sensor = test::T_world_camera(camera);
    for (std::size_t i = 0; i < grid.pixels(); ++i) {
      if (!grid.measured[i]) continue;
      const Vec3d p = T_world_sensor * grid.points[i].cast<double>();
      const bool floor = wall_m - p.x() > p.z();
      set(i, floor ? 1 : 2, floor ? 1 : 2);
    }
    labels.planes = {{.id = 1, .label = Label::h}, {.id = 2, .label = Label::v}};
    refit_planes(labels, grid);
  }

  void set(std::size_t pixel, int plane, int hv) {
    labels.plane.data[pixel] = static_cast<std::uint16_t>(plane);
    labels.hv.data[pixel] = static_cast<std::uint8_t>(hv);
  }
  template <typename Change>
  void in_box(int x1, int y1, int x2, int y2, const Change& change) {
    for (int y = y1; y < y2; ++y)
      for (int x = x1; x < x2; ++x)
        if (const std::size_t i = y * grid.width + x; grid.measured[i]) change(i);
  }

  /// Expects a single finding and returns it.
  Finding only() {
    const auto findings = audit_labels(labels, grid);
    EXPECT_EQ(findings.size(), 1u);
    for (const Finding& finding : findings)
      EXPECT_TRUE(finding.pixels.empty() ||
                  std::ranges::binary_search(finding.pixels, finding.pixel));
    return findings.empty() ? Finding{} : findings[0];
  }

  LabelGrid grid;
  FrameLabels labels;
};

TEST_F(AuditTest, GoodLabelsHaveNoFindingsHoweverNoisyTheDepth) {
  for (const double noise_px : {0.0, 0.06, 0.15}) {
    for (const double wall_m : {1.6, 3.0}) {
      look(noise_px, wall_m);
      for (const Finding& finding : audit_labels(labels, grid))
        ADD_FAILURE() << noise_px << " " << wall_m << ": " << finding.text;
    }
  }
}

TEST_F(AuditTest, APlaneOverACornerDoesNotFit) {
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (labels.plane.data[i] == 2) set(i, 1, 1);
  labels.planes.pop_back();
  refit_planes(labels, grid);
  const auto findings = audit_labels(labels, grid);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].kind, FindingKind::rms);
  EXPECT_EQ(findings[0].plane, 1);
  EXPECT_GT(findings[0].value, 50);
  EXPECT_TRUE(findings[0].text.starts_with("P1: RMS ")) << findings[0].text;
  EXPECT_NE(findings[0].text.find("mm; expected at most"), std::string::npos);
}

TEST_F(AuditTest, AStrokeOntoAnotherSurfaceIsAmongTheOutliers) {
  in_box(240, 0, 400, 40, [&](std::size_t i) { set(i, 1, 1); });  // of the wall
  const auto findings = audit_labels(labels, grid);
  const auto outliers = std::ranges::find(findings, FindingKind::outliers, &Finding::kind);
  ASSERT_NE(outliers, findings.end());
  EXPECT_EQ(outliers->plane, 1);
  EXPECT_NEAR(static_cast<double>(outliers->pixels.size()), 160 * 40, 50);
  EXPECT_GE(outliers->pixel % 640, 240u);
  EXPECT_LT(outliers->pixel / 640, 40u);
}

TEST_F(AuditTest, SeparatePartsAreCountedOnlyBeyondTheGap) {
  in_box(0, 0, 640, 480, [&](std::size_t i) {
    if (labels.plane.data[i] == 2) set(i, 0, kHvIgnore);
  });
  in_box(100, 0, 150, 480, [&](std::size_t i) {
    if (labels.plane.data[i] == 1) set(i, 0, kHvIgnore);
  });
  refit_planes(labels, grid);
  const Finding finding = only();
  EXPECT_EQ(finding.kind, FindingKind::parts);
  EXPECT_EQ(finding.value, 2);
  EXPECT_LT(finding.pixel % 640, 100u);  // in the smaller part
  AuditOptions options;
  options.gap_px = 60;
  EXPECT_TRUE(audit_labels(labels, grid, options).empty());
}

TEST_F(AuditTest, APlaneOfAFewPixelsIsTiny) {
  in_box(300, 400, 312, 412, [&](std::size_t i) { set(i, 7, 1); });
  labels.planes.push_back({.id = 7, .label = Label::h});
  refit_planes(labels, grid);
  const Finding finding = only();
  EXPECT_EQ(finding.kind, FindingKind::tiny);
  EXPECT_EQ(finding.plane, 7);
  EXPECT_LT(finding.value, finding.limit);
  EXPECT_EQ(finding.pixels.size(), 144u);
}

TEST_F(AuditTest, AClassThatContradictsTheTiltIsReported) {
  labels.planes[0].label = Label::v;
  Finding finding = only();
  EXPECT_EQ(finding.kind, FindingKind::class_normal);
  EXPECT_NE(finding.text.find("P1: labeled v and tilted"), std::string::npos) << finding.text;
  labels.gravity.source = GravitySource::none;
  EXPECT_TRUE(audit_labels(labels, grid).empty()) << "nobody knows what is level";
  labels.gravity.source = GravitySource::picked;
  labels.planes[0].label = Label::unknown;
  EXPECT_TRUE(audit_labels(labels, grid).empty());
}

TEST_F(AuditTest, AnUnlabeledRegionIsReportedAndStripsAreNot) {
  for (int x = 0; x + 3 <= 640; x += 9)
    in_box(x, 0, x + 3, 480, [&](std::size_t i) { set(i, 0, 0); });
  auto findings = audit_labels(labels, grid);
  std::erase_if(findings, [](const Finding& f) { return f.kind != FindingKind::unlabeled; });
  EXPECT_TRUE(findings.empty());

  look(0.06);
  in_box(200, 300, 400, 400, [&](std::size_t i) { set(i, 0, 0); });
  const Finding finding = only();
  EXPECT_EQ(finding.kind, FindingKind::unlabeled);
  EXPECT_EQ(finding.plane, 0);
  EXPECT_NEAR(finding.pixel % 640, 300, 60);
  EXPECT_NEAR(static_cast<int>(finding.pixel / 640), 350, 20);

  in_box(200, 300, 400, 400, [&](std::size_t i) { set(i, kPlaneIgnore, kHvIgnore); });
  EXPECT_TRUE(audit_labels(labels, grid).empty());
}

TEST_F(AuditTest, LabelsOfAnotherCameraAreReported) {
  labels.intrinsics.fx *= 1.5;
  labels.depth_unit_m = 2 * grid.depth_unit_m;
  const auto findings = audit_labels(labels, grid);
  ASSERT_GE(findings.size(), 2u);
  for (const Finding& finding : std::span(findings).first(2)) {
    EXPECT_EQ(finding.kind, FindingKind::camera);
    EXPECT_FALSE(is_hint(finding.kind));
    EXPECT_NE(finding.text.find("drawn with"), std::string::npos) << finding.text;
  }
  labels.intrinsics = grid.intrinsics;
  labels.depth_unit_m = 0;  // an older file without this field
  EXPECT_TRUE(audit_labels(labels, grid).empty());
}

TEST_F(AuditTest, ARegionThatAReviewerKeptUnlabeledIsNotReported) {
  in_box(200, 300, 400, 400, [&](std::size_t i) { set(i, 0, 0); });
  const Finding finding = only();
  FrameLabels decided = labels;
  ReviewNote note;
  note.kind = DisagreementKind::invented;
  note.pixel = finding.pixel;
  note.pixels = static_cast<std::uint32_t>(finding.pixels.size());
  note.decision = ReviewDecision::keep;
  decided.review.push_back(note);
  EXPECT_TRUE(audit_labels(decided, grid).empty());
  labels.review_state = "reviewed";
  EXPECT_TRUE(audit_labels(labels, grid).empty());
}

TEST(Clutter, IsNotReportedUnlessOnePlaneContainsMostOfIt) {
  // A pile of objects in front of a wall: steps of 5 cm from one to the next.
  const auto depth = [](bool heap) {
    return [heap](int u, int v) {
      const bool inside = u >= 30 && u < 90 && v >= 20 && v < 80;
      if (!inside) return 1.0;
      return heap ? 0.9 - 0.02 * ((u / 10 * 7 + v / 10 * 5) % 9) : 0.9;
    };
  };
  for (const bool heap : {true, false}) {
    const LabelGrid grid = make_label_grid(test::frame_of(120, 100, depth(heap)), Gravity{});
    FrameLabels labels = empty_labels(grid, std::string(64, 'a'));
    for (std::size_t i = 0; i < grid.pixels(); ++i)
      if (grid.points[i].z() > 0.95f) labels.plane.data[i] = 1;
    labels.planes = {{.id = 1}};
    refit_planes(labels, grid);
    auto findings = audit_labels(labels, grid);
    std::erase_if(findings, [](const Finding& f) { return f.kind != FindingKind::unlabeled; });
    EXPECT_EQ(findings.size(), heap ? 0u : 1u) << (heap ? "heap" : "box");
  }
}

TEST_F(AuditTest, StatisticsCountPixelsPlanesAndArea) {
  in_box(200, 300, 210, 310, [&](std::size_t i) { set(i, kPlaneIgnore, kHvIgnore); });
  in_box(220, 300, 230, 310, [&](std::size_t i) { set(i, 0, 0); });
  labels.planes[1].hidden = true;
  const LabelStatistics s = statistics_of(labels, grid);
  EXPECT_EQ(s.planes, 2);
  EXPECT_EQ(s.h, 1);
  EXPECT_EQ(s.v, 1);
  EXPECT_EQ(s.ignored, 100u);
  EXPECT_EQ(s.measured, grid.measured_count);
  EXPECT_EQ(s.labeled, s.measured - 200);
  EXPECT_EQ(s.hidden, static_cast<std::size_t>(std::ranges::count(labels.plane.data, 2)));
  double seen_m2 = 0;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i)
    if (labels.plane.data[i] == 1 || labels.plane.data[i] == 2) seen_m2 += grid.pixel_area_m2(i);
  EXPECT_NEAR(s.labeled_m2, seen_m2, 0.1 * seen_m2);
}

TEST(PixelDepth, TheDeepestPixelIsFarthestFromTheOutside) {
  PixelSet ring;  // a 9x9 square in a 12x10 image, without its lower right quarter
  for (std::uint32_t y = 0; y < 9; ++y)
    for (std::uint32_t x = 0; x < 9; ++x)
      if (x < 6 || y < 6) ring.push_back(y * 12 + x);
  const LabelGrid grid = test::wall_grid(12, 10);
  EXPECT_EQ(deepest_pixel(ring, grid), 3 * 12 + 3u);
  const std::vector<std::uint32_t> one = {119};
  EXPECT_EQ(deepest_pixel(one, grid), 119u);
}

TEST(PixelDepth, PartsCloserThanTheGapAreOne) {
  const std::vector<std::uint32_t> pixels = {0, 5, 12};  // in a row of 20
  const LabelGrid row = test::wall_grid(20, 1);
  EXPECT_EQ(parts_apart(pixels, row, 4).size(), 3u);
  EXPECT_EQ(parts_apart(pixels, row, 6).size(), 2u);
  EXPECT_EQ(parts_apart(pixels, row, 8).size(), 1u);
}

}  // namespace
}  // namespace planescope::labels
