#include "core/world/tracks/expected.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/model/parallel.hpp"
#include "core/planes/cloud/camera.hpp"

namespace planescope::world {
namespace {

constexpr double kNearest_m = 0.05;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kMargin_px = 2;  // as far as lenses bend an edge of a tile

/// Where a tile is in the image: from x to x of each row that it reaches.
struct Rows {
  int top = 0, bottom = -1;            // inclusive
  std::vector<std::pair<int, int>> x;  // by row - top, inclusive
};

/// Finds the pixels whose rays hit a track's cells.
class Footprint {
 public:
  Footprint(const Frame& frame, const Pose& T_world_camera)
      : frame_(frame),
        T_world_camera_(T_world_camera),
        T_camera_world_(T_world_camera.inverse()),
        rays_(planes::ray_table(frame.intrinsics)) {}

  planes::KnownPlane of(const Track& track) {
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
      find_rows(corners_of(track, tile));
      for (int y = rows_.top; y <= rows_.bottom; ++y) {
        const planes::RayRow row = rays_->row(y, scratch);
        const auto [left, right] = rows_.x[y - rows_.top];
        for (int x = left; x <= right; ++x) {
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
  /// The polygon that is seen of a tile [px]; empty: it is behind the camera. Corners that the lens
  /// model cannot place are NaN.
  std::vector<Vec2d> corners_of(const Track& track, const CellMap::Tile& tile) const {
    const double side = CellMap::kSide * track.cells.cell_m();
    Vec3d square[4];
    int n = 0;
    for (const Vec2d& corner : {Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1)})
      square[n++] = T_camera_world_ * track.on_plane(side * (Vec2d(tile.x, tile.y) + corner));
    std::vector<Vec2d> corners;
    for (int c = 0; c < 4; ++c) {
      const Vec3d &a = square[c], &b = square[(c + 1) % 4];
      const double from = a.z() - kNearest_m, to = b.z() - kNearest_m;
      const auto add = [&](const Vec3d& p) {
        const Vec2d ray = p.head<2>() / p.z();
        const Vec2d pixel = planes::ray_to_pixel(frame_.intrinsics, ray);
        const Vec2d back = planes::pixel_to_ray(frame_.intrinsics, pixel.x(), pixel.y());
        // Far outside the image, a lens model may fold back into it.
        const bool folds = !((back - ray).norm() < 1e-3 * (1 + ray.norm()));
        corners.push_back(folds ? Vec2d::Constant(kUnknown) : pixel);
      };
      if (from >= 0) add(a);
      if ((from >= 0) != (to >= 0)) add(a + from / (from - to) * (b - a));
    }
    return corners;
  }

  /// Sets rows_: all pixels of a polygon and a few more; the whole image if a corner is NaN.
  void find_rows(const std::vector<Vec2d>& corners) {
    rows_ = {};
    if (corners.empty()) return;
    const double width = frame_.intrinsics.width, height = frame_.intrinsics.height;
    if (!std::ranges::all_of(corners, [](const Vec2d& c) { return c.allFinite(); })) {
      rows_.bottom = frame_.intrinsics.height - 1;
      rows_.x.assign(frame_.intrinsics.height, {0, frame_.intrinsics.width - 1});
      return;
    }
    double low = corners[0].y(), high = low;
    for (const Vec2d& c : corners) low = std::min(low, c.y()), high = std::max(high, c.y());
    rows_.top = static_cast<int>(std::clamp(std::floor(low - kMargin_px), 0.0, height));
    rows_.bottom = static_cast<int>(std::clamp(std::ceil(high + kMargin_px), -1.0, height - 1));
    for (int y = rows_.top; y <= rows_.bottom; ++y) {
      // What is in the row of the edges, or that near to it.
      const double above = y - kMargin_px, below = y + kMargin_px;
      double left = width, right = -1;
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const Vec2d &a = corners[c], &b = corners[(c + 1) % corners.size()];
        if (std::max(a.y(), b.y()) < above || std::min(a.y(), b.y()) > below) continue;
        const auto x_at = [&](double at) {
          const double length = b.y() - a.y();
          const double t = length == 0 ? 0 : std::clamp((at - a.y()) / length, 0.0, 1.0);
          return a.x() + t * (b.x() - a.x());
        };
        for (const double x : {x_at(above), x_at(below)})
          left = std::min(left, x), right = std::max(right, x);
        if (std::abs(b.y() - a.y()) <= 2 * kMargin_px)
          left = std::min({left, a.x(), b.x()}), right = std::max({right, a.x(), b.x()});
      }
      rows_.x.emplace_back(
          static_cast<int>(std::clamp(std::floor(left - kMargin_px), 0.0, width)),
          static_cast<int>(std::clamp(std::ceil(right + kMargin_px), -1.0, width - 1)));
    }
  }

  const Frame& frame_;
  const Pose T_world_camera_, T_camera_world_;
  const std::shared_ptr<const planes::RayTable> rays_;
  Rows rows_;
};

}  // namespace

std::vector<planes::KnownPlane> expected_planes(std::span<const Track* const> tracks,
                                                const Frame& frame,
                                                const Pose& T_world_camera,
                                                const TrackOptions& options,
                                                int threads) {
  std::vector<planes::KnownPlane> all(tracks.size());
  work_through(static_cast<int>(tracks.size()), threads, [&](int i) {
    const Track& track = *tracks[i];
    all[i] = Footprint(frame, T_world_camera).of(track);
    all[i].slack_m =
        options.max_offset_m + options.sigmas * track.sigma_m(track.on_grid(track.centroid()));
  });
  std::vector<planes::KnownPlane> expected;
  for (planes::KnownPlane& known : all)
    if (!known.pixels.empty()) expected.push_back(std::move(known));
  return expected;
}

}  // namespace planescope::world
