#pragma once

// What became of the planes of an earlier run of the same frame.

#include <cstdint>
#include <vector>

#include "core/report/data/plane_summary.hpp"
#include "core/report/data/region_sample.hpp"

namespace planescope::report {

/// `same` to `split` describe a plane of the baseline, `gained` one that is new.
enum class PlaneFate : std::uint8_t { same, resized, moved, lost, merged, split, gained };
const char* to_string(PlaneFate fate);

/// The least change by which a plane counts as moved or resized.
struct FateLimits {
  double offset_m = 0.005;
  double angle_deg = 1;
  double area_ratio = 1.25;  // of the larger area to the smaller
};

struct PlaneComparison {
  PlaneFate fate = PlaneFate::same;
  int baseline = 0, now = 0;  // ids, 0 none; of a split plane its largest part, and so on
  std::vector<int> others;    // merged: baseline's planes that went into `now` as well; split: its
                              // other parts
  double iou = 0;             // of the samples on them
  double offset_m = 0;        // distance of the one from the centroid of the other, the larger
  double angle_deg = 0;
  double area_ratio = 0;  // now / baseline
};

/// One run's planes of a frame, in that run's world frame: z up, metres.
struct ComparedPlanes {
  const std::vector<PlaneSummary>& planes;  // by id - 1
  const RegionSample& sample;
};

/// Baseline's planes by their ids, then those gained. Where the samples are not of the same pixels
/// or points, as in reports that have none, and for planes without samples, centroids and normals
/// decide.
std::vector<PlaneComparison> compare_planes(const ComparedPlanes& baseline,
                                            const ComparedPlanes& now,
                                            const FateLimits& limits = {});

}  // namespace planescope::report
