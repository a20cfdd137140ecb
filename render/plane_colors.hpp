#pragma once

// Assigns palette colors to planes: surfaces keep their color from frame to frame, and touching
// planes have different colors. Works in the sensor frame, without gravity and poses. The palette
// is in palette.hpp.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::render {

/// A plane in the sensor frame [m].
struct PlaneInView {
  Vec3d normal = Vec3d::UnitZ();  // unit, either sign
  double offset_m = 0;            // normal . x = offset
  Vec3d centroid = Vec3d::Zero();
  double radius_m = 0;   // RMS distance of its points from the centroid
  std::size_t size = 0;  // number of points
};

/// Positions of a frame's planes, in a compact form that is kept for every frame.
struct PlaneImage {
  /// A cell covered by a plane: of a coarse grid on the depth image or, for clouds, in space.
  struct Cell {
    std::uint32_t at = 0;
    int plane = 0;  // id, from 1
    auto operator<=>(const Cell&) const = default;
  };
  std::vector<Cell> cells;                    // ascending
  std::vector<PlaneInView> planes;            // by id - 1
  std::vector<std::pair<int, int>> touching;  // ids, smaller first; ascending
};

/// `plane_of`: per point of the cloud, ids up to `count`; below 1 means no plane. Planes touch if
/// their pixels are within 1/80 of the image's width along a row or column (to bridge unmeasured
/// edges of depth cameras) or, in clouds, if they are in neighboring cells of 10 cm.
PlaneImage plane_image(const planes::Cloud& cloud,
                       std::span<const std::int32_t> plane_of,
                       std::size_t count);
PlaneImage plane_image(const planes::FrameResult& result);
PlaneImage plane_image(const debug::Run& run);

/// Corresponding planes of two frames, and the sensor's motion between them.
struct PlaneMatch {
  std::vector<int> before_of;  // by id - 1 of `now`: id in `before`, 0 none; one to one
  // Same, for planes split from a plane of `before` that is matched with another plane of `now`: on
  // the same surface, and part of it in the image of `before`.
  std::vector<int> piece_of;
  Pose T_now_before = Pose::Identity();  // identity in directions not determined by the planes
};

/// First matches planes that overlap in the image and have similar normals and offsets, maximizing
/// the total overlap; then planes that coincide after the motion of the first matches. `before` may
/// contain remembered planes, without cells.
PlaneMatch match_planes(const PlaneImage& before, const PlaneImage& now);

/// A plane lost for at most this many frames gets its color back.
inline constexpr int kRememberedFrames = 10;

/// Planes of a frame with their colors; input for the next frame's colors.
struct ColoredPlanes {
  PlaneImage image;         // the frame's own planes, then remembered ones without cells
  std::vector<int> colors;  // color ids by plane id - 1, 1 to kPlaneColors
  std::vector<int> unseen;  // frames since each was seen; 0: in this frame

  std::vector<int> own_colors() const;  // without remembered planes
};

/// Planes of `now` that match a plane of `before` keep its color if settle_colors() allows it.
/// `before`: the previous successful frame; null: none.
ColoredPlanes color_planes(PlaneImage now, const ColoredPlanes* before = nullptr);

/// Returns color ids by plane id - 1. `wanted`: preferred ids, 0 none. Touching planes get
/// different colors, and the larger plane keeps its preference. Other planes get a color that is
/// unused and not in `reserved`; else one not used by any touching plane; else the one used by the
/// fewest points of touching planes.
std::vector<int> settle_colors(const PlaneImage& planes,
                               std::vector<int> wanted,
                               const std::vector<int>& reserved = {});

/// Color ids of a single frame's planes, by plane id - 1.
std::vector<int> first_colors(const planes::FrameResult& result);

/// Color ids of true planes, by id - 1: the color of the matched found plane (`found_of`, 0 none);
/// for unmatched planes, a color that differs from touching planes. `colors`: colors of found
/// planes, by id - 1.
std::vector<int> true_plane_colors(const PlaneImage& truth,
                                   std::span<const int> found_of,
                                   std::span<const int> colors);

/// Color ids of the planes of a run's trace. Planes that do not last until the end get colors not
/// used by lasting planes, if available. `colors`: colors of the run's planes, by id - 1.
std::vector<int> trace_colors(const debug::Run& run, std::span<const int> colors);

}  // namespace planescope::render
