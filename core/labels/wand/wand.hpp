#pragma once

// The plane wand: from a click, the connected surface that is one plane; and what finishes a plane.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/edit/edit.hpp"
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

// Gestures that finish a labelled plane. Each selects the pixels; finish_plane() changes them. Only
// unlabelled pixels are added, none farther off the plane than the wand would take.

/// Of one plane; both ascending, and disjoint.
struct Finish {
  PixelSet adds, takes;

  bool empty() const { return adds.empty() && takes.empty(); }
};

// All throw Error where there is no such plane, or it is locked.
/// What lies on the plane in its holes, however large they are.
Finish fill_holes(const FrameLabels& labels, const LabelGrid& grid, int plane, const WandOptions&);
/// The same of an image's holes with at most `most_px` pixels.
Finish fill_small_holes(
    const FrameLabels& labels, const LabelGrid& grid, int plane, const WandOptions&, int most_px);
/// Straightens the border: a pixel near it goes with most of those around, within a few pixels.
Finish smooth_border(const FrameLabels& labels,
                     const LabelGrid& grid,
                     int plane,
                     const WandOptions&);
/// What continues the plane, to where another surface begins.
Finish grow_to_border(const FrameLabels& labels,
                      const LabelGrid& grid,
                      int plane,
                      const WandOptions&);
/// Takes off connected parts smaller than that; the largest stays in any case.
Finish drop_specks(const FrameLabels& labels, const LabelGrid& grid, int plane, double area_m2);

void finish_plane(LabelDraft& draft, const LabelGrid& grid, int plane, const Finish& finish);

}  // namespace planescope::labels
