#pragma once

// The segmentation of a depth image in progress: the cells of its octree, how noisy it is, and
// regions of pixels, each with its moments and plane. Stages change regions through these functions
// alone; with a trace, each logs what it did.

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/planes/depth/inverse_depth.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

// The cells of an octree over (u, v, rho), all levels at once. A leaf is a square of 4 px by 1/16
// 1/m; a cell of the level above is twice as large along each axis. The grid is fixed: it follows
// neither gravity nor anything measured, so that a frame that changes by less than its noise keeps
// its cells.

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

// How noisy a depth image is, measured in the image itself at two scales: white noise, which
// differs from pixel to pixel, and the bow, the sensor's low-frequency error (none in a scanner,
// about a centimeter at 1 to 3 m in a D400).

struct DepthNoise {
  double white = 0;  // standard deviation of rho [1/m]; 0: too little depth to measure it
  double bow = 0;    // likewise, over distances of length_px and more
  double wide = 0;   // of single pixels about planes of wide squares: white noise and bow [1/m]
  double length_px = 20;  // over which the bow develops
  double lateral_px = 2;  // sideways error of a pixel

  /// Variance of a pixel about a plane, and of the bow [1/m^2]. A sideways error counts by the
  /// slope of rho: on a grazing surface it is most of the noise.
  double white2(const InversePlane& p) const { return white * white + sideways2(p); }
  double bow2(const InversePlane& p) const { return bow * bow + sideways2(p); }
  double sideways2(const InversePlane& p) const {
    return lateral_px * lateral_px * (p.a * p.a + p.b * p.b);
  }
  double pixel2(const InversePlane& p) const { return white2(p) + bow2(p); }
  /// Share of the bow's variance that shows between two places this far apart.
  double developed(double distance2_px2) const {
    return std::min(1.0, distance2_px2 / (length_px * length_px));
  }

  /// What joining two sets of pixels adds to the misfit: the mean squared offset between their
  /// planes over the variance that noise and bow explain. The cost of a plane, options.merge_cost,
  /// is what joining them saves.
  double join_cost(const PixelMoments& a,
                   const InversePlane& plane_a,
                   const PixelMoments& b,
                   const InversePlane& plane_b) const {
    PixelMoments both = a;
    both += b;
    // No plane is credited with less misfit than noise makes: a cell's face cuts noise in two
    // layers, each flatter than it.
    const double apart = std::max(plane_a.sse, (a.n - 3) * white * white) +
                         std::max(plane_b.sse, (b.n - 3) * white * white);
    const double offset2 = std::max(0.0, both.fit().sse - apart) * both.n / (a.n * b.n);
    const double du = a.u / a.n - b.u / b.n, dv = a.v / a.n - b.v / b.n;
    const double explained = 3 * (white2(plane_a) / a.n + white2(plane_b) / b.n) +
                             std::min(bow2(plane_a), bow2(plane_b)) * developed(du * du + dv * dv);
    return offset2 / explained;
  }
};

/// `blocks`: moments of all full squares of 4 px, row by row, `columns` to a row. `unit_m`: what
/// depth is rounded to, 0: nothing.
DepthNoise measure_depth_noise(const std::vector<PixelMoments>& blocks,
                               int columns,
                               int width_px,
                               double unit_m,
                               const ObjectiveOptions& options);

// ---- Regions ----

inline constexpr std::int32_t kNoRegion = -1;

/// A join that would not have happened at a little more cost.
struct DearJoin {
  double cost = 0;
  double smaller_px = 0;  // pixels of the smaller part
};

struct DepthNeighbor {
  std::int32_t region = kNoRegion;
  // Cost of joining; merge_regions() sets it if `region` is the greater index.
  double cost = std::numeric_limits<double>::infinity();
};

struct DepthRegion {
  PixelMoments moments;
  InversePlane plane;
  bool alive = true;
  int known = 0;                     // index + 1 of the known plane it is; 0: none
  std::vector<DearJoin> dear_joins;  // that made it
  std::vector<DepthNeighbor> near;   // ascending
};

/// What the trace needs beside the regions; empty without one.
struct DepthTrace {
  Trace* trace = nullptr;
  bool gravity_known = false;
  std::vector<std::uint32_t> position;  // per pixel: Morton position
  std::span<const Vec3f> points;        // by Morton position: local coordinates [m]
  std::vector<GrowingPlane> planes;     // per region: in space

  Label label_of(const PlaneFit& fit) const {
    return gravity_known ? label_of_normal(fit.normal) : Label::unknown;
  }
};

struct DepthSegmentation {
  const DepthImage& image;
  const ObjectiveOptions& options;
  std::span<const KnownPlane> known = {};
  DepthCells cells = {};
  DepthNoise noise = {};
  std::vector<DepthRegion> regions = {};
  std::vector<std::int32_t> region_of = {};  // per pixel
  SegmentCounts counts = {};
  DepthTrace traced = {};

  double u(std::uint32_t pixel) const { return image.u(static_cast<int>(pixel) % image.width); }
  double v(std::uint32_t pixel) const { return image.v(static_cast<int>(pixel) / image.width); }
  /// rho of the pixel, less that of the plane [1/m].
  double residual(std::uint32_t pixel, const InversePlane& plane) const {
    return image.rho[pixel] - plane.at(u(pixel), v(pixel));
  }
  /// How far off a known plane may be where rho is this [1/m].
  double reach_of(const KnownPlane& expected, double rho) const {
    return expected.slack_m * rho * rho + options.reach_sigma * std::hypot(noise.white, noise.bow);
  }
  /// Whether a region's plane is where a known one is expected.
  bool lies_on(const DepthRegion& region, const KnownPlane& expected) const {
    const PixelMoments& m = region.moments;
    const double off2 = (m.sse_about(expected.plane) - region.plane.sse) / m.n;
    const double most = reach_of(expected, m.r / m.n);
    return off2 <= most * most;
  }
  /// Infinite for two known planes, as joining them saves nothing, and for a region that does not
  /// lie on the known one.
  double join_cost(std::int32_t a, std::int32_t b) const {
    const DepthRegion &p = regions[a], &q = regions[b];
    const auto excludes = [&](const DepthRegion& one, const DepthRegion& other) {
      return one.known > 0 && (other.known > 0 || !lies_on(other, known[one.known - 1]));
    };
    if (excludes(p, q) || excludes(q, p)) return std::numeric_limits<double>::infinity();
    return noise.join_cost(p.moments, p.plane, q.moments, q.plane);
  }
};

// Every decision is logged before what follows from it. Without a trace these do nothing.

/// The region of a node has just been founded.
void log_founded(DepthSegmentation& s,
                 const Octree& octree,
                 std::int32_t region,
                 std::int32_t node);
void log_join(DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost);
/// Pixels changed hands: `before` is what region_of was.
void log_growth(DepthSegmentation& s, const std::vector<std::int32_t>& before);
/// A region ends: its pixels are free.
void log_drop(DepthSegmentation& s, Stage stage, std::int32_t region, double value);

/// `from` becomes part of `into`; region_of is left to the caller. `cost`: join_cost() of the two.
void join_regions(
    DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost);

/// Pixels of regions that ended become free.
inline void free_pixels_of_ended(DepthSegmentation& s) {
  for (std::int32_t& region : s.region_of)
    if (region >= 0 && !s.regions[region].alive) region = kNoRegion;
}

/// Founds the first regions: cells of the octree that one plane explains (Sun et al. 2023, Sec.
/// IV-C). Fills the nodes of the octree.
void divide_image(DepthSegmentation& s, Octree& octree);

/// Founds regions on known planes where the depth supports them; other regions give up these
/// pixels. Returns the known planes that are not apart from larger ones.
std::vector<KnownCover> found_known_regions(DepthSegmentation& s);

/// Counts the border that each two regions share, and sets `near` of both where it is at least
/// `least` px. `gap`: pixels that may lie between them; `step`: largest difference of rho across it
/// [1/m].
void find_neighbors(DepthSegmentation& s, int least, int gap, double step);

/// Appends the pixels of a row that have a region and a neighbor that is not in it. The row is none
/// at the edge of the image.
inline void append_border_pixels(const std::vector<std::int32_t>& region,
                                 int width,
                                 int y,
                                 std::vector<std::uint32_t>& pixels) {
  const std::int32_t* const row = region.data() + static_cast<std::size_t>(y) * width;
  const auto differs = [&](int x) {
    return (row[x + 1] ^ row[x]) | (row[x - 1] ^ row[x]) | (row[x + width] ^ row[x]) |
           (row[x - width] ^ row[x]);
  };
  const auto look = [&](int x) {
    if (row[x] >= 0 && differs(x) != 0) pixels.push_back(static_cast<std::uint32_t>(y * width + x));
  };
  constexpr int kRun = 16;  // most of an image lies inside of regions
  int x = 1;
  for (; x + kRun < width; x += kRun) {
    std::int32_t any = 0;
    for (int k = 0; k < kRun; ++k) any |= differs(x + k);
    if (any == 0) continue;
    for (int k = 0; k < kRun; ++k) look(x + k);
  }
  for (; x + 1 < width; ++x) look(x);
}

/// Joins neighbors, the lowest cost first, while a join costs less than a plane.
void merge_regions(DepthSegmentation& s);

/// Pixels at borders go to the region that explains them best; free ones to a region in reach.
void grow_regions(DepthSegmentation& s);

/// Joins parts of one plane that something nearer hides from each other.
void join_hidden_parts(DepthSegmentation& s);

/// What a region is worth: its pixels relative to a plane of 1 % RMS, in an image 640 px wide.
double worth_px(const DepthSegmentation& s, const DepthRegion& region);

}  // namespace planescope::planes
