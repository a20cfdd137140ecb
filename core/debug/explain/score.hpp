#pragma once

// What a run comes to: how good it is against ground truth, quick enough for every tick of a slider
// and thousands of runs of a search, how much of the frame is on planes, and what other options
// make of that.

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

inline constexpr double kDetectedIou = 0.8;  // as eval counts planes

struct TruthMatch {
  std::int32_t truth = 0;  // truth plane id
  std::int32_t found = 0;  // plane id that overlaps it most, 0 none
  double iou = 0;
  std::uint32_t points = 0;
};

struct QuickScore {
  std::vector<TruthMatch> planes;  // per truth plane that has voxels, ascending id
  int detected = 0;                // IoU >= kDetectedIou
  double mean_iou = 0;             // 0..1
  double in_no_plane = 0;          // share of voxels with a true plane that are in none
  int found_planes = 0;
};
/// `plane_of`: per voxel, 0 none.
QuickScore quick_score(std::span<const std::int32_t> plane_of, const VoxelTruth& truth);

enum class TruthVerdict : std::uint8_t { detected, missed, merged, split };
/// What became of each truth plane of a score: merged where its best plane also covers half of
/// another one, split where several cover half of it.
std::vector<TruthVerdict> verdicts_of(const QuickScore& score,
                                      std::span<const std::int32_t> plane_of,
                                      const VoxelTruth& truth);
const char* to_string(TruthVerdict verdict);

/// The plane that most of them name, of equals the one with the least id; 0 where none names one.
std::int32_t most_common_plane(std::span<const std::int32_t> planes);

/// Points that are in no plane for one reason.
struct Lost {
  std::string reason;                 // "worth too little"
  std::size_t sources = 0;            // pixels, or points of the file
  std::vector<std::uint32_t> voxels;  // ascending; empty where they are cropped
  std::int64_t middle = -1;           // a voxel in the midst of the most that one decision lost
};

struct FrameSummary {
  std::size_t measured = 0;      // pixels, or points of the file
  std::size_t out_of_range = 0;  // outside the octree's cube, or without a voxel
  std::size_t beyond = 0;        // of these, farther than max_range_m; depth images only
  std::size_t on_planes = 0;
  std::size_t on_undecided = 0;  // of these, on planes that are undecided
  int planes = 0, undecided = 0;
  std::vector<Lost> lost;  // the most first

  double share(std::size_t sources) const {
    return measured > 0 ? static_cast<double>(sources) / static_cast<double>(measured) : 0;
  }
};

FrameSummary summary_of(const Run& run);

// What other options make of a frame.

/// What a change does to one frame.
struct FixEffect {
  int frame = 0;
  int detected_before = 0, detected_after = 0, planes_truth = 0;
  double iou_before = 0, iou_after = 0;
  std::vector<std::int32_t> recovered = {}, broken = {};  // truth plane ids
};
FixEffect effect_of(const Run& before, const planes::PipelineOptions& after);

/// Plane of each voxel of the run's frame with other options, 0 none. Of these, the segment options
/// alone count.
std::vector<std::int32_t> planes_with(const Run& run, const planes::PipelineOptions& options);

// How far a number is from another, so that changes of different options can be compared: positions
// on a logarithmic axis, log value or, for shares between 0 and 1, log of their odds, since 0.98 is
// as far from 0.99 as 0.02 from 0.01. 0 itself stands at the far end.
double scale_position(const planes::OptionInfo& info, double value);
/// The value there as --set takes it, within the option's range.
std::string scale_value(const planes::OptionInfo& info, double position);

/// Score against value, for the strip under a slider.
struct Sensitivity {
  std::string option;
  std::vector<double> values = {};  // ascending, the current one among them
  std::vector<double> scores = {};  // mean IoU with truth, planes found without
  bool against_truth = false;
};
Sensitivity sensitivity_of(const Run& run, const std::string& option, std::stop_token stop);

}  // namespace planescope::debug
