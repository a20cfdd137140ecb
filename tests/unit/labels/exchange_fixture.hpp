#pragma once

// A small frame with holes, random labels for it, and a folder for their files.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/labels/exchange/exchange.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

namespace planescope::labels {

inline constexpr const char* kHash =
    "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

inline LabelGrid random_grid(Random& random, int width = 31, int height = 22) {
  Frame frame;
  frame.depth = Image16(width, height);
  frame.depth_unit_m = 0.001;
  frame.intrinsics = {width, height, 30.5, 30.25, width / 2.0, height / 2.0};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      frame.depth.at(x, y) = random.uniform() < 0.15
                                 ? std::uint16_t{0}
                                 : static_cast<std::uint16_t>(900 + 11 * y + random.integer(0, 6));
  if (random.integer(0, 1)) {
    frame.color = Image8(width, height, 3);
    for (std::uint8_t& value : frame.color.data)
      value = static_cast<std::uint8_t>(random.integer(0, 255));
    frame.color_aligned = true;
  }
  Gravity gravity;
  gravity.direction = Vec3d(0.1, 0.8, 0.3).normalized();
  return make_label_grid(frame, gravity);
}

/// Planes, class only, "do not score" and unlabeled, on measured pixels only.
inline FrameLabels random_labels(const LabelGrid& grid, Random& random) {
  FrameLabels labels = empty_labels(grid, kHash);
  for (int i = 0; i < 15; ++i) labels = after_random_gesture(labels, random);
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (!grid.measured[i]) labels.plane.data[i] = labels.hv.data[i] = 0;
  labels.gravity = grid.gravity;
  refit_planes(labels, grid);
  return labels;
}

struct Exchange : testing::Test {
  const std::filesystem::path dir =
      fresh_dir(testing::UnitTest::GetInstance()->current_test_info()->name());
  Random random{4};
  LabelGrid grid = random_grid(random);
  FrameLabels labels = random_labels(grid, random);

  void SetUp() override { std::filesystem::create_directories(dir); }
  void make(std::uint64_t seed) {
    random = Random(seed);
    grid = random_grid(random);
    labels = random_labels(grid, random);
  }
  void TearDown() override { std::filesystem::remove_all(dir); }

  /// Writes the labels to files and reads them back for the frame.
  FrameLabels there_and_back(LabelFormat format) {
    const auto paths = write_labeled(dir / "frame", format, points_of_labels(labels, grid));
    return labels_of_points(read_labeled(paths.back(), format), grid, kHash, paths[0].string());
  }
};

}  // namespace planescope::labels
