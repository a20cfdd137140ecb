#pragma once

// Colors of planes that stay: a surface keeps its color from frame to frame, and planes that touch
// never share one. palette.hpp has the colors themselves; any two of them are well apart.

#include <vector>

#include "render/plane_image.hpp"

namespace planescope::render {

/// A plane that is lost for up to this many frames gets its color back.
inline constexpr int kRememberedFrames = 10;

/// The planes of a frame with their colors: what the next frame's colors follow from.
struct ColoredPlanes {
  PlaneImage image;         // behind the frame's own planes those that it remembers, without cells
  std::vector<int> colors;  // color ids by plane id - 1, 1 to kPlaneColors
  std::vector<int> unseen;  // frames; 0: in this one

  /// Of the frame's own planes.
  std::vector<int> own_colors() const;
};

/// Planes that go on from `before` keep their colors, within settle_colors(). Null: a first frame.
/// Frames that could not be worked on are left out.
ColoredPlanes color_planes(PlaneImage now, const ColoredPlanes* before = nullptr);

/// Color ids by plane id - 1. `wanted`: the same, 0 for none. Of planes that touch, none has the
/// color of the other: the larger keeps what it wants. Those that are left get a color that no
/// other plane has and that is not `reserved`, or else one that only planes have that they do not
/// touch.
std::vector<int> settle_colors(const PlaneImage& planes,
                               std::vector<int> wanted,
                               const std::vector<int>& reserved = {});

/// Of a frame by itself.
std::vector<int> first_colors(const planes::FrameResult& result);

}  // namespace planescope::render
