#include "core/lab/synthetic/repeatable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace planescope::lab {
namespace {

TEST(Random, ValuesAreFixedForAllTime) {
  EXPECT_EQ(mix_bits(0), 0xe220a8397b1dcdafu);  // the published first value of splitmix64
  EXPECT_EQ(random_uniform(1, 2, 3), random_uniform(1, 2, 3));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(1, 3, 2));
  EXPECT_NE(random_bits(1, 2, 3), random_bits(2, 1, 3));
}

TEST(Random, NormalValuesHaveTheMomentsOfANormalDistribution) {
  constexpr int kCount = 200000;
  double sum = 0, squares = 0, fourth = 0, largest = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random_normal(7, 1, i);
    largest = std::max(largest, std::abs(x));
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_LT(largest, 4.91);
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(squares / kCount, 1, 0.01);
  EXPECT_NEAR(fourth / kCount, 3 - 1.2 / 8, 0.06);  // Irwin-Hall of 8 has a little less tail
}

}  // namespace
}  // namespace planescope::lab
