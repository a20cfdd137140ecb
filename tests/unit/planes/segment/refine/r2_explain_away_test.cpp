#include "core/planes/segment/refine/r2_explain_away.hpp"

#include <gtest/gtest.h>

#include "core/planes/segment/criteria.hpp"

namespace planescope::planes {
namespace {

TEST(ExplainAway, TellsNoiseFromSurfacesByWidthAndDensity) {
  PlaneFit strip;  // 100 points over 1 m x 2 cm: variances are the squared sides over 12
  strip.count = 100;
  strip.eigenvalues = {0, 100 * 0.0004 / 12, 100 * 1.0 / 12};
  EXPECT_NEAR(area_per_point(strip), 0.02 / 100, 1e-12);
  const r2_explain_away::Options options;
  EXPECT_TRUE(is_wider_than_noise(strip, 0.002, options));
  EXPECT_FALSE(is_wider_than_noise(strip, 0.006, options));
  EXPECT_TRUE(is_dense(strip, 0.02 / 100, options));
  EXPECT_FALSE(is_dense(strip, 0.1 * 0.02 / 100, options));
}

}  // namespace
}  // namespace planescope::planes
