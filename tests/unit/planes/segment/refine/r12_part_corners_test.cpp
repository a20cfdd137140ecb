#include "core/planes/segment/refine/r12_part_corners.hpp"

#include <gtest/gtest.h>

#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

enum class Edge { convex, concave };

/// The upright edge of a far box, or the corner of a far niche, its faces turned by 45 degrees to
/// either side and 8 cm deep, before nothing. One plane across it is 45 degrees off.
Frame box_edge(Edge edge = Edge::convex) {
  const auto depth_m = [&](double x, double y) {
    const double z = 2.8 / (1 + (edge == Edge::convex ? -1 : 1) * std::abs(x));
    return std::abs(x * z) < 0.08 && std::abs(y * z) < 0.3 ? z : 0;
  };
  return test::depth_frame(depth_m, 0.003);
}

double angle_deg(const PlaneRegion& plane, const Vec3d& axis) {
  return std::acos(std::min(1.0, std::abs(plane.fit.normal.dot(axis.normalized())))) * 180 / M_PI;
}

TEST(PartCorners, APlaneAcrossAnEdgeIsTwo) {
  for (const Edge kind : {Edge::convex, Edge::concave}) {
    const Frame edge = box_edge(kind);
    const FrameResult across =
        test::result_of(edge, [](SegmentOptions& o) { o.r12_part_corners.on = false; });
    ASSERT_EQ(across.segmentation.planes.size(), 1u);
    const FrameResult result = test::result_of(edge);
    ASSERT_EQ(result.segmentation.planes.size(), 2u);
    EXPECT_NE(test::plane_at(result, 313, 240), test::plane_at(result, 326, 240));
    // The world is level: x ahead, y left.
    for (const PlaneRegion& plane : result.segmentation.planes)
      EXPECT_LT(std::min(angle_deg(plane, {1, 1, 0}), angle_deg(plane, {1, -1, 0})), 20);
  }
}

TEST(PartCorners, NeedNoOtherRefinementOfPixels) {
  const FrameResult result = test::result_of(box_edge(), [](SegmentOptions& o) {
    o.r9_join_sheets.on = o.r10_minor.on = o.r11_pixel_borders.on = false;
  });
  EXPECT_EQ(result.segmentation.planes.size(), 2u);
}

TEST(PartCorners, AFlatWallAndABowedOneStayWhole) {
  for (const double bow_m : {0.0, 0.02}) {
    const Frame wall =
        test::depth_frame([&](double x, double) { return 1.8 + bow_m * std::sin(3 * x); }, 0.004);
    const auto [result, trace] = test::traced_result_of(wall);
    EXPECT_FALSE(result.segmentation.planes.empty());
    for (const TraceEvent& event : trace.events)
      EXPECT_NE(event.stage, Stage::r12_part_corners) << bow_m;
  }
}

TEST(PartCorners, TheTraceTellsWhichPlaneWasParted) {
  const Trace trace = test::traced_result_of(box_edge()).second;
  std::int32_t parted = -1, kept = -1;
  for (const TraceEvent& event : trace.events) {
    if (event.stage != Stage::r12_part_corners) continue;
    if (event.type == EventType::found) parted = event.other;
    if (event.type == EventType::refine) kept = event.plane;
  }
  EXPECT_GE(parted, 0);
  EXPECT_EQ(parted, kept);
}

}  // namespace
}  // namespace planescope::planes
