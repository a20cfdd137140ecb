// Planes known before a depth image is processed, from other frames or from the same one.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/error.hpp"
#include "support/wall_scene.hpp"

namespace planescope::planes {
namespace {

using test::depth_frame;
using test::plane_at;

FrameResult planes_with(const Frame& frame, std::span<const KnownPlane> known = {}) {
  return run_frame(frame, test::wall_options(), nullptr, nullptr, nullptr, known);
}

/// A plane parallel to the image, expected in the columns from `left` to `right`.
KnownPlane upright_at(double z_m, int id, int left, int right) {
  KnownPlane known;
  known.id = id;
  known.plane.c = 1 / z_m;
  known.slack_m = 0.002;
  for (std::uint32_t pixel = 0; pixel < 640 * 480; ++pixel)
    if (static_cast<int>(pixel % 640) >= left && static_cast<int>(pixel % 640) < right)
      known.pixels.push_back(pixel);
  return known;
}

/// A wall at 2 m whose right half is farther by `step_m`.
Frame stepped_wall(double step_m) {
  return depth_frame([=](double x, double) { return x < 0 ? 2 : 2 + step_m; }, 0.004);
}

TEST(KnownPlanes, AreKeptSeparateIfNoiseHidesTheStep) {
  const Frame frame = stepped_wall(0.012);
  ASSERT_EQ(planes_with(frame).segmentation.planes.size(), 1u);
  const std::vector<KnownPlane> known = {upright_at(2, 7, 0, 320), upright_at(2.012, 3, 320, 640)};
  const FrameResult result = planes_with(frame, known);
  ASSERT_EQ(result.segmentation.planes.size(), 2u);
  const int left = plane_at(result, 100, 240), right = plane_at(result, 500, 240);
  ASSERT_GT(left, 0);
  ASSERT_GT(right, 0);
  EXPECT_EQ(result.segmentation.planes[left - 1].known, 7);
  EXPECT_EQ(result.segmentation.planes[right - 1].known, 3);
}

TEST(KnownPlanes, AreNotFoundIfDepthDoesNotShowThem) {
  const Frame frame = stepped_wall(0.3);
  const FrameResult alone = planes_with(frame);
  // In front of the wall and behind it.
  for (const double z_m : {1.7, 2.15, 2.6}) {
    const std::vector<KnownPlane> known = {upright_at(z_m, 7, 0, 640)};
    const FrameResult result = planes_with(frame, known);
    EXPECT_EQ(result.plane_of, alone.plane_of) << z_m;
    for (const PlaneRegion& plane : result.segmentation.planes) EXPECT_EQ(plane.known, 0) << z_m;
  }
}

TEST(KnownPlanes, AreCoveredByALargerOneThatCoincides) {
  const Frame frame = stepped_wall(0);
  const std::vector<KnownPlane> same = {upright_at(2, 1, 0, 640), upright_at(2.001, 2, 200, 300)};
  const FrameResult result = planes_with(frame, same);
  ASSERT_EQ(result.segmentation.covered.size(), 1u);
  EXPECT_EQ(result.segmentation.covered[0].covered, 2);
  EXPECT_EQ(result.segmentation.covered[0].by, 1);
}

TEST(KnownPlanes, AreNotCoveredByOneThatMerelyCrossesThem) {
  const Frame frame = stepped_wall(0);
  KnownPlane crossing = upright_at(2, 2, 0, 640);
  crossing.plane.a = 0.001;  // in front of the wall on one side, behind it on the other
  const std::vector<KnownPlane> known = {upright_at(2, 1, 0, 640), crossing};
  const FrameResult result = planes_with(frame, known);
  ASSERT_EQ(result.segmentation.planes.size(), 1u);
  EXPECT_EQ(result.segmentation.planes[0].known, 1);
  EXPECT_TRUE(result.segmentation.covered.empty());
}

/// The result's planes, as a map stores them.
std::shared_ptr<GivenPlanes> given_of(const FrameResult& result) {
  auto given = std::make_shared<GivenPlanes>();
  given->plane_of = Image16(640, 480);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    given->plane_of.data[result.cloud.source[i]] = static_cast<std::uint16_t>(result.plane_of[i]);
  given->listed = static_cast<int>(result.segmentation.planes.size());
  for (const PlaneRegion& plane : result.segmentation.planes)
    given->margins.push_back(plane.margin);
  return given;
}

TEST(GivenPlanes, AreUsedUnchanged) {
  Frame frame = stepped_wall(0.012);
  const std::vector<KnownPlane> known = {upright_at(2, 7, 0, 320), upright_at(2.012, 3, 320, 640)};
  const FrameResult found = planes_with(frame, known);
  frame.given = given_of(found);
  const FrameResult taken = planes_with(frame);
  EXPECT_EQ(taken.plane_of, found.plane_of);
  ASSERT_EQ(taken.segmentation.planes.size(), found.segmentation.planes.size());
  for (std::size_t k = 0; k < found.segmentation.planes.size(); ++k) {
    const PlaneRegion &a = found.segmentation.planes[k], &b = taken.segmentation.planes[k];
    EXPECT_LT((a.fit.normal - b.fit.normal).norm(), 1e-9);
    EXPECT_LT((a.fit.centroid - b.fit.centroid).norm(), 1e-9);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.margin, b.margin);
    EXPECT_EQ(a.undecided, b.undecided);
  }
}

TEST(GivenPlanes, OfAnotherImageAreRejected) {
  Frame frame = stepped_wall(0.3);
  const std::shared_ptr<const GivenPlanes> right = given_of(planes_with(frame));
  const auto refusal = [&](const std::function<void(GivenPlanes&)>& damage) -> std::string {
    const auto given = std::make_shared<GivenPlanes>(*right);
    damage(*given);
    frame.given = given;
    try {
      planes_with(frame);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal([](GivenPlanes&) {}), "");
  EXPECT_EQ(refusal([](GivenPlanes& given) { given.plane_of = Image16(640, 479); }),
            "stored planes are 640x479; expected 640x480");
  EXPECT_EQ(refusal([](GivenPlanes& given) { given.plane_of.data[5] = 9; }),
            "stored planes contain plane 9; expected at most 2");
  frame.depth.at(100, 240) = 0;
  EXPECT_NE(refusal([](GivenPlanes&) {}).find("do not match the depth"), std::string::npos);
}

}  // namespace
}  // namespace planescope::planes
