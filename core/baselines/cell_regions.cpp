// Proenca & Gao 2018, Sec. III: seeds from a histogram of normals, growth and merging.

#include "core/baselines/cell_regions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace planescope {
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

std::vector<Moments> moments_of(const CellGraph& graph, std::span<const std::int32_t> region) {
  std::vector<Moments> moments(region.empty() ? 1 : std::ranges::max(region) + 1);
  for (std::size_t c = 0; c < region.size(); ++c) {
    if (region[c] > 0) moments[region[c]] += graph.cells[c].moments;
  }
  return moments;
}

/// Neighbouring regions become one where their normals are near enough and their cells still lie
/// in one plane together.
void merge(const CellGraph& graph,
           const RegionGrowingOptions& options,
           std::vector<std::int32_t>& region) {
  std::vector<Moments> moments = moments_of(graph, region);
  std::vector<std::int32_t> parent(moments.size());
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
      Moments both = moments[a];
      both += moments[b];
      const double cosine = fit_plane(moments[a]).normal.dot(fit_plane(moments[b]).normal);
      if (std::abs(cosine) < options.merge_threshold) continue;
      if (mse(fit_plane(both)) > max_cell_mse_m2(options)) continue;
      parent[std::max(a, b)] = std::min(a, b);
      moments[std::min(a, b)] = both;
    }
  }
  for (std::int32_t& r : region) r = root(r);
}

}  // namespace

double max_cell_mse_m2(const RegionGrowingOptions& options) {
  constexpr double kFullPatch = 20 * 20;  // points of the paper's patch
  return options.region_threshold_m2 / kFullPatch;
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
  std::vector<PlaneFit> plane;
  for (const Moments& m : moments_of(graph, region)) plane.push_back(fit_plane(m));
  // Per cell the regions in and around it; just its own: amid it.
  std::vector<std::vector<std::int32_t>> choices(graph.cells.size());
  for (std::uint32_t c = 0; c < graph.cells.size(); ++c) {
    std::vector<std::int32_t>& here = choices[c];
    bool border = false;
    const auto add = [&](std::uint32_t other) {
      border |= region[other] != region[c];
      if (region[other] > 0 && std::ranges::find(here, region[other]) == here.end())
        here.push_back(region[other]);
    };
    add(c);
    for (const std::uint32_t other : graph.around[c]) add(other);
    if (!border) here.clear();
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (graph.cell_of[i] == kNoCell || choices[graph.cell_of[i]].empty()) continue;
    group[i] = 0;
    double nearest = 0;
    for (const std::int32_t r : choices[graph.cell_of[i]]) {
      const double d = std::abs(plane[r].distance_m(points[i].cast<double>()));
      const double limit = std::max(3 * plane[r].rms_m(), std::sqrt(max_cell_mse_m2(options)));
      if (d > limit || (group[i] != 0 && d >= nearest)) continue;
      group[i] = r;
      nearest = d;
    }
  }
  return found_planes(points, group, 3);
}

}  // namespace planescope
