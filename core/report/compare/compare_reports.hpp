#pragma once

// Changes of each frame and its planes since an earlier report, the baseline.

#include <cstdint>
#include <string>
#include <vector>

#include "core/report/data/report_data.hpp"

namespace planescope::report {

/// `same` to `split` describe a plane of the baseline, `gained` a new one.
enum class PlaneFate : std::uint8_t { same, resized, moved, lost, merged, split, gained };
const char* to_string(PlaneFate fate);

/// Minimum change of a plane that counts as moved or resized.
struct FateLimits {
  double offset_m = 0.005;
  double angle_deg = 1;
  double area_ratio = 1.25;  // of the larger area to the smaller
};

struct PlaneComparison {
  PlaneFate fate = PlaneFate::same;
  int baseline = 0, now = 0;  // plane ids, 0: none; for a split plane `now` is its largest part
  std::vector<int> others;    // merged: other planes of the baseline merged into `now`; split: the
                              // other parts
  double iou = 0;             // of the samples on them
  double offset_m = 0;        // from one plane to the other's centroid, the larger of both
  double angle_deg = 0;
  double area_ratio = 0;   // now / baseline
  bool undecided = false;  // at least one of the planes is undecided in its run
};

/// Compares frames of the same input. Returns the baseline's planes by id, then the gained ones.
/// Planes without samples are matched by centroids and normals, and so are all planes if the
/// samples are missing or of different pixels or points.
std::vector<PlaneComparison> compare_planes(const ReportFrame& baseline,
                                            const ReportFrame& now,
                                            const FateLimits& limits = {});

enum class FrameFate : std::uint8_t {
  compared,
  other_input,  // its pixels or points differ from the baseline's frame
  refused,      // processed in the baseline, now refused
  mended,       // refused in the baseline, now processed
  both_refused,
  added,    // not in the baseline
  missing,  // only in the baseline
};
const char* to_string(FrameFate fate);

struct FrameComparison {
  FrameFate fate = FrameFate::compared;
  std::string recording;
  int index = 0;                          // for a missing frame, in the baseline
  std::string name;                       // may be empty
  const ReportFrame* baseline = nullptr;  // points into the compared reports; null: missing
  const ReportFrame* now = nullptr;
  std::vector<PlaneComparison> planes;  // if it was compared

  int count(PlaneFate fate_of_plane) const;
};

struct ReportComparison {
  /// All other differences: "option voxel_size_m: 0.02 -> 0.04", "weights: ...".
  std::vector<std::string> differences;
  std::vector<FrameComparison> frames;  // in the new report's order, then the missing ones
  /// Parts of the baseline that were not requested for the new report and so are not missing:
  /// "stairs: 35 of 40 frames", "hall".
  std::vector<std::string> left_out;
};

/// Matches recordings by name (in order, if several have the same name), and their frames by
/// pixels, by name and by time, in this order. Frame numbers are used only if names are unknown,
/// because they shift when a frame is removed. The result points into both reports.
ReportComparison compare_reports(const Report& baseline,
                                 const Report& now,
                                 const FateLimits& limits = {});

// Changes of terrain as text.

/// "4 steps up, rise 170 mm, going 289 mm in the baseline, 3 steps up, ... now"; empty: unchanged,
/// or unknown in one report.
std::string flights_change(const FrameComparison& frame);
/// "0.43 m2 in the baseline, 0.12 m2 now", and each plane that became steppable, or is no longer,
/// with the reason. Empty as above, and if either report has no foot.
std::vector<std::string> steppable_changes(const FrameComparison& frame);
/// All of these, with kerbs and ramps: one sentence each.
std::vector<std::string> terrain_changes(const FrameComparison& frame);

/// "3 of 5 planes are steppable"; "no stairs are found".
std::string steppable_text(const ReportFrame& frame);
std::string flights_text(const ReportFrame& frame);

}  // namespace planescope::report
