// Frames with unknown gravity: planes of any direction, without h and v.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "core/planes/result/analyze.hpp"
#include "support/render_depth.hpp"

namespace planescope::planes {
namespace {

/// A floor, and a wall 1.2 m ahead, seen by a camera rolled by 70 degrees: no estimate is possible.
Frame rolled() {
  const test::Parallelogram floor{Vec3d(-5, -5, 0), Vec3d(10, 0, 0), Vec3d(0, 10, 0)};
  const test::Parallelogram wall{Vec3d(1.2, -5, -3), Vec3d(0, 10, 0), Vec3d(0, 0, 6)};
  return test::render_depth({floor, wall}, {0.5, 20, 70, 0, 1});
}

PipelineOptions without_gravity() {
  PipelineOptions options;
  set_option(options, "gravity", "none");
  return options;
}

TEST(NoGravity, FindsEveryPlaneWithoutClasses) {
  for (const char* method : {"ours", "region-growing"}) {
    PipelineOptions options = without_gravity();
    set_option(options, "method", method);
    const FrameResult result = run_frame(rolled(), options, nullptr);  // no classifier is needed
    ASSERT_EQ(result.segmentation.planes.size(), 2u) << method;
    for (const PlaneRegion& plane : result.segmentation.planes) {
      EXPECT_EQ(plane.label, Label::unknown) << method;
      EXPECT_GT(plane.fit.normal.dot(result.sensor() - plane.fit.centroid), 0) << "to the camera";
      EXPECT_TRUE(std::isnan(summarize_planes(result, 0.02)[0].tilt_deg)) << method;
    }
    for (const Label label : result.classification.labels) EXPECT_EQ(label, Label::unknown);
  }
}

TEST(NoGravity, FindsTheSamePlanesAsWithGravityButWithoutClasses) {
  PipelineOptions options = without_gravity();
  const FrameResult none = run_frame(rolled(), options, nullptr);
  set_option(options, "gravity", "0,1,0");  // the same world as with `none`
  options.segment.use_labels = false;
  const auto classifier = make_pca_classifier();
  const FrameResult level = run_frame(rolled(), options, classifier.get());
  EXPECT_EQ(none.plane_of, level.plane_of);
}

TEST(NoGravity, TheWorldHasTheCamerasAxes) {
  const FrameResult result = run_frame(rolled(), without_gravity(), nullptr);
  Mat3d axes;  // the camera's forward, left and up
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  EXPECT_TRUE(result.cloud.T_world_sensor.linear().isApprox(axes));
}

TEST(NoGravity, TraceEventsAndNodesHaveNoLabel) {
  Trace trace;
  const FrameResult result = run_frame(rolled(), without_gravity(), nullptr, nullptr, &trace);
  for (const TraceEvent& event : trace.events) EXPECT_EQ(event.label, Label::unknown);
  for (const PlaneRegion& plane : result.segmentation.planes)
    EXPECT_EQ(plane.label, Label::unknown);
}

TEST(NoGravity, PlanesAreScoredButNotLabels) {
  Frame frame;
  PointSet& set = frame.cloud.emplace();
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) {
      const float a = 0.0125f * static_cast<float>(i), b = 0.0125f * static_cast<float>(j);
      set.points.emplace_back(0.5f + a, b, -0.3f);
      set.points.emplace_back(1.6f, b, a);
      for (const int plane : {1, 2}) {
        set.label.push_back(static_cast<std::uint8_t>(plane));
        set.instance.push_back(plane);
      }
    }
  const SourceTruth truth = *truth_of_cloud(*frame.cloud);
  const FrameResult result = run_frame(frame, without_gravity(), nullptr);
  const Metrics metrics = score_frame(result, truth);
  EXPECT_GT(metrics.mean_iou, 95);
  EXPECT_TRUE(std::isnan(metrics.label_accuracy_edge));
  const EvaluatedFrame evaluated = evaluate_frame(result, truth);
  EXPECT_EQ(std::ranges::count(evaluated.verdict, Verdict::wrong_class), 0);

  Metrics labeled;
  labeled.label_accuracy_edge = labeled.label_accuracy_inner = 80;
  EXPECT_EQ(mean_of(std::vector{metrics, labeled}).label_accuracy_edge, 80)
      << "the mean of those that have labels";
  EXPECT_TRUE(std::isnan(mean_of(std::vector{metrics}).label_accuracy_inner));
  EXPECT_THROW(labeled_frame(frame, without_gravity(), truth), Error) << "to learn from";
}

TEST(NoGravity, ClassifierOptionsAreNotOptionsOfSuchARun) {
  for (const char* name : {"classifier", "pca_neighbours", "use_labels"}) {
    EXPECT_FALSE(find_option(name).matters(without_gravity())) << name;
    EXPECT_TRUE(find_option(name).matters({})) << name;
  }
}

}  // namespace
}  // namespace planescope::planes
