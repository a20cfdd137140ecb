#include "core/planes/segment/refine/r9_join_sheets.hpp"

#include <gtest/gtest.h>

#include <set>

#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

/// How many planes have the wall's pixels along its middle row.
std::size_t planes_across(const FrameResult& result) {
  std::set<int> planes;
  for (int u = 20; u < 620; u += 10)
    if (const int plane = test::plane_at(result, u, 240)) planes.insert(plane);
  return planes.size();
}

void no_joins(SegmentOptions& options) { options.r9_join_sheets.on = false; }

TEST(JoinSheets, ABowedWallIsOnePlane) {
  const Frame wall =
      test::depth_frame([](double x, double) { return 1.8 + 0.04 * std::sin(6 * x); });
  EXPECT_GT(planes_across(test::result_of(wall, no_joins)), 1u);
  EXPECT_EQ(planes_across(test::result_of(wall)), 1u);
}

TEST(JoinSheets, AStepPartsPlanesHoweverParallel) {
  const Frame step = test::depth_frame([](double x, double) { return x < 0 ? 1.5 : 1.54; });
  const FrameResult result = test::result_of(step);
  EXPECT_EQ(planes_across(result), 2u);
  EXPECT_NE(test::plane_at(result, 200, 240), test::plane_at(result, 440, 240));
}

TEST(JoinSheets, ACreasePartsPlanesHoweverSmooth) {
  const Frame corner =
      test::depth_frame([](double x, double) { return 1.6 / (1 + 0.5 * std::abs(x)); });
  const FrameResult result = test::result_of(corner);
  EXPECT_NE(test::plane_at(result, 120, 240), test::plane_at(result, 520, 240));
}

TEST(JoinSheets, TheTraceTellsWhoWentWhere) {
  const Frame wall =
      test::depth_frame([](double x, double) { return 1.8 + 0.04 * std::sin(6 * x); });
  const Trace trace = test::traced_result_of(wall).second;
  int joins = 0;
  for (const TraceEvent& event : trace.events)
    if (event.stage == Stage::r9_join_sheets) {
      ++joins;
      EXPECT_EQ(event.type, EventType::refine);
      EXPECT_GE(event.other, 0);
      EXPECT_NE(event.plane, event.other);
    }
  EXPECT_GE(joins, 1);
}

}  // namespace
}  // namespace planescope::planes
