#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "core/model/error.hpp"
#include "core/planes/rivals/rivals.hpp"
#include "unit/planes/rivals/found_planes_support.hpp"

namespace planescope::planes {
namespace {

using test::angle_deg;
using test::floor_and_wall;
using test::points_everywhere;
using test::same;

/// A floor and a wall seen by a camera that looks along +x, 0.5 m above the floor and 1 m before
/// the wall; the leftmost columns were not measured, the rightmost cropped.
struct PixelScene {
  static constexpr int kWidth = 320, kHeight = 240, kUnmeasured = 10, kCropped = 5;
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> pixel;
  std::vector<std::uint8_t> kept;

  PixelScene() {
    Random random(3);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = kUnmeasured; u < kWidth; ++u) {
        const Vec3d ray(1, -(u - kWidth / 2) / 300.0, -(v - kHeight / 2) / 300.0 - 0.4);
        const double depth = ray.z() < -0.5 ? 0.5 / -ray.z() : 1;
        points.push_back(((depth + 0.0005 * random.normal()) * ray).cast<float>());
        pixel.push_back(static_cast<std::uint32_t>(v * kWidth + u));
        kept.push_back(u < kWidth - kCropped);
      }
    }
  }
  PixelPoints input() const {
    return {.points = points,
            .pixel = pixel,
            .kept = kept,
            .view = Vec3f::UnitX(),
            .width = kWidth,
            .height = kHeight};
  }
};

struct Rival {
  const char* name;
  std::function<FoundPlanes(std::span<const Vec3f>)> find;
};
const Rival kRivals[] = {
    {"pcl_region_growing",
     [](auto points) { return pcl_region_growing(points, kPclRegionGrowingByPoint); }},
    {"cgal_ransac", [](auto points) { return cgal_ransac(points, kCgalRansacByPoint); }},
    {"cgal_region_growing",
     [](auto points) { return cgal_region_growing(points, kCgalRegionGrowingByPoint); }}};

class FurtherRivals : public testing::TestWithParam<Rival> {
 protected:
  void SetUp() override {
    if (!has_pcl_and_cgal()) GTEST_SKIP() << "this build has none of them (-DPLANESCOPE_RIVALS=ON)";
  }
};
/// GoogleTest would print the bytes, with addresses that differ from run to run.
void PrintTo(const Rival& rival, std::ostream* out) { *out << rival.name; }

INSTANTIATE_TEST_SUITE_P(OfUnorderedClouds,
                         FurtherRivals,
                         testing::ValuesIn(kRivals),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(FurtherRivals, FindAFloorAndTheSmallerWallOnIt) {
  const std::vector<Vec3f> points = floor_and_wall(3000, 1500, 0.001);
  const FoundPlanes found = GetParam().find(points);
  ASSERT_EQ(found.planes.size(), 2u);
  EXPECT_LT(angle_deg(found.planes[0].normal, Vec3d::UnitZ()), 0.5);
  EXPECT_LT(angle_deg(found.planes[1].normal, Vec3d::UnitX()), 0.5);
  ASSERT_EQ(found.plane_of.size(), points.size());
  EXPECT_GT(std::count(found.plane_of.begin(), found.plane_of.begin() + 3000, 1), 2700);
  EXPECT_GT(std::count(found.plane_of.begin() + 3000, found.plane_of.end(), 2), 1300);
}

TEST_P(FurtherRivals, FindNothingInFewPoints) {
  for (const int count : {0, 1, 2, 3, 10}) {
    const FoundPlanes found = GetParam().find(points_everywhere(count));
    EXPECT_TRUE(found.planes.empty());
    EXPECT_EQ(found.plane_of, std::vector<std::int32_t>(static_cast<std::size_t>(count), 0));
  }
}

TEST_P(FurtherRivals, AnswerTheSameAgainAndInThreadsAtATime) {
  const std::vector<Vec3f> points = floor_and_wall(2000, 1000, 0.003);
  const FoundPlanes once = GetParam().find(points);
  EXPECT_TRUE(same(once, GetParam().find(points)));
  FoundPlanes others[2];
  {
    std::jthread a([&] { others[0] = GetParam().find(points); });
    std::jthread b([&] { others[1] = GetParam().find(points); });
  }
  EXPECT_TRUE(same(once, others[0]));
  EXPECT_TRUE(same(once, others[1]));
}

TEST(PclMultiPlane, FindsTheFloorAndTheWallInADepthImageFromWhereverItIsSeen) {
  if (!has_pcl_and_cgal()) GTEST_SKIP() << "this build has none of them (-DPLANESCOPE_RIVALS=ON)";
  // Along the crease each row of pixels has normals of its own: a region, but for its size.
  const PclMultiPlaneOptions options{.min_points = 1000};
  PixelScene scene;
  PixelPoints input = scene.input();
  const FoundPlanes found = pcl_multi_plane(input, options);
  ASSERT_EQ(found.planes.size(), 2u);
  EXPECT_GT(std::max(found.planes[0].normal.x(), found.planes[0].normal.z()), 0.99);
  EXPECT_LT(std::abs(found.planes[0].normal.dot(found.planes[1].normal)), 0.02);
  std::size_t in_planes = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    in_planes += found.plane_of[i] != 0;
    EXPECT_TRUE(scene.kept[i] || found.plane_of[i] == 0);
  }
  EXPECT_GT(in_planes, 9 * scene.points.size() / 10);

  // The same camera and scene, the points told about another origin.
  const Vec3f shift(2, 1, 0.5);
  for (Vec3f& p : scene.points) p += shift;
  input = scene.input();
  input.sensor = shift;
  const FoundPlanes again = pcl_multi_plane(input, options);
  EXPECT_TRUE(same(again, pcl_multi_plane(input, options)));
  ASSERT_EQ(again.planes.size(), 2u);
  EXPECT_LT(angle_deg(again.planes[0].normal, found.planes[0].normal), 0.05);
}

TEST(MissingRivals, AreRefusedByName) {
  const auto refused = [](auto find, const std::string& name, const std::string& option) {
    try {
      find();
      FAIL() << "nothing was refused";
    } catch (const Error& error) {
      EXPECT_EQ(
          error.what(),
          "method " + name + " is not part of this build, configure it with -D" + option + "=ON");
    }
  };
  refused([] { find_planes_ransac({}, {}); }, "ransac", "PLANESCOPE_OPEN3D");
  if (!has_pcl_and_cgal()) refused([] { cgal_ransac({}, {}); }, "cgal-ransac", "PLANESCOPE_RIVALS");
}

}  // namespace
}  // namespace planescope::planes
