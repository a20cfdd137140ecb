#pragma once

// Pixels selected by a drawn shape: directly on the image, or in space among the visible points.

#include <Eigen/Core>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// In pixels of the picture it was drawn on: depth pixels on the image, view pixels in space. Pixel
/// (x, y) covers [x, x + 1) x [y, y + 1), from the top left corner; its center is in the middle.
struct DrawnShape {
  enum class Kind : std::uint8_t {
    stroke,  // all within `radius_px` of the path: a brush
    area,    // inside the closed path (even-odd): rectangle, lasso, polygon
  };
  Kind kind = Kind::stroke;
  std::vector<Vec2f> path;
  float radius_px = 8;
};

/// Coverage of a width x height picture: 1 if the pixel's center is inside.
Image8 mask_of(const DrawnShape& shape, int width, int height);

/// On the image every measured pixel is visible. `shown`: per pixel, 0 if it has a hidden label;
/// empty: all.
PixelSet pixels_on_image(const LabelGrid& grid,
                         const DrawnShape& shape,
                         std::span<const std::uint8_t> shown = {});

/// Projection of a view in space from the sensor frame, and point sizes.
struct SpaceView {
  Eigen::Matrix4f clip_from_sensor = Eigen::Matrix4f::Identity();
  int width = 0, height = 0;
  float point_size_m = 0.004f;  // diameter in space ...
  float px_per_m = 500;         // ... of a length 1 m from the eye (perspective) or anywhere
  bool orthographic = false;
  float min_px = 1.5f, max_px = 14;
};
/// Draws points large enough that a surface seen from the front has no gaps.
SpaceView view_of_points(const LabelGrid& grid);

/// Each point's position in the view, and whether something nearer occludes it.
struct SeenPoints {
  int width = 0, height = 0;
  std::vector<Vec2f> place;           // per pixel [view px]; NaN if outside or not measured
  std::vector<std::uint8_t> visible;  // per pixel
  // As drawn; only for clouds, whose points are isolated.
  std::vector<float> radius_px, depth_m;
};
/// A point is visible unless a surface in front is nearer by more than a few times the noise.
SeenPoints see(const LabelGrid& grid,
               const SpaceView& view,
               std::span<const std::uint8_t> shown = {});

struct SpaceSelection {
  PixelSet pixels;
  std::size_t hidden = 0;  // occluded points inside the shape, selected only if `through`
};
SpaceSelection points_in_space(const SeenPoints& seen, const DrawnShape& shape, bool through);

/// 1 if a pixel's label is not hidden.
std::vector<std::uint8_t> shown_pixels(const FrameLabels& labels);

}  // namespace planescope::labels
