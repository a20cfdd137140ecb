#pragma once

// What a report keeps of a frame's planes: each one's figures, and which plane some of the frame's
// measurements are on.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::report {

/// What planes.json, the report and eval say about one plane. World frame: z up, metres.
struct PlaneSummary {
  int id = 0;  // from 1
  Label label = Label::unknown;
  Vec3d normal = Vec3d::UnitZ();  // unit
  Vec3d centroid = Vec3d::Zero();
  double offset_m = 0;  // normal . x = offset
  double tilt_deg = 0;  // against the horizontal: 0 a floor, 90 a wall; NaN: gravity is unknown
  std::uint64_t points = 0;  // input points
  std::uint64_t voxels = 0;
  double rms_m = 0;  // distance of its input points from the plane, root mean square
  // Area covered by points: occupied cells of a grid in the plane, as wide as a voxel (2 cm where
  // there is no voxel grid). Unlike the hull's area it does not count holes and bays.
  double area_m2 = 0;
  double margin = std::numeric_limits<double>::infinity();  // of PlaneRegion, as is `undecided`
  bool undecided = false;
  std::vector<Vec3d> hull;  // convex hull of its points on the plane, counter-clockwise seen from
                            // where the normal points
};

/// Of the grid in a plane that tells what it covers [m].
inline double cell_size_m(double voxel_size_m) { return voxel_size_m > 0 ? voxel_size_m : 0.02; }

/// One entry per plane, by id - 1.
std::vector<PlaneSummary> summarize_planes(const planes::FrameResult& result, double voxel_size_m);

/// Which plane some of a frame's measurements are on: enough to match its planes with those of
/// another run, and small enough to be kept.
struct RegionSample {
  struct Run {
    int plane = 0;  // plane id, 0 in none, -1 not measured or cropped
    int count = 0;
    bool operator==(const Run&) const = default;
  };
  int step = 1;               // every step-th pixel of every step-th row, or point of a cloud
  int columns = 0, rows = 0;  // of a cloud one row
  std::vector<Run> runs;      // row by row

  bool operator==(const RegionSample&) const = default;
  std::vector<int> plane_of() const;  // one per sample
};

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of);
RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result);

}  // namespace planescope::report
