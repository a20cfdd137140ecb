// Proenca & Gao 2018, Sec. III: seeds from a histogram of normals, growing and merging of cells.
// Cells are patches of a depth image, or voxels.

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/planes/rivals/rivals.hpp"

namespace planescope::planes {
namespace {

constexpr std::uint32_t kNoCell = 0xffffffff;

/// A patch or voxel with its plane.
struct PlanarCell {
  Moments moments;
  PlaneFit fit;
  double max_e_n_m2 = 0;  // largest smallest eigenvalue of the scatter that counts as planar
  bool planar = false;    // regions may grow over it
};

struct CellGraph {
  std::vector<PlanarCell> cells;
  std::vector<std::vector<std::uint32_t>> beside;  // per cell: cells to which it can grow
  std::vector<std::vector<std::uint32_t>> around;  // per cell: cells whose planes its points
                                                   // may join
  std::vector<std::uint32_t> cell_of;              // per point; kNoCell: ignored
};

constexpr int kBins = 20;                                   // bins of the histogram per angle
constexpr int kMinCells = 4;                                // per region
const double kCosGrowth = std::cos(std::numbers::pi / 12);  // between normals of neighboring cells
const double kSinGrowth = std::sin(std::numbers::pi / 12);

/// Histogram bin of a plane's direction; independent of the normal's sign.
int bin_of(Vec3d normal) {
  if (normal.z() < 0) normal = -normal;
  const double polar = std::acos(std::min(normal.z(), 1.0)) / (std::numbers::pi / 2);
  const int row = std::min(static_cast<int>(polar * kBins), kBins - 1);
  if (row == 0) return 0;  // at the pole the azimuth is undefined
  double turn = std::atan2(normal.y(), normal.x()) / (2 * std::numbers::pi);
  if (turn < 0) turn += 1;
  if (row == kBins - 1 && turn >= 0.5) turn -= 0.5;  // on the horizon both signs are equivalent
  return row * kBins + std::min(static_cast<int>(turn * kBins), kBins - 1);
}

double mse(const PlaneFit& fit) { return fit.count > 0 ? fit.eigenvalues[0] / fit.count : 0; }

/// Size of a cell from its scatter: the diagonal of a square with the same variance.
double diameter_m(const PlaneFit& fit) {
  return std::sqrt(12 * (fit.eigenvalues[1] + fit.eigenvalues[2]) / fit.count);
}

bool grows_to(const PlaneFit& from, const PlaneFit& to) {
  if (std::abs(from.normal.dot(to.normal)) < kCosGrowth) return false;
  return std::abs(from.distance_m(to.centroid)) <= kSinGrowth * diameter_m(from);
}

class Growth {
 public:
  explicit Growth(const CellGraph& graph) : graph_(graph), region_(graph.cells.size(), 0) {
    for (std::uint32_t c = 0; c < graph.cells.size(); ++c) {
      if (graph.cells[c].planar) bins_[bin_of(graph.cells[c].fit.normal)].push_back(c);
    }
  }

  std::vector<std::int32_t> grow() {
    std::int32_t regions = 0;
    for (std::vector<std::uint32_t>* bin = &fullest(); !bin->empty(); bin = &fullest()) {
      const std::uint32_t seed = *std::ranges::min_element(
          *bin, {}, [&](std::uint32_t c) { return mse(graph_.cells[c].fit); });
      const std::vector<std::uint32_t> grown = grow_from(seed);
      const bool enough = grown.size() >= kMinCells;
      if (enough) ++regions;
      for (const std::uint32_t c : grown) {
        region_[c] = enough ? regions : kTooSmall;
        std::erase(bins_[bin_of(graph_.cells[c].fit.normal)], c);
      }
    }
    for (std::int32_t& r : region_) r = std::max(r, 0);
    return std::move(region_);
  }

 private:
  static constexpr std::int32_t kTooSmall = -1;

  std::vector<std::uint32_t>& fullest() {
    return *std::ranges::max_element(bins_, {}, &std::vector<std::uint32_t>::size);
  }

  std::vector<std::uint32_t> grow_from(std::uint32_t seed) {
    std::vector<std::uint32_t> grown = {seed};
    std::vector<bool> seen(graph_.cells.size(), false);
    seen[seed] = true;
    for (std::size_t next = 0; next < grown.size(); ++next) {
      const std::uint32_t from = grown[next];
      for (const std::uint32_t to : graph_.beside[from]) {
        const PlanarCell& cell = graph_.cells[to];
        if (seen[to] || !cell.planar || region_[to] != 0) continue;
        if (!grows_to(graph_.cells[from].fit, cell.fit)) continue;
        seen[to] = true;
        grown.push_back(to);
      }
    }
    return grown;
  }

  const CellGraph& graph_;
  std::vector<std::int32_t> region_;
  std::vector<std::uint32_t> bins_[kBins * kBins];
};

/// Sum over the cells of a region.
struct Region {
  Moments moments;
  double max_e_n_m2 = 0;

  Region& operator+=(const Region& other) {
    moments += other.moments;
    max_e_n_m2 += other.max_e_n_m2;
    return *this;
  }
};

std::vector<Region> sum_up(const CellGraph& graph, std::span<const std::int32_t> region) {
  std::vector<Region> regions(region.empty() ? 1 : std::ranges::max(region) + 1);
  for (std::size_t c = 0; c < region.size(); ++c) {
    if (region[c] > 0) regions[region[c]] += {graph.cells[c].moments, graph.cells[c].max_e_n_m2};
  }
  return regions;
}

/// Merges neighboring regions if their normals are close and the union is still planar.
void merge(const CellGraph& graph,
           const RegionGrowingOptions& options,
           std::vector<std::int32_t>& region) {
  std::vector<Region> regions = sum_up(graph, region);
  std::vector<std::int32_t> parent(regions.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t r) {
    while (parent[r] != r) r = parent[r];
    return r;
  };
  for (std::uint32_t c = 0; c < region.size(); ++c) {
    for (const std::uint32_t other : graph.beside[c]) {
      if (region[c] == 0 || region[other] == 0) continue;
      const std::int32_t a = root(region[c]), b = root(region[other]);
      if (a == b) continue;
      const double cosine =
          fit_plane(regions[a].moments).normal.dot(fit_plane(regions[b].moments).normal);
      if (std::abs(cosine) < options.merge_threshold) continue;
      Region both = regions[a];
      both += regions[b];
      if (fit_plane(both.moments).eigenvalues[0] > both.max_e_n_m2) continue;
      parent[std::max(a, b)] = std::min(a, b);
      regions[std::min(a, b)] = both;
    }
  }
  for (std::int32_t& r : region) r = root(r);
}

/// Per cell, the regions in and around it; empty for cells in the interior of a region.
std::vector<std::vector<std::int32_t>> choices_along_borders(const CellGraph& graph,
                                                             std::span<const std::int32_t> region) {
  std::vector<std::vector<std::int32_t>> choices(graph.cells.size());
  for (std::uint32_t c = 0; c < graph.cells.size(); ++c) {
    const auto same = [&](std::uint32_t other) { return region[other] == region[c]; };
    if (std::ranges::all_of(graph.around[c], same)) continue;
    if (region[c] > 0) choices[c].push_back(region[c]);
    for (const std::uint32_t other : graph.around[c]) {
      if (region[other] > 0 && std::ranges::find(choices[c], region[other]) == choices[c].end())
        choices[c].push_back(region[other]);
    }
  }
  return choices;
}

/// max_e_n_m2 for a cell of `count` points.
double max_e_n_m2(double count, const RegionGrowingOptions& options) {
  constexpr double kFullPatch = 20 * 20;  // points per patch in the paper
  return options.region_threshold_m2 * count / kFullPatch;
}

/// Region of each cell, from 1; 0: none. Grows regions from seeds and merges neighbors.
std::vector<std::int32_t> grow_and_merge(const CellGraph& graph,
                                         const RegionGrowingOptions& options) {
  std::vector<std::int32_t> region = Growth(graph).grow();
  merge(graph, options, region);
  return region;
}

/// Planes of the regions. Interior cells of a region give it all of their points. Points of other
/// cells join the nearest surrounding plane if `options` say so.
FoundPlanes planes_of_regions(std::span<const Vec3f> points,
                              const CellGraph& graph,
                              std::span<const std::int32_t> region,
                              const RegionGrowingOptions& options) {
  std::vector<std::int32_t> group(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (graph.cell_of[i] != kNoCell) group[i] = region[graph.cell_of[i]];
  }
  if (!options.refine_boundaries) return found_planes(points, group, 3);
  struct Sheet {
    PlaneFit plane;
    double half_m = 0;  // half of the thickness
  };
  std::vector<Sheet> sheets;
  for (const Region& r : sum_up(graph, region)) {
    const PlaneFit plane = fit_plane(r.moments);
    const double thickest_m = plane.count > 0 ? std::sqrt(r.max_e_n_m2 / plane.count) : 0;
    sheets.push_back({plane, std::max(3 * plane.rms_m(), thickest_m)});
  }
  const std::vector<std::vector<std::int32_t>> choices = choices_along_borders(graph, region);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (graph.cell_of[i] == kNoCell || choices[graph.cell_of[i]].empty()) continue;
    group[i] = 0;
    double nearest = 0;
    for (const std::int32_t r : choices[graph.cell_of[i]]) {
      const double d = std::abs(sheets[r].plane.distance_m(points[i].cast<double>()));
      if (d > sheets[r].half_m || (group[i] != 0 && d >= nearest)) continue;
      group[i] = r;
      nearest = d;
    }
  }
  return found_planes(points, group, 3);
}

// Sun et al. 2023, Sec. V-C 2: "we use depth image patches of size 20 x 20 pixels".

/// If depth changes by more than this fraction between successive measurements along the middle of
/// a patch, the patch contains a depth edge.
constexpr double kMaxStep = 0.04;

/// Patches of an image in raster order; patches at the right and bottom borders may be smaller.
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

/// Whether the middle row or column of each patch crosses a depth edge.
std::vector<bool> with_steps(const PixelPoints& input, const Patches& patches) {
  struct Last {
    double row_m = 0, column_m = 0;  // last measured depth along each; 0: none
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
        // Proenca & Gao limit the mean square to the sensor's noise, which grows with depth^2.
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

// Sun et al. 2023, Sec. V-C 2: "we employed 3D region-growing with a voxel size of 0.05 m for
// synthetic data consisting solely of point clouds".

namespace {

// A cell has its own plane if it contains this many points, spread (RMS) over this share of its
// edge in both directions. This excludes a row of points along its border.
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
