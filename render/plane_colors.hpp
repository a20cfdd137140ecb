#pragma once

// Which plane gets which color: a surface keeps its color from frame to frame, and planes that
// touch have different ones. The colors themselves are in palette.hpp.

#include <span>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "render/plane_image.hpp"

namespace planescope::render {

/// A plane that is lost for up to this many frames gets its color back.
inline constexpr int kRememberedFrames = 10;

/// The planes of a frame with their colors: what the next frame's colors follow from.
struct ColoredPlanes {
  PlaneImage image;         // after the frame's own planes the remembered ones, without cells
  std::vector<int> colors;  // color ids by plane id - 1, 1 to kPlaneColors
  std::vector<int> unseen;  // frames since each was seen; 0: in this one

  std::vector<int> own_colors() const;  // without the remembered planes
};

/// Planes of `now` that match one of `before` keep its color as far as settle_colors() allows.
/// `before`: the frame before, skipping those that failed; null: none.
ColoredPlanes color_planes(PlaneImage now, const ColoredPlanes* before = nullptr);

/// Color ids by plane id - 1. `wanted`: the same, 0 none. Planes that touch get different colors,
/// and the larger one keeps what it wants. The rest get a color that no other plane has and that is
/// not `reserved`; if there is none, one that no plane has that they touch; if there is none, the
/// one that fewest points of touching planes have.
std::vector<int> settle_colors(const PlaneImage& planes,
                               std::vector<int> wanted,
                               const std::vector<int>& reserved = {});

/// Color ids of a single frame's planes, by plane id - 1.
std::vector<int> first_colors(const planes::FrameResult& result);

/// Color ids of true planes, by id - 1: those of the found planes that they were matched with
/// (`found_of`, 0 none); of the rest, other ones than those of planes that they touch. `colors`:
/// of found planes, by id - 1.
std::vector<int> true_plane_colors(const PlaneImage& truth,
                                   std::span<const int> found_of,
                                   std::span<const int> colors);

/// Color ids of the planes of a run's trace. Planes that do not last until the end have colors that
/// no lasting plane has, as long as there are such. `colors`: of the run's planes, by id - 1.
std::vector<int> trace_colors(const debug::Run& run, std::span<const int> colors);

}  // namespace planescope::render
