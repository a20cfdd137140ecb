#pragma once

// Regions of an image as one byte per pixel, grown and filled. Internal to core/labels.

#include <cstdint>
#include <span>
#include <vector>

namespace planescope::labels {

/// Adds to `region` (1) what can be reached from `start` over pixels where `passable` is not 0,
/// by sides. Returns the pixels added.
std::vector<std::uint32_t> flood(const std::vector<std::uint8_t>& passable,
                                 int width,
                                 int height,
                                 std::span<const std::uint32_t> start,
                                 std::vector<std::uint8_t>& region);

/// Adds to `region` what lies within `reach` steps of it, of pixels where `passable` is not 0.
void spread(const std::vector<std::uint8_t>& passable,
            int width,
            int height,
            int reach,
            std::vector<std::uint8_t>& region);

/// The holes of a region with at most `most` pixels each; none of them touches the image's border.
std::vector<std::uint32_t> small_holes(const std::vector<std::uint8_t>& region,
                                       int width,
                                       int height,
                                       int most);

}  // namespace planescope::labels
