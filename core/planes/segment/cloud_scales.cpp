// Noise, bow and point spacing of a cloud, measured in small patches.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/planes/segment/cells.hpp"
#include "core/planes/segment/cloud_regions.hpp"

namespace planescope::planes {
namespace {

constexpr double kCalmCells = 0.5;  // quantile of the cells' RMS used as noise
constexpr int kPatchLevels = 3;     // the scales are measured in cells this far above the leaves
constexpr int kLeastPoints = 8;     // patches with fewer points are ignored
constexpr double kLeastBow = 0.4;   // smallest bow, as a share of the white noise
constexpr double kCalm = 4;         // patches with more variance relative to the noise contain
                                    // an edge

double quantile(std::vector<double>& values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

struct Patch {
  Moments moments;
  double misfit_m2 = 0;
  bool calm = false;
};
struct Patches {
  CellGrid grid;
  std::vector<std::array<Patch, 2>> of_cell;  // by label
  std::vector<double> variances, areas;       // per patch with enough points; area per point [m^2]
};

/// Points of one label per patch, in cells some levels above the leaves.
Patches make_patches(const SegmentState& state, int levels) {
  const Octree& octree = state.octree;
  Patches made{make_cell_grid(octree, levels), {}, {}, {}};
  const CellGrid& grid = made.grid;
  made.of_cell.resize(grid.size());
  for (std::size_t c = 0; c < grid.size(); ++c) {
    for (std::uint32_t i = grid.starts[c]; i < grid.starts[c + 1]; ++i)
      made.of_cell[c][state.options.use_labels && octree.labels[i] == Label::h].moments.add(
          octree.points[i].cast<double>());
    for (Patch& patch : made.of_cell[c]) {
      const double count = patch.moments.count;
      if (count < kLeastPoints) continue;
      const Cubic cubic(patch.moments);
      patch.misfit_m2 = cubic.least_root();
      made.variances.push_back(patch.misfit_m2 / (count - 3));
      made.areas.push_back(12 * std::sqrt(cubic.product_of_others()) / (count * count));
    }
  }
  return made;
}

}  // namespace

CloudScales measure_scales(const SegmentState& state, const ObjectiveOptions& options) {
  Patches made = make_patches(state, kPatchLevels);
  // Sparse clouds have too few points in small cells.
  for (int levels = kPatchLevels + 1;
       made.variances.empty() && levels <= state.octree.cube.max_depth; ++levels)
    made = make_patches(state, levels);
  auto& [grid, patches, variances, areas] = made;
  CloudScales scales;
  if (variances.empty()) return scales;
  scales.spacing_m = std::sqrt(quantile(areas, 0.5));
  const double measured2 = quantile(variances, kCalmCells);
  scales.measured_m = std::sqrt(measured2);
  scales.white_m = std::max(scales.measured_m, options.resolution * scales.spacing_m);
  for (auto& of_cell : patches)
    for (Patch& patch : of_cell)
      patch.calm = patch.moments.count >= kLeastPoints &&
                   patch.misfit_m2 <= kCalm * measured2 * (patch.moments.count - 3);
  std::vector<double> offsets;
  for (std::uint32_t c = 0; c < grid.size(); ++c)
    for (int label = 0; label < 2; ++label) {
      const Patch& p = patches[c][label];
      if (!p.calm) continue;
      for (std::uint32_t n = grid.neighbor_first[c]; n < grid.neighbor_first[c + 1]; ++n) {
        const std::uint32_t other = grid.neighbors[n];
        const Patch& q = patches[other][label];
        if (other <= c || !q.calm) continue;
        Moments both = p.moments;
        both += q.moments;
        const double misfit_m2 = Cubic(both).least_root();
        if (misfit_m2 > kCalm * kCalm * measured2 * (both.count - 3)) continue;  // an edge, not bow
        const double weight = p.moments.count * q.moments.count / both.count;
        offsets.push_back((misfit_m2 - p.misfit_m2 - q.misfit_m2 - 3 * measured2) / weight);
      }
    }
  double bow2 = 0;
  if (!offsets.empty()) bow2 = std::max(0.0, quantile(offsets, 0.5));
  scales.bow_m = options.bow * std::max(std::sqrt(bow2), kLeastBow * scales.white_m);
  return scales;
}

NoiseModel noise_of(const CloudScales& scales, const ObjectiveOptions& options) {
  return {.estimated = true,
          .constant_m = std::sqrt(scales.variance_m2()),
          .reach_sigma = options.point_reach_sigma};
}

}  // namespace planescope::planes
