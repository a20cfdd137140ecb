#pragma once

// Where a camera stands so that what it is to show fills the view, whatever the view's shape.

#include <span>
#include <vector>

#include "core/planes/pipeline/pipeline.hpp"
#include "render/draw_list.hpp"

namespace planescope::render {

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

}  // namespace planescope::render
