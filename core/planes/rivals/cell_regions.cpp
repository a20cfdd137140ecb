// Proenca & Gao 2018, Sec. III: seeds from a histogram of normals, growth and merging.

#include "core/planes/rivals/cell_regions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace planescope::planes {
namespace {

constexpr int kBins = 20;                                   // of the histogram, along either angle
constexpr int kMinCells = 4;                                // of a region
const double kCosGrowth = std::cos(std::numbers::pi / 12);  // between neighbouring cells' normals
const double kSinGrowth = std::sin(std::numbers::pi / 12);

/// Bin of a plane's direction, which is the same for either sign of the normal.
int bin_of(Vec3d normal) {
  if (normal.z() < 0) normal = -normal;
  const double polar = std::acos(std::min(normal.z(), 1.0)) / (std::numbers::pi / 2);
  const int row = std::min(static_cast<int>(polar * kBins), kBins - 1);
  if (row == 0) return 0;  // about the pole the other angle means nothing
  double turn = std::atan2(normal.y(), normal.x()) / (2 * std::numbers::pi);
  if (turn < 0) turn += 1;
  if (row == kBins - 1 && turn >= 0.5) turn -= 0.5;  // on the horizon both signs are as good
  return row * kBins + std::min(static_cast<int>(turn * kBins), kBins - 1);
}

double mse(const PlaneFit& fit) { return fit.count > 0 ? fit.eigenvalues[0] / fit.count : 0; }

/// How far a cell reaches, from its scatter: the diagonal of the square of the same spread.
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

/// What the cells of a region add up to.
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

/// Merges neighbouring regions whose normals are close enough and whose cells together still lie in
/// one plane.
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

/// For each cell the regions in and around it; none for cells in the interior of their region.
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

}  // namespace

double max_e_n_m2(double count, const RegionGrowingOptions& options) {
  constexpr double kFullPatch = 20 * 20;  // points of the paper's patch
  return options.region_threshold_m2 * count / kFullPatch;
}

std::vector<std::int32_t> grow_and_merge(const CellGraph& graph,
                                         const RegionGrowingOptions& options) {
  std::vector<std::int32_t> region = Growth(graph).grow();
  merge(graph, options, region);
  return region;
}

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
    double half_m = 0;  // thick to either side
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

}  // namespace planescope::planes
