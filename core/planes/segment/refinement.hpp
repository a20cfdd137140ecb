#pragma once

// What a file of core/planes/segment/refine/ tells of itself. A refinement is planescope's own, not
// the paper's; it is added by writing one such file, and nothing else needs to know of it: CMake
// lists the folder in core/planes/segment/refinements.hpp. The file's name is that of its
// namespace, of its member in SegmentOptions, of its Stage and of the option that switches it on.
//
//   namespace planescope::planes::r99_example {
//   struct Options {
//     bool on = false;  // in the profile `paper`
//     double reach_m = 0.1;
//     template <typename Rows> static void describe(Rows& rows);  // a row for each option
//   };
//   inline constexpr Options kRefined{.on = true};  // in the profile `refined`
//   inline constexpr RefinementInfo kInfo{.name = "R9", .title = "example", ...};
//   void run(SegmentState& state, const Options& options);  // if it acts on all planes at once
//   }
//
// run() asks by itself whether it is on. Where its body stands in the header, it is a template of
// the state, which is not complete there. Every header of the folder is a refinement: what only
// helps one stands outside.

#include <cstdint>
#include <limits>
#include <string>

namespace planescope::planes {

struct SegmentState;

/// The values that a number may take.
struct OptionRange {
  double min = 0;
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
};

/// When a refinement acts on all planes at once: after a stage of the paper, or never, where it
/// changes what happens within one.
enum class After : std::uint8_t { within, merging, assignment };

struct RefinementInfo {
  const char* name;   // as filters, pictures and lists call it: "R2"
  const char* title;  // "explain away"
  /// What its `refine` event means, with {plane}, {other}, {point}, and the event's {value}, or as
  /// a length in {mm}, filled in (fmt).
  const char* says = "{plane} changes";
  /// Why a plane that it drops is none, where that needs saying; filled in likewise.
  const char* why_dropped = "";
  /// Of a part that it founds as a plane of its own: what the two are to each other.
  const char* why_parted = "";
  After after = After::within;
  int turn = 0;            // among those that follow the same stage, ascending
  bool on_pixels = false;  // looks at the depth image; does nothing where there is none
};

/// "R2: explain away", "split disconnected planes".
std::string heading_of(const RefinementInfo& refinement);

}  // namespace planescope::planes
