#pragma once

// The paper's Section IV in one function.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/segment/noise.hpp"
#include "core/planes/segment/octree.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::planes {

/// Pixels of columns [x0, x1) and rows [y0, y1).
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// The depth image behind the points, for what is decided between neighbouring pixels: what each
/// measured, in raster order.
struct PixelGrid {
  static constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

  int width = 0, height = 0;         // 0: the points come from no image
  double focal_px = 0;               // pixels per metre on a surface that faces the camera 1 m away
  std::vector<Vec3f> measured;       // where it is [m], in the coordinates of segment()'s points
  std::vector<std::uint32_t> point;  // which of these it went into; kNoPoint: none

  /// A pixel as seen along its ray from the sensor; see inverse_plane.hpp.
  struct Seen {
    Vec3d ray = Vec3d::Zero();  // unit
    double w = 0;               // 1 / distance [1/m]
  };
  Seen seen(std::size_t pixel, const Vec3d& sensor) const {
    const Vec3d to = measured[pixel].cast<double>() - sensor;
    const double w = 1 / std::max(to.norm(), 1e-3);
    return {to * w, w};
  }

  bool empty() const { return point.empty(); }
  bool has(std::size_t pixel) const { return point[pixel] != kNoPoint; }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  /// The rectangle with a margin, as far as it is in the image.
  Rect around(const Rect& rect, int margin) const {
    return {std::max(0, rect.x0 - margin), std::max(0, rect.y0 - margin),
            std::min(width, rect.x1 + margin), std::min(height, rect.y1 + margin)};
  }
};

struct PlaneRegion {
  int id = 0;  // 1-based
  Label label = Label::unknown;
  PlaneFit fit;  // local coordinates; normal points up (h) or towards the sensor side (v)
  std::uint32_t points = 0;  // points of segment()'s input
  std::int32_t founded = 0;  // number of the plane in the trace: order of founding
  // By how much the objective would rise if the plane were lost, or joined with its closest
  // neighbor, whichever is less. Dimensionless, at least 0; infinite: no objective was minimized.
  double margin = std::numeric_limits<double>::infinity();
  bool undecided = false;  // the margin is below the threshold
};

/// How much the traversal did; the same for any thread count.
struct SegmentCounts {
  std::uint32_t nodes_visited = 0;
  std::uint32_t nodes_per_case[5] = {};            // indexed by Case
  std::uint32_t nodes_per_case_depth[5][22] = {};  // [Case][depth]
  std::uint32_t candidates = 0;
  std::uint32_t merges = 0;
  std::uint32_t leftovers = 0;   // points left over by the traversal
  std::uint32_t assigned = 0;    // of those, given to a plane afterwards
  std::uint32_t unassigned = 0;  // points in no plane at the end
};

struct SegmentTimings {
  double build_ms = 0;     // t_b
  double traverse_ms = 0;  // t_s: traversal, merge, assignment and refinements
};

/// What else was measured, for the refinements that ask.
struct Measurements {
  std::vector<Spread> spreads;  // R8: per point, of its measurements about it
  bool rays = false;            // the split: `sensor` saw all points along rays that end there ...
  std::vector<Vec3f> beyond;    // ... and these, which were cropped
  PixelGrid pixels;             // R9 to R12: of a depth image
};

struct Segmentation {
  std::vector<std::int32_t> plane_of;        // per input point: plane id, 0 none
  std::vector<std::int32_t> plane_of_pixel;  // R11: per pixel, likewise; without it empty
  std::vector<PlaneRegion> planes;           // planes[id - 1]
  std::vector<PlaneRegion> minor;  // R10: too small or too ragged to be listed; ids 0, in no pixel
  std::vector<std::vector<std::uint32_t>> minor_points;  // of each, the points that were its own
  Octree octree;                                         // with each visited node's case
  SegmentCounts counts;
  SegmentTimings timings;
  NoiseModel noise;  // measured, and the thresholds that follow
};

/// `points`: local coordinates inside `cube`, finite, metres. `labels`: h or v each; any where the
/// options do not use them.
/// `sensor`: the sensor's position in the same coordinates (range for sigma, side for normals).
/// `threads`: for what asks each pixel or each plane by itself; the result is the same for any.
Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace = nullptr,
                     const Measurements& more = {},
                     int threads = 1);

/// The normal on the side that is shown: floors look up, walls look at the sensor.
inline Vec3d outward_normal(const PlaneFit& fit, Label label, const Vec3d& sensor) {
  const double side = label == Label::h ? fit.normal.z() : fit.normal.dot(sensor - fit.centroid);
  return side < 0 ? Vec3d(-fit.normal) : fit.normal;
}

}  // namespace planescope::planes
