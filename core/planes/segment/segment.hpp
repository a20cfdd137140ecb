#pragma once

// The paper's Section IV in one function.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/planes/segment/noise.hpp"
#include "core/planes/segment/octree.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/pixel_grid.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::planes {

struct PlaneRegion {
  int id = 0;  // 1-based
  Label label = Label::unknown;
  PlaneFit fit;  // local coordinates; normal points up (h) or towards the sensor side (v)
  std::uint32_t points = 0;  // points of segment()'s input
  std::int32_t founded = 0;  // number of the plane in the trace: order of founding
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
  Octree octree;                   // with each visited node's case
  SegmentCounts counts;
  SegmentTimings timings;
  NoiseModel noise;  // measured, and the thresholds that follow
};

/// `points`: local coordinates inside `cube`, finite, metres. `labels`: h or v each; any where the
/// options do not use them.
/// `sensor`: the sensor's position in the same coordinates (range for sigma, side for normals).
Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace = nullptr,
                     const Measurements& more = {});

}  // namespace planescope::planes
