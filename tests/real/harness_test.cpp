// Tests the checks of this folder on artificial output, without recordings.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/real/expectations.hpp"

namespace planescope {
namespace {

// Adds a horizontal square of 1 m with points every 2 cm, and its corner at (x, 0, z).
void add_floor(FrameOutput& output, int id, double x, double z) {
  OutputPlane plane;
  plane.id = id;
  plane.label = "h";
  plane.normal = Vec3d::UnitZ();
  plane.centroid = Vec3d(x + 0.49, 0.49, z);
  plane.offset_m = z;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j) {
      output.cloud.points.push_back(Vec3d(x + 0.02 * i, 0.02 * j, z).cast<float>());
      output.cloud.instance.push_back(id);
      output.cloud.label.push_back(1);
      ++plane.points;
    }
  output.planes.push_back(plane);
}

// 100 x 100 pixels: plane 1 on the left half, plane 2 on the right.
FrameOutput two_walls(double angle_deg) {
  FrameOutput output;
  output.plane_ids = Image16(100, 100);
  for (int v = 0; v < 100; ++v)
    for (int u = 0; u < 100; ++u) output.plane_ids.at(u, v) = u < 50 ? 1 : 2;
  const double angle = angle_deg * M_PI / 180;
  for (const int id : {1, 2}) {
    OutputPlane plane;
    plane.id = id;
    plane.label = "v";
    plane.normal = id == 1 ? Vec3d(1, 0, 0) : Vec3d(std::cos(angle), std::sin(angle), 0);
    plane.points = 5000;
    output.planes.push_back(plane);
    for (int i = 0; i < 5000; ++i) output.cloud.instance.push_back(id);
  }
  return output;
}

TEST(RealDataHarness, OverlappingSurfacesAreFoundAsSheets) {
  FrameOutput output;
  add_floor(output, 1, 0, 0);
  add_floor(output, 2, 0.2, 0.03);
  EXPECT_EQ(find_sheets(output, {}).size(), 1u);
}

TEST(RealDataHarness, StepsAndNeighborsAreNotSheets) {
  FrameOutput output;
  add_floor(output, 1, 0, 0);
  add_floor(output, 2, 0, 0.1);     // above, but by a step
  add_floor(output, 3, 1.1, 0.02);  // similar height, but beside
  EXPECT_TRUE(find_sheets(output, {}).empty());
}

TEST(RealDataHarness, EachLevelNeedsAPlane) {
  FrameOutput output;
  add_floor(output, 1, 0, 0.6);
  add_floor(output, 2, 1, 0.77);
  EXPECT_TRUE(check_levels(output, 0.75, {0.6, 0.77}, 0.02).empty());
  EXPECT_EQ(check_levels(output, 0.75, {0.6, 0.77, 0.94}, 0.02).size(), 1u);
  EXPECT_EQ(check_levels(output, 0.75, {0.6, 0.8}, 0.02).size(), 1u);
}

TEST(RealDataHarness, APlaneThatSpansTwoLevelsIsReported) {
  FrameOutput output;
  add_floor(output, 1, 0, 0.6);
  add_floor(output, 1, 1, 0.77);
  output.planes.pop_back();
  EXPECT_FALSE(check_levels(output, 0.75, {0.6, 0.77}, 0.02).empty());
}

TEST(RealDataHarness, AnglesAreAcuteAndCheckedWithinTheirTolerance) {
  const nlohmann::json expected = {
      {"kind", "angle"}, {"a", {20, 50}}, {"b", {80, 50}}, {"deg", 86}, {"tolerance_deg", 1.5}};
  EXPECT_TRUE(check_expectation(expected, two_walls(86)).empty());
  EXPECT_TRUE(check_expectation(expected, two_walls(95)).empty());
  EXPECT_EQ(check_expectation(expected, two_walls(88)).size(), 1u);
}

TEST(RealDataHarness, PixelsWithoutAPlaneAndUnknownKindsAreProblems) {
  FrameOutput output = two_walls(90);
  EXPECT_EQ(
      check_expectation({{"kind", "label"}, {"at", {300, 300}}, {"label", "v"}}, output).size(),
      1u);
  EXPECT_EQ(check_expectation({{"kind", "wings"}}, output).size(), 1u);
  EXPECT_TRUE(check_expectation({{"kind", "apart"}, {"at", {{20, 50}, {80, 50}}}}, output).empty());
  EXPECT_EQ(check_expectation({{"kind", "one_plane"}, {"at", {{20, 50}, {80, 50}}}}, output).size(),
            1u);
}

TEST(RealDataHarness, FilesThatDisagreeAreProblems) {
  FrameOutput output = two_walls(90);
  EXPECT_TRUE(check_consistency(output).empty());
  output.plane_ids.at(0, 0) = 2;
  EXPECT_EQ(check_consistency(output).size(), 2u);
}

}  // namespace
}  // namespace planescope
