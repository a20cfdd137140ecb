#pragma once

// Operations of the label tools, each written into a draft; fit_planes() then fits the planes whose
// pixels changed. Locked planes lose and gain no pixel, hidden ones lose none; unmeasured pixels
// get no label. Changing a carried plane settles it: its confidence becomes 1.

#include <span>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// What a tool paints: a plane (made if it is new), "do not score" (kPlaneIgnore), or nothing (0).
struct Paint {
  int plane = 0;
  Label label = Label::unknown;  // of a new plane; unknown: by its tilt. For plane 0 and not
                                 // unknown: the class alone, without a plane
  LabelOrigin origin = LabelOrigin::hand;
};

enum class PaintMode : std::uint8_t {
  over,      // whatever was there
  add,       // only where nothing was
  subtract,  // takes off the paint's own label, and nothing else
};

/// Returns the number of changed pixels.
std::size_t paint(LabelDraft& draft,
                  const LabelGrid& grid,
                  std::span<const std::uint32_t> pixels,
                  const Paint& paint,
                  PaintMode mode);
/// Fits the draft's planes that gained or lost pixels; those left without a pixel are removed.
void fit_planes(LabelDraft& draft, const LabelGrid& grid);

/// The smallest id that no plane has.
int free_plane_id(const FrameLabels& labels);
const LabelPlane* find_plane(const FrameLabels& labels, int id);
/// Throws Error where there is no such plane, or it is locked.
const LabelPlane& editable_plane(const FrameLabels& labels, int id);
PixelSet pixels_of_plane(const FrameLabels& labels, int id);
/// Keeps the list in order of id.
LabelPlane& add_plane(FrameLabels& labels, const LabelPlane& plane);

// These throw Error, before anything changes, if the plane is missing or locked.
void set_class(LabelDraft& draft, int plane, Label label);
void remove_plane(LabelDraft& draft, int plane);
void join_planes(LabelDraft& draft, int into, int from);
/// Each connected part (eight neighbours, bridging gaps of up to `gap_px` unmeasured pixels) of at
/// least `min_area_m2` becomes a plane of its own, the largest keeps the id; smaller parts go with
/// the part nearest to them.
void split_by_parts(
    LabelDraft& draft, const LabelGrid& grid, int plane, double min_area_m2, int gap_px = 2);
/// Pixels to the right of the line from -> to become a plane of their own. `side`: per pixel of the
/// image, > 0 right of it; made by sides_of_line() on the image, from projected points in space.
/// Nothing changes where all of them are on one side.
void split_by_side(LabelDraft& draft, int plane, std::span<const float> side);
std::vector<float> sides_of_line(int width, int height, const Vec2f& from, const Vec2f& to);

/// Planes without a class that are not locked get that of their tilt.
void set_gravity(LabelDraft& draft, const Gravity& gravity);

enum class PlaneFlag : std::uint8_t { locked, hidden };
void set_flag(LabelDraft& draft, int plane, PlaneFlag flag, bool on);

/// First labels from a segmentation: `plane_of` per pixel (0 none), `label_of_plane` by id - 1.
/// Replaces everything but "do not score" and locked and hidden planes with their pixels. Planes
/// whose ids are taken by these get new ids.
void take_segmentation(LabelDraft& draft,
                       const LabelGrid& grid,
                       std::span<const std::int32_t> plane_of,
                       std::span<const Label> label_of_plane);

}  // namespace planescope::labels
