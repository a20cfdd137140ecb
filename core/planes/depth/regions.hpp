#pragma once

// State of the depth segmentation: octree cells, noise, and regions of pixels with their moments
// and planes. Stages change regions only through these functions, which log each change to the
// trace (if any).

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

// Cells of an octree over (u, v, rho), all levels at once. A leaf is 4 px square and 1/16 1/m deep;
// each level doubles the cell along every axis. The grid is fixed, independent of gravity and of
// all measurements, so changes within the noise do not change a frame's cells.

inline constexpr int kLeafPx = 4;
inline constexpr double kPxPerInverseMeter = 64;  // ratio of a cell's sides in u and v to its side
                                                  // in rho

struct DepthCell {
  std::uint64_t code = 0;  // Morton code of (u, v, rho) at its level
  PixelMoments moments;
  std::uint32_t begin = 0, end = 0;              // child cells, in the level below
  std::uint32_t first_pixel = 0, end_pixel = 0;  // pixels: DepthCells::pixels[first, end)
};

struct DepthCells {
  std::vector<std::vector<DepthCell>> levels;  // levels.front(): leaves; levels.back(): one root
  std::vector<std::uint32_t> pixels;           // raster indices, ordered by leaf
  std::vector<PixelMoments> blocks;            // all full squares of 4 px, for any rho
  int block_columns = 0;

  int depth() const { return static_cast<int>(levels.size()) - 1; }
  static int side_px(int level) { return kLeafPx << level; }
};

DepthCells make_depth_cells(const DepthImage& image);

// Noise of a depth image, measured in the image at two scales: white noise, which varies from pixel
// to pixel, and the bow, the sensor's low-frequency error (none for a scanner, about a centimeter
// at 1 to 3 m for a D400).

struct DepthNoise {
  double white = 0;       // standard deviation of rho [1/m]; 0: too little depth to measure it
  double bow = 0;         // same, over distances of length_px and more
  double wide = 0;        // standard deviation of single pixels about planes of wide squares: white
                          // noise and bow [1/m]
  double length_px = 20;  // distance over which the bow develops
  double lateral_px = 2;  // lateral error of a pixel

  /// Variance of a pixel about a plane, and of the bow [1/m^2]. The lateral error contributes in
  /// proportion to the slope of rho; on grazing surfaces it dominates.
  double white2(const InversePlane& p) const { return white * white + sideways2(p); }
  double bow2(const InversePlane& p) const { return bow * bow + sideways2(p); }
  double sideways2(const InversePlane& p) const {
    return lateral_px * lateral_px * (p.a * p.a + p.b * p.b);
  }
  double pixel2(const InversePlane& p) const { return white2(p) + bow2(p); }
  /// Share of the bow's variance visible between two positions at this distance.
  double developed(double distance2_px2) const {
    return std::min(1.0, distance2_px2 / (length_px * length_px));
  }

  /// Misfit added by joining two sets of pixels: the mean squared offset between their planes
  /// divided by the variance explained by noise and bow. Joining them saves the cost of one
  /// plane, options.merge_cost.
  double join_cost(const PixelMoments& a,
                   const InversePlane& plane_a,
                   const PixelMoments& b,
                   const InversePlane& plane_b) const {
    PixelMoments both = a;
    both += b;
    // Limit each plane's misfit from below to the noise level: a cell boundary that splits noise
    // into two layers makes each layer flatter than the noise.
    const double apart = std::max(plane_a.sse, (a.n - 3) * white * white) +
                         std::max(plane_b.sse, (b.n - 3) * white * white);
    const double offset2 = std::max(0.0, both.fit().sse - apart) * both.n / (a.n * b.n);
    const double du = a.u / a.n - b.u / b.n, dv = a.v / a.n - b.v / b.n;
    const double explained = 3 * (white2(plane_a) / a.n + white2(plane_b) / b.n) +
                             std::min(bow2(plane_a), bow2(plane_b)) * developed(du * du + dv * dv);
    return offset2 / explained;
  }
};

/// `blocks`: moments of all full squares of 4 px, row by row, `columns` per row. `unit_m`: rounding
/// step of the depth; 0: not rounded.
DepthNoise measure_depth_noise(const std::vector<PixelMoments>& blocks,
                               int columns,
                               int width_px,
                               double unit_m,
                               const ObjectiveOptions& options);

// ---- Regions ----

inline constexpr std::int32_t kNoRegion = -1;

/// A join that was made at nearly the cost limit.
struct DearJoin {
  double cost = 0;
  double smaller_px = 0;  // pixels of the smaller part
};

struct DepthNeighbor {
  std::int32_t region = kNoRegion;
  // Cost of joining; set by merge_regions() if `region` is the higher index.
  double cost = std::numeric_limits<double>::infinity();
};

struct DepthRegion {
  PixelMoments moments;
  InversePlane plane;
  bool alive = true;
  int known = 0;                     // index + 1 of its known plane; 0: none
  std::vector<DearJoin> dear_joins;  // joins that formed this region
  std::vector<DepthNeighbor> near;   // ascending
};

/// Additional data for the trace; empty if not tracing.
struct DepthTrace {
  Trace* trace = nullptr;
  bool gravity_known = false;
  std::vector<std::uint32_t> position;  // per pixel: Morton position
  std::span<const Vec3f> points;        // by Morton position: local coordinates [m]
  std::vector<GrowingPlane> planes;     // per region, in 3D

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
  /// rho of the pixel minus rho of the plane [1/m].
  double residual(std::uint32_t pixel, const InversePlane& plane) const {
    return image.rho[pixel] - plane.at(u(pixel), v(pixel));
  }
  /// Tolerance for a known plane at this rho [1/m].
  double tolerance_of(const KnownPlane& expected, double rho) const {
    return expected.slack_m * rho * rho + options.reach_sigma * std::hypot(noise.white, noise.bow);
  }
  /// Whether a region's plane matches the expected position of a known plane.
  bool lies_on(const DepthRegion& region, const KnownPlane& expected) const {
    const PixelMoments& m = region.moments;
    const double off2 = (m.sse_about(expected.plane) - region.plane.sse) / m.n;
    const double most = tolerance_of(expected, m.r / m.n);
    return off2 <= most * most;
  }
  /// Infinite for two known planes, because joining them saves nothing, and for a region that is
  /// not on the known plane.
  double join_cost(std::int32_t a, std::int32_t b) const {
    const DepthRegion &p = regions[a], &q = regions[b];
    const auto excludes = [&](const DepthRegion& one, const DepthRegion& other) {
      return one.known > 0 && (other.known > 0 || !lies_on(other, known[one.known - 1]));
    };
    if (excludes(p, q) || excludes(q, p)) return std::numeric_limits<double>::infinity();
    return noise.join_cost(p.moments, p.plane, q.moments, q.plane);
  }
};

// Every decision is logged before its consequences. Without a trace these functions do nothing.

/// Logs a region created from a node.
void log_founded(DepthSegmentation& s,
                 const Octree& octree,
                 std::int32_t region,
                 std::int32_t node);
void log_join(DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost);
/// Logs pixels that changed regions; `before` is the previous region_of.
void log_growth(DepthSegmentation& s, const std::vector<std::int32_t>& before);
/// Logs the end of a region, whose pixels become free.
void log_drop(DepthSegmentation& s, Stage stage, std::int32_t region, double value);

/// Merges `from` into `into`; the caller updates region_of. `cost`: join_cost() of the two.
void join_regions(
    DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost);

/// Frees the pixels of regions that have ended.
inline void free_pixels_of_ended(DepthSegmentation& s) {
  for (std::int32_t& region : s.region_of)
    if (region >= 0 && !s.regions[region].alive) region = kNoRegion;
}

/// Creates the first regions: octree cells explained by one plane (Sun et al. 2023, Sec. IV-C).
/// Fills the nodes of the octree.
void divide_image(DepthSegmentation& s, Octree& octree);

/// Creates regions for known planes where the depth supports them, taking the pixels from other
/// regions. Returns the known planes that are indistinguishable from larger ones.
std::vector<KnownCover> found_known_regions(DepthSegmentation& s);

/// Measures the common border of every pair of regions, and sets `near` of both if it is at least
/// `least` px long. `gap`: pixels allowed between them; `step`: largest difference of rho across
/// the border [1/m].
void find_neighbors(DepthSegmentation& s, int least, int gap, double step);

/// Appends the pixels of a row that have a region and a neighbor outside it. `y` must not be
/// the first or last row.
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
  constexpr int kRun = 16;  // most pixels are inside a region
  int x = 1;
  for (; x + kRun < width; x += kRun) {
    std::int32_t any = 0;
    for (int k = 0; k < kRun; ++k) any |= differs(x + k);
    if (any == 0) continue;
    for (int k = 0; k < kRun; ++k) look(x + k);
  }
  for (; x + 1 < width; ++x) look(x);
}

/// Joins neighbors in order of cost while a join costs less than a plane.
void merge_regions(DepthSegmentation& s);

/// Reassigns border pixels to the region that explains them best, and free pixels to a region
/// in reach.
void grow_regions(DepthSegmentation& s);

/// Joins parts of one plane that are separated by a closer object.
void join_hidden_parts(DepthSegmentation& s);

/// Worth of a region: its pixel count, relative to a plane of 1 % RMS in an image 640 px wide.
double worth_px(const DepthSegmentation& s, const DepthRegion& region);

}  // namespace planescope::planes
