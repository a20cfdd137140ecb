#pragma once

#include <gtest/gtest.h>

/// Skips the running test if the rival `ransac`, from Open3D, is not built in.
#define PLANESCOPE_NEEDS_OPEN3D() \
  if (!PLANESCOPE_WITH_OPEN3D) GTEST_SKIP() << "needs a build with PLANESCOPE_OPEN3D"
