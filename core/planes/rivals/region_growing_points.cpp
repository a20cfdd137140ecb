// Sun et al. 2023, Sec. V-C 2: "we employed 3D region-growing with a voxel size of 0.05 m for
// synthetic data consisting solely of point clouds".

#include <array>
#include <cmath>
#include <map>

#include "core/planes/rivals/cell_regions.hpp"
#include "core/planes/rivals/region_growing.hpp"

namespace planescope::planes {
namespace {

// A cell has a plane of its own if it holds this many points, spread (RMS) over this share of its
// edge in both directions: a row of points along its border has none.
constexpr int kLeastPoints = 3;
constexpr double kLeastSpread = 0.1;

using Voxel = std::array<std::int64_t, 3>;

CellGraph voxels_of(std::span<const Vec3f> points, const RegionGrowingOptions& options) {
  CellGraph graph;
  std::map<Voxel, std::uint32_t> index;
  std::vector<Voxel> voxels;
  for (const Vec3f& p : points) {
    const Vec3d scaled = p.cast<double>() / options.voxel_size_m;
    const Voxel voxel = {std::llround(std::floor(scaled.x())), std::llround(std::floor(scaled.y())),
                         std::llround(std::floor(scaled.z()))};
    const auto [at, added] = index.try_emplace(voxel, static_cast<std::uint32_t>(voxels.size()));
    if (added) {
      voxels.push_back(voxel);
      graph.cells.emplace_back();
    }
    graph.cells[at->second].moments.add(p.cast<double>());
    graph.cell_of.push_back(at->second);
  }
  for (PlanarCell& cell : graph.cells) {
    cell.fit = fit_plane(cell.moments);
    const double n = cell.fit.count, spread_m = kLeastSpread * options.voxel_size_m;
    cell.max_e_n_m2 = max_e_n_m2(n, options);
    cell.planar = n >= kLeastPoints && cell.fit.eigenvalues[1] >= n * spread_m * spread_m &&
                  cell.fit.eigenvalues[0] <= cell.max_e_n_m2;
  }
  graph.beside.resize(voxels.size());
  for (std::size_t c = 0; c < voxels.size(); ++c) {
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          if (dx == 0 && dy == 0 && dz == 0) continue;
          const auto at = index.find({voxels[c][0] + dx, voxels[c][1] + dy, voxels[c][2] + dz});
          if (at != index.end()) graph.beside[c].push_back(at->second);
        }
  }
  graph.around = graph.beside;
  return graph;
}

}  // namespace

FoundPlanes grow_regions(std::span<const Vec3f> points, const RegionGrowingOptions& options) {
  const CellGraph graph = voxels_of(points, options);
  return planes_of_regions(points, graph, grow_and_merge(graph, options), options);
}

}  // namespace planescope::planes
