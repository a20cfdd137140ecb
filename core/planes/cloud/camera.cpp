// Lens distortion as defined by OpenCV (Brown-Conrady: undistorted -> distorted) and librealsense
// (inverse Brown-Conrady: the same polynomial, distorted -> undistorted).

#include "core/planes/cloud/camera.hpp"

#include <cmath>
#include <limits>
#include <mutex>
#include <string>

#include "core/model/error.hpp"

namespace planescope::planes {
namespace {

struct Polynomial {
  Vec2d value;
  Eigen::Matrix2d jacobian;
};

/// x (1 + k1 r2 + k2 r4 + k3 r6) + tangential terms, with its derivative.
Polynomial brown_conrady(const std::array<double, 5>& c, const Vec2d& p) {
  const auto [k1, k2, p1, p2, k3] = c;
  const double x = p.x(), y = p.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // twice d radial / d r2
  Polynomial result;
  result.value = {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                  y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  const double cross = slope * x * y + 2 * p1 * x + 2 * p2 * y;
  result.jacobian << radial + slope * x * x + 2 * p1 * y + 6 * p2 * x, cross,  //
      cross, radial + slope * y * y + 6 * p1 * y + 2 * p2 * x;
  return result;
}

/// Solves brown_conrady(c, p) = target by Newton's method from the undistorted guess.
Vec2d invert(const std::array<double, 5>& c, const Vec2d& target) {
  constexpr double kTolerance = 1e-12;  // in ray units; a pixel is about 1e-3
  Vec2d p = target;
  for (int i = 0; i < 30; ++i) {
    const Polynomial f = brown_conrady(c, p);
    const Vec2d error = f.value - target;
    if (error.squaredNorm() < kTolerance * kTolerance) return p;
    const double determinant = f.jacobian.determinant();
    // Past the fold of the polynomial, two rays would share a pixel: no unique solution.
    if (!(determinant > 1e-3)) break;
    Eigen::Matrix2d adjugate;
    adjugate << f.jacobian(1, 1), -f.jacobian(0, 1), -f.jacobian(1, 0), f.jacobian(0, 0);
    p -= adjugate * error / determinant;
  }
  return Vec2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

void check_camera(const Frame& frame) {
  const Image16& depth = frame.depth;
  const Intrinsics& k = frame.intrinsics;
  if (k.width != depth.width || k.height != depth.height)
    throw Error("frame " + frame.name + ": depth is " + std::to_string(depth.width) + "x" +
                std::to_string(depth.height) + ", but its intrinsics are for " +
                std::to_string(k.width) + "x" + std::to_string(k.height));
  if (!(k.fx != 0) || !(k.fy != 0) || !(frame.depth_unit_m > 0))
    throw Error(
        "frame " + frame.name +
        ": focal length or depth unit is zero; specify them with --intrinsics and --depth-unit");
}

Vec2d pixel_to_ray(const Intrinsics& k, double u, double v) {
  Vec2d seen((u - k.cx) / k.fx, (v - k.cy) / k.fy);
  switch (k.distortion) {
    case Distortion::none:
      return seen;
    case Distortion::brown_conrady:
      return invert(k.coefficients, seen);
    case Distortion::inverse_brown_conrady:
      return brown_conrady(k.coefficients, seen).value;
  }
  return seen;
}

Vec2d ray_to_pixel(const Intrinsics& k, const Vec2d& ray) {
  Vec2d seen = ray;
  if (k.distortion == Distortion::brown_conrady) seen = brown_conrady(k.coefficients, ray).value;
  if (k.distortion == Distortion::inverse_brown_conrady) seen = invert(k.coefficients, ray);
  return {k.fx * seen.x() + k.cx, k.fy * seen.y() + k.cy};
}

RayTable::RayTable(const Intrinsics& k)
    : width_(static_cast<std::size_t>(k.width)), by_axis_(k.distortion == Distortion::none) {
  if (by_axis_) {
    for (int u = 0; u < k.width; ++u) x_.push_back(pixel_to_ray(k, u, 0).x());
    for (int v = 0; v < k.height; ++v) y_.push_back(pixel_to_ray(k, 0, v).y());
    return;
  }
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      Vec2d ray = pixel_to_ray(k, u, v);
      if (!ray.allFinite()) ray.setConstant(std::numeric_limits<double>::quiet_NaN());
      x_.push_back(ray.x());
      y_.push_back(ray.y());
    }
}

RayRow RayTable::row(int v, std::vector<double>& scratch) const {
  const auto at = static_cast<std::size_t>(v);
  if (!by_axis_) return {x_.data() + at * width_, y_.data() + at * width_};
  scratch.assign(width_, y_[at]);
  return {x_.data(), scratch.data()};
}

std::shared_ptr<const RayTable> ray_table(const Intrinsics& intrinsics) {
  static std::mutex mutex;
  static Intrinsics last;
  static std::shared_ptr<const RayTable> table;
  {
    const std::lock_guard lock(mutex);
    if (table && last == intrinsics) return table;
  }
  auto made = std::make_shared<const RayTable>(intrinsics);
  const std::lock_guard lock(mutex);
  last = intrinsics;
  return table = std::move(made);
}

std::vector<Vec2d> rays_of_pixels(const Intrinsics& intrinsics) {
  const std::shared_ptr<const RayTable> table = ray_table(intrinsics);
  std::vector<double> scratch;
  std::vector<Vec2d> rays;
  rays.reserve(static_cast<std::size_t>(intrinsics.width) * intrinsics.height);
  for (int v = 0; v < intrinsics.height; ++v) {
    const RayRow row = table->row(v, scratch);
    for (int u = 0; u < intrinsics.width; ++u) rays.emplace_back(row.x[u], row.y[u]);
  }
  return rays;
}

}  // namespace planescope::planes
