#pragma once

// What the labels of a frame look like, in space and on the camera's image: pure functions, no GL.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "render/draw_list.hpp"
#include "render/step_scene.hpp"

namespace planescope::render {

/// Distances to a plane, as colors from -most_m, behind it, to +most_m, before it.
struct Residual {
  int plane = 0;                  // of the labels; 0: of the preview
  Vec3d normal = Vec3d::UnitZ();  // towards the sensor, in its frame: normal . x = offset
  double offset_m = 0, most_m = 0.016;
  std::string name;

  double distance_m(const Vec3f& point) const {
    return normal.dot(point.cast<double>()) - offset_m;
  }
  bool operator==(const Residual&) const = default;
};

/// What is drawn and what stands out.
struct LabelLook {
  std::shared_ptr<const FrameLabels> labels;  // null: none yet
  int plane = 0;                              // the active one, brighter than others; 0: none
  bool show_class = false;                    // colors of h and v instead of the planes' own
  std::span<const std::uint32_t> preview;     // pixels that a gesture would change
  bool preview_takes = false;                 // ... by taking labels off
  std::span<const std::uint32_t> taken;       // pixels that it would take off besides
  std::optional<Residual> residual;           // colors by distance, in place of labels
  std::span<const std::uint8_t> doubt;        // per pixel; empty: none
  std::span<const std::uint32_t> marked;      // pixels that a question is about
  Theme theme = Theme::dark;
};

/// What labels are drawn over, RGB per depth pixel: the camera's color where it is aligned, the
/// shape of surfaces otherwise.
Image8 label_ground(const labels::LabelGrid& grid, Backdrop backdrop);

/// How labels cover the ground, per pixel: alpha is their share. `opacity`: of labels, 0..1; what
/// stands out is seen however faint they are.
std::vector<Rgba> label_tints(const labels::LabelGrid& grid, const LabelLook& look, double opacity);

/// Labels over a copy of the ground, each plane with its outline. Hidden planes are left out.
void paint_labels(Image8& image,
                  const labels::LabelGrid& grid,
                  const LabelLook& look,
                  double opacity);

/// The points that are shown, by pixel: `world` of each, its id is pixel + 1. Colors are missing.
DrawPoints label_points(const labels::LabelGrid& grid,
                        std::span<const Vec3f> world,
                        std::span<const std::uint8_t> shown);
void color_label_points(DrawPoints& points,
                        const Image8& ground,
                        const labels::LabelGrid& grid,
                        const LabelLook& look);
/// Where a plane's name stands: on its pixel farthest from other labels.
struct LabelPlace {
  int plane = 0;
  std::uint32_t pixel = 0;
};
/// Of the planes that are shown, by id.
std::vector<LabelPlace> label_places(const FrameLabels& labels, const labels::LabelGrid& grid);

}  // namespace planescope::render
