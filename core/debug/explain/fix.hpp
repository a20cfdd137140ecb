#pragma once

// What would fix this? The smallest change of one option that recovers a plane on this frame, and
// what that change breaks on the labelled frames of the recording.

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/debug/explain/score.hpp"
#include "core/debug/replay/run.hpp"

namespace planescope::planes {
struct OptionInfo;
}

namespace planescope::debug {

/// The wanted result: these voxels as one plane, IoU >= kDetectedIou.
struct FixTarget {
  std::vector<std::uint32_t> voxels;
  std::string name;   // "truth plane 4", "marked region"
  bool whole = true;  // false: part of a surface; that share of it in one plane is enough
};
FixTarget target_of_truth(const Run& run, std::int32_t truth_plane);
/// Is it one plane of the run already?
bool is_recovered(const Run& run, const FixTarget& target);

struct Fix {
  std::string option;
  std::string before, after;  // as --set takes them
  double change = 0;          // |log ratio| of numbers, of the odds of shares; per switch 1
  double iou = 0;             // of the target with it, or its share in one plane
  QuickScore score = {};      // of this frame with it; empty without truth
};

using FixProgress = std::function<void(int done, int total)>;

/// Every single change that recovers the target, smallest first; empty where none does. Numbers are
/// searched outwards from where they are and bisected to 1 %; switches are flipped.
std::vector<Fix> find_fixes(const Run& run,
                            const FixTarget& target,
                            std::stop_token stop,
                            const FixProgress& progress = {});

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
