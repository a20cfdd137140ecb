#include "core/labels/model/fragments.hpp"

#include <gtest/gtest.h>

namespace planescope::labels {
namespace {

TEST(Fragments, PartsThatTouchOnlyAtACornerAreTwo) {
  Image16 image(4, 3);
  image.data = {5, 5, 0, 2,  //
                0, 5, 0, 2,  //
                5, 0, 2, 0};
  const auto counts = count_fragments(image);
  ASSERT_EQ(counts.size(), 6u);
  EXPECT_EQ(counts[5], 2);
  EXPECT_EQ(counts[2], 2);
  EXPECT_EQ(counts[1], 0);
}

TEST(Fragments, ASpiralIsOnePart) {
  Image16 image(5, 5);
  image.data = {1, 1, 1, 1, 1,  //
                0, 0, 0, 0, 1,  //
                1, 1, 1, 0, 1,  //
                1, 0, 0, 0, 1,  //
                1, 1, 1, 1, 1};
  EXPECT_EQ(count_fragments(image)[1], 1);
}

}  // namespace
}  // namespace planescope::labels
