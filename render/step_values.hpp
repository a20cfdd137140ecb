#pragma once

// What is measured of the points of a step, in metres: the quantities that colours show along a
// scale.

#include <string>
#include <vector>

#include "render/color_scale.hpp"
#include "render/step_colors.hpp"

namespace planescope::render {

/// depth: along the camera's axis, in clouds the distance from their origin. height: along gravity,
/// above the camera or the cloud's origin. rms: of the plane that a point is in, of its settled
/// node where it is in none. distance: to the selected plane, to each point's own where none is;
/// positive on the side that the plane shows, above or before it.
bool is_along_scale(ColorBy by);

/// Why nothing is known of the quantity at the step; empty where it is.
std::string why_no_values(const debug::Run& run, const StepLook& look);

/// Per voxel; NaN where nothing is known of it.
std::vector<float> voxel_values(const debug::Run& run,
                                const StepLook& look,
                                const StepState& state);

/// Its range is the same at every step: that of the points as the run leaves them, or `look`'s own.
ColorScale color_scale(const debug::Run& run, const StepLook& look);

/// Colours of the values; `unknown` for those of which nothing is known, and for points that lie
/// farther off the selected plane than the scale goes and are not its own.
std::vector<Rgba> scaled_colors(const debug::Run& run,
                                const StepLook& look,
                                const StepState& state,
                                Rgba unknown);

/// "depth 1.234 m", "3.2 mm before P3"; empty where nothing is known of the voxel.
std::string value_text(const debug::Run& run, const StepLook& look, std::int32_t voxel);

}  // namespace planescope::render
