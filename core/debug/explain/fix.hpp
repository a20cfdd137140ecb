#pragma once

// Suggests fixes: changes of a single option that give a surface of this frame the requested
// result. Each change is verified before it is reported.

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/debug/explain/score.hpp"
#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Requested result for a surface.
enum class Wish : std::uint8_t {
  true_plane,  // one plane, IoU >= kDetectedIou
  plane,       // in a plane that takes little beyond the surface from others
  own_plane,   // in a separate plane
  joined,      // entirely in one plane
  no_plane,
};

struct FixTarget {
  std::vector<std::uint32_t> voxels;  // ascending
  std::string name;                   // "truth plane 4", "marked region"
  Wish wish = Wish::true_plane;
  std::int64_t voxel = -1;  // the clicked voxel of these; -1: none
  std::int64_t with = -1;   // another voxel, in the same plane (joined) or in a different
                            // one (own_plane)
  /// The surface that contains the voxels, ascending: `plane` may take all of it.
  std::vector<std::uint32_t> surface = {};
  bool far = false;  // vary numbers by up to a factor of 100, not 3, and also try profiles
};
FixTarget target_of_truth(const Run& run, std::int32_t truth_plane);
/// Target of a click. `surface`: ascending voxels of the clicked surface; if empty, the voxels with
/// the same outcome as the clicked one. The target is its unassigned part (`plane`), its part in
/// the voxel's plane (`own_plane`), all of it (`joined`), or the voxel's whole plane (`no_plane`).
FixTarget target_of_click(const Run& run,
                          std::uint32_t voxel,
                          Wish wish,
                          std::vector<std::uint32_t> surface = {});
/// Whether the run already satisfies the request.
bool is_granted(const Run& run, const FixTarget& target);

/// A change of one option that satisfies a request.
struct Fix {
  std::string option;
  std::string before, after;   // as passed to --set
  double change = 0;           // |log ratio| of numbers or of the odds of shares; 1 per switch
  bool restores = false;       // resets the option to the profile's value
  double share = 0;            // of the target as requested; for a true plane, its IoU
  std::int32_t gained = 0;     // number of target voxels that become as requested
  std::int32_t elsewhere = 0;  // number of other voxels whose plane changes
  int planes_before = 0, planes_after = 0;
  /// The cause: the first step of the run whose decision changes for most of the target. 0: none.
  /// Only set for the first fixes.
  std::int32_t step = 0;
  QuickScore score = {};  // score of this frame with the fix; empty without truth
};

/// Reports the fixes found so far, best first.
using FixProgress = std::function<void(int done, int total, const std::vector<Fix>& found)>;

/// For each option, the cheapest change that satisfies the request; empty if there is none. Fixes
/// that restore the profile's value come first. The others are sorted by cost: voxels changed
/// elsewhere relative to voxels gained, and size of the change (Fix::change). Numbers are searched
/// outward from their current value, bisected to 2 % of the change, and rounded to few digits;
/// switches are flipped. Options that decided on the target are tried first.
std::vector<Fix> find_fixes(const Run& run,
                            const FixTarget& target,
                            std::stop_token stop,
                            const FixProgress& progress = {});

}  // namespace planescope::debug
