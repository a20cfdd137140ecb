#pragma once

// What would fix this? Changes of one option that make a surface of this frame what it should be,
// each tried before it is reported.

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/debug/explain/score.hpp"
#include "core/debug/replay/run.hpp"

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

}  // namespace planescope::debug
