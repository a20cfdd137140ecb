#include "render/view.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace planescope::render {
namespace {

// Rows: right, up and back in the world. Where `up` says nothing (along the view), any will do.
Mat3d eye_axes(const Camera& camera) {
  Vec3d back = camera.eye - camera.target;
  if (back.norm() < 1e-12) back = Vec3d::UnitZ();
  back.normalize();
  Vec3d right = camera.up.cross(back);
  if (right.norm() < 1e-9) right = back.unitOrthogonal();
  right.normalize();
  Mat3d axes;
  axes.row(0) = right;
  axes.row(1) = back.cross(right);
  axes.row(2) = back;
  return axes;
}

}  // namespace

View make_view(const Camera& camera, int width, int height, double screen_scale) {
  View view;
  view.screen_scale = screen_scale;
  view.width = width;
  view.height = height;
  view.orthographic = camera.orthographic;
  view.near_m = static_cast<float>(camera.near_m);
  view.far_m = static_cast<float>(camera.far_m);

  const Mat3d axes = eye_axes(camera);
  Eigen::Matrix4d to_eye = Eigen::Matrix4d::Identity();
  to_eye.topLeftCorner<3, 3>() = axes;
  to_eye.topRightCorner<3, 1>() = -axes * camera.eye;
  view.view = to_eye.cast<float>();

  const double n = camera.near_m;
  const double f = camera.far_m;
  const double aspect = static_cast<double>(width) / height;
  const double tan_half = std::tan(camera.fov_y_deg * 0.5 * M_PI / 180);
  Eigen::Matrix4d proj = Eigen::Matrix4d::Zero();
  if (camera.orthographic) {
    proj(0, 0) = 2 / (camera.ortho_height_m * aspect);
    proj(1, 1) = 2 / camera.ortho_height_m;
    proj(2, 2) = -2 / (f - n);
    proj(2, 3) = -(f + n) / (f - n);
    proj(3, 3) = 1;
    view.px_per_m = static_cast<float>(height / camera.ortho_height_m);
    view.px_per_m_at_target = height / camera.ortho_height_m;
  } else {
    proj(0, 0) = 1 / (tan_half * aspect);
    proj(1, 1) = 1 / tan_half;
    proj(2, 2) = -(f + n) / (f - n);
    proj(2, 3) = -2 * f * n / (f - n);
    proj(3, 2) = -1;
    const double px_per_m = height / (2 * tan_half);
    const double distance = (camera.eye - camera.target).norm();
    view.px_per_m = static_cast<float>(px_per_m);
    view.px_per_m_at_target = distance > 0 ? px_per_m / distance : 0;
  }
  view.proj = proj.cast<float>();
  return view;
}

std::optional<ScreenPoint> project(const View& view, const Vec3f& world) {
  const Eigen::Vector4f eye = view.view * world.homogeneous();
  const double depth_m = -eye.z();
  if (!(depth_m > view.near_m)) return std::nullopt;  // also where a coordinate is NaN
  const Eigen::Vector4f clip = view.proj * eye;
  ScreenPoint point;
  point.px.x() = (clip.x() / clip.w() * 0.5 + 0.5) * view.width;
  point.px.y() = (0.5 - clip.y() / clip.w() * 0.5) * view.height;
  point.depth_m = depth_m;
  return point;
}

}  // namespace planescope::render
