#pragma once

// The geometry that labels are drawn on: each measured pixel of a depth frame as a point, or the
// points of a cloud. A cloud is an image of one row: its "pixels" are its points, in file order.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/plane.hpp"
#include "core/model/types.hpp"

namespace planescope::labels {

using Vec2f = Eigen::Vector2f;

/// Pixel indices v * width + u, ascending, none twice.
using PixelSet = std::vector<std::uint32_t>;

/// Neighbours of point i: list[first[i] .. first[i+1]), ascending, each a neighbour of the other,
/// none of itself. Empty: there is no cloud.
struct PointGraph {
  std::vector<std::uint32_t> first, list;

  bool empty() const { return first.empty(); }
  std::span<const std::uint32_t> around(std::uint32_t point) const {
    return std::span(list).subspan(first[point], first[point + 1] - first[point]);
  }
};

/// About how many spacings a step from a point to its neighbours reaches.
inline constexpr int kSpacingsOfStep = 2;

struct LabelGrid {
  int width = 0, height = 0;
  Intrinsics intrinsics;
  double depth_unit_m = 0;  // metres per count
  Gravity gravity;
  std::vector<std::uint8_t> measured;  // per pixel, 1 where depth is a measurement
  std::vector<Vec3f> points;           // per pixel, sensor frame [m]; NaN where not measured
  std::vector<Vec3f> normals;          // unit, towards the sensor; zero where unknown
  std::vector<float> sigma_m;          // depth noise expected there, along the ray
  Image8 color;                        // RGB per depth pixel; empty unless aligned

  std::size_t measured_count = 0;

  // Of clouds alone, whose frame is the file's; points are about `origin`.
  Vec3d origin = Vec3d::Zero();
  PointGraph graph;
  std::vector<float> point_area_m2;
  double spacing_m = 0;

  bool is_cloud() const { return !graph.empty(); }
  std::size_t pixels() const { return measured.size(); }
  /// Area of the surface that a pixel stands for [m2]; 0 where its normal is unknown and
  /// none is given.
  double pixel_area_m2(std::uint32_t pixel, const Vec3d* normal = nullptr) const;
  double area_m2(std::span<const std::uint32_t> pixels, const Vec3d* normal = nullptr) const;
  /// The pixel that a point of the sensor's frame falls on, whatever was measured there; nullopt
  /// where it is behind the sensor or out of the image.
  std::optional<std::uint32_t> pixel_that_sees(const Vec3d& point) const;
};

/// Throws Error where a depth image comes without a camera, or a cloud without a point.
LabelGrid make_label_grid(const Frame& frame, const Gravity& gravity);

/// No pixel labelled yet.
FrameLabels empty_labels(const LabelGrid& grid, const std::string& depth_sha256);

/// A plane through points by least squares, towards the sensor (offset <= 0), of a cloud to the
/// upper side; area is that of the pixels on it.
struct FittedPlane {
  Vec3d normal = Vec3d::UnitZ();  // sensor frame
  double offset_m = 0;            // normal . x = offset
  Vec3d centroid = Vec3d::Zero();
  double rms_m = 0;
  double area_m2 = 0;
  double tilt_deg = 0;  // normal against up; NaN where gravity is not known
  std::size_t points = 0;

  double distance_m(const Vec3f& point) const {
    return normal.dot(point.cast<double>()) - offset_m;
  }
};
/// Fewer than three points, or all in a line: `points` says so, the normal is +z.
FittedPlane fit_plane(const LabelGrid& grid, std::span<const std::uint32_t> pixels);

/// The fit with its normal towards the sensor; nullopt where its points are fewer than three, or
/// all in a line, so that they determine no plane.
std::optional<PlaneFit> facing_sensor(PlaneFit fit);

/// The angle between a normal and up, both in the sensor's frame; NaN where gravity is not known.
double tilt_of(const Vec3d& normal, const Gravity& gravity);
/// h where the normal is within 45 degrees of up or down, as the paper's classes are meant; unknown
/// where the tilt is.
Label class_of_tilt(double tilt_deg);

/// Fits normal, offset, RMS and fragments of these planes anew from their pixels; a plane without
/// pixels is taken off the list. `ids` empty: of all.
void refit_planes(FrameLabels& labels, const LabelGrid& grid, std::span<const int> ids = {});

/// What the surface around each point of a cloud is like (point_graph.cpp).
struct PointSurface {
  PointGraph graph;  // of the 12 nearest places; of points at one place the first has them,
                     // and is the neighbour of the others
  std::vector<Vec3f> normals;  // unit, either way; zero where unknown
  std::vector<float> area_m2;  // of the surface that a point stands for
  double noise_m = 0;          // across a smooth surface
  double spacing_m = 0;        // from point to point, the median
};
/// `measured`: 0 where a point is none; such points have no neighbours.
PointSurface surface_of_points(std::span<const Vec3f> points,
                               std::span<const std::uint8_t> measured);

}  // namespace planescope::labels
