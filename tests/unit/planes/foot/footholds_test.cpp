// Tests of steppable planes, plane uncertainty and outline validity.

#include "core/planes/foot/footholds.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/planes/outline/outline.hpp"
#include "support/polygon_scenes.hpp"
#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

constexpr double kCell_m = 0.02;
constexpr double kCamera_m = 0.6;  // height above the floor

/// A floor with objects, seen by a level camera above it.
Frame floor_frame(const std::function<double(double, double)>& height_m, double noise = 0.002) {
  return test::depth_frame(
      [&](double x, double y) {
        if (y < 0.1) return 0.0;
        double z = kCamera_m / y;  // half the distance if it is higher
        for (int i = 0; i < 4; ++i) z = (kCamera_m - height_m(x * z, z)) / y;
        return z < 2.5 ? z : 0.0;
      },
      noise);
}

struct Found {
  FrameResult result;
  std::vector<Outline> outlines;
  std::vector<Foothold> footholds;
};

Found found_in(const Frame& frame, const FootOptions& foot = {}) {
  Found found;
  found.result = test::result_of(frame);
  found.outlines = outlines_of(frame, found.result, kCell_m);
  found.footholds = footholds_of(frame, found.result, found.outlines, kCell_m, foot);
  return found;
}

/// Foothold of the largest plane.
const Foothold& floor_of(const Found& found) {
  std::size_t largest = 0;
  for (std::size_t k = 0; k < found.outlines.size(); ++k)
    if (found.outlines[k].area_m2 > found.outlines[largest].area_m2) largest = k;
  return found.footholds.at(largest);
}

TEST(Footholds, AFloorIsSteppableAndItsSurfaceIsDescribed) {
  const Found found = found_in(floor_frame([](double, double) { return 0.0; }), {.radius_m = 0.1});
  const Foothold& floor = floor_of(found);
  EXPECT_TRUE(floor.steppable) << floor.why_not;
  EXPECT_TRUE(floor.why_not.empty());
  EXPECT_LT(floor.surface.slope_deg, 1);
  EXPECT_LT(floor.surface.rough_rms_m, 0.005);
  EXPECT_GT(floor.surface.support, 0.95);
  EXPECT_GT(floor.surface.clearance_m, 0.5);
  EXPECT_NEAR(floor.surface.best_place.z(), -kCamera_m, 0.01);
}

TEST(Footholds, WithoutAFootNoAreaIsReported) {
  const Found found = found_in(floor_frame([](double, double) { return 0.0; }));
  EXPECT_FALSE(floor_of(found).space);
  EXPECT_TRUE(floor_of(found).why_not.empty());
}

TEST(Footholds, ExplainWhyAPlaneIsNotSteppable) {
  const Frame frame = floor_frame([](double, double) { return 0.0; });
  const auto why_not = [&](const FootOptions& foot) {
    return floor_of(found_in(frame, foot)).why_not;
  };
  EXPECT_NE(why_not({.radius_m = 0.1, .max_slope_deg = 0}).find("slope 0."), std::string::npos);
  EXPECT_NE(why_not({.radius_m = 0.1, .max_rough_m = 1e-4}).find("mm rough, limit 0.1"),
            std::string::npos);
  EXPECT_NE(why_not({.radius_m = 0.1, .min_area_m2 = 50}).find("cm2 for the foot's center"),
            std::string::npos);
  EXPECT_EQ(why_not({.radius_m = 5}), "no room for the foot");

  Frame torn = frame;  // a quarter of the pixels are missing
  for (int v = 0; v < 480; ++v)
    for (int u = 0; u < 640; ++u)
      if (u % 4 < 2 && v % 4 < 2) torn.depth.at(u, v) = 0;
  const Foothold floor = floor_of(found_in(torn, {.radius_m = 0.1, .min_support = 0.9}));
  EXPECT_NEAR(floor.surface.support, 0.75, 0.03);
  EXPECT_NE(floor.why_not.find("% measured, limit 90"), std::string::npos) << floor.why_not;
}

TEST(Footholds, AWallAndAPlaneWithoutGravityAreNotSteppable) {
  const Found wall =
      found_in(test::depth_frame([](double, double) { return 1.0; }, 0.0005), {.radius_m = 0.1});
  EXPECT_NE(floor_of(wall).why_not.find("upright, v"), std::string::npos);

  Frame frame = floor_frame([](double, double) { return 0.0; });
  PipelineOptions options;
  options.cloud.max_range_m = 4;
  options.gravity.mode = GravityMode::none;
  const FrameResult result = run_frame(frame, options, nullptr);
  const std::vector<Outline> outlines = outlines_of(frame, result, kCell_m);
  ASSERT_FALSE(outlines.empty());
  const auto footholds = footholds_of(frame, result, outlines, kCell_m, {.radius_m = 0.1});
  EXPECT_NE(footholds[0].why_not.find("gravity is unknown"), std::string::npos);
  EXPECT_TRUE(std::isnan(footholds[0].surface.slope_deg));
}

TEST(Footholds, RoughGroundIsRough) {
  const Found found =
      found_in(floor_frame([](double x, double z) {
                 return 0.012 * std::sin(x * 2 * M_PI / 0.08) * std::sin(z * 2 * M_PI / 0.08);
               }),
               {.radius_m = 0.05});
  EXPECT_GT(floor_of(found).surface.rough_rms_m, 0.003);
  EXPECT_GT(floor_of(found).surface.rough_step_m, 0.006);
}

TEST(Certainty, TheTruePlaneIsWithinTwoSigmaAndLargerPlanesAreMoreCertain) {
  const Foothold near = floor_of(found_in(floor_frame([](double, double) { return 0.0; }, 0.001)));
  const Foothold noisy = floor_of(found_in(floor_frame([](double, double) { return 0.0; }, 0.01)));
  EXPECT_GT(near.certainty.sigma_offset_m, 0);
  EXPECT_GT(noisy.certainty.sigma_offset_m, near.certainty.sigma_offset_m);
  EXPECT_LE(near.certainty.sigma_tilt_rad[0], near.certainty.sigma_tilt_rad[1])
      << "along its longer extent it is known better";
  EXPECT_NEAR(near.certainty.axes[0].dot(near.certainty.axes[1]), 0, 1e-12);
  EXPECT_LT(near.certainty.eigenvalues_m2[0], near.certainty.eigenvalues_m2[1]);
}

TEST(Certainty, ItsCovarianceIsOfThePlanesOffsetFromTheOrigin) {
  Certainty certainty;
  certainty.sigma_tilt_rad[0] = 0.01;
  certainty.sigma_tilt_rad[1] = 0.02;
  certainty.sigma_offset_m = 0.003;
  const Mat3d about_itself = certainty.covariance(Vec3d::Zero());
  EXPECT_DOUBLE_EQ(about_itself(2, 2), 9e-6);
  EXPECT_DOUBLE_EQ(about_itself(0, 2), 0);
  const Mat3d covariance = certainty.covariance(Vec3d(2, 0, 0));  // a tilt changes the offset
  EXPECT_DOUBLE_EQ(covariance(2, 2), 9e-6 + 4 * 1e-4);
  EXPECT_DOUBLE_EQ(covariance(0, 2), 2 * 1e-4);
  EXPECT_DOUBLE_EQ(covariance(1, 1), 4e-4);
}

// ---- Properties ----

/// A wall at 1 m; the pixels inside these polygons belong to the plane.
class Drawn {
 public:
  Drawn() : frame_(test::depth_frame([](double, double) { return 1.0; }, 0.0005)) {
    result_ = test::result_of(frame_);
  }
  const Frame& frame() const { return frame_; }
  FrameResult with(const std::function<bool(int x, int y)>& has) const {
    FrameResult drawn = result_;
    for (std::size_t i = 0; i < drawn.plane_of.size(); ++i) {
      const int x = static_cast<int>(drawn.cloud.source[i] % 640);
      const int y = static_cast<int>(drawn.cloud.source[i] / 640);
      drawn.plane_of[i] = has(x, y) ? 1 : 0;
    }
    return drawn;
  }

 private:
  Frame frame_;
  FrameResult result_;
};

void expect_sound(const Outline& outline, const Foothold& foothold) {
  EXPECT_TRUE(is_valid(polygons_of(outline)));
  ASSERT_TRUE(foothold.space);
  EXPECT_TRUE(is_valid(foothold.space->area));
  for (const PolygonRing& piece : foothold.space->pieces) EXPECT_TRUE(test::is_convex(piece));
  EXPECT_TRUE(std::isfinite(foothold.surface.clearance_m));
  EXPECT_GE(foothold.surface.support, 0);
  EXPECT_LE(foothold.surface.support, 1);
  double meshed_m2 = 0;
  const Mesh mesh = mesh_of(outline);
  for (const auto& [a, b, c] : mesh.triangles)
    meshed_m2 +=
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
  EXPECT_NEAR(meshed_m2, outline.area_m2, 1e-9);
}

TEST(OutlineProperties, RandomPolygonsWithHolesAreRecoveredFromTheirPixels) {
  const Drawn drawn;
  Random random(21);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE(trial);
    const Polygons truth = test::random_polygons(random);
    const FrameResult result = drawn.with([&](int x, int y) {
      const Vec2d p((x - 319.5) / 400, (239.5 - y) / 400);
      return std::ranges::any_of(truth, [&](const Polygon& polygon) {
        return is_in(polygon.outer, p) &&
               std::ranges::none_of(polygon.holes,
                                    [&](const auto& hole) { return is_in(hole, p); });
      });
    });
    const auto outlines = outlines_of(drawn.frame(), result, kCell_m);
    // In the world, y points left and z up; convert to the polygons' axes.
    Polygons back;
    for (const Polygon& polygon : polygons_of(outlines[0])) {
      const auto onto = [&](PolygonRing ring) {
        for (Vec2d& p : ring) p = {-outlines[0].world(p).y(), outlines[0].world(p).z()};
        return ring;
      };
      back.push_back({onto(polygon.outer), {}});
      for (const PolygonRing& hole : polygon.holes) back.back().holes.push_back(onto(hole));
    }
    // Gaps under 25 cm2 are closed, and corners are accurate to 1 cm.
    EXPECT_GT(area(common(back, truth)) / area(united(back, truth)), 0.9);
    const auto footholds =
        footholds_of(drawn.frame(), result, outlines, kCell_m, {.radius_m = 0.06});
    expect_sound(outlines[0], footholds[0]);
  }
}

TEST(OutlineProperties, DegenerateShapesGiveAValidPolygonOrNone) {
  const Drawn drawn;
  const std::pair<const char*, std::function<bool(int, int)>> shapes[] = {
      {"nothing", [](int, int) { return false; }},
      {"one pixel", [](int x, int y) { return x == 100 && y == 100; }},
      {"one row", [](int, int y) { return y == 200; }},
      {"one column", [](int x, int) { return x == 300; }},
      {"a ring of one pixel",
       [](int x, int y) {
         return x >= 100 && x <= 300 && y >= 100 && y <= 300 &&
                (x == 100 || x == 300 || y == 100 || y == 300);
       }},
      {"holes that touch at a corner",
       [](int x, int y) {
         const bool first = x >= 200 && x < 260 && y >= 150 && y < 210;
         const bool second = x >= 260 && x < 320 && y >= 210 && y < 270;
         return x >= 100 && x < 500 && y >= 50 && y < 400 && !first && !second;
       }},
      {"a chessboard", [](int x, int y) { return (x / 40 + y / 40) % 2 == 0; }},
      {"a comb", [](int x, int y) { return y < 20 || x % 8 == 0; }}};
  for (const auto& [name, has] : shapes) {
    SCOPED_TRACE(name);
    const FrameResult result = drawn.with(has);
    const auto outlines = outlines_of(drawn.frame(), result, kCell_m);
    const auto footholds =
        footholds_of(drawn.frame(), result, outlines, kCell_m, {.radius_m = 0.02});
    expect_sound(outlines[0], footholds[0]);
  }
}

TEST(OutlineProperties, APlaneSeenEdgeOnGivesAValidPolygonOrNone) {
  // A floor 1 cm below the camera.
  const Frame frame = test::depth_frame(
      [](double, double y) { return y > 0.01 ? std::min(0.01 / y, 0.8) : 0.8; }, 0.0005);
  const Found found = found_in(frame, {.radius_m = 0.02});
  for (std::size_t k = 0; k < found.outlines.size(); ++k)
    expect_sound(found.outlines[k], found.footholds[k]);
}

}  // namespace
}  // namespace planescope::planes
