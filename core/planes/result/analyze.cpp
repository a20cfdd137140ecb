// Area, RMS and hull of the points on each plane. The hull is computed from few points: points
// inside the hull of each column's extremes are discarded before sorting.

#include "core/planes/result/analyze.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "core/model/plane.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/simd/pixel_kernels.hpp"

namespace planescope::planes {
namespace {

/// A plane's points in plane coordinates, one block at a time. Recomputed on each visit, which is
/// faster than storing them because a block stays in the cache.
class FlatPoints {
 public:
  static constexpr std::size_t kMost = 512;
  struct Block {
    std::size_t count = 0;
    double u[kMost], v[kMost];  // in plane coordinates [m]
    double n[kMost];            // signed distances from the plane [m]
  };

  /// `points` and `runs` must outlive this object. The axes are u, v and n of `basis` and `normal`.
  FlatPoints(const std::vector<Vec3f>& points,
             std::span<const PointRun> runs,
             const PlaneBasis& basis,
             const Vec3d& normal,
             const Vec3d& origin)
      : points_(points), runs_(runs) {
    for (const PointRun& run : runs) size_ += run.end - run.begin;
    for (int axis = 0; axis < 3; ++axis) {
      args_.origin[axis] = origin[axis];
      args_.u_axis[axis] = basis.u[axis], args_.v_axis[axis] = basis.v[axis];
      args_.n_axis[axis] = normal[axis];
    }
  }

  std::size_t size() const { return size_; }

  /// Visits the blocks in the order of the points.
  template <typename Visit>
  void visit(const Visit& visit) const {
    Vec3f members[kMost];
    Block block;
    LayFlatArgs args = args_;
    args.points = members[0].data();
    args.u = block.u, args.v = block.v, args.n = block.n;
    const auto flush = [&] {
      args.count = block.count;
      kernels_.lay_flat(args);
      visit(block);
      block.count = 0;
    };
    for (const PointRun& run : runs_)
      for (std::size_t begin = run.begin; begin < run.end;) {
        const std::size_t count = std::min(run.end - begin, kMost - block.count);
        std::copy_n(points_.data() + begin, count, members + block.count);
        block.count += count;
        begin += count;
        if (block.count == kMost) flush();
      }
    if (block.count > 0) flush();
  }

 private:
  const std::vector<Vec3f>& points_;
  std::span<const PointRun> runs_;
  std::size_t size_ = 0;
  LayFlatArgs args_;
  const PixelKernels& kernels_ = pixel_kernels(best_simd());
};

struct Cover {
  double squares_m2 = 0;    // sum of squared distances from the plane
  std::size_t cells = 0;    // occupied cells of a grid
  std::vector<Vec2d> hull;  // same as convex_hull() of all points, bit for bit
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cell_at(double at, double cell_m) { return std::floor(at / cell_m); }

struct Range {
  double least = kInfinity, greatest = -kInfinity;
  void add(double x) { least = std::min(least, x), greatest = std::max(greatest, x); }
};

/// Bounds from a first pass over all points.
struct Bounds2 {
  Range u, v;
  double squares_m2 = 0;
};

Bounds2 bounds_of(const FlatPoints& points) {
  Bounds2 bounds;
  points.visit([&](const FlatPoints::Block& block) {
    for (std::size_t i = 0; i < block.count; ++i) {
      bounds.u.add(block.u[i]);
      bounds.v.add(block.v[i]);
      bounds.squares_m2 += block.n[i] * block.n[i];
    }
  });
  return bounds;
}

/// For few points in a wide grid.
void cover_sparse(const FlatPoints& points, double cell_m, Cover& cover) {
  std::vector<std::array<double, 2>> cells;
  std::vector<Vec2d> all;
  points.visit([&](const FlatPoints::Block& block) {
    for (std::size_t i = 0; i < block.count; ++i) {
      cells.push_back({cell_at(block.u[i], cell_m), cell_at(block.v[i], cell_m)});
      all.emplace_back(block.u[i], block.v[i]);
    }
  });
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  cover.cells = cells.size();
  cover.hull = convex_hull(std::move(all));
}

/// One axis of the grid.
struct Axis {
  int first = 0;  // cell
  int cells = 0;
  double cell_m = 0;

  double begin_of(int cell) const { return (cell + first) * cell_m; }
  /// Index of the cell that contains `place`, at least 0.
  int at(double place) const {
    return std::max(0, static_cast<int>(cell_at(place, cell_m)) - first);
  }
  void find_cells(const double* places, std::size_t count, std::int32_t* to) const {
    pixel_kernels(best_simd())
        .find_cells(
            {.count = count, .places = places, .cell = cell_m, .first = first, .cells = to});
  }
};

/// Has no cells if coordinates would overflow an int.
Axis axis_of(const Range& range, double cell_m) {
  constexpr double kFarthest = 1 << 30;
  const double first = cell_at(range.least, cell_m), last = cell_at(range.greatest, cell_m);
  if (!(first > -kFarthest && last < kFarthest)) return {0, 0, cell_m};
  return {static_cast<int>(first), static_cast<int>(last - first) + 1, cell_m};
}

/// For each column, the range inside the hull of some of the points: least < v < greatest.
std::vector<Range> inside_of(const std::vector<Vec2d>& hull, const Axis& columns) {
  std::vector<double> lower(columns.cells + 1, kInfinity), upper(columns.cells + 1, -kInfinity);
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const auto [left, right] = std::minmax(a.x(), b.x());
    if (!(left < right)) continue;
    for (int c = columns.at(left); c <= columns.cells; ++c) {
      const double x = columns.begin_of(c);
      if (x > right) break;
      if (x < left) continue;
      const double y = a.y() + (x - a.x()) * (b.y() - a.y()) / (b.x() - a.x());
      (a.x() < b.x() ? lower : upper)[c] = y;
    }
  }
  // Larger than any rounding error; points within the margin are kept.
  const double margin_m = columns.cell_m / 8;
  std::vector<Range> inside(columns.cells);
  for (int c = 0; c < columns.cells; ++c)
    inside[c] = {std::max(lower[c], lower[c + 1]) + margin_m,
                 std::min(upper[c], upper[c + 1]) - margin_m};
  return inside;
}

/// Points of a column with the smallest and the largest v.
struct Extremes {
  Vec2d lowest{0, kInfinity}, highest{0, -kInfinity};

  void add(double u, double v) {
    if (v < lowest.y()) lowest = {u, v};
    if (v > highest.y()) highest = {u, v};
  }
};

/// Counts the occupied cells, and returns the extremes of each column.
std::vector<Extremes> look_at_cells(const FlatPoints& points,
                                    const Axis& columns,
                                    const Axis& rows,
                                    Cover& cover) {
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(columns.cells) * rows.cells);
  std::vector<Extremes> extremes(columns.cells);
  points.visit([&, cell = occupied.data()](const FlatPoints::Block& block) {
    std::int32_t column[FlatPoints::kMost], row[FlatPoints::kMost];
    columns.find_cells(block.u, block.count, column);
    rows.find_cells(block.v, block.count, row);
    for (std::size_t i = 0; i < block.count; ++i)
      cell[static_cast<std::size_t>(row[i]) * columns.cells + column[i]] = 1;
    for (std::size_t i = 0; i < block.count; ++i) extremes[column[i]].add(block.u[i], block.v[i]);
  });
  cover.cells = static_cast<std::size_t>(std::ranges::count(occupied, 1));
  return extremes;
}

Cover cover_of(const FlatPoints& points, double cell_m) {
  Cover cover;
  if (points.size() == 0) return cover;
  const Bounds2 bounds = bounds_of(points);
  cover.squares_m2 = bounds.squares_m2;
  const Axis columns = axis_of(bounds.u, cell_m), rows = axis_of(bounds.v, cell_m);
  const double cells = static_cast<double>(columns.cells) * rows.cells;
  if (cells == 0 || cells > 4096 + 8 * static_cast<double>(points.size())) {
    cover_sparse(points, cell_m, cover);
    return cover;
  }
  std::vector<Vec2d> some;
  for (const Extremes& e : look_at_cells(points, columns, rows, cover))
    if (e.lowest.y() <= e.highest.y()) some.insert(some.end(), {e.lowest, e.highest});
  const std::vector<Range> inside = inside_of(convex_hull(std::move(some)), columns);
  std::vector<Vec2d> outside;
  points.visit([&](const FlatPoints::Block& block) {
    std::int32_t column[FlatPoints::kMost];
    columns.find_cells(block.u, block.count, column);
    for (std::size_t i = 0; i < block.count; ++i) {
      const Range& range = inside[column[i]];
      if (!(block.v[i] > range.least && block.v[i] < range.greatest))
        outside.emplace_back(block.u[i], block.v[i]);
    }
  });
  cover.hull = convex_hull(std::move(outside));
  return cover;
}

}  // namespace

std::vector<PlaneSummary> summarize_planes(const FrameResult& result, double voxel_size_m) {
  const std::size_t n = result.segmentation.planes.size();
  const std::vector<std::vector<PointRun>> runs = runs_of_planes(result);
  const double cell_m = cell_size_m(voxel_size_m);
  std::vector<PlaneSummary> summaries(n);
  for (std::size_t k = 0; k < n; ++k) {
    const PlaneRegion& plane = result.segmentation.planes[k];
    PlaneSummary& s = summaries[k];
    s.id = plane.id;
    s.label = plane.label;
    s.normal = plane.fit.normal;
    s.centroid = result.cloud.origin + plane.fit.centroid;
    s.offset_m = s.normal.dot(s.centroid);
    s.tilt_deg = result.gravity.known()
                     ? std::acos(std::min(1.0, std::abs(s.normal.z()))) * 180 / std::numbers::pi
                     : std::nan("");
    s.voxels = plane.points;
    s.margin = plane.margin;
    s.undecided = plane.undecided;

    const PlaneBasis basis = plane_basis(s.normal);
    const FlatPoints flat(result.cloud.points, runs[k], basis, s.normal, plane.fit.centroid);
    s.points = flat.size();
    const Cover cover = cover_of(flat, cell_m);
    if (s.points > 0) s.rms_m = std::sqrt(cover.squares_m2 / static_cast<double>(s.points));
    s.area_m2 = static_cast<double>(cover.cells) * cell_m * cell_m;
    for (const Vec2d& corner : cover.hull)
      s.hull.push_back(s.centroid + corner.x() * basis.u + corner.y() * basis.v);
  }
  return summaries;
}

FramePlanes analyze_planes(const Frame& frame,
                           const FrameResult& result,
                           const PipelineOptions& options) {
  const double cell_m = cell_size_m(options.cloud.voxel_size_m);
  FramePlanes found;
  found.summaries = summarize_planes(result, options.cloud.voxel_size_m);
  found.outlines = outlines_of(frame, result, cell_m);
  found.footholds = footholds_of(frame, result, found.outlines, cell_m, options.foot);
  std::optional<Vec3d> sensor;
  if (!result.from_cloud) sensor = result.cloud.T_world_sensor.translation();
  const std::vector<Outline> minor = minor_outlines_of(result, cell_m);
  found.stairs = find_stairs({result.segmentation.planes, found.outlines},
                             {result.segmentation.minor, minor}, sensor, options.stairs);
  return found;
}

AnalyzedFrame analyze(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth) {
  AnalyzedFrame analyzed{run_frame(frame, options, classifier, truth), {}};
  analyzed.found = analyze_planes(frame, analyzed, options);
  return analyzed;
}

}  // namespace planescope::planes
