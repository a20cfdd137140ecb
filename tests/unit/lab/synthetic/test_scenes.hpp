#pragma once

// Simple synthetic views and pixel helpers for tests of the camera model.

#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/scene.hpp"

namespace planescope::synthetic_test {

inline Vec3d point_at(const Frame& frame, int x, int y) {
  const Intrinsics& k = frame.intrinsics;
  const double z = frame.depth.at(x, y) * frame.depth_unit_m;
  return {(x - k.cx) / k.fx * z, (y - k.cy) / k.fy * z, z};
}

/// A wall perpendicular to the view of a level camera at the origin, at distance `z_m`.
inline lab::Scene wall_at(double z_m) {
  lab::Scene scene;
  scene.camera.position = Vec3d::Zero();
  lab::add_polygon(scene, {{z_m, 20, -20}, {z_m, -20, -20}, {z_m, -20, 20}, {z_m, 20, 20}}, {});
  return scene;
}

inline lab::D435Model without_color(int width = 640, int height = 480) {
  lab::D435Model model;
  model.intrinsics = lab::d435_intrinsics(width, height);
  model.color = false;
  return model;
}

inline Frame seen(const lab::Scene& scene,
                  const lab::D435Model& model,
                  FrameLabels* truth = nullptr) {
  return lab::render_scene(scene, scene.camera, model, 11, truth);
}

/// Share of unmeasured pixels in a part of the image.
inline double hole_share(const Image16& depth, int x0, int x1, int y0, int y1) {
  int holes = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) holes += depth.at(x, y) == 0;
  return static_cast<double>(holes) / ((x1 - x0) * (y1 - y0));
}

}  // namespace planescope::synthetic_test
