#pragma once

// Small depth frames with plain shapes, and views of the synthetic scenes with their truth.

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <string>

#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::test {

/// Depth of every pixel in meters, 0: none. Counts are millimeters, focal length 100 px.
inline Frame frame_of(int width, int height, const std::function<double(int, int)>& depth_m) {
  Frame frame;
  frame.name = "small";
  frame.depth = Image16(width, height);
  frame.depth_unit_m = 0.001;
  frame.intrinsics = {width, height, 100, 100, width / 2.0, height / 2.0, Distortion::none, {}};
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      frame.depth.at(u, v) = static_cast<std::uint16_t>(std::lround(1000 * depth_m(u, v)));
  return frame;
}

/// A vertical wall, 1 m in front of the camera.
inline labels::LabelGrid wall_grid(int width = 40, int height = 30) {
  return labels::make_label_grid(frame_of(width, height, [](int, int) { return 1.0; }), Gravity{});
}

inline std::uint32_t pixel_at(const labels::LabelGrid& grid, int u, int v) {
  return static_cast<std::uint32_t>(v * grid.width + u);
}

/// All pixels of [u0, u1) x [v0, v1).
inline labels::PixelSet rectangle(const labels::LabelGrid& grid, int u0, int v0, int u1, int v1) {
  labels::PixelSet pixels;
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u) pixels.push_back(pixel_at(grid, u, v));
  return pixels;
}

/// A scene of planescope synth, seen by the camera model.
struct TrueFrame {
  Frame frame;
  FrameLabels truth;  // measured pixels only
  labels::LabelGrid grid;
};
inline TrueFrame view_of(const lab::Scene& scene,
                         const lab::CameraPose& camera,
                         bool color = true) {
  TrueFrame view;
  lab::D435Model model;
  model.color = color;
  view.frame = lab::render_scene(scene, camera, model, 1, &view.truth);
  view.frame.name = scene.name;
  view.grid = labels::make_label_grid(view.frame, view.truth.gravity);
  for (std::size_t i = 0; i < view.grid.pixels(); ++i)
    if (!view.grid.measured[i]) view.truth.plane.data[i] = view.truth.hv.data[i] = 0;
  return view;
}

/// Intersection over union; both ascending.
inline double iou(const labels::PixelSet& a, const labels::PixelSet& b) {
  labels::PixelSet both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  const double joint = static_cast<double>(a.size() + b.size() - both.size());
  return joint > 0 ? static_cast<double>(both.size()) / joint : 0;
}

}  // namespace planescope::test
