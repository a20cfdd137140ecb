#pragma once

// The cells of an octree over (u, v, rho), all levels at once. A leaf is a square of 4 px by
// 1/16 1/m; a cell of the level above is twice as large along each axis. The grid is fixed: it
// follows neither gravity nor anything measured, so that a frame that changes by less than its
// noise keeps its cells.

#include <cstdint>
#include <vector>

#include "core/planes/depth/inverse_depth.hpp"

namespace planescope::planes {

inline constexpr int kLeafPx = 4;
inline constexpr double kPxPerInverseMeter = 64;  // a cell's sides in u and v to that in rho

struct DepthCell {
  std::uint64_t code = 0;  // Morton code of (u, v, rho) at its level
  PixelMoments moments;
  std::uint32_t begin = 0, end = 0;              // its cells in the level below
  std::uint32_t first_pixel = 0, end_pixel = 0;  // its pixels: DepthCells::pixels[first, end)
};

struct DepthCells {
  std::vector<std::vector<DepthCell>> levels;  // 0: the leaves; the last: one root
  std::vector<std::uint32_t> pixels;           // raster numbers, in the order of the leaves
  std::vector<PixelMoments> blocks;            // of all full squares of 4 px, whatever their rho
  int block_columns = 0;

  int depth() const { return static_cast<int>(levels.size()) - 1; }
  static int side_px(int level) { return kLeafPx << level; }
};

DepthCells make_depth_cells(const DepthImage& image);

}  // namespace planescope::planes
