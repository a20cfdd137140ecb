// Tests of the synthetic scenes: plane truth, labels, visibility and seeds.

#include "core/lab/synthetic/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"
#include "unit/lab/synthetic/test_scenes.hpp"

namespace planescope::lab {
namespace {

using namespace synthetic_test;

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes,
                         EveryScene,
                         testing::ValuesIn(scene_names()),
                         [](const auto& scene) { return scene.param; });

/// Moments of the measured points of every true plane; checks that each point is on its plane.
std::map<int, Moments> moments_of_planes(const Frame& frame, const FrameLabels& truth) {
  std::map<int, const LabelPlane*> planes;
  for (const LabelPlane& plane : truth.planes) planes[plane.id] = &plane;
  std::map<int, Moments> moments;
  double farthest = 0;
  for (int y = 0; y < frame.depth.height; ++y) {
    for (int x = 0; x < frame.depth.width; ++x) {
      const int id = truth.plane.at(x, y);
      if (id == 0 || frame.depth.at(x, y) == 0) continue;
      const Vec3d point = point_at(frame, x, y);
      const LabelPlane& plane = *planes.at(id);
      farthest = std::max(farthest, std::abs(plane.normal.dot(point) - plane.offset_m));
      moments[id].add(point);
    }
  }
  EXPECT_LT(farthest, 0.001);
  return moments;
}

TEST_P(EveryScene, TrueRegionsMatchTheirPlanesWithinAMillimeter) {
  for (const std::uint64_t seed : {1, 2}) {
    D435Model model = without_color();
    model.noise = false;
    FrameLabels truth;
    const Frame frame = seen(make_scene(GetParam(), seed), model, &truth);
    const auto moments = moments_of_planes(frame, truth);
    int fitted = 0;
    for (const LabelPlane& plane : truth.planes) {
      EXPECT_LT(plane.offset_m, 0) << "the normal points to the camera";
      if (!moments.contains(plane.id)) continue;
      const PlaneFit fit = fit_plane(moments.at(plane.id));
      EXPECT_LT(fit.rms_m(), 0.0005) << plane.id;
      EXPECT_NEAR(plane.rms_m, fit.rms_m(), 0.0002) << plane.id;
      if (fit.count < 2000) continue;
      ++fitted;
      EXPECT_GT(std::abs(fit.normal.dot(plane.normal)), std::cos(0.3 * M_PI / 180)) << plane.id;
    }
    EXPECT_GE(fitted, 3);
  }
}

TEST_P(EveryScene, LabelsFollowTheTrueNormalsAgainstGravity) {
  const Scene scene = make_scene(GetParam(), 3);
  FrameLabels truth;
  seen(scene, without_color(), &truth);
  EXPECT_NEAR(truth.gravity.direction.norm(), 1, 1e-8);
  const Vec3d down = pose_of(scene.camera).linear().transpose() * -Vec3d::UnitZ();
  EXPECT_LT((truth.gravity.direction - down).norm(), 1e-8);
  std::map<int, Label> label;
  std::set<Label> seen_labels;
  for (const LabelPlane& plane : truth.planes) {
    const double cosine = std::abs(plane.normal.dot(truth.gravity.direction));
    EXPECT_EQ(plane.label, cosine >= std::sqrt(0.5) ? Label::h : Label::v) << plane.id;
    EXPECT_GE(plane.fragments, 1);
    label[plane.id] = plane.label;
    seen_labels.insert(plane.label);
  }
  EXPECT_EQ(seen_labels, (std::set<Label>{Label::h, Label::v}));
  for (std::size_t i = 0; i < truth.plane.data.size(); ++i) {
    const int id = truth.plane.data[i];
    ASSERT_EQ(truth.hv.data[i], id == 0 ? 0 : static_cast<int>(label.at(id)));
  }
}

TEST_P(EveryScene, IsMostlyWithinRangeAndHasHoles) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Scene scene = make_scene(GetParam(), seed);
    EXPECT_GE(scene.camera.position.z(), 0.6);
    EXPECT_LE(scene.camera.position.z(), 1.0);
    EXPECT_GE(scene.camera.pitch_deg, 25);
    EXPECT_LE(scene.camera.pitch_deg, 40);
    const Frame frame = seen(scene, without_color(320, 240));
    int measured = 0, near = 0;
    for (const std::uint16_t count : frame.depth.data) {
      measured += count > 0;
      near += count > 0 && count <= 1500;
    }
    const double pixels = 320 * 240;
    EXPECT_GT(near / pixels, 0.6) << seed;
    EXPECT_GT(measured / pixels, 0.85) << seed;
    EXPECT_LT(measured / pixels, 0.99) << "holes are part of such images";
  }
}

TEST_P(EveryScene, TheSeedDeterminesTheFrameAndItsNoise) {
  const Scene scene = make_scene(GetParam(), 1);
  D435Model model = without_color(160, 120);
  model.color = true;
  FrameLabels truth, other_truth;
  const Frame a = render_scene(scene, scene.camera, model, 5, &truth);
  const Frame b = render_scene(make_scene(GetParam(), 1), scene.camera, model, 5);
  const Frame other = render_scene(scene, scene.camera, model, 6, &other_truth);
  EXPECT_EQ(a.depth.data, b.depth.data);
  EXPECT_EQ(a.color.data, b.color.data);
  EXPECT_NE(a.depth.data, other.depth.data);
  EXPECT_EQ(a.color.data, other.color.data);
  EXPECT_EQ(truth.plane.data, other_truth.plane.data);
  EXPECT_EQ(truth.depth_sha256, depth_sha256(a.depth));
  EXPECT_NE(truth.depth_sha256, other_truth.depth_sha256);
}

TEST(Scenes, NoiseDoesNotChangeTheTruth) {
  const Scene scene = make_scene("boxes", 1);
  D435Model model = without_color(320, 240);
  FrameLabels noisy, exact;
  seen(scene, model, &noisy);
  model.noise = false;
  seen(scene, model, &exact);
  EXPECT_EQ(noisy.plane.data, exact.plane.data);
  EXPECT_EQ(noisy.hv.data, exact.hv.data);
  ASSERT_EQ(noisy.planes.size(), exact.planes.size());
  EXPECT_GT(noisy.planes[0].rms_m, 3 * exact.planes[0].rms_m);
}

TEST(Scenes, TheTreadsOfTheStairsAreEvenlySpacedAlongGravity) {
  FrameLabels truth;
  seen(make_scene("stairs", 4), without_color(), &truth);
  std::vector<double> heights;  // of the h planes above the floor
  for (const LabelPlane& plane : truth.planes)
    if (plane.label == Label::h) heights.push_back(plane.offset_m - truth.planes[0].offset_m);
  ASSERT_EQ(heights.size(), 5u);  // floor and four treads
  for (int i = 1; i < 5; ++i) EXPECT_NEAR(heights[i], i * heights[1], 1e-6);
  EXPECT_NEAR(heights[1], 0.15, 0.01);
}

TEST(Scenes, TheRampRisesByFifteenDegreesAndIsHorizontal) {
  FrameLabels truth;
  seen(make_scene("ramp", 4), without_color(320, 240), &truth);
  int sloped = 0;
  for (const LabelPlane& plane : truth.planes) {
    const double angle = std::acos(-plane.normal.dot(truth.gravity.direction)) * 180 / M_PI;
    if (angle > 1 && angle < 80) {
      ++sloped;
      EXPECT_NEAR(angle, 15, 1e-4);
      EXPECT_EQ(plane.label, Label::h);
    }
  }
  EXPECT_EQ(sloped, 1);
}

TEST(Scenes, CurvedSurfacesAreMeasuredButBelongToNoPlane) {
  FrameLabels truth;
  const Frame frame = seen(make_scene("corner", 1), without_color(), &truth);
  int measured_without_plane = 0;
  for (std::size_t i = 0; i < frame.depth.data.size(); ++i)
    measured_without_plane += frame.depth.data[i] > 0 && truth.plane.data[i] == 0;
  EXPECT_GT(measured_without_plane, 2000);
}

TEST(Scenes, AnUnknownNameIsRejectedWithAListOfNames) {
  try {
    make_scene("attic", 1);
    FAIL();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("attic"), std::string::npos);
    EXPECT_NE(message.find("stairs, kerb, ramp, boxes, corner"), std::string::npos);
  }
}

}  // namespace
}  // namespace planescope::lab
