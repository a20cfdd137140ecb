#pragma once

// Cameras: one made ready for a picture, and where it stands so that its subject fills the view.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"
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

/// A few of the points that stand for all of them in a view: in each of many directions, one that
/// all but `outliers` of the points stay below. At most 96; none of none.
std::vector<Vec3f> reach_of(std::span<const Vec3f> points, double outliers);

/// The points without what stands far apart from the rest and has less than 2 % of them: pieces on
/// a grid of cells of `cell_m`, which touch where their cells do.
std::vector<Vec3f> bulk_of(std::span<const Vec3f> points, double cell_m);

/// How a view looks, apart from where it stands.
struct Lens {
  Vec3d forward = Vec3d::UnitX();  // unit
  Vec3d up = Vec3d::UnitZ();
  double fov_y_deg = 45;
  double aspect = 4.0 / 3;  // width by height
  bool orthographic = false;
  double room = 1;  // how far away: times the distance at which the points fill the view
};

/// A camera from which the points just fill the view, but for a margin. A perspective one that
/// stands where an orthographic view of the height at its target shows the same, if that is asked.
Camera camera_holding(std::span<const Vec3f> reach, const Lens& lens);

/// A frame's own view, before its shape is known.
struct Home {
  Vec3d forward = Vec3d::UnitX();  // unit
  std::vector<Vec3f> reach;        // of the bulk of its points
};
Home home_of(const planes::PreparedFrame& prepared, const planes::Segmentation& segmentation);

/// A view of the frame that just holds its kept points (all but the outermost half percent). Depth
/// frames: from behind and above the sensor, looking the way it looks. Clouds: from the -x side.
Camera frame_camera(const planes::PreparedFrame& prepared,
                    const planes::Segmentation& segmentation,
                    double aspect);
inline Camera frame_camera(const planes::FrameResult& result, double aspect) {
  return frame_camera(result, result.segmentation, aspect);
}

}  // namespace planescope::render
