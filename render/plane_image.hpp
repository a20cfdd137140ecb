#pragma once

// Where a frame's planes are, small enough to be kept for every frame, and which planes of two
// frames are the same surface. Works in the sensor's own frame: no gravity, no poses.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/cloud/cloud.hpp"
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

PlaneInView moved(PlaneInView plane, const Pose& T);  // the same surface in another frame

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

}  // namespace planescope::render
