#include "core/world/poses/upright.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/text.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::world {
namespace {

constexpr double kStray = 4;          // median angles
constexpr double kLeastSpread = 0.1;  // [deg]
constexpr double kUpright = 5;        // [deg]: an accelerometer leans by as much
constexpr int kRounds = 10;

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

SharedGravity shared_gravity(std::span<const GravitySample> samples) {
  SharedGravity shared;
  struct Vote {
    Vec3d direction;
    double weight;
    GravitySource source;
  };
  std::vector<Vote> votes;
  for (const GravitySample& sample : samples)
    if (sample.gravity.known())
      votes.push_back({sample.T_world_camera.linear() * sample.gravity.direction,
                       std::max(0.05, sample.gravity.confidence), sample.gravity.source});
  if (votes.empty()) return shared;
  // A mean that starts from the middle vote of each axis and leaves out what is far from it.
  Vec3d mean;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vote& vote : votes) values.push_back(vote.direction[axis]);
    mean[axis] = median(std::move(values));
  }
  if (!(mean.norm() > 1e-6)) mean = votes[0].direction;
  mean.normalize();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> angles;
    for (const Vote& vote : votes) angles.push_back(angle_deg(vote.direction, mean));
    shared.spread_deg = median(angles);
    const double limit = kStray * std::max(kLeastSpread, shared.spread_deg);
    Vec3d sum = Vec3d::Zero();
    shared.strays = 0;
    shared.source = votes[0].source;
    for (std::size_t i = 0; i < votes.size(); ++i) {
      if (angles[i] > limit) {
        ++shared.strays;
        continue;
      }
      sum += votes[i].weight * votes[i].direction;
      shared.source = std::max(shared.source, votes[i].source);
    }
    if (!(sum.norm() > 0)) break;
    mean = sum.normalized();
  }
  shared.known = true;
  shared.direction = mean;
  shared.samples = static_cast<int>(votes.size());
  return shared;
}

std::vector<SharedGravity> turn_upright(Trajectory& trajectory,
                                        std::span<const GravitySample> samples,
                                        std::span<const int> segments) {
  int count = 0;
  for (const CameraPose& pose : trajectory.poses) count = std::max(count, pose.segment + 1);
  std::vector<SharedGravity> found(count);
  for (int segment = 0; segment < count; ++segment) {
    std::vector<GravitySample> own;
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (segments[i] == segment) own.push_back(samples[i]);
    SharedGravity& shared = found[segment];
    shared = shared_gravity(own);
    const bool upright = angle_deg(shared.direction, -Vec3d::UnitZ()) <= kUpright;
    if (!shared.known || upright) continue;
    // The first camera looks along x.
    const auto first = std::ranges::find(trajectory.poses, segment, &CameraPose::segment);
    const Mat3d T_camera_world = first->T_world_camera.linear().transpose();
    const Pose upright_of_camera =
        planes::world_from_gravity(T_camera_world * shared.direction, true);
    const Mat3d turn = upright_of_camera.linear() * T_camera_world;
    for (CameraPose& pose : trajectory.poses)
      if (pose.segment == segment) {
        Pose turned = Pose::Identity();
        turned.linear() = turn * pose.T_world_camera.linear();
        turned.translation() = turn * pose.T_world_camera.translation();
        pose.T_world_camera = turned;
        pose.quaternion = {};
      }
    shared.direction = -Vec3d::UnitZ();
  }
  return found;
}

Gravity gravity_at(const Pose& T_world_camera, const SharedGravity& shared) {
  Gravity gravity;
  gravity.direction = T_world_camera.linear().transpose() * -Vec3d::UnitZ();
  gravity.source = shared.source;
  gravity.confidence = 1;
  gravity.note = fmt::format("from the camera's pose and {}, which spread by {:.2f} degrees",
                             counted(shared.samples - shared.strays, "frame"), shared.spread_deg);
  return gravity;
}

}  // namespace planescope::world
