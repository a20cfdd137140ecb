// Proenca & Gao 2018, Sec. III; Sun et al. 2023, Sec. V-C 2: "we use depth image patches of size
// 20 x 20 pixels".

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "core/planes/rivals/cell_regions.hpp"
#include "core/planes/rivals/region_growing.hpp"

namespace planescope::planes {
namespace {

/// From one measurement to the next along the middle of a patch depth changes by less than this
/// part of itself, or the patch shows an edge with something behind it.
constexpr double kMaxStep = 0.04;

/// The patches of an image, in raster order; those at its right and lower border may be smaller.
struct Patches {
  int edge_px, columns, rows;

  explicit Patches(const PixelPoints& input, const RegionGrowingOptions& options)
      : edge_px(options.patch_px),
        columns((input.width + edge_px - 1) / edge_px),
        rows((input.height + edge_px - 1) / edge_px) {}

  std::uint32_t of(int u, int v) const { return index(u / edge_px, v / edge_px); }
  std::uint32_t index(int column, int row) const {
    return static_cast<std::uint32_t>(row) * columns + column;
  }
};

/// Patches whose middle row or column steps from one surface to another.
std::vector<bool> with_steps(const PixelPoints& input, const Patches& patches) {
  struct Last {
    double row_m = 0, column_m = 0;  // depth of the last measurement along either; 0: none
  };
  const int middle = patches.edge_px / 2;
  std::vector<Last> last(static_cast<std::size_t>(patches.columns) * patches.rows);
  std::vector<bool> stepped(last.size(), false);
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    if (!input.kept[i]) continue;
    const int u = input.pixel[i] % input.width, v = input.pixel[i] / input.width;
    const std::uint32_t patch = patches.of(u, v);
    const double depth = input.view.dot(input.points[i] - input.sensor);
    const auto follow = [&](double& before) {
      if (before > 0 && std::abs(depth - before) > kMaxStep * std::min(depth, before))
        stepped[patch] = true;
      before = depth;
    };
    if (v % patches.edge_px == middle) follow(last[patch].row_m);
    if (u % patches.edge_px == middle) follow(last[patch].column_m);
  }
  return stepped;
}

CellGraph patches_of(const PixelPoints& input, const RegionGrowingOptions& options) {
  const Patches patches(input, options);
  CellGraph graph;
  graph.cells.resize(static_cast<std::size_t>(patches.columns) * patches.rows);
  graph.cell_of.assign(input.points.size(), kNoCell);
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    if (!input.kept[i]) continue;
    graph.cell_of[i] = patches.of(static_cast<int>(input.pixel[i] % input.width),
                                  static_cast<int>(input.pixel[i] / input.width));
    graph.cells[graph.cell_of[i]].moments.add(input.points[i].cast<double>());
  }
  const std::vector<bool> stepped = with_steps(input, patches);
  const Vec3d sensor = input.sensor.cast<double>();
  const double half_px = 0.5 * patches.edge_px * patches.edge_px;
  graph.beside.resize(graph.cells.size());
  graph.around.resize(graph.cells.size());
  for (int row = 0; row < patches.rows; ++row) {
    for (int column = 0; column < patches.columns; ++column) {
      const std::uint32_t c = patches.index(column, row);
      PlanarCell& cell = graph.cells[c];
      cell.fit = fit_plane(cell.moments);
      if (cell.fit.count > 0) {
        // Proenca & Gao bound the mean square by the sensor's noise, which grows with depth^2.
        const double depth = input.view.cast<double>().dot(cell.fit.centroid - sensor);
        cell.max_e_n_m2 = max_e_n_m2(cell.fit.count, options) * std::max(1.0, std::pow(depth, 4));
      }
      cell.planar =
          !stepped[c] && cell.fit.count >= half_px && cell.fit.eigenvalues[0] <= cell.max_e_n_m2;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, patches.rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, patches.columns - 1); ++x) {
          if (x == column && y == row) continue;
          graph.around[c].push_back(patches.index(x, y));
          if (x == column || y == row) graph.beside[c].push_back(patches.index(x, y));
        }
      }
    }
  }
  return graph;
}

}  // namespace

FoundPlanes grow_regions(const PixelPoints& input, const RegionGrowingOptions& options) {
  assert(input.points.size() == input.pixel.size() && input.points.size() == input.kept.size());
  const CellGraph graph = patches_of(input, options);
  return planes_of_regions(input.points, graph, grow_and_merge(graph, options), options);
}

}  // namespace planescope::planes
