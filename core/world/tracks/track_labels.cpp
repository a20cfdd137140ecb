#include "core/world/tracks/track_labels.hpp"

#include <cmath>

namespace planescope::world {
namespace {

// Across the plane, beside so many sigmas of the pixel's noise.
constexpr double kSure_m = 0.003, kDoubtful_m = 0.015, kSigmas = 3;
constexpr double kSureCosine = 0.7;  // of a pixel's normal, smoothed over edges, with the plane's

/// A cell is the track's where its middle is: the plane goes on for up to half a cell.
bool is_covered(const Track& track, const Vec2d& place) {
  const double half_m = track.cells.cell_m() / 2;
  for (const double x : {place.x() - half_m, place.x() + half_m})
    for (const double y : {place.y() - half_m, place.y() + half_m}) {
      const Cell* cell = track.cells.find(track.cells.index_of(x), track.cells.index_of(y));
      if (cell && cell->sure()) return true;
    }
  return false;
}

}  // namespace

PixelsOfTrack pixels_of_track(const Track& track,
                              const labels::LabelGrid& grid,
                              const Pose& T_world_camera) {
  PixelsOfTrack found;
  const Vec3d normal = T_world_camera.linear().transpose() * track.fit.normal;  // seen from it
  for (std::uint32_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const Vec3d seen = grid.points[i].cast<double>();
    const Vec3d p = T_world_camera * seen;
    const double off = std::abs(track.distance_m(p));
    const double sigma =
        static_cast<double>(grid.sigma_m[i]) * std::abs(normal.dot(seen)) / seen.norm();
    if (off > kDoubtful_m + kSigmas * sigma) continue;
    if (!is_covered(track, track.on_grid(p))) continue;
    const double cosine = std::abs(normal.dot(grid.normals[i].cast<double>()));
    const bool is_sure = off <= kSure_m + kSigmas * sigma && cosine >= kSureCosine;
    (is_sure ? found.sure : found.doubtful).push_back(i);
  }
  return found;
}

}  // namespace planescope::world
