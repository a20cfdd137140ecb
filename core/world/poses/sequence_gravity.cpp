// Gravity over a sequence: shared by all poses, or carried from a nearby frame.

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::world {

namespace {

constexpr double kStray = 4;          // multiples of the median angle
constexpr double kLeastSpread = 0.1;  // [deg]
constexpr double kUpright = 5;        // [deg]: typical tilt error of an accelerometer
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
  // A mean that starts at the median vote of each axis and excludes outliers.
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
  gravity.note = fmt::format("from the camera's pose and {} with a spread of {:.2f} degrees",
                             counted(shared.samples - shared.strays, "frame"), shared.spread_deg);
  return gravity;
}

// ---- Gravity from a neighbor ----

namespace {

using Grid = std::shared_ptr<const labels::LabelGrid>;
using OwnGravity = std::optional<Gravity>;

constexpr double kMostTiltSigma_deg = 1;  // of a motion: with a single wall, depth leaves its
                                          // roll undetermined

/// Motion to the next frame, from depth only, so that commands with and without color agree.
struct Motion {
  bool believed = false;
  Mat3d R_next_this = Mat3d::Identity();
  Mat3d covariance = Mat3d::Zero();  // of a rotation about the axes of the next frame [rad^2]

  /// Uncertainty of a gravity direction carried over this motion (next camera frame).
  double tilt_sigma_deg(const Vec3d& gravity) const {
    const double variance = covariance.trace() - gravity.dot(covariance * gravity);
    return std::sqrt(std::max(0.0, variance)) * 180 / std::numbers::pi;
  }
};

Motion motion_between(const Grid& from, const Grid& to) {
  Motion motion;
  if (!from || !to) return motion;
  const labels::Registration found = labels::register_frames(*from, *to, {}, {});
  motion.believed = is_credible(found, found.T_to_from);
  motion.R_next_this = found.T_to_from.linear();
  motion.covariance = effective_information(found).inverse().topLeftCorner<3, 3>();
  return motion;
}

bool is_sure(const OwnGravity& gravity) {
  return gravity &&
         (gravity->source != GravitySource::estimate || gravity->confidence >= kSureGravity);
}

template <typename Value>
struct Once {
  std::once_flag flag;
  Value value;
};

}  // namespace

struct SequenceGravity::Cache {
  std::shared_ptr<const io::Recording> recording;
  planes::GravityOptions options;
  int count = 0;
  std::vector<Once<OwnGravity>> owns;  // by frame
  std::vector<Once<Motion>> motions;   // from the frame to the next

  Cache(std::shared_ptr<const io::Recording> of, const planes::GravityOptions& by)
      : recording(std::move(of)),
        options(by),
        count(recording->frame_count()),
        owns(static_cast<std::size_t>(count)),
        motions(static_cast<std::size_t>(count)) {}

  const OwnGravity& own(const Frame& frame) {
    Once<OwnGravity>& own = owns[static_cast<std::size_t>(frame.index)];
    std::call_once(own.flag, [&] { own.value = planes::estimate_gravity(frame, options); });
    return own.value;
  }

  const OwnGravity& own(int index) {
    Once<OwnGravity>& own = owns[static_cast<std::size_t>(index)];
    std::call_once(own.flag, [&] {
      try {
        const Frame frame = recording->frame(index);
        own.value = frame.gravity ? frame.gravity : planes::estimate_gravity(frame, options);
      } catch (const Error&) {  // reported when that frame is requested
      }
    });
    return own.value;
  }

  /// `grids`: of the previous motion; on return, of this one.
  const Motion& motion(int from, std::map<int, Grid>& grids) {
    Once<Motion>& motion = motions[static_cast<std::size_t>(from)];
    std::call_once(motion.flag, [&] {
      std::erase_if(grids,
                    [&](const auto& grid) { return grid.first != from && grid.first != from + 1; });
      for (const int index : {from, from + 1})
        if (!grids.contains(index)) grids[index] = registration_grid(*recording, index, false);
      motion.value = motion_between(grids[from], grids[from + 1]);
    });
    return motion.value;
  }

  /// Rotates a gravity direction from camera `from` to camera `to`. Returns false if odometry ends
  /// in between.
  bool follow(int from, int to, Vec3d& direction) {
    std::map<int, Grid> grids;
    for (int at = from; at != to; at += from < to ? 1 : -1) {
      const bool ahead = from < to;
      const Motion& step = motion(ahead ? at : at - 1, grids);
      if (!step.believed) return false;
      const Vec3d in_next = ahead ? Vec3d(step.R_next_this * direction) : direction;
      if (step.tilt_sigma_deg(in_next) > kMostTiltSigma_deg) return false;
      direction = ahead ? in_next : Vec3d(step.R_next_this.transpose() * direction);
    }
    return true;
  }

  /// Gravity of frame `from` in frame `to`; nullopt if the motion is unknown.
  std::optional<Gravity> carried(const Gravity& gravity, int from, int to) {
    Gravity result{gravity.direction, GravitySource::carried, gravity.confidence, ""};
    const std::optional<Pose> T_world_from = recording->T_world_camera(from);
    const std::optional<Pose> T_world_to = recording->T_world_camera(to);
    const bool by_poses = T_world_from && T_world_to;
    if (by_poses)
      result.direction =
          T_world_to->linear().transpose() * (T_world_from->linear() * result.direction);
    else if (std::abs(to - from) > kMostFramesCarried || !follow(from, to, result.direction))
      return std::nullopt;
    result.direction.normalize();
    result.note = fmt::format("carried from frame {}, where it was {}, by {} over {}", from,
                              gravity.note, by_poses ? "the recording's poses" : "odometry",
                              counted(std::abs(to - from), "frame"));
    return result;
  }

  std::optional<Gravity> from_picks(const io::PickedGravity& picked, int to) {
    std::vector<const io::PickedDirection*> nearest;
    for (const auto& [frame, direction] : picked.frames) nearest.push_back(&direction);
    std::ranges::stable_sort(
        nearest, {}, [&](const io::PickedDirection* pick) { return std::abs(pick->frame - to); });
    for (const io::PickedDirection* pick : nearest)
      if (auto found =
              carried({pick->direction, GravitySource::picked, 1, pick->note}, pick->frame, to))
        return found;
    return std::nullopt;
  }

  /// Carries gravity from the nearest frame with reliable gravity; the earlier one on ties.
  std::optional<Gravity> from_neighbors(int to) {
    bool before = true, after = true;  // not found on that side yet
    for (int far = 1; far <= kMostFramesCarried && (before || after); ++far)
      for (const int from : {to - far, to + far}) {
        bool& open = from < to ? before : after;
        if (!open || from < 0 || from >= count || !is_sure(own(from))) continue;
        if (auto found = carried(*own(from), from, to)) return found;
        open = false;  // frames beyond it would be carried over the same motion
      }
    return std::nullopt;
  }
};

SequenceGravity::SequenceGravity(std::shared_ptr<const io::Recording> recording,
                                 planes::GravityOptions options)
    : cache_(std::make_unique<Cache>(std::move(recording), options)) {}
SequenceGravity::~SequenceGravity() = default;

void SequenceGravity::resolve(Frame& frame, const io::PickedGravity& picked) const {
  io::apply_picked_gravity(picked, frame);
  if (frame.gravity || cache_->options.mode != planes::GravityMode::automatic || frame.is_cloud() ||
      !cache_->recording->info().knows_camera())
    return;
  frame.gravity = cache_->from_picks(picked, frame.index);
  if (frame.gravity) return;
  const OwnGravity& own = cache_->own(frame);
  if (!is_sure(own)) frame.gravity = cache_->from_neighbors(frame.index);
  if (!frame.gravity) frame.gravity = own;
}

}  // namespace planescope::world
