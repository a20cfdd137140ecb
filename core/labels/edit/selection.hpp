#pragma once

// Which pixels a drawn shape takes: on the image directly, in space through what is seen there.

#include <Eigen/Core>
#include <vector>

#include "core/labels/model/grid.hpp"

namespace planescope::labels {

/// In pixels of the picture it was drawn on: depth pixels on the image, view pixels in space. Pixel
/// (x, y) covers [x, x + 1) x [y, y + 1), from the top left corner; its centre is in the middle.
struct DrawnShape {
  enum class Kind : std::uint8_t {
    stroke,  // all within `radius_px` of the path: a brush
    area,    // inside the closed path (even-odd): rectangle, lasso, polygon
  };
  Kind kind = Kind::stroke;
  std::vector<Vec2f> path;
  float radius_px = 8;
};

/// Coverage of a width x height picture, 1 inside: a pixel is inside where its centre is.
Image8 mask_of(const DrawnShape& shape, int width, int height);

/// On the image every measured pixel is seen. `shown`: per pixel, 0 where a hidden label covers it;
/// empty: all.
PixelSet pixels_on_image(const LabelGrid& grid,
                         const DrawnShape& shape,
                         std::span<const std::uint8_t> shown = {});

/// How a view in space maps points of the sensor's frame, and how large it draws them.
struct SpaceView {
  Eigen::Matrix4f clip_from_sensor = Eigen::Matrix4f::Identity();
  int width = 0, height = 0;
  float point_size_m = 0.004f;  // diameter in space ...
  float px_per_m = 500;         // ... of a length at 1 m from the eye (perspective) or anywhere
  bool orthographic = false;
  float min_px = 1.5f, max_px = 14;
};
/// Of points that are drawn so large that a surface seen from the front has no gaps.
SpaceView view_of_points(const LabelGrid& grid);

/// Each point's place in the view, and whether something nearer covers it.
struct SeenPoints {
  int width = 0, height = 0;
  std::vector<Vec2f> place;           // per pixel [view px]; NaN where outside or not measured
  std::vector<std::uint8_t> visible;  // per pixel
  // As drawn; of a cloud alone, whose points lie apart.
  std::vector<float> radius_px, depth_m;
};
/// A point is visible unless the surface before it is nearer by more than a few times the noise.
SeenPoints see(const LabelGrid& grid,
               const SpaceView& view,
               std::span<const std::uint8_t> shown = {});

struct SpaceSelection {
  PixelSet pixels;
  std::size_t hidden = 0;  // points inside the shape that are not visible, taken only if `through`
};
SpaceSelection points_in_space(const SeenPoints& seen, const DrawnShape& shape, bool through);

/// 1 where a pixel's label is not hidden.
std::vector<std::uint8_t> shown_pixels(const FrameLabels& labels);

}  // namespace planescope::labels
