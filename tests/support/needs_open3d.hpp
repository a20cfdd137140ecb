#pragma once

#include <gtest/gtest.h>

/// Skips the running test where the rival `ransac`, which is Open3D's, is not built in.
#define PLANESCOPE_NEEDS_OPEN3D() \
  if (!PLANESCOPE_WITH_OPEN3D) GTEST_SKIP() << "needs a build with PLANESCOPE_OPEN3D"
