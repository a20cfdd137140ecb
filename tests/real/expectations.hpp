#pragma once

// The kinds of things that tests/real_data.json can expect of a frame.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tests/real/frame_output.hpp"

namespace planescope {

/// One line per thing that is not as expected, empty where all is. `expectation` is one object of
/// real_data.json; its "kind" names the check:
///   angle        acute angle between the planes at pixels a and b is `deg` +- `tolerance_deg`
///   label        the plane at pixel `at` is `label` (h or v)
///   one_plane    the pixels `at` lie on one plane
///   apart        the pixels `at` lie on planes of their own
///   height       the plane at `upper` stands `m` +- `tolerance_m` above the plane at `lower`
///   offset       the distance along the normal between parallel planes at a and b, same form
///   gravity      found within `tolerance_deg` of `direction` (sensor frame)
///   planes       the number of planes is from `least` to `most`
///   coverage     at least `least` (0..1) of the points inside the range are on a plane
///   no_sheets    no two planes with one label lie over each other, nearly parallel and close
///   levels       horizontal planes stand at the heights `z` +- `tolerance_m` where y = `y`, and no
///                such plane spans two of them
///   flights      there are as many flights of stairs as in `heights`, the treads of each standing
///   at
///                these heights +- `tolerance_m` above what is before its first riser
std::vector<std::string> check_expectation(const nlohmann::json& expectation,
                                           const FrameOutput& output);

/// Checks that need no expectation: the three files of a frame agree with one another.
std::vector<std::string> check_consistency(const FrameOutput& output);

}  // namespace planescope
