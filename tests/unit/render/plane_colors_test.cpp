// Tests of plane colors over sequences, and of contact between planes.

#include "render/plane_colors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <numbers>
#include <optional>
#include <set>

#include "render/palette.hpp"

namespace planescope::render {
namespace {

constexpr int kColumns = 160, kRows = 120, kLeast_px = 50;
constexpr double kFocal_px = 100;

/// A box-shaped room, 4 m wide, 2.4 m high and 3 m deep, with a table and a pillar, each a separate
/// plane. The camera looks along +z of the world, y down.
struct Wall {
  Vec3d corner, u, v;
};
const std::vector<Wall>& room() {
  static const std::vector<Wall> walls = {
      {{-2, 1, 0}, {4, 0, 0}, {0, 0, 3}},            // floor
      {{-2, -1.4, 3}, {4, 0, 0}, {0, 2.4, 0}},       // far wall
      {{-2, -1.4, 0}, {0, 0, 3}, {0, 2.4, 0}},       // left
      {{2, -1.4, 0}, {0, 0, 3}, {0, 2.4, 0}},        // right
      {{-0.6, 0.4, 1.4}, {0.9, 0, 0}, {0, 0, 0.6}},  // table
      {{0.8, -1.4, 2}, {0.3, 0, 0}, {0, 2.4, 0}},    // pillar
  };
  return walls;
}

/// The camera's view: a cloud with the room's planes, numbered by size, so that their ids differ
/// between frames. `hidden`: a plane that is not found.
struct Seen {
  planes::Cloud cloud;
  std::vector<std::int32_t> plane_of;
  std::vector<int> id_of;  // by wall; 0: not visible
  std::size_t planes = 0;

  explicit Seen(const Pose& T_world_camera, int hidden = -1) {
    cloud.width = kColumns;
    cloud.height = kRows;
    std::vector<int> wall_of;
    std::vector<int> count(room().size(), 0);
    for (int v = 0; v < kRows; ++v)
      for (int u = 0; u < kColumns; ++u) {
        const Vec3d ray((u - 79.5) / kFocal_px, (v - 59.5) / kFocal_px, 1);
        const auto [depth, wall] = hit(T_world_camera, ray);
        if (wall < 0) continue;
        cloud.points.push_back((depth * ray).cast<float>());
        cloud.source.push_back(static_cast<std::uint32_t>(v * kColumns + u));
        wall_of.push_back(wall == hidden ? -1 : wall);
        if (wall != hidden) ++count[static_cast<std::size_t>(wall)];
      }
    // A sliver is not a plane.
    for (int& wall : wall_of)
      if (wall >= 0 && count[static_cast<std::size_t>(wall)] < kLeast_px) wall = -1;
    for (int& px : count)
      if (px < kLeast_px) px = 0;
    std::vector<std::size_t> order(room().size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return count[i]; });
    id_of.assign(room().size(), 0);
    int next = 0;
    for (const std::size_t i : order)
      if (count[i] > 0) id_of[i] = ++next;
    for (const int wall : wall_of)
      plane_of.push_back(wall < 0 ? 0 : id_of[static_cast<std::size_t>(wall)]);
    planes = static_cast<std::size_t>(next);
  }

  PlaneImage image() const { return plane_image(cloud, plane_of, planes); }

  static std::pair<double, int> hit(const Pose& T, const Vec3d& ray) {
    std::pair<double, int> nearest{1e9, -1};
    for (std::size_t i = 0; i < room().size(); ++i) {
      const Wall& w = room()[i];
      Mat3d m;
      m << w.u, w.v, -(T.linear() * ray);
      if (std::abs(m.determinant()) < 1e-9) continue;
      const Vec3d at = m.inverse() * (T.translation() - w.corner);
      if (at.x() < 0 || at.x() > 1 || at.y() < 0 || at.y() > 1 || at.z() <= 0) continue;
      if (at.z() < nearest.first) nearest = {at.z(), static_cast<int>(i)};
    }
    return nearest;
  }
};

Pose pose(double right_m, double yaw_deg, double roll_deg = 0) {
  const double deg = std::numbers::pi / 180;
  Pose T = Pose::Identity();
  T.linear() = (Eigen::AngleAxisd(yaw_deg * deg, Vec3d::UnitY()) *
                Eigen::AngleAxisd(roll_deg * deg, Vec3d::UnitZ()))
                   .toRotationMatrix();
  T.translation() = Vec3d(right_m, 0, 0.2);
  return T;
}

/// By wall; 0: not visible.
std::vector<int> by_wall(const Seen& seen, const ColoredPlanes& colored) {
  std::vector<int> colors;
  for (const int id : seen.id_of)
    colors.push_back(id > 0 ? colored.colors[static_cast<std::size_t>(id) - 1] : 0);
  return colors;
}

TEST(PlaneColors, StayOnTheirSurfacesWhileTheCameraMovesTurnsAndRolls) {
  std::vector<int> first(room().size(), 0);
  std::optional<ColoredPlanes> before;
  for (int i = 0; i < 25; ++i) {
    const Seen seen(pose(0.03 * i - 0.4, 2.0 * i - 24, 1.5 * (i % 5)));
    before = color_planes(seen.image(), before ? &*before : nullptr);
    const std::vector<int> colors = by_wall(seen, *before);
    for (std::size_t wall = 0; wall < first.size(); ++wall) {
      if (first[wall] == 0) first[wall] = colors[wall];
      EXPECT_TRUE(colors[wall] == 0 || colors[wall] == first[wall]) << wall << " in frame " << i;
    }
    std::set<int> distinct(colors.begin(), colors.end());
    distinct.erase(0);
    EXPECT_EQ(distinct.size(), seen.planes) << "frame " << i;
  }
  EXPECT_EQ(std::ranges::count(first, 0), 0) << "all walls came into view";
}

TEST(PlaneColors, TheMotionOfTheCameraFollowsFromItsPlanes) {
  const Seen a(pose(0, 0)), b(pose(0.05, 3));
  const PlaneMatch match = match_planes(a.image(), b.image());
  for (std::size_t wall = 0; wall < room().size(); ++wall)
    if (b.id_of[wall] > 0) {
      EXPECT_EQ(match.before_of[static_cast<std::size_t>(b.id_of[wall]) - 1], a.id_of[wall])
          << wall;
    }
  const Pose expected = pose(0.05, 3).inverse() * pose(0, 0);
  EXPECT_LT((match.T_now_before.translation() - expected.translation()).norm(), 0.01);
  EXPECT_LT(Eigen::AngleAxisd(match.T_now_before.linear().transpose() * expected.linear()).angle(),
            0.01);
}

TEST(PlaneColors, APlaneThatIsLostForAWhileGetsItsColorBack) {
  constexpr int kTable = 4;
  const Seen first(pose(-0.1, 0));
  ColoredPlanes colored = color_planes(first.image());
  const int color = by_wall(first, colored)[kTable];
  for (int i = 1; i <= kRememberedFrames; ++i) {
    const Seen without(pose(-0.1 + 0.02 * i, 0.5 * i), kTable);
    colored = color_planes(without.image(), &colored);
    const std::vector<int> others = by_wall(without, colored);
    EXPECT_EQ(std::ranges::count(others, color), 0) << "nothing else takes it";
  }
  const Seen again(pose(0.12, 5.5));
  EXPECT_EQ(by_wall(again, color_planes(again.image(), &colored))[kTable], color);
}

TEST(PlaneColors, AreNotForgottenInAFrameWithoutPlanes) {
  const Seen first(pose(0, 0));
  ColoredPlanes colored = color_planes(first.image());
  const std::vector<int> before = by_wall(first, colored);
  colored = color_planes(PlaneImage{}, &colored);
  EXPECT_TRUE(colored.own_colors().empty());
  EXPECT_EQ(by_wall(first, color_planes(first.image(), &colored)), before);
}

TEST(PlaneColors, TheLargerOfTwoTouchingPlanesKeepsItsColor) {
  PlaneImage image;
  image.planes.resize(3);
  for (std::size_t i = 0; i < 3; ++i) image.planes[i].size = 100 * (i + 1);
  image.touching = {{1, 2}};
  const std::vector<int> colors = settle_colors(image, {5, 5, 5});
  EXPECT_EQ(colors[1], 5);
  EXPECT_EQ(colors[2], 5) << "it touches neither";
  EXPECT_NE(colors[0], 5);
  EXPECT_EQ(settle_colors(image, {0, 2, 3}, {1})[0], 4)
      << "the first that is neither taken nor kept";
}

TEST(PlaneColors, TouchingPlanesDifferInAnyNumber) {
  // A large new plane touches more small ones than there are colors, and they use all colors.
  PlaneImage image;
  image.planes.resize(3 * kPlaneColors);
  std::vector<int> wanted;
  for (int i = 0; i < std::ssize(image.planes); ++i) {
    image.planes[static_cast<std::size_t>(i)].size = i == 0 ? 1'000'000 : 10;
    wanted.push_back(i);
    if (i > 0) image.touching.emplace_back(1, i + 1);
    if (i > 1) image.touching.emplace_back(i, i + 1);
  }
  const std::vector<int> colors = settle_colors(image, wanted);
  for (const auto& [a, b] : image.touching)
    EXPECT_NE(colors[static_cast<std::size_t>(a) - 1], colors[static_cast<std::size_t>(b) - 1])
        << a << " " << b;
}

TEST(PlaneImage, PlanesTouchAcrossAnUnmeasuredEdgeButNotAcrossTheRoom) {
  const auto touching = [](int gap) {
    planes::Cloud cloud;
    cloud.width = 800;
    cloud.height = 4;
    std::vector<std::int32_t> plane_of;
    for (int v = 0; v < 4; ++v)
      for (int u = 0; u < 800; ++u) {
        if (u >= 400 && u < 400 + gap) continue;
        cloud.points.push_back({0.01F * static_cast<float>(u), 0.01F * static_cast<float>(v), 1});
        cloud.source.push_back(static_cast<std::uint32_t>(800 * v + u));
        plane_of.push_back(u < 400 ? 1 : 2);
      }
    return plane_image(cloud, plane_of, 2).touching.size();
  };
  EXPECT_EQ(touching(0), 1u);
  EXPECT_EQ(touching(9), 1u);
  EXPECT_EQ(touching(10), 0u);
}

TEST(PlaneImage, OfACloudPlanesTouchInSpace) {
  planes::Cloud cloud;
  std::vector<std::int32_t> plane_of;
  const auto add = [&](const Vec3f& corner, int id) {
    for (int i = 0; i < 20; ++i)
      for (int k = 0; k < 20; ++k) {
        cloud.points.push_back(
            corner + Vec3f(0.05F * static_cast<float>(i), 0.05F * static_cast<float>(k), 0));
        plane_of.push_back(id);
      }
  };
  add({0, 0, 0}, 1);
  add({1.05F, 0, 0.1F}, 2);
  add({3, 0, 0}, 3);
  const PlaneImage image = plane_image(cloud, plane_of, 3);
  EXPECT_EQ(image.touching, (std::vector<std::pair<int, int>>{{1, 2}}));
  // The same cloud, with its planes in a different order.
  for (std::int32_t& id : plane_of) id = 4 - id;
  const ColoredPlanes before = color_planes(image);
  const ColoredPlanes now = color_planes(plane_image(cloud, plane_of, 3), &before);
  EXPECT_EQ(now.colors, (std::vector{before.colors[2], before.colors[1], before.colors[0]}));
}

}  // namespace
}  // namespace planescope::render
