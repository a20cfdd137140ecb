#pragma once

// What the stages of the objective say of themselves, wherever a decision is shown.

#include "core/planes/segment/refinement.hpp"

namespace planescope::planes {

inline constexpr RefinementInfo kJoinInfo{
    .name = "join",
    .title = "join neighbors",
    .says = "{plane} joins {other}: their misfit costs {value:.3g}, less than a plane"};
inline constexpr RefinementInfo kGrowInfo{
    .name = "grow",
    .title = "grow over pixels",
    .says = "{plane} changes by {value:+.0f} px at its border",
    .why_dropped = "it has {value:.0f} px, too few to grow",
    .on_pixels = true};
inline constexpr RefinementInfo kHiddenInfo{
    .name = "hidden",
    .title = "join hidden parts",
    .says =
        "{plane} joins {other} behind what hides them from each other: their misfit costs "
        "{value:.3g}",
    .on_pixels = true};
inline constexpr RefinementInfo kPartsInfo{
    .name = "parts", .title = "part planes", .why_parted = "they do not touch"};
inline constexpr RefinementInfo kListInfo{
    .name = "list",
    .title = "list planes",
    .says = "{plane} is not listed: it is worth {value:.0f}, less than it costs",
    .why_dropped = "it is worth {value:.0f}, less than it costs"};

}  // namespace planescope::planes
