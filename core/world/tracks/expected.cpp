#include "core/world/tracks/expected.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/planes/cloud/camera.hpp"

namespace planescope::world {
namespace {

constexpr double kNearest_m = 0.05;

struct PixelBox {
  int left, top, right, bottom;  // inclusive
};

/// Finds the pixels that show a track's cells.
class Footprint {
 public:
  Footprint(const Frame& frame, const Pose& T_world_camera)
      : frame_(frame),
        T_world_camera_(T_world_camera),
        T_camera_world_(T_world_camera.inverse()),
        rays_(planes::ray_table(frame.intrinsics)) {}

  planes::KnownPlane of(const Track& track) const {
    planes::KnownPlane known;
    known.id = track.id;
    const Mat3d R_camera_world = T_camera_world_.linear();
    const Vec3d camera = T_world_camera_.translation();
    const Vec3d normal = R_camera_world * track.fit.normal;
    const double distance = -track.distance_m(camera);  // along the normal
    if (!(std::abs(distance) > 1e-6)) return known;
    const Vec3d w = normal / distance;  // w . ray = 1 / z
    const Vec3d along_u = R_camera_world * track.basis.u, along_v = R_camera_world * track.basis.v;
    const Vec2d origin = track.on_grid(camera);
    std::vector<double> scratch;
    for (const CellMap::Tile& tile : track.cells.tiles()) {
      const std::optional<PixelBox> box = box_of(track, tile);
      if (!box) continue;
      for (int y = box->top; y <= box->bottom; ++y) {
        const planes::RayRow row = rays_->row(y, scratch);
        for (int x = box->left; x <= box->right; ++x) {
          const std::uint32_t pixel = static_cast<std::uint32_t>(y * frame_.depth.width + x);
          if (frame_.depth.data[pixel] == planes::kNoDepth) continue;
          const Vec3d ray(row.x[x], row.y[x], 1);
          const double inverse_z = w.dot(ray);
          if (!(inverse_z > 0)) continue;
          const int i = track.cells.index_of(origin.x() + along_u.dot(ray) / inverse_z) -
                        tile.x * CellMap::kSide;
          const int j = track.cells.index_of(origin.y() + along_v.dot(ray) / inverse_z) -
                        tile.y * CellMap::kSide;
          if (i < 0 || j < 0 || i >= CellMap::kSide || j >= CellMap::kSide) continue;
          const Cell& cell = tile.cells[j * CellMap::kSide + i];
          if (cell.sure() || cell.gone) known.pixels.push_back(pixel);
        }
      }
    }
    const Intrinsics& k = frame_.intrinsics;
    const double u0 = 0.5 * (k.width - 1), v0 = 0.5 * (k.height - 1);
    known.plane.a = w.x() / k.fx;
    known.plane.b = w.y() / k.fy;
    known.plane.c = w.z() + known.plane.a * (u0 - k.cx) + known.plane.b * (v0 - k.cy);
    return known;
  }

 private:
  /// Where the tile is in the image; none: outside.
  std::optional<PixelBox> box_of(const Track& track, const CellMap::Tile& tile) const {
    const Intrinsics& k = frame_.intrinsics;
    const double side = CellMap::kSide * track.cells.cell_m();
    double left = k.width, top = k.height, right = -1, bottom = -1;
    int behind = 0;
    for (const Vec2d& corner : {Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1), Vec2d(1, 1)}) {
      const Vec3d p = T_camera_world_ * track.on_plane(side * (Vec2d(tile.x, tile.y) + corner));
      if (!(p.z() > kNearest_m)) {
        ++behind;
        continue;
      }
      const Vec2d at = planes::ray_to_pixel(k, p.head<2>() / p.z());
      left = std::min(left, at.x()), right = std::max(right, at.x());
      top = std::min(top, at.y()), bottom = std::max(bottom, at.y());
    }
    if (behind == 4) return std::nullopt;
    if (behind > 0) left = top = 0, right = k.width, bottom = k.height;
    const auto clamped = [](double value, int most) {
      return static_cast<int>(std::clamp(value, -1.0, static_cast<double>(most)));
    };
    const PixelBox box{std::max(0, clamped(std::floor(left), k.width)),
                       std::max(0, clamped(std::floor(top), k.height)),
                       std::min(k.width - 1, clamped(std::ceil(right), k.width)),
                       std::min(k.height - 1, clamped(std::ceil(bottom), k.height))};
    if (box.left > box.right || box.top > box.bottom) return std::nullopt;
    return box;
  }

  const Frame& frame_;
  const Pose T_world_camera_, T_camera_world_;
  const std::shared_ptr<const planes::RayTable> rays_;
};

}  // namespace

std::vector<planes::KnownPlane> expected_planes(std::span<const Track* const> tracks,
                                                const Frame& frame,
                                                const Pose& T_world_camera,
                                                const TrackOptions& options) {
  std::vector<planes::KnownPlane> expected;
  const Footprint footprint(frame, T_world_camera);
  for (const Track* track : tracks) {
    planes::KnownPlane known = footprint.of(*track);
    if (known.pixels.empty()) continue;
    known.slack_m =
        options.max_offset_m + options.sigmas * track->sigma_m(track->on_grid(track->centroid()));
    expected.push_back(std::move(known));
  }
  return expected;
}

}  // namespace planescope::world
