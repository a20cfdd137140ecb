#pragma once

// Gestures that finish a labelled plane. Each says what it would change, so that it can be shown
// first; finished() does it. Only unlabelled pixels are added, and none is farther off the plane
// than the wand would take (WandOptions, wand_field.hpp).

#include "core/labels/model/grid.hpp"
#include "core/labels/wand/wand.hpp"

namespace planescope::labels {

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

FrameLabels finished(const FrameLabels& labels,
                     const LabelGrid& grid,
                     int plane,
                     const Finish& finish);

}  // namespace planescope::labels
