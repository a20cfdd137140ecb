#include "core/planes/cloud/gravity_pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace planescope::planes {
namespace {

const Vec3d kDown = Vec3d(0.2, 0.9, 0.3).normalized();

/// A wall in a world where things fall along kDown, turned about that by an angle.
Vec3d wall(double turned_deg) {
  const Vec3d across = kDown.cross(Vec3d::UnitZ()).normalized(), along = across.cross(kDown);
  const double angle = turned_deg * std::numbers::pi / 180;
  return std::cos(angle) * across + std::sin(angle) * along;
}

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, a.dot(b))) * 180 / std::numbers::pi;
}

TEST(GravityPick, AFloorTellsItAgainstItsNormal) {
  EXPECT_TRUE(gravity_of_floor(-2 * kDown).isApprox(kDown));
}

TEST(GravityPick, OneWallTurnsWhatIsKnownUntilTheWallStandsUpright) {
  const Vec3d known = (kDown + 0.2 * wall(0) + 0.1 * wall(90)).normalized();
  const std::vector<Vec3d> walls = {wall(0)};
  const auto gravity = gravity_of_walls(walls, known);
  ASSERT_TRUE(gravity);
  EXPECT_NEAR(gravity->dot(wall(0)), 0, 1e-12);
  EXPECT_NEAR(gravity->norm(), 1, 1e-12);
  EXPECT_LT(angle_deg(*gravity, kDown), angle_deg(known, kDown));
}

TEST(GravityPick, TwoWallsTellItWhateverWasKnown) {
  // The camera itself is tilted by 40 degrees against them: only up and down are taken from it.
  const Vec3d known = (kDown + 0.8 * wall(30)).normalized();
  for (const double corner_deg : {30.0, 90.0, -75.0}) {
    const std::vector<Vec3d> walls = {wall(10), wall(10 + corner_deg)};
    const auto gravity = gravity_of_walls(walls, known);
    ASSERT_TRUE(gravity) << corner_deg;
    EXPECT_LT(angle_deg(*gravity, kDown), 1e-5) << corner_deg;
  }
}

TEST(GravityPick, MoreWallsAreTakenTogether) {
  const auto leaning = [](double turned_deg, double lean) {
    return Vec3d(wall(turned_deg) + lean * kDown).normalized();
  };
  const std::vector<Vec3d> walls = {leaning(0, 0.03), leaning(180, 0.03), leaning(90, 0)};
  const auto gravity = gravity_of_walls(walls, kDown);
  ASSERT_TRUE(gravity);
  EXPECT_LT(angle_deg(*gravity, kDown), 0.1) << "opposite walls that lean alike cancel";
}

TEST(GravityPick, ParallelWallsAndFloorsTakenForWallsAreRefusedWithAReason) {
  std::string why;
  const std::vector<Vec3d> parallel = {wall(0), wall(185)};
  EXPECT_FALSE(gravity_of_walls(parallel, kDown, &why));
  EXPECT_NE(why.find("parallel"), std::string::npos) << why;
  const std::vector<Vec3d> floor = {Vec3d(-kDown + 0.3 * wall(0)).normalized()};
  EXPECT_FALSE(gravity_of_walls(floor, kDown, &why));
  EXPECT_NE(why.find("floor"), std::string::npos) << why;
  EXPECT_FALSE(gravity_of_walls({}, kDown));
}

}  // namespace
}  // namespace planescope::planes
