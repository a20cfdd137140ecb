#include "core/world/tracks/sight.hpp"

#include <algorithm>
#include <cmath>

#include "core/planes/cloud/camera.hpp"

namespace planescope::world {
namespace {

constexpr double kThroughLeast_m = 0.03;  // nearer behind it is the plane itself, measured badly
constexpr double kThroughSigmas = 5;
constexpr double kAhead_m = 0.05;
constexpr double kEdgeOn = 0.15;  // cosine: nearly edge-on, depth tells planes apart badly

}  // namespace

int Sight::most_on() const {
  int best = 0;
  for (std::size_t id = 1; id < on.size(); ++id)
    if (on[id].cells > 0 && (best == 0 || on[id].cells > on[best].cells))
      best = static_cast<int>(id);
  return best;
}

Sight sight_of(Track& track,
               const ObservedFrame& frame,
               const TrackOptions& options,
               std::vector<std::uint32_t>* there) {
  Sight sight;
  sight.on.resize(frame.planes.size() + 1);
  const Pose T_camera_world = frame.T_world_camera.inverse();
  const Intrinsics& k = frame.intrinsics;
  for (CellMap::Tile& tile : track.cells.tiles())
    for (int i = 0; i < CellMap::kSide * CellMap::kSide; ++i) {
      Cell& cell = tile.cells[i];
      if (!cell.present()) continue;
      ++sight.cells;
      const Vec3d place = track.on_plane(track.cells.middle(tile, i));
      const Vec3d p = T_camera_world * place;
      if (!(p.z() > kAhead_m)) continue;
      const Vec2d at = planes::ray_to_pixel(k, p.head<2>() / p.z());
      const double u = std::round(at.x()), v = std::round(at.y());
      if (!(u >= 0 && v >= 0 && u < k.width && v < k.height)) continue;
      if (frame.max_range_m > 0 && p.z() > frame.max_range_m) {
        ++sight.beyond_range;
        continue;
      }
      if (std::abs(track.distance_m(frame.camera())) < kEdgeOn * p.norm()) continue;
      ++sight.in_view;
      const int x = static_cast<int>(u), y = static_cast<int>(v);
      const std::uint16_t counts = frame.depth.at(x, y);
      if (counts == planes::kNoDepth || counts == planes::kFarOutlier) {
        ++sight.unmeasured;
        continue;
      }
      const double z = counts * frame.depth_unit_m;
      const double range = p.norm(), sigma = frame.noise.sigma(range);
      const Vec3d measured = frame.T_world_camera * Vec3d(p * (z / p.z()));
      const double off = track.distance_m(measured);
      const bool on_plane =
          std::abs(off) <= options.max_offset_m + options.sigmas * std::max(sigma, 1e-4);
      const double behind = (z - p.z()) * range / p.z();
      const bool is_through =
          !on_plane && behind > std::max(kThroughLeast_m, kThroughSigmas * sigma);
      if (!on_plane && !is_through) {
        ++sight.hidden;
        ++sight.on[frame.plane_of.at(x, y)].hides;
        continue;
      }
      sight.looks.push_back({&cell, is_through});
      if (is_through) {
        ++sight.through;
        continue;
      }
      ++sight.there;
      if (there) there->push_back(static_cast<std::uint32_t>(y * k.width + x));
      Sight::On& on = sight.on[frame.plane_of.at(x, y)];
      ++on.cells;
      on.sum += place;
    }
  return sight;
}

void remember(const Sight& sight) {
  for (const Sight::Look& look : sight.looks) look.cell->look(look.through);
}

}  // namespace planescope::world
