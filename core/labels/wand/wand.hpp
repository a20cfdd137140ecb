#pragma once

// The plane wand, which selects the connected plane at a click, and gestures that finish a plane.

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
  double max_angle_deg = 35;               // of local normals to the plane, if known
  bool use_color = true;                   // if depth does not show where the surface ends
  bool take_labeled = false;               // also pixels that already have a label
  std::span<const std::uint8_t> within = {};  // per pixel, 0 to exclude it; empty: all allowed
};

struct WandResult {
  PixelSet pixels;    // each connected to a seed
  FittedPlane plane;  // least-squares fit of the pixels
  Label label = Label::unknown;
  std::vector<std::size_t> fragment_pixels;  // by seed
};

/// `seeds`: clicked pixels; all but the first are fragments of the first one's plane, separated by
/// objects in front. Returns nullopt, with the reason, if the surroundings of the first seed are
/// not a plane or have no measurements. A later seed with surroundings off the plane adds nothing.
/// `labels` may be null. Deterministic. Takes less than 16 ms for a frame of 640x480.
std::optional<WandResult> grow_plane(const LabelGrid& grid,
                                     const FrameLabels* labels,
                                     std::span<const std::uint32_t> seeds,
                                     const WandOptions& options,
                                     std::string* why_not = nullptr);

// Gestures that finish a labeled plane. Each selects pixels, and finish_plane() changes them. Only
// unlabeled pixels are added, none farther from the plane than the wand's tolerance.

/// Pixels to add to and remove from a plane; both ascending, and disjoint.
struct Finish {
  PixelSet adds, takes;

  bool empty() const { return adds.empty() && takes.empty(); }
};

// All throw Error if the plane is missing or locked.
/// Adds pixels on the plane in its holes of any size.
Finish fill_holes(const FrameLabels& labels, const LabelGrid& grid, int plane, const WandOptions&);
/// The same for an image's holes with at most `most_px` pixels.
Finish fill_small_holes(
    const FrameLabels& labels, const LabelGrid& grid, int plane, const WandOptions&, int most_px);
/// Straightens the border: pixels near it follow the majority within a few pixels.
Finish smooth_border(const FrameLabels& labels,
                     const LabelGrid& grid,
                     int plane,
                     const WandOptions&);
/// Extends the plane to the border of other surfaces.
Finish grow_to_border(const FrameLabels& labels,
                      const LabelGrid& grid,
                      int plane,
                      const WandOptions&);
/// Removes connected parts smaller than `area_m2`, but never the largest.
Finish drop_specks(const FrameLabels& labels, const LabelGrid& grid, int plane, double area_m2);

void finish_plane(LabelDraft& draft, const LabelGrid& grid, int plane, const Finish& finish);

}  // namespace planescope::labels
