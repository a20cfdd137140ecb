#pragma once

// The plane wand: from a click, the connected surface that is one plane.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

inline constexpr double kCloseTolerance_m = 0.008;
struct WandOptions {
  double tolerance_m = kCloseTolerance_m;  // distance to the plane at close range; grows with noise
  double max_angle_deg = 35;               // of local normals to the plane, where they are known
  bool use_color = true;                   // where depth does not tell where the surface ends
  bool take_labelled = false;              // also pixels that have a label already
  std::span<const std::uint8_t> within = {};  // per pixel, 0 where none is taken; empty: anywhere
};

struct WandResult {
  PixelSet pixels;    // connected to a seed each
  FittedPlane plane;  // by least squares through them
  Label label = Label::unknown;
  std::vector<std::size_t> fragment_pixels;  // by seed
};

/// `seeds`: pixels that were clicked; all but the first are fragments of the first one's plane, cut
/// off by what stands before it. nullopt, with a phrase why, where the surroundings of the first
/// seed are no plane or nothing was measured there. A later seed whose surroundings do not lie on
/// the plane adds nothing. `labels` may be null. Deterministic. A frame of 640x480 takes less than
/// 16 ms.
std::optional<WandResult> grow_plane(const LabelGrid& grid,
                                     const FrameLabels* labels,
                                     std::span<const std::uint32_t> seeds,
                                     const WandOptions& options,
                                     std::string* why_not = nullptr);

}  // namespace planescope::labels
