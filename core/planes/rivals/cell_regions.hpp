#pragma once

// What region growing does once there are cells, be they patches of a depth image or voxels.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/moments.hpp"
#include "core/planes/rivals/found_planes.hpp"
#include "core/planes/rivals/region_growing.hpp"

namespace planescope::planes {

inline constexpr std::uint32_t kNoCell = 0xffffffff;

/// A part of the cloud.
struct PlanarCell {
  Moments moments;
  PlaneFit fit;
  double max_e_n_m2 = 0;  // smallest eigenvalue of the scatter up to which it counts as planar
  bool planar = false;    // may be grown over
};

struct CellGraph {
  std::vector<PlanarCell> cells;
  std::vector<std::vector<std::uint32_t>> beside;  // of each cell those that it grows to
  std::vector<std::vector<std::uint32_t>> around;  // those whose planes its points may belong to
  std::vector<std::uint32_t> cell_of;              // per point: kNoCell takes no part
};

/// max_e_n_m2 of `count` points.
double max_e_n_m2(double count, const RegionGrowingOptions& options);

/// Region from 1 of each cell, 0 none: grown from seeds, neighbouring ones merged.
std::vector<std::int32_t> grow_and_merge(const CellGraph& graph,
                                         const RegionGrowingOptions& options);

/// The planes of the regions. Cells in the interior of a region give it all their points; points of
/// other cells go, where `options` say so, to the nearest of the planes around them.
FoundPlanes planes_of_regions(std::span<const Vec3f> points,
                              const CellGraph& graph,
                              std::span<const std::int32_t> region,
                              const RegionGrowingOptions& options);

}  // namespace planescope::planes
