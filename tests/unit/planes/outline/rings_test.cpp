// Tests of tracing regions of pixels as rings.

#include "core/planes/outline/rings.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "core/model/random.hpp"

namespace planescope::planes {
namespace {

struct Drawn {
  int width = 0, height = 0;
  std::vector<std::int32_t> labels;
  std::vector<Ring> rings() const { return trace_rings(labels, width, height); }
};

/// Digits are labels; '.' is unlabeled.
Drawn drawn(const std::vector<std::string>& rows) {
  Drawn image{static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), {}};
  for (const std::string& row : rows)
    for (const char c : row) image.labels.push_back(c == '.' ? 0 : c - '0');
  return image;
}

TEST(Rings, ARegionWithAHoleHasTwo) {
  const std::vector<Ring> rings = drawn({"....",  //
                                         ".111", ".1.1", ".111"})
                                      .rings();
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_FALSE(rings[0].hole);
  EXPECT_EQ(rings[0].corners, (std::vector<Corner>{{1, 4}, {4, 4}, {4, 1}, {1, 1}}));
  EXPECT_TRUE(rings[1].hole);
  EXPECT_EQ(rings[1].corners.size(), 4u);
  EXPECT_EQ(rings[0].part, rings[1].part);
}

TEST(Rings, RegionsThatTouchAtACornerAreTwo) {
  const std::vector<Ring> rings = drawn({"1.", ".1"}).rings();
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_NE(rings[0].part, rings[1].part);
  const Corner &own = rings[0].corners[1], &others = rings[1].corners[3];
  EXPECT_EQ(Vec2d(own.x, own.y), Vec2d(others.x, others.y));
  EXPECT_EQ(own.place(), Vec2d(0.75, 0.75)) << "and do not touch";
  EXPECT_EQ(others.place(), Vec2d(1.25, 1.25));
}

TEST(Rings, ContainEachPixelOfTheirLabelOnce) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    Drawn image{random.integer(1, 23), random.integer(1, 17), {}};
    const int labels = random.integer(1, 3);
    for (int i = 0; i < image.width * image.height; ++i)
      image.labels.push_back(random.integer(0, labels));
    std::vector<int> covered(image.labels.size(), 0);  // sum of the labels around each pixel
    std::map<std::int32_t, std::int32_t> label_of_part;
    std::set<std::int32_t> outer;
    for (const Ring& ring : image.rings()) {
      label_of_part.emplace(ring.part, ring.label);
      EXPECT_EQ(label_of_part[ring.part], ring.label);
      EXPECT_EQ(ring.hole, !outer.insert(ring.part).second) << "one outer ring, and the first";
      for (const PixelRun& run : pixels_inside(ring))
        for (int x = run.x0; x < run.x1; ++x)
          covered[static_cast<std::size_t>(run.y) * image.width + x] +=
              ring.hole ? -ring.label : ring.label;
    }
    for (std::size_t i = 0; i < covered.size(); ++i)
      ASSERT_EQ(covered[i], image.labels[i]) << "trial " << trial << ", pixel " << i;
  }
}

}  // namespace
}  // namespace planescope::planes
