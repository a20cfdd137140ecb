#pragma once

// A camera made ready for one picture.

#include <Eigen/Core>
#include <optional>

#include "render/draw_list.hpp"

namespace planescope::render {

struct View {
  Eigen::Matrix4f view;  // world -> eye: x right, y up, looking along -z [m]
  Eigen::Matrix4f proj;  // eye -> clip
  bool orthographic = false;
  float near_m = 0, far_m = 0;
  float px_per_m = 0;  // of a length at 1 m from the eye; anywhere where orthographic
  double px_per_m_at_target = 0;
  int width = 0, height = 0;  // [px]
  double screen_scale = 1;    // pixels per pixel of an ordinary screen

  Eigen::Vector2f size_px() const {
    return {static_cast<float>(width), static_cast<float>(height)};
  }
};

View make_view(const Camera& camera, int width, int height, double screen_scale = 1);

/// Where a world point lands, in pixels from the top left corner, and its distance along the view
/// axis. Nothing for points before the near plane.
struct ScreenPoint {
  Vec2d px;
  double depth_m = 0;
};
std::optional<ScreenPoint> project(const View& view, const Vec3f& world);

}  // namespace planescope::render
