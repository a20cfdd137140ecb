// Compares tracks with a frame: visible cells, pose alignment and expected pixels.

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/model/parallel.hpp"
#include "core/planes/cloud/camera.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {

namespace {

constexpr double kThroughLeast_m = 0.03;  // closer behind the plane, it is an inaccurate
                                          // measurement of the plane itself
constexpr double kThroughSigmas = 5;
constexpr double kAhead_m = 0.05;
constexpr double kEdgeOn = 0.15;  // cosine: nearly edge-on, depth distinguishes planes poorly

}  // namespace

int Visibility::most_on() const {
  int best = 0;
  for (std::size_t id = 1; id < on.size(); ++id)
    if (on[id].cells > 0 && (best == 0 || on[id].cells > on[best].cells))
      best = static_cast<int>(id);
  return best;
}

Visibility visibility_of(Track& track,
                         const ObservedFrame& frame,
                         const TrackOptions& options,
                         std::vector<std::uint32_t>* there) {
  Visibility visibility;
  visibility.on.resize(frame.planes.size() + 1);
  const Pose T_camera_world = frame.T_world_camera.inverse();
  const Intrinsics& k = frame.intrinsics;
  for (CellMap::Tile& tile : track.cells.tiles())
    for (int i = 0; i < CellMap::kSide * CellMap::kSide; ++i) {
      Cell& cell = tile.cells[i];
      if (!cell.present()) continue;
      ++visibility.cells;
      const Vec3d place = track.on_plane(track.cells.middle(tile, i));
      const Vec3d p = T_camera_world * place;
      if (!(p.z() > kAhead_m)) continue;
      const Vec2d at = planes::ray_to_pixel(k, p.head<2>() / p.z());
      const double u = std::round(at.x()), v = std::round(at.y());
      if (!(u >= 0 && v >= 0 && u < k.width && v < k.height)) continue;
      if (frame.max_range_m > 0 && p.z() > frame.max_range_m) {
        ++visibility.beyond_range;
        continue;
      }
      if (std::abs(track.distance_m(frame.camera())) < kEdgeOn * p.norm()) continue;
      ++visibility.in_view;
      const int x = static_cast<int>(u), y = static_cast<int>(v);
      const std::uint16_t counts = frame.depth.at(x, y);
      if (counts == planes::kNoDepth || counts == planes::kFarOutlier) {
        ++visibility.unmeasured;
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
        ++visibility.hidden;
        ++visibility.on[frame.plane_of.at(x, y)].hides;
        continue;
      }
      visibility.looks.push_back({&cell, is_through});
      if (is_through) {
        ++visibility.through;
        continue;
      }
      ++visibility.there;
      visibility.places.add(place - frame.camera());
      if (there) there->push_back(static_cast<std::uint32_t>(y * k.width + x));
      Visibility::On& on = visibility.on[frame.plane_of.at(x, y)];
      ++on.cells;
      on.sum += place;
    }
  return visibility;
}

void update_cells(const Visibility& visibility) {
  for (const Visibility::Look& look : visibility.looks) look.cell->look(look.through);
}

// ---- Alignment ----

namespace {

// Uncertainty of a given pose.
constexpr double kPoseSigma_m = 0.01, kPoseSigma_rad = 0.005;
constexpr double kReach_m[] = {0.06, 0.04, 0.03};  // inlier distance per iteration
constexpr double kIndependent = 3;  // n cells weigh this times sqrt(n), because errors of neighbors
                                    // are correlated
constexpr double kAlignSigma_m = 0.003;
const double kAlike =
    std::cos(8 * std::numbers::pi / 180);  // cosine of the largest angle between normals

using Mat6d = Eigen::Matrix<double, 6, 6>;
using Vec6d = Eigen::Matrix<double, 6, 1>;

/// Normal equations for a small motion (rotation, translation) of the camera about its center.
struct Equations {
  Mat6d A = Mat6d::Zero();
  Vec6d b = Vec6d::Zero();
  double misfit = 0, count = 0;  // sum of squares in sigmas, and number of cells
};

void add_track(const Track& track,
               const ObservedFrame& frame,
               const Pose& T_world_camera,
               double reach_m,
               Equations& all) {
  const Pose T_camera_world = T_world_camera.inverse();
  const Intrinsics& k = frame.intrinsics;
  Equations own;
  std::vector<bool> alike(frame.planes.size() + 1, false);
  for (const ObservedPlane& plane : frame.planes)
    alike[plane.id] = std::abs(plane.normal.dot(track.fit.normal)) > kAlike;
  for (const CellMap::Tile& tile : track.cells.tiles())
    for (int i = 0; i < CellMap::kSide * CellMap::kSide; ++i) {
      if (!tile.cells[i].sure()) continue;
      const Vec3d p = T_camera_world * track.on_plane(track.cells.middle(tile, i));
      if (!(p.z() > 0.05)) continue;
      const Vec2d at = planes::ray_to_pixel(k, p.head<2>() / p.z());
      const double u = std::round(at.x()), v = std::round(at.y());
      if (!(u >= 0 && v >= 0 && u < k.width && v < k.height)) continue;
      const int x = static_cast<int>(u), y = static_cast<int>(v);
      if (!alike[frame.plane_of.at(x, y)]) continue;
      const double z = frame.depth.at(x, y) * frame.depth_unit_m;
      const Vec3d arm = T_world_camera.linear() * Vec3d(p * (z / p.z()));
      const double off = track.distance_m(T_world_camera.translation() + arm);
      const double sigma = std::max(kAlignSigma_m, frame.noise.sigma(arm.norm()));
      if (std::abs(off) > reach_m + sigma) continue;
      Vec6d row;
      row << arm.cross(track.fit.normal), track.fit.normal;
      own.A += row * row.transpose() / (sigma * sigma);
      own.b -= row * (off / (sigma * sigma));
      own.misfit += off * off / (sigma * sigma);
      own.count += 1;
    }
  if (own.count == 0) return;
  const double weight = std::min(1.0, kIndependent / std::sqrt(own.count));
  all.A += weight * own.A;
  all.b += weight * own.b;
  all.misfit += weight * own.misfit;
  all.count += weight * own.count;
}

}  // namespace

Pose aligned_pose(const ObservedFrame& frame, std::span<Track* const> tracks) {
  const Pose given = frame.T_world_camera;
  Equations as_given;
  for (const Track* track : tracks) add_track(*track, frame, given, kReach_m[0], as_given);
  if (as_given.misfit <= as_given.count) return given;
  Pose pose = given;
  for (const double reach_m : kReach_m) {
    Equations all;
    for (const Track* track : tracks) add_track(*track, frame, pose, reach_m, all);
    if (all.A.isZero(0)) return given;
    // The prior pulls toward the given pose.
    const Eigen::AngleAxisd turned(pose.linear() * given.linear().transpose());
    Vec6d moved;
    moved << turned.angle() * turned.axis(), pose.translation() - given.translation();
    Vec6d prior;
    prior << Vec3d::Constant(1 / squared(kPoseSigma_rad)),
        Vec3d::Constant(1 / squared(kPoseSigma_m));
    all.A.diagonal() += prior;
    all.b -= prior.cwiseProduct(moved);
    const Vec6d step = all.A.ldlt().solve(all.b);
    const double angle = step.head<3>().norm();
    if (angle > 0) pose.linear() = Eigen::AngleAxisd(angle, step.head<3>() / angle) * pose.linear();
    pose.translation() += step.tail<3>();
  }
  return pose;
}

void move_to(ObservedFrame& frame, const Pose& T_world_camera) {
  const Pose T = T_world_camera * frame.T_world_camera.inverse();
  Pose turn = Pose::Identity();
  turn.linear() = T.linear();
  for (ObservedPlane& plane : frame.planes) {
    plane.normal = T.linear() * plane.normal;
    plane.centroid = T * plane.centroid;
    plane.moments = moved(plane.moments, turn);
    for (Vec3d& axis : plane.certainty.axes) axis = T.linear() * axis;
    plane.outline = planes::moved(std::move(plane.outline), T);
  }
  frame.T_world_camera = T_world_camera;
}

// ---- Expected planes ----

namespace {

constexpr double kNearest_m = 0.05;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kMargin_px = 2;  // allowance for lens distortion of tile edges

/// Image area of a tile: the range of x in each of its rows.
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
  /// Visible polygon of a tile [px]; empty if behind the camera. Corners for which the lens model
  /// has no solution are NaN.
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

  /// Sets rows_ to all pixels of a polygon plus a margin; the whole image if a corner is NaN.
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
      // Parts of edges in or near the row.
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

// ---- Labels from the map ----

namespace {

// Distance from the plane, in addition to kSigmas of the pixel's noise.
constexpr double kSure_m = 0.003, kDoubtful_m = 0.015, kSigmas = 3;
constexpr double kSureCosine = 0.7;  // between a pixel's normal, which is smoothed over edges, and
                                     // the plane's normal

/// Whether the track covers a position. Cells count by their middle, so the plane extends for up to
/// half a cell.
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
  // In the camera frame.
  const Vec3d normal = T_world_camera.linear().transpose() * track.fit.normal;
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
