// Iterative closest points with projective association (Rusinkiewicz and Levoy 2001) and the hybrid
// term of RGB-D odometry (Park et al. 2017). Open3D implements both, but its sums depend on the
// number of threads: for 60 000 points, the last bits differed between one and two threads (0.16).

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "core/labels/review/carry.hpp"
#include "core/model/error.hpp"
#include "core/planes/cloud/camera.hpp"

namespace planescope::labels {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

struct Level {
  int stride_px;   // between points, in each direction
  int blur_px;     // of the brightness, to each side
  double reach_m;  // maximum distance of partners
  int most_rounds;
};
constexpr std::array kLevels{Level{8, 6, 0.30, 20}, Level{4, 3, 0.15, 15}, Level{2, 1, 0.05, 10}};
constexpr float kFacing = 0.7f;       // cosine between the normals of partners
constexpr double kColorSigma = 0.06;  // of brightness, 0..1
constexpr double kHuber = 1.5;        // standard deviations
constexpr double kPrior =
    4;  // weight of "no motion" per radian^2 and meter^2, for undetermined directions
constexpr double kSettled = 1e-6;         // of a step [rad, m]
constexpr double kPartnerNoises = 4;      // of the final count of partners ...
constexpr double kPartnerLeast_m = 0.01;  // ... and at least this

/// Brightness 0..1, averaged over squares.
std::vector<float> brightness(const LabelGrid& grid, int blur_px) {
  const int width = grid.width, height = grid.height;
  std::vector<double> sums(static_cast<std::size_t>(width + 1) * (height + 1), 0);
  for (int v = 0; v < height; ++v) {
    double row = 0;
    for (int u = 0; u < width; ++u) {
      row += 0.299 * grid.color.at(u, v, 0) + 0.587 * grid.color.at(u, v, 1) +
             0.114 * grid.color.at(u, v, 2);
      sums[static_cast<std::size_t>(v + 1) * (width + 1) + u + 1] =
          sums[static_cast<std::size_t>(v) * (width + 1) + u + 1] + row;
    }
  }
  std::vector<float> result(grid.pixels());
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const int u0 = std::max(0, u - blur_px), u1 = std::min(width, u + blur_px + 1);
      const int v0 = std::max(0, v - blur_px), v1 = std::min(height, v + blur_px + 1);
      const auto at = [&](int x, int y) {
        return sums[static_cast<std::size_t>(y) * (width + 1) + x];
      };
      const double sum = at(u1, v1) - at(u0, v1) - at(u1, v0) + at(u0, v0);
      result[static_cast<std::size_t>(v) * width + u] =
          static_cast<float>(sum / (255.0 * (u1 - u0) * (v1 - v0)));
    }
  return result;
}

/// Normal equations of a least-squares step; rotation first.
struct Step {
  Mat6d a = Mat6d::Identity() * kPrior;
  Vec6d b = Vec6d::Zero();

  /// Residual in standard deviations; large ones count less (Huber).
  void add(const Vec6d& jacobian, double residual, double sigma) {
    const double size = std::abs(residual) / sigma;
    const double weight = (size <= kHuber ? 1 : kHuber / size) / (sigma * sigma);
    a.noalias() += weight * jacobian * jacobian.transpose();
    b.noalias() -= weight * residual * jacobian;
  }
  Vec6d solved() const { return a.ldlt().solve(b); }
};

Pose motion_of(const Vec6d& step) {
  Pose motion = Pose::Identity();
  const Vec3d rotation = step.head<3>();
  if (const double angle = rotation.norm(); angle > 0)
    motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  motion.translation() = step.tail<3>();
  return motion;
}

/// The surface at a point's projection in the other image.
struct Partner {
  std::size_t pixel = 0;
  double distance_m = 0;  // across the partner's surface
};
std::optional<Partner> partner_of(const LabelGrid& to,
                                  const Vec3d& point,
                                  const Vec3f& normal,
                                  double reach_m) {
  const auto seen = to.pixel_that_sees(point);
  if (!seen || !to.measured[*seen] || to.normals[*seen].isZero(0)) return std::nullopt;
  Partner partner;
  partner.pixel = *seen;
  if (normal.dot(to.normals[partner.pixel]) < kFacing) return std::nullopt;
  const Vec3d offset = point - to.points[partner.pixel].cast<double>();
  if (offset.squaredNorm() > reach_m * reach_m) return std::nullopt;
  partner.distance_m = to.normals[partner.pixel].cast<double>().dot(offset);
  return partner;
}

template <typename Visit>
void for_points(const LabelGrid& grid, int stride, const Visit& visit) {
  for (int v = stride / 2; v < grid.height; v += stride)
    for (int u = stride / 2; u < grid.width; u += stride) {
      const std::size_t i = static_cast<std::size_t>(v) * grid.width + u;
      if (grid.measured[i] && !grid.normals[i].isZero(0)) visit(i);
    }
}

double sigma_of(const LabelGrid& from, std::size_t i, const LabelGrid& to, std::size_t j) {
  return std::hypot(from.sigma_m[i], to.sigma_m[j]);
}

class Registering {
 public:
  Registering(const LabelGrid& from, const LabelGrid& to, bool use_color, const Pose& start)
      : from_(from), to_(to), use_color_(use_color), pose_(start) {}

  void start_level(const Level& level) {
    level_ = level;
    if (!use_color_) return;
    from_gray_ = brightness(from_, level.blur_px);
    to_gray_ = brightness(to_, level.blur_px);
  }

  /// One round; returns the size of its step.
  double improve() {
    Step step;
    const Mat3d rotation = pose_.linear();
    const Eigen::Matrix3f rotation_f = rotation.cast<float>();
    for_points(from_, level_.stride_px, [&](std::size_t i) {
      const Vec3d point = pose_ * from_.points[i].cast<double>();
      const Vec3f normal = rotation_f * from_.normals[i];
      const auto partner = partner_of(to_, point, normal, level_.reach_m);
      if (!partner) return;
      const Vec3d facing = to_.normals[partner->pixel].cast<double>();
      Vec6d jacobian;
      jacobian << point.cross(facing), facing;
      step.add(jacobian, partner->distance_m, sigma_of(from_, i, to_, partner->pixel));
      if (use_color_) add_color(step, i, point, partner->pixel);
    });
    information_ = step.a;
    const Vec6d move = step.solved();
    pose_ = motion_of(move) * pose_;
    return move.norm();
  }

  Registration result() const {
    Registration registration;
    registration.T_to_from = pose_;
    registration.used_color = use_color_;
    const Eigen::Matrix3f rotation = pose_.linear().cast<float>();
    double points = 0, partners = 0, squares = 0;
    for_points(from_, 2, [&](std::size_t i) {
      points += 1;
      const Vec3d point = pose_ * from_.points[i].cast<double>();
      const auto partner =
          partner_of(to_, point, rotation * from_.normals[i], kLevels.back().reach_m * 2);
      if (!partner) return;
      const double sigma = sigma_of(from_, i, to_, partner->pixel);
      if (std::abs(partner->distance_m) > std::max(kPartnerLeast_m, kPartnerNoises * sigma)) return;
      partners += 1;
      squares += partner->distance_m * partner->distance_m;
    });
    registration.fitness = points > 0 ? partners / points : 0;
    registration.rms_m = partners > 0 ? std::sqrt(squares / partners) : 0;
    registration.information = information_;
    registration.partners = partners;
    return registration;
  }

 private:
  /// Brightness should stay the same as a point moves in the image.
  void add_color(Step& step, std::size_t i, const Vec3d& point, std::size_t pixel) const {
    const int width = to_.width, reach = level_.blur_px;
    const int u = static_cast<int>(pixel) % width, v = static_cast<int>(pixel) / width;
    if (u < reach || v < reach || u + reach >= width || v + reach >= to_.height) return;
    const Intrinsics& k = to_.intrinsics;
    // Uses the gradient of a pinhole camera: lens distortion hardly changes it.
    const double span = 2.0 * reach;
    const double du = (to_gray_[pixel + reach] - to_gray_[pixel - reach]) / span * k.fx;
    const double dv = (to_gray_[pixel + static_cast<std::size_t>(reach) * width] -
                       to_gray_[pixel - static_cast<std::size_t>(reach) * width]) /
                      span * k.fy;
    const Vec2d at = planes::ray_to_pixel(k, point.head<2>() / point.z());
    const double there = to_gray_[pixel] + du / k.fx * (at.x() - u) + dv / k.fy * (at.y() - v);
    const double z = point.z();
    const Vec3d slope(du / z, dv / z, -(du * point.x() + dv * point.y()) / (z * z));
    Vec6d jacobian;
    jacobian << point.cross(slope), slope;
    step.add(jacobian, there - from_gray_[i], kColorSigma);
  }

  const LabelGrid& from_;
  const LabelGrid& to_;
  bool use_color_;
  Level level_{};
  std::vector<float> from_gray_, to_gray_;
  Pose pose_;
  Mat6d information_ = Mat6d::Zero();  // of the last round
};

}  // namespace

Registration register_frames(const LabelGrid& from,
                             const LabelGrid& to,
                             std::stop_token stop,
                             const std::function<void(double)>& progress,
                             const Pose& T_to_from) {
  Registering registering(from, to, !from.color.empty() && !to.color.empty(), T_to_from);
  double done = 0;
  for (const Level& level : kLevels) {
    registering.start_level(level);
    for (int round = 0; round < level.most_rounds; ++round) {
      if (stop.stop_requested()) throw Cancelled();
      if (registering.improve() < kSettled) break;
    }
    done += 1.0 / kLevels.size();
    if (progress) progress(done);
  }
  return registering.result();
}

}  // namespace planescope::labels
