#pragma once

// Which plane gets which color: a surface keeps its color from frame to frame, and planes that
// touch have different ones. Works in the sensor's own frame: no gravity, no poses. The colors
// themselves are in palette.hpp.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::render {

/// A plane in the sensor's frame [m].
struct PlaneInView {
  Vec3d normal = Vec3d::UnitZ();  // unit; either side
  double offset_m = 0;            // normal . x = offset
  Vec3d centroid = Vec3d::Zero();
  double radius_m = 0;   // of its points about the centroid, root mean square
  std::size_t size = 0;  // points
};

/// Where a frame's planes are, small enough to keep for every frame.
struct PlaneImage {
  /// A cell that a plane covers: of a coarse grid on the depth image, or of clouds in space.
  struct Cell {
    std::uint32_t at = 0;
    int plane = 0;  // id, from 1
    auto operator<=>(const Cell&) const = default;
  };
  std::vector<Cell> cells;                    // ascending
  std::vector<PlaneInView> planes;            // by id - 1
  std::vector<std::pair<int, int>> touching;  // ids, the smaller first; ascending
};

/// `plane_of`: per point of the cloud, ids up to `count`; those below 1 are no plane. Planes touch
/// where their pixels are at most 1/80 of the image's width apart in a row or a column, which
/// bridges the edges that depth cameras leave unmeasured; in clouds, where they are in neighboring
/// cells of 10 cm.
PlaneImage plane_image(const planes::Cloud& cloud,
                       std::span<const std::int32_t> plane_of,
                       std::size_t count);
PlaneImage plane_image(const planes::FrameResult& result);
PlaneImage plane_image(const debug::Run& run);

/// Which planes of one frame are surfaces of another, and how the sensor moved.
struct PlaneMatch {
  std::vector<int> before_of;  // by id - 1 of `now`: id in `before`, 0 none; one to one
  // The same for planes that came off one that another plane of `now` was matched with: on the same
  // surface, and part of it in the image of `before`.
  std::vector<int> piece_of;
  Pose T_now_before = Pose::Identity();  // zero in directions that the planes do not determine
};

/// First pairs planes that overlap in the image and have about the same normal and offset, with the
/// greatest overlap in total; then those that the motion of the first pairs moves onto each other.
/// `before` may contain remembered planes, without cells.
PlaneMatch match_planes(const PlaneImage& before, const PlaneImage& now);

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
