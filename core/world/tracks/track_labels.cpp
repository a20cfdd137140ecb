#include "core/world/tracks/track_labels.hpp"

#include <cmath>

namespace planescope::world {
namespace {

// Across the plane, beside so many sigmas of the pixel's noise.
constexpr double kSure_m = 0.003, kDoubtful_m = 0.015, kSigmas = 3;
constexpr double kSureCosine = 0.7;  // of a pixel's normal, smoothed over edges, with the plane's

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
    const Vec2d place = track.on_grid(p);
    const Cell* cell =
        track.cells.find(track.cells.index_of(place.x()), track.cells.index_of(place.y()));
    if (!cell || !cell->sure()) continue;
    const double cosine = std::abs(normal.dot(grid.normals[i].cast<double>()));
    const bool is_sure = off <= kSure_m + kSigmas * sigma && cosine >= kSureCosine;
    (is_sure ? found.sure : found.doubtful).push_back(i);
  }
  return found;
}

}  // namespace planescope::world
