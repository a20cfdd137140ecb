#pragma once

// What is known of each voxel at a step, and its colour: shared by the pictures of a step in space
// and on the camera's image.

#include <cstdint>
#include <vector>

#include "render/step_scene.hpp"

namespace planescope::render {

/// What is known at a step, read from the timeline once for a whole picture.
struct StepState {
  static constexpr std::int32_t kOpen = -1;      // plane of a voxel: not known yet
  static constexpr std::int32_t kLeftover = -2;  // in none, on the list of leftovers or dropped
  std::vector<planes::Case> case_of;             // per voxel: of the node that settled it
  std::vector<std::int32_t> plane_of;            // per voxel: plane of the trace
  // What the event that led here was about; -1 none.
  std::int32_t node = -1;  // its own, or that of its point
  std::int32_t plane = -1;
  std::int32_t other = -1;  // the second plane
  std::int32_t voxel = -1;
};
StepState step_state(const debug::Run& run, const StepLook& look);

/// Colours of marks, not of data.
struct MarkColors {
  Rgba selected;
  Rgba current;  // what the step's event is about
  Rgba marked;
  Rgba waiting;  // voxels not settled yet
};
MarkColors mark_colors(Theme theme);

/// Per voxel: 1 where it belongs to the node or the planes that is selected or that the step is
/// about. Empty where there is none, and where it is all of them: nothing recedes then.
std::vector<std::uint8_t> concerned_voxels(const debug::Run& run,
                                           const StepLook& look,
                                           const StepState& state);

/// Per voxel, as `look` asks, with single ones and the marked region standing out.
std::vector<Rgba> voxel_colors(const debug::Run& run, const StepLook& look, const StepState& state);

/// What the colours show: only our method has cases and margins, for others planes and labels take
/// their place.
ColorBy told_by(const debug::Run& run, ColorBy asked);

/// A settled node that was not divided: its points are done with.
bool is_settled_leaf(const debug::Run& run, std::int32_t node, std::int32_t step);

}  // namespace planescope::render
