// The paper's evaluation stairs with perfect labels: results of refined, and how the text as
// written fails. scripts/bench measures all hundred stairs.

#include "core/lab/synthetic/stairs.hpp"

#include <gtest/gtest.h>

#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/segment/segment.hpp"
#include "support/scenes.hpp"

namespace planescope::planes {
namespace {

Metrics score(Profile profile, double noise_m, int count = 6) {
  lab::StairsOptions set;
  set.noise_m = noise_m;
  std::vector<Metrics> all;
  for (int i = 0; i < count; ++i) {
    const lab::Stairs stairs = lab::make_stairs(i, set);
    const PointSet& cloud = stairs.cloud;
    std::vector<Label> labels;
    for (const std::uint8_t l : cloud.label) labels.push_back(static_cast<Label>(l));
    SegmentOptions options = profile_options(profile);
    const Segmentation s =
        segment(cloud.points, labels, test::cube_around(cloud.points), Vec3d::Zero(), options);
    std::vector<Vec3d> normals;
    for (const PlaneRegion& p : s.planes) normals.push_back(p.fit.normal);
    all.push_back(evaluate(
        {cloud.points, cloud.instance, s.plane_of, normals, stairs.normals, labels, labels}));
  }
  return mean_of(all);
}

TEST(Stairs, RefinedFindsEveryPlaneAtEveryNoise) {
  for (const double noise : {0.0, 0.001, 0.002, 0.003}) {
    const Metrics m = score(Profile::refined, noise);
    EXPECT_NEAR(m.r_p, 100, 0.3) << noise;
    EXPECT_LE(m.r_m, 0.05) << noise;
    EXPECT_LE(m.alpha_deg, 0.12) << noise;
    EXPECT_GE(m.point_accuracy, 99.5) << noise;
    EXPECT_EQ(m.detected_iou80, m.planes_truth) << noise;
  }
}

TEST(Stairs, TheTextAsWrittenWorksWithoutNoiseAndFragmentsWithIt) {
  const Metrics clean = score(Profile::paper, 0), noisy = score(Profile::paper, 0.003);
  EXPECT_NEAR(clean.r_p, 100, 6);
  EXPECT_LT(clean.alpha_deg, 0.8);
  EXPECT_GT(noisy.r_p, 250);
  EXPECT_GT(noisy.alpha_deg, 8);
}

TEST(Stairs, TheClosestInterpretationStaysNearThePaper) {
  const Metrics noisy = score(Profile::paper_closest, 0.003);
  EXPECT_LT(noisy.r_p, 125);
  EXPECT_LT(noisy.alpha_deg, 3);
}

TEST(Stairs, AreReproducibleAndWithinThePapersRanges) {
  const lab::Stairs a = lab::make_stairs(7, {}), b = lab::make_stairs(7, {}),
                    c = lab::make_stairs(8, {});
  EXPECT_EQ(a.cloud.points.size(), 8192u);
  EXPECT_EQ(a.cloud.points, b.cloud.points);
  EXPECT_NE(a.width_m, c.width_m);
  for (const lab::Stairs& s : {a, c}) {
    EXPECT_GE(s.steps, 2);
    EXPECT_LE(s.steps, 6);
    EXPECT_EQ(s.normals.size(), 2u * s.steps);
    EXPECT_TRUE(s.length_m >= 0.2 && s.length_m <= 0.4);
    EXPECT_TRUE(s.width_m >= 0.3 && s.width_m <= 1.5);
    EXPECT_TRUE(s.height_m >= 0.1 && s.height_m <= 0.3);
  }
}

TEST(Stairs, NoiseHasTheRequestedDeviation) {
  lab::StairsOptions set;
  set.random_yaw = false;
  set.noise_m = 0.003;
  const lab::Stairs s = lab::make_stairs(3, set);
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < s.cloud.points.size(); ++i)
    if (s.cloud.instance[i] == 2) {  // the first tread
      const double d = s.cloud.points[i].z() - s.height_m;
      sum += d * d;
      ++n;
    }
  EXPECT_NEAR(std::sqrt(sum / n), 0.003, 0.0003);
}

}  // namespace
}  // namespace planescope::planes
