#include "core/world/tracks/align.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/planes/cloud/camera.hpp"

namespace planescope::world {
namespace {

// How far a given pose errs.
constexpr double kPoseSigma_m = 0.01, kPoseSigma_rad = 0.005;
constexpr double kReach_m[] = {0.06, 0.04, 0.03};  // inlier distance in each iteration
constexpr double kIndependent = 3;  // n cells weigh this times sqrt(n): neighbors err alike
constexpr double kAlignSigma_m = 0.003;
const double kAlike =
    std::cos(8 * std::numbers::pi / 180);  // cosine of the largest angle between normals

using Mat6d = Eigen::Matrix<double, 6, 6>;
using Vec6d = Eigen::Matrix<double, 6, 1>;

/// Normal equations of a small motion (rotation, translation) of the camera about its center.
struct Equations {
  Mat6d A = Mat6d::Zero();
  Vec6d b = Vec6d::Zero();
  double misfit = 0, count = 0;  // squared, in sigmas; of so many cells
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
    // The prior pulls towards the given pose.
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

}  // namespace planescope::world
