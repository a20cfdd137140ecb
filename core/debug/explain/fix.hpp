#pragma once

// What would fix this? Changes of one option that make a surface of this frame what it should be,
// each tried before it is told, and what a change breaks on the labelled frames of the recording.

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

/// What is wanted of a surface.
enum class Wish : std::uint8_t {
  true_plane,  // one plane, IoU >= kDetectedIou
  plane,       // in a plane that takes little beyond the surface from others
  own_plane,   // in a plane of its own
  joined,      // in one plane, all of it
  no_plane,
};

struct FixTarget {
  std::vector<std::uint32_t> voxels;  // ascending
  std::string name;                   // "truth plane 4", "marked region"
  Wish wish = Wish::true_plane;
  std::int64_t voxel = -1;  // of these the one that was clicked; -1: none
  std::int64_t with = -1;   // another, to be in one plane with it (joined) or not (own_plane)
  /// The surface that the voxels are part of, ascending: `plane` may take all of it.
  std::vector<std::uint32_t> surface = {};
  bool far = false;  // numbers change by up to a hundredfold, not threefold, and profiles are tried
};
FixTarget target_of_truth(const Run& run, std::int32_t truth_plane);
/// Of a click. `surface`: voxels of the surface there, ascending; where that is unknown, what
/// shares the voxel's fate. `plane` wants what of it is in no plane, `own_plane` what is in the
/// voxel's; `no_plane` the voxel's plane whatever the surface; `joined` all of it.
FixTarget target_of_click(const Run& run,
                          std::uint32_t voxel,
                          Wish wish,
                          std::vector<std::uint32_t> surface = {});
/// Is it so in the run already?
bool is_granted(const Run& run, const FixTarget& target);

/// A change of one option that grants a wish.
struct Fix {
  std::string option;
  std::string before, after;   // as --set takes them
  double change = 0;           // |log ratio| of numbers, of the odds of shares; per switch 1
  bool restores = false;       // takes the option back to the profile's value
  double share = 0;            // of the target as wished; of a true plane its IoU
  std::int32_t gained = 0;     // voxels of the target that are as wished by it alone
  std::int32_t elsewhere = 0;  // other voxels that it moves to another plane, to or from none
  int planes_before = 0, planes_after = 0;
  /// The step of the run that it decides otherwise, the first about most of the target: the cause.
  /// 0: none. Of the first fixes only.
  std::int32_t step = 0;
  QuickScore score = {};  // of this frame with it; empty without truth
};

/// The fixes so far, the best first.
using FixProgress = std::function<void(int done, int total, const std::vector<Fix>& found)>;

/// Of each option the change that grants the wish at the least cost; empty where none does. First
/// those that restore the profile's value, then by cost: how much the change moves elsewhere for
/// what it gains, and how large it is (Fix::change). Numbers are searched outwards from where they
/// are, bisected to 2 % of the change and rounded to few digits; switches are flipped. Options that
/// decided on the target are tried first.
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
