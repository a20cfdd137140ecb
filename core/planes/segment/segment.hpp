#pragma once

// Finds the planes of a cloud: Section IV of the paper, or the objective of `refined`.

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
  PlaneFit fit;              // local coordinates; normal points up (h) or toward the sensor (v)
  std::uint32_t points = 0;  // number of points of segment()'s input
  int known = 0;             // id of the known plane it matches; 0: none
  std::int32_t founded = 0;  // index of the plane in the trace: order of creation
  // Distance of the objective from losing the plane: the minimum over not listing it, joining it
  // with a neighbor at least as large, and not having joined its parts. Dimensionless, at least 0;
  // infinite without an objective.
  double margin = std::numeric_limits<double>::infinity();
  bool undecided = false;  // the margin is below the threshold
};

/// Work done by the traversal; the same for any thread count.
struct SegmentCounts {
  std::uint32_t nodes_visited = 0;
  std::uint32_t nodes_per_case[5] = {};            // indexed by Case
  std::uint32_t nodes_per_case_depth[5][22] = {};  // [Case][depth]
  std::uint32_t candidates = 0;
  std::uint32_t merges = 0;
  std::uint32_t leftovers = 0;   // points left over by the traversal
  std::uint32_t assigned = 0;    // leftovers later assigned to a plane
  std::uint32_t unassigned = 0;  // points in no plane at the end
};

struct SegmentTimings {
  double build_ms = 0;     // t_b
  double traverse_ms = 0;  // t_s: everything after the octree
};

struct Segmentation {
  std::vector<std::int32_t> plane_of;        // per input point: plane id, 0 none
  std::vector<std::int32_t> plane_of_pixel;  // depth images: the same per pixel
  std::vector<PlaneRegion> planes;           // planes[id - 1]
  std::vector<PlaneRegion> minor;            // worth too little to be listed; id 0, assigned to
                                             // no pixel
  std::vector<std::vector<std::uint32_t>> minor_points;  // points of each minor plane
  std::vector<KnownCover> covered;                       // known planes explained by larger ones
  Octree octree;                                         // with the case of each visited node
  SegmentCounts counts;
  SegmentTimings timings;
  NoiseModel noise;  // as measured
};

/// Segments a cloud. `points`: finite local coordinates inside `cube`, in meters. `labels`: h or v;
/// ignored if the options do not use labels. `sensor`: sensor position in the same coordinates,
/// which determines range and the side of normals.
Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace = nullptr);

/// Normal on the visible side: floors face up, walls face the sensor.
inline Vec3d outward_normal(const PlaneFit& fit, Label label, const Vec3d& sensor) {
  const double side = label == Label::h ? fit.normal.z() : fit.normal.dot(sensor - fit.centroid);
  return side < 0 ? Vec3d(-fit.normal) : fit.normal;
}

}  // namespace planescope::planes
