#pragma once

// Finds likely mistakes in a frame's labels.

#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

enum class FindingKind : std::uint8_t {
  camera,        // drawn with other intrinsics or another depth unit
  rms,           // the plane does not fit its pixels
  outliers,      // some of its pixels are far off
  parts,         // it has several separate pieces
  tiny,          // smaller than the minimum area
  class_normal,  // its class contradicts its tilt
  unlabeled,     // a measured region without a label, most of it on one plane
};
const char* to_string(FindingKind kind);
/// Hints: labels with these findings can be correct (a plane in parts behind a pole, a small plane,
/// a remainder that is not a plane). The other kinds are definite mistakes.
bool is_hint(FindingKind kind);

struct Finding {
  FindingKind kind = FindingKind::rms;
  int plane = 0;                // 0 for unlabeled
  std::uint32_t pixel = 0;      // position of the finding
  PixelSet pixels;              // the outliers, the smaller parts, the region
  double value = 0, limit = 0;  // measured and allowed, in `text`'s unit
  std::string text;             // "P3: RMS 14 mm; expected at most 8 mm at 1.9 m"
};

struct AuditOptions {
  double max_rms_m = 0.006;         // at close range; grows with the noise of the depth
  double max_outlier_share = 0.02;  // pixels farther than four times the expected noise
  double min_area_m2 = 0.002;
  double unlabeled_area_m2 = 0.01;  // report connected regions of at least this size
  double max_class_tilt_deg = 30;   // an h plane is tilted less, a v plane more than 90 - this
  int gap_px = 8;                   // parts nearer than this count as one
};

/// Ordered by kind, then size. Ignored pixels are correct; so are unlabeled regions if most pixels
/// are on no plane, or if a reviewer accepted them (kept an "invented" region, or reviewed the
/// whole frame).
std::vector<Finding> audit_labels(const FrameLabels& labels,
                                  const LabelGrid& grid,
                                  const AuditOptions& options = {});

/// Statistics of one frame.
struct LabelStatistics {
  int planes = 0, h = 0, v = 0;
  std::size_t measured = 0, labeled = 0, ignored = 0, hidden = 0;  // pixels
  double labeled_m2 = 0;
};
LabelStatistics statistics_of(const FrameLabels& labels, const LabelGrid& grid);

}  // namespace planescope::labels
