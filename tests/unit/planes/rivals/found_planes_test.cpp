// Tests of plane numbering in rival methods, and of the missing-RANSAC error.

#include <gtest/gtest.h>

#include "core/planes/rivals/rivals.hpp"
#include "support/refusal.hpp"

namespace planescope::planes {
namespace {

const std::vector<Vec3f> kPoints = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2},
                                    {1, 0, 2}, {0, 1, 2}, {1, 1, 2}, {5, 5, 5},
                                    {0, 0, 3}, {1, 0, 3}, {0, 1, 3}};

TEST(FoundPlanes, AreNumberedLargestFirstAndFitted) {
  const std::vector<std::int32_t> group = {2, 2, 2, 7, 7, 7, 7, -1, 5, 5, 5};
  const FoundPlanes found = found_planes(kPoints, group);
  EXPECT_EQ(found.plane_of, (std::vector<std::int32_t>{2, 2, 2, 1, 1, 1, 1, 0, 3, 3, 3}));
  ASSERT_EQ(found.planes.size(), 3u);
  EXPECT_DOUBLE_EQ(found.planes[0].offset_m(), 2);
  EXPECT_DOUBLE_EQ(found.planes[1].offset_m(), 1);
  EXPECT_EQ(found.planes[0].normal, Vec3d(0, 0, 1));
}

TEST(FoundPlanes, OfTooFewPointsAreRemoved) {
  const std::vector<std::int32_t> group = {2, 2, 2, 7, 7, 7, 7, 3, 0, 0, 0};
  const FoundPlanes found = found_planes(kPoints, group, 4);
  EXPECT_EQ(found.plane_of, (std::vector<std::int32_t>{0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(found.planes.size(), 1u);
}

TEST(FoundPlanes, WithoutPointsAreEmpty) {
  EXPECT_TRUE(found_planes({}, {}).planes.empty());
  EXPECT_TRUE(found_planes({}, {}).plane_of.empty());
}

TEST(Ransac, IsRejectedByNameIfTheProgramLacksIt) {
  expect_refused([] { find_planes_ransac({}, {}); },
                 "method ransac is not part of this build; configure it with "
                 "-DPLANESCOPE_OPEN3D=ON");
}

}  // namespace
}  // namespace planescope::planes
