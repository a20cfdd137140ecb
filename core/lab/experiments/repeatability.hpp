#pragma once

// Whether a method finds the same planes in the next frame, and the floor as one.

#include <cstdint>
#include <span>
#include <vector>

#include "core/planes/foot/footholds.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// Smaller planes, and smaller parts of the floor, do not count [px].
inline constexpr std::uint64_t kLeastRepeatPixels = 500;
/// Planes of neighbouring frames are partners from this IoU on.
inline constexpr double kPartnerIou = 0.5;

/// The planes found in a depth frame, by pixel.
struct PixelPlanes {
  std::vector<std::int32_t> plane_of;          // by pixel v * width + u: plane id, 0 none
  std::vector<PlaneFit> fits;                  // by id - 1, about the sensor, z up [m]
  std::vector<planes::Certainty> certainties;  // likewise
};
PixelPlanes pixel_planes(const planes::FrameResult& result);

/// What became of the planes of a frame in the next one. The camera's own movement is in all of it,
/// the same for every method.
struct Neighbours {
  int planes = 0;    // of at least kLeastRepeatPixels, in the first frame
  int partners = 0;  // of those, with a partner in the next
  // Of partners.
  std::vector<double> offset_jumps_m;
  std::vector<double> normal_jumps_deg;
  // Of two of them that stand 60 degrees and more to each other: how much the angle between them
  // changed, which no movement of the camera does, by what the certainty of all four tells.
  std::vector<double> angle_jumps_sigmas;
};
/// Both frames have as many pixels. A pixel is the same in both, wherever the camera went.
Neighbours compare_neighbours(const PixelPlanes& first, const PixelPlanes& next);

/// The floor of a depth frame, found from its pixels alone, whatever the method: the level below
/// the camera that most pixels lie within 3 cm of, then a plane fitted to the pixels near it, five
/// times. A pixel is near within 3 cm, and within 1 cm x z^2 where its depth z [m] makes that more,
/// as a stereo camera's noise grows. Of each pixel, whether it is the floor's: 1, else 0.
std::vector<std::uint8_t> floor_pixels(const planes::PreparedFrame& frame);

/// How whole the floor is in what was found.
struct FloorPieces {
  std::uint64_t pixels = 0;  // of the floor
  int pieces = 0;      // planes with at least kLeastRepeatPixels on it, at least half of their own
  double largest = 0;  // % of the floor's pixels that lie in any plane: in its largest piece
  double missing = 0;  // % of the floor's pixels: in no plane
};
FloorPieces floor_pieces(std::span<const std::uint8_t> floor, const PixelPlanes& found);

}  // namespace planescope::lab
