#pragma once

// Planes of a cloud in one function: the paper's Section IV, or the objective of `refined`.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/depth/inverse_depth.hpp"
#include "core/planes/segment/octree.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::planes {

struct PlaneRegion {
  int id = 0;  // 1-based
  Label label = Label::unknown;
  PlaneFit fit;  // local coordinates; normal points up (h) or towards the sensor side (v)
  std::uint32_t points = 0;  // points of segment()'s input
  int known = 0;             // id of the known plane it is, 0: none
  std::int32_t founded = 0;  // number of the plane in the trace: order of founding
  // How far the objective is from losing the plane: from not listing it, from joining it with a
  // neighbor at least as large, or from not having joined its parts; the least of these.
  // Dimensionless, at least 0; infinite: no objective was minimized.
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
  double traverse_ms = 0;  // t_s: all that follows
};

struct Segmentation {
  std::vector<std::int32_t> plane_of;        // per input point: plane id, 0 none
  std::vector<std::int32_t> plane_of_pixel;  // depth images: per pixel, likewise
  std::vector<PlaneRegion> planes;           // planes[id - 1]
  std::vector<PlaneRegion> minor;            // worth too little to be listed; ids 0, in no pixel
  std::vector<std::vector<std::uint32_t>> minor_points;  // of each, the points that were its own
  std::vector<KnownCover> covered;                       // known planes that larger ones explain
  Octree octree;                                         // with each visited node's case
  SegmentCounts counts;
  SegmentTimings timings;
  NoiseModel noise;  // as measured
};

/// `points`: local coordinates inside `cube`, finite, metres. `labels`: h or v each; any where the
/// options do not use them.
/// `sensor`: the sensor's position in the same coordinates (range for sigma, side for normals).
Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace = nullptr);

/// The normal on the side that is shown: floors look up, walls look at the sensor.
inline Vec3d outward_normal(const PlaneFit& fit, Label label, const Vec3d& sensor) {
  const double side = label == Label::h ? fit.normal.z() : fit.normal.dot(sensor - fit.centroid);
  return side < 0 ? Vec3d(-fit.normal) : fit.normal;
}

}  // namespace planescope::planes
