#pragma once

// What became of each frame, and of its planes, since an earlier report: the baseline.

#include <cstdint>
#include <string>
#include <vector>

#include "core/report/data/report_data.hpp"

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
  int baseline = 0, now = 0;  // plane ids, 0: none; of a split plane `now` is its largest part
  std::vector<int> others;    // merged: baseline's planes that went into `now` as well; split: its
                              // other parts
  double iou = 0;             // of the samples on them
  double offset_m = 0;        // from the one plane to the centroid of the other, the larger of two
  double angle_deg = 0;
  double area_ratio = 0;   // now / baseline
  bool undecided = false;  // one of these planes is, in its run
};

/// Of frames of the same input: baseline's planes by their ids, then those gained. Where the
/// samples are not of the same pixels or points, as in reports that have none, and for planes
/// without samples, centroids and normals decide.
std::vector<PlaneComparison> compare_planes(const ReportFrame& baseline,
                                            const ReportFrame& now,
                                            const FateLimits& limits = {});

enum class FrameFate : std::uint8_t {
  compared,
  other_input,  // its pixels or points are not those of the baseline's frame
  refused,      // processed in the baseline, now refused
  mended,       // refused in the baseline, now processed
  both_refused,
  added,    // not in the baseline
  missing,  // in the baseline alone
};
const char* to_string(FrameFate fate);

struct FrameComparison {
  FrameFate fate = FrameFate::compared;
  std::string recording;
  int index = 0;                          // of a missing frame in the baseline
  std::string name;                       // may be empty
  const ReportFrame* baseline = nullptr;  // of the reports that were compared; null: not there
  const ReportFrame* now = nullptr;
  std::vector<PlaneComparison> planes;  // where it was compared

  int count(PlaneFate fate_of_plane) const;
};

struct ReportComparison {
  /// Everything else that is not the same: "option voxel_size_m: 0.02 -> 0.04", "weights: ...".
  std::vector<std::string> differences;
  std::vector<FrameComparison> frames;  // in the new report's order, then those that it lacks
  /// Parts of the baseline that the new report was not asked for, which are not missing:
  /// "stairs: 35 of 40 frames", "hall".
  std::vector<std::string> left_out;
};

/// Matches recordings by name (those of one name by order), and their frames by pixels, by name and
/// by time, in this order. Frame numbers decide only where names are unknown: they shift when a
/// frame is removed. The result points into both reports.
ReportComparison compare_reports(const Report& baseline,
                                 const Report& now,
                                 const FateLimits& limits = {});

// What became of what one can stand on, in words.

/// "4 steps up, rise 170 mm, going 289 mm in the baseline, 3 steps up, ... now"; empty: both tell
/// of the same, or one is not known.
std::string flights_change(const FrameComparison& frame);
/// "0.43 m2 in the baseline, 0.12 m2 now", and each plane that is no longer steppable, and why, or
/// has become so; empty as above, and where one was without a foot.
std::vector<std::string> steppable_changes(const FrameComparison& frame);
/// All of it, with kerbs and ramps: a sentence each.
std::vector<std::string> terrain_changes(const FrameComparison& frame);

/// "3 of 5 planes are steppable"; "no stairs are found".
std::string steppable_text(const ReportFrame& frame);
std::string flights_text(const ReportFrame& frame);

}  // namespace planescope::report
