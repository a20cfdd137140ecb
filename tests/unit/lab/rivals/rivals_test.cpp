// Tests of the PCL and CGAL methods, and of the nanoflann PCA classifier.

#include "core/lab/rivals/rivals.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "core/lab/synthetic/stairs.hpp"
#include "core/model/error.hpp"
#include "support/found_planes.hpp"

namespace planescope::lab {
namespace {

using test::angle_deg;
using test::floor_and_wall;
using test::points_everywhere;
using test::same;

/// A floor and a wall, seen by a camera that looks along +x, 0.5 m above the floor and 1 m in front
/// of the wall. The leftmost columns were not measured, the rightmost are cropped.
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
  planes::PixelPoints input() const {
    return {.points = points,
            .pixel = pixel,
            .kept = kept,
            .view = Vec3f::UnitX(),
            .width = kWidth,
            .height = kHeight};
  }
};

/// Rivals for unordered clouds.
std::vector<LibraryRival> cloud_rivals() {
  std::vector<LibraryRival> rivals = library_rivals();
  std::erase_if(rivals, [](const LibraryRival& rival) { return !rival.on_points; });
  return rivals;
}

class FurtherRivals : public testing::TestWithParam<LibraryRival> {
 protected:
  static planes::FoundPlanes find(std::span<const Vec3f> points) {
    return GetParam().on_points(points, /*by_point=*/true);
  }
};
/// GoogleTest would print the bytes, which contain addresses that differ between runs.
[[maybe_unused]] void PrintTo(const LibraryRival& rival, std::ostream* out) { *out << rival.name; }

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(FurtherRivals);
INSTANTIATE_TEST_SUITE_P(OfUnorderedClouds, FurtherRivals, testing::ValuesIn(cloud_rivals()));

TEST_P(FurtherRivals, FindAFloorAndTheSmallerWallOnIt) {
  const std::vector<Vec3f> points = floor_and_wall(3000, 1500, 0.001);
  const planes::FoundPlanes found = find(points);
  ASSERT_EQ(found.planes.size(), 2u);
  EXPECT_LT(angle_deg(found.planes[0].normal, Vec3d::UnitZ()), 0.5);
  EXPECT_LT(angle_deg(found.planes[1].normal, Vec3d::UnitX()), 0.5);
  ASSERT_EQ(found.plane_of.size(), points.size());
  EXPECT_GT(std::count(found.plane_of.begin(), found.plane_of.begin() + 3000, 1), 2700);
  EXPECT_GT(std::count(found.plane_of.begin() + 3000, found.plane_of.end(), 2), 1300);
}

TEST_P(FurtherRivals, FindNothingInFewPoints) {
  for (const int count : {0, 1, 2, 3, 10}) {
    const planes::FoundPlanes found = find(points_everywhere(count));
    EXPECT_TRUE(found.planes.empty());
    EXPECT_EQ(found.plane_of, std::vector<std::int32_t>(static_cast<std::size_t>(count), 0));
  }
}

TEST_P(FurtherRivals, AreDeterministicAlsoInParallel) {
  const std::vector<Vec3f> points = floor_and_wall(2000, 1000, 0.003);
  const planes::FoundPlanes once = find(points);
  EXPECT_TRUE(same(once, find(points)));
  planes::FoundPlanes others[2];
  {
    std::jthread a([&] { others[0] = find(points); });
    std::jthread b([&] { others[1] = find(points); });
  }
  EXPECT_TRUE(same(once, others[0]));
  EXPECT_TRUE(same(once, others[1]));
}

TEST(PclMultiPlane, FindsTheFloorAndTheWallInADepthImageFromAnyPosition) {
  const LibraryRival* rival = find_library_rival("pcl-multi-plane");
  if (!rival) GTEST_SKIP() << "this build has none of them (-DPLANESCOPE_RIVALS=ON)";
  PixelScene scene;
  planes::PixelPoints input = scene.input();
  const planes::FoundPlanes found = rival->on_pixels(input);
  ASSERT_GE(found.planes.size(), 2u) << "smaller ones along the crease";
  EXPECT_GT(std::max(found.planes[0].normal.x(), found.planes[0].normal.z()), 0.99);
  EXPECT_LT(std::abs(found.planes[0].normal.dot(found.planes[1].normal)), 0.02);
  std::size_t in_planes = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    in_planes += found.plane_of[i] != 0;
    EXPECT_TRUE(scene.kept[i] || found.plane_of[i] == 0);
  }
  EXPECT_GT(in_planes, 9 * scene.points.size() / 10);

  // The same camera and scene, with points relative to another origin.
  const Vec3f shift(2, 1, 0.5);
  for (Vec3f& p : scene.points) p += shift;
  input = scene.input();
  input.sensor = shift;
  const planes::FoundPlanes again = rival->on_pixels(input);
  EXPECT_TRUE(same(again, rival->on_pixels(input)));
  ASSERT_GE(again.planes.size(), 2u);
  EXPECT_LT(angle_deg(again.planes[0].normal, found.planes[0].normal), 0.05);
}

TEST(LibraryRivals, ThoseForDepthImagesRejectClouds) {
  const LibraryRival on_pixels{
      "images", [](const planes::PixelPoints&) { return planes::FoundPlanes(); }, nullptr};
  Frame frame;
  frame.cloud = make_stairs(0, {.points = 64}).cloud;
  EXPECT_THROW(run_method(frame, {}, nullptr, &on_pixels), Error);
}

// ---- Classifiers ----

/// Points farther from any other plane than their 16 neighbors.
std::vector<bool> away_from_edges(const PointSet& cloud) {
  constexpr float kReach = 0.08f;
  std::vector<bool> away(cloud.points.size(), true);
  for (std::size_t i = 0; i < away.size(); ++i)
    for (std::size_t j = 0; j < away.size() && away[i]; ++j)
      away[i] =
          cloud.label[i] == cloud.label[j] || (cloud.points[i] - cloud.points[j]).norm() > kReach;
  return away;
}

TEST(NanoflannPca, AgreesWithOurPcaAwayFromEdges) {
  const PointSet cloud = make_stairs(2, {.points = 4096}).cloud;
  const std::vector<bool> away = away_from_edges(cloud);
  const planes::Classification rival = make_nanoflann_pca_classifier()->classify(cloud.points, 1);
  const planes::Classification ours = planes::make_pca_classifier()->classify(cloud.points, 1);
  int compared = 0;
  for (std::size_t i = 0; i < away.size(); ++i) {
    if (!away[i]) continue;
    ++compared;
    ASSERT_EQ(rival.labels[i], static_cast<Label>(cloud.label[i]));
    ASSERT_EQ(rival.labels[i], ours.labels[i]);
    ASSERT_NEAR(rival.margins[i], 1, 1e-3);
  }
  EXPECT_GT(compared, 1000);
}

TEST(NanoflannPca, GivesTheSameAnswerForAnyThreadCount) {
  const PointSet cloud = make_stairs(1, {.points = 2048, .noise_m = 0.002}).cloud;
  const auto classifier = make_nanoflann_pca_classifier();
  const planes::Classification one = classifier->classify(cloud.points, 1);
  const planes::Classification four = classifier->classify(cloud.points, 4);
  EXPECT_EQ(one.labels, four.labels);
  EXPECT_EQ(one.margins, four.margins);
}

TEST(NanoflannPca, AcceptsTinyCloudsAndNonFinitePoints) {
  const auto classifier = make_nanoflann_pca_classifier();
  EXPECT_TRUE(classifier->classify({}, 1).labels.empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {0, 1, 0}};
  const planes::Classification result = classifier->classify(points, 1);
  EXPECT_EQ(result.labels, (std::vector{Label::h, Label::h, Label::unknown, Label::h}));
}

}  // namespace
}  // namespace planescope::lab
