#include "app/desktop/camera.hpp"

#include <algorithm>
#include <cmath>

namespace planescope::desktop {
namespace {

constexpr double kDeg = 0.017453292519943295;  // [rad]

}  // namespace

render::Camera preset_camera(const render::Camera& home, CameraPreset preset) {
  render::Camera camera = home;
  if (preset == CameraPreset::home) return camera;
  const double distance = (camera.eye - camera.target).norm();
  const Vec3d looks = camera.target - camera.eye;
  const Vec3d ahead = Vec3d(looks.x(), looks.y(), 0).norm() > 1e-9
                          ? Vec3d(looks.x(), looks.y(), 0).normalized()
                          : Vec3d(Vec3d::UnitX());
  switch (preset) {
    case CameraPreset::top:
      camera.eye = camera.target + distance * Vec3d::UnitZ();
      camera.up = ahead;
      break;
    case CameraPreset::side:
      camera.eye = camera.target + distance * ahead.cross(Vec3d::UnitZ());
      break;
    default:
      camera.eye = camera.target - distance * ahead;
  }
  return camera;
}

render::Camera camera_of(const State& state) {
  if (state.view.camera) return *state.view.camera;
  return state.run_view() ? state.run_view()->home : render::Camera{};
}

render::Camera orbited(const render::Camera& camera, double right_deg, double up_deg) {
  const Vec3d offset = camera.eye - camera.target;
  const double distance = offset.norm();
  double azimuth = std::atan2(offset.y(), offset.x());
  const double elevation = std::asin(std::clamp(offset.z() / distance, -1.0, 1.0));
  if (camera.up.z() < 0.5 && std::abs(offset.z()) > 0.999 * distance)  // from above: up tells
    azimuth = std::atan2(-camera.up.y(), -camera.up.x());
  // Just short of the pole, so that up stays up.
  const double tilted = std::clamp(elevation + up_deg * kDeg, -89.9 * kDeg, 89.9 * kDeg);
  const double turned = azimuth - right_deg * kDeg;
  render::Camera result = camera;
  result.up = Vec3d::UnitZ();
  result.eye =
      camera.target + distance * Vec3d(std::cos(tilted) * std::cos(turned),
                                       std::cos(tilted) * std::sin(turned), std::sin(tilted));
  return result;
}

render::Camera panned(const render::Camera& camera, double right, double up) {
  const Vec3d forward = (camera.target - camera.eye).normalized();
  const Vec3d sideways = forward.cross(camera.up).normalized();
  const Vec3d upwards = sideways.cross(forward);
  const double height =
      2 * (camera.target - camera.eye).norm() * std::tan(camera.fov_y_deg * kDeg / 2);
  const Vec3d by = height * (right * sideways + up * upwards);
  render::Camera result = camera;
  result.eye += by;
  result.target += by;
  return result;
}

render::Camera zoomed(const render::Camera& camera, double factor) {
  render::Camera result = camera;
  const Vec3d offset = camera.eye - camera.target;
  const double distance = std::clamp(offset.norm() / std::clamp(factor, 0.01, 100.0), 0.02, 100.0);
  result.eye = camera.target + distance * offset.normalized();
  return result;
}

render::Camera fitted(render::Camera camera, double aspect) {
  constexpr double kMadeFor = 4.0 / 3;
  if (aspect >= kMadeFor) return camera;
  const double half = camera.fov_y_deg * kDeg / 2;
  camera.fov_y_deg = 2 / kDeg * std::atan(std::tan(half) * kMadeFor / aspect);
  return camera;
}

bool same_camera(const render::Camera& a, const render::Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_y_deg == b.fov_y_deg &&
         a.orthographic == b.orthographic && a.ortho_height_m == b.ortho_height_m;
}

}  // namespace planescope::desktop
