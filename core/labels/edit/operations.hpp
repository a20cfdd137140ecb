#pragma once

// Operations of the label tools. Each writes into a draft; fit_planes() then fits the planes whose
// pixels changed. Locked planes neither lose nor gain pixels, hidden ones lose none; unmeasured
// pixels get no label. Changing a carried plane confirms it: its confidence becomes 1.

#include <span>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// Paint of a tool: a plane (created if it is new), "do not score" (kPlaneIgnore), or none (0).
struct Paint {
  int plane = 0;
  Label label = Label::unknown;  // of a new plane; unknown: by its tilt. With plane 0, a known
                                 // label paints the class alone
  LabelOrigin origin = LabelOrigin::hand;
};

enum class PaintMode : std::uint8_t {
  over,      // any pixel
  add,       // only unlabeled pixels
  subtract,  // removes only the paint's own label
};

/// Returns the number of changed pixels.
std::size_t paint(LabelDraft& draft,
                  const LabelGrid& grid,
                  std::span<const std::uint32_t> pixels,
                  const Paint& paint,
                  PaintMode mode);
/// Fits the draft's planes that gained or lost pixels, and removes those without pixels.
void fit_planes(LabelDraft& draft, const LabelGrid& grid);

/// The smallest unused plane id.
int free_plane_id(const FrameLabels& labels);
const LabelPlane* find_plane(const FrameLabels& labels, int id);
/// Throws Error if the plane is missing or locked.
const LabelPlane& editable_plane(const FrameLabels& labels, int id);
PixelSet pixels_of_plane(const FrameLabels& labels, int id);
/// Keeps the list sorted by id.
LabelPlane& add_plane(FrameLabels& labels, const LabelPlane& plane);

// These throw Error, before anything changes, if the plane is missing or locked.
void set_class(LabelDraft& draft, int plane, Label label);
void remove_plane(LabelDraft& draft, int plane);
void join_planes(LabelDraft& draft, int into, int from);
/// Each connected part (eight neighbors, bridging gaps of up to `gap_px` unmeasured pixels) of at
/// least `min_area_m2` becomes a separate plane. The largest part keeps the id; smaller parts join
/// the nearest part.
void split_by_parts(
    LabelDraft& draft, const LabelGrid& grid, int plane, double min_area_m2, int gap_px = 2);
/// Moves pixels to the right of the line from -> to to a new plane. `side`: per pixel of the image,
/// > 0 right of it. Computed by sides_of_line() on the image, from projected points in space.
/// Changes nothing if all pixels are on one side.
void split_by_side(LabelDraft& draft, int plane, std::span<const float> side);
std::vector<float> sides_of_line(int width, int height, const Vec2f& from, const Vec2f& to);

/// Classifies unlocked planes without a class by their tilt.
void set_gravity(LabelDraft& draft, const Gravity& gravity);

enum class PlaneFlag : std::uint8_t { locked, hidden };
void set_flag(LabelDraft& draft, int plane, PlaneFlag flag, bool on);

/// First labels from a segmentation: `plane_of` per pixel (0 none), `label_of_plane` by id - 1.
/// Replaces everything except "do not score" and locked and hidden planes with their pixels. New
/// planes get new ids if theirs are in use.
void take_segmentation(LabelDraft& draft,
                       const LabelGrid& grid,
                       std::span<const std::int32_t> plane_of,
                       std::span<const Label> label_of_plane);

}  // namespace planescope::labels
