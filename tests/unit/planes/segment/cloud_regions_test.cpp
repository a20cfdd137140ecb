// Planes in clouds, found by minimizing one objective.

#include <gtest/gtest.h>

#include "core/lab/synthetic/evaluation_sets.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/segment.hpp"
#include "support/scenes.hpp"

namespace planescope::planes {
namespace {

struct LabeledSet {
  PointSet cloud;
  std::vector<Vec3d> normals;
  std::vector<Label> labels;
};

LabeledSet make(const std::string& set, int index, double noise_m) {
  lab::EvaluationOptions options;
  options.noise_m = noise_m;
  const lab::EvaluationFrame frame =
      lab::make_evaluation_frame(lab::find_evaluation_set(set), index, options);
  LabeledSet result{*frame.frame.cloud, frame.normals, {}};
  for (const std::uint8_t l : result.cloud.label)  // curved surfaces count as v
    result.labels.push_back(l == 1 ? Label::h : Label::v);
  return result;
}

Segmentation planes_of(const LabeledSet& set, Trace* trace = nullptr) {
  return segment(set.cloud.points, set.labels, test::cube_around(set.cloud.points), Vec3d::Zero(),
                 profile_options(Profile::refined), trace);
}

Metrics score(const std::string& set, double noise_m, int count) {
  std::vector<Metrics> all;
  for (int i = 0; i < count; ++i) {
    const LabeledSet scene = make(set, i, noise_m);
    const Segmentation s = planes_of(scene);
    std::vector<Vec3d> normals;
    for (const PlaneRegion& p : s.planes) normals.push_back(p.fit.normal);
    all.push_back(evaluate({scene.cloud.points, scene.cloud.instance, s.plane_of, normals,
                            scene.normals, scene.labels, scene.labels}));
  }
  return mean_of(all);
}

TEST(Objective, FindsEveryPlaneOfStairsAtEveryNoise) {
  for (const double noise : {0.0, 0.001, 0.002, 0.003}) {
    const Metrics m = score("stairs", noise, 6);
    EXPECT_NEAR(m.r_p, 100, 0.3) << noise;
    EXPECT_LE(m.r_m, 0.05) << noise;
    EXPECT_LE(m.alpha_deg, 0.12) << noise;
    EXPECT_GE(m.point_accuracy, 99.8) << noise;
    EXPECT_EQ(m.detected_iou80, m.planes_truth) << noise;
  }
}

TEST(Objective, SeparatesLevelsThatDoNotTouch) {
  const Metrics m = score("equal_boxes", 0.002, 4);
  EXPECT_GE(m.mean_iou, 97);
  EXPECT_EQ(m.detected_iou80, m.planes_truth);
}

TEST(Objective, FindsTreadsThatAreThinSlabs) {
  EXPECT_GE(score("open_risers", 0.001, 4).mean_iou, 88);
}

TEST(Objective, IsTheSameWithAndWithoutATrace) {
  for (const char* set : {"stairs", "equal_boxes", "spiral"}) {
    const LabeledSet scene = make(set, 1, 0.002);
    Trace trace;
    const Segmentation traced = planes_of(scene, &trace), plain = planes_of(scene);
    EXPECT_EQ(traced.plane_of, plain.plane_of);
    // The trace contains the final plane of every point.
    std::vector<std::int32_t> last(scene.cloud.points.size(), -1);
    for (const Trace::Point& point : trace.points) {
      EXPECT_LE(point.change.step, trace.steps());
      last[point.point] = point.change.plane;
    }
    for (std::size_t i = 0; i < last.size(); ++i) {
      const std::int32_t id = traced.plane_of[traced.octree.order[i]];
      EXPECT_EQ(last[i], id > 0 ? traced.planes[id - 1].founded : -1);
    }
  }
}

TEST(Objective, JitterOfAMicrometerChangesNoPlane) {
  for (const char* set : {"stairs", "equal_boxes", "ramps"}) {
    const LabeledSet scene = make(set, 2, 0.002);
    LabeledSet moved = scene;
    for (std::size_t i = 0; i < moved.cloud.points.size(); ++i)
      moved.cloud.points[i] += Vec3f::Constant(i % 3 == 0 ? 1e-6f : -1e-6f);
    const Segmentation a = planes_of(scene), b = planes_of(moved);
    const std::vector<Vec3d> normals(b.planes.size(), Vec3d::UnitZ());
    const Metrics m = evaluate({scene.cloud.points, a.plane_of, b.plane_of, normals, {}, {}, {}});
    EXPECT_EQ(m.planes_found, m.planes_truth) << set;
    EXPECT_GE(m.mean_iou, 99.9) << set;
  }
}

}  // namespace
}  // namespace planescope::planes
