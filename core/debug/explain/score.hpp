#pragma once

// Evaluates a run: its score against ground truth (fast enough for slider ticks and for searches
// with thousands of runs), the share of the frame on planes, and the effect of other options.

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::planes {
struct OptionInfo;
}

namespace planescope::debug {

inline constexpr double kDetectedIou = 0.8;  // as in eval

struct TruthMatch {
  std::int32_t truth = 0;  // truth plane id
  std::int32_t found = 0;  // plane id with the largest overlap, 0 none
  double iou = 0;
  std::uint32_t points = 0;
};

struct QuickScore {
  std::vector<TruthMatch> planes;  // per true plane with voxels, ascending id
  int detected = 0;                // IoU >= kDetectedIou
  double mean_iou = 0;             // 0..1
  double in_no_plane = 0;          // share of voxels on true planes that are in no found plane
  int found_planes = 0;
};
/// `plane_of`: per voxel, 0 none.
QuickScore quick_score(std::span<const std::int32_t> plane_of, const VoxelTruth& truth);

enum class TruthVerdict : std::uint8_t { detected, missed, merged, split };
/// Verdict for each true plane of a score: merged if its best plane also covers half of another
/// true plane, split if several planes together cover half of it.
std::vector<TruthVerdict> verdicts_of(const QuickScore& score,
                                      std::span<const std::int32_t> plane_of,
                                      const VoxelTruth& truth);
const char* to_string(TruthVerdict verdict);

/// The most frequent plane id, the smallest on ties; 0 if all are 0.
std::int32_t most_common_plane(std::span<const std::int32_t> planes);

/// Points that are in no plane for the same reason.
struct Lost {
  std::string reason;                 // "worth too little"
  std::size_t sources = 0;            // pixels, or points of the file
  std::vector<std::uint32_t> voxels;  // ascending; empty if cropped
  std::int64_t middle = -1;           // a voxel in the middle of the largest group lost by
                                      // one decision
};

struct FrameSummary {
  std::size_t measured = 0;      // pixels, or points of the file
  std::size_t out_of_range = 0;  // outside the octree's cube, or without a voxel
  std::size_t beyond = 0;        // number of these farther than max_range_m; depth images only
  std::size_t on_planes = 0;
  std::size_t on_undecided = 0;  // number of these on undecided planes
  int planes = 0, undecided = 0;
  std::vector<Lost> lost;  // most points first

  double share(std::size_t sources) const {
    return measured > 0 ? static_cast<double>(sources) / static_cast<double>(measured) : 0;
  }
};

FrameSummary summary_of(const Run& run);

// Effects of other options on a frame.

/// Effect of a change on one frame.
struct FixEffect {
  int frame = 0;
  int detected_before = 0, detected_after = 0, planes_truth = 0;
  double iou_before = 0, iou_after = 0;
  std::vector<std::int32_t> recovered = {}, broken = {};  // truth plane ids
};
FixEffect effect_of(const Run& before, const planes::PipelineOptions& after);

/// Plane of each voxel of the run's frame with other options, 0 none. Only the segment options
/// are used.
std::vector<std::int32_t> planes_with(const Run& run, const planes::PipelineOptions& options);

// Logarithmic scale for comparing changes of different options: log value or, for shares between 0
// and 1, the log of their odds, because 0.98 is as far from 0.99 as 0.02 from 0.01. 0 is mapped to
// the far end.
double scale_position(const planes::OptionInfo& info, double value);
/// The value at a position as passed to --set, within the option's range.
std::string scale_value(const planes::OptionInfo& info, double position);

/// Score as a function of the value, for the strip below a slider.
struct Sensitivity {
  std::string option;
  std::vector<double> values = {};  // ascending, including the current one
  std::vector<double> scores = {};  // mean IoU with truth; number of planes without truth
  bool against_truth = false;
};
Sensitivity sensitivity_of(const Run& run, const std::string& option, std::stop_token stop);

}  // namespace planescope::debug
