#pragma once

// The geometry under labels: each measured pixel of a depth frame as a point, or the points of a
// cloud. A cloud is an image of one row: its "pixels" are its points, in file order.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/plane.hpp"
#include "core/model/types.hpp"

namespace planescope::labels {

using Vec2f = Eigen::Vector2f;

/// Pixel indices v * width + u, ascending and unique.
using PixelSet = std::vector<std::uint32_t>;

/// Neighbors of point i: list[first[i] .. first[i+1]), ascending, symmetric, without the point
/// itself. Empty: no cloud.
struct PointGraph {
  std::vector<std::uint32_t> first, list;

  bool empty() const { return first.empty(); }
  std::span<const std::uint32_t> around(std::uint32_t point) const {
    return std::span(list).subspan(first[point], first[point + 1] - first[point]);
  }
};

/// Approximate length in spacings of a step from a point to its neighbors.
inline constexpr int kSpacingsOfStep = 2;

struct LabelGrid {
  int width = 0, height = 0;
  Intrinsics intrinsics;
  double depth_unit_m = 0;  // meters per count
  Gravity gravity;
  std::vector<std::uint8_t> measured;  // per pixel, 1 if depth was measured
  std::vector<Vec3f> points;           // per pixel, sensor frame [m]; NaN if not measured
  std::vector<Vec3f> normals;          // unit, towards the sensor; zero if unknown
  std::vector<float> sigma_m;          // expected depth noise, along the ray
  Image8 color;                        // RGB per depth pixel; empty unless aligned

  std::size_t measured_count = 0;

  // Only for clouds, whose frame is the file's; points are relative to `origin`.
  Vec3d origin = Vec3d::Zero();
  PointGraph graph;
  std::vector<float> point_area_m2;
  double spacing_m = 0;

  bool is_cloud() const { return !graph.empty(); }
  std::size_t pixels() const { return measured.size(); }
  /// Surface area of a pixel [m2]; 0 if its normal is unknown and none is given.
  double pixel_area_m2(std::uint32_t pixel, const Vec3d* normal = nullptr) const;
  double area_m2(std::span<const std::uint32_t> pixels, const Vec3d* normal = nullptr) const;
  /// The pixel that a point in the sensor frame projects to, whatever was measured there; nullopt
  /// if it is behind the sensor or outside the image.
  std::optional<std::uint32_t> pixel_that_sees(const Vec3d& point) const;
};

/// Throws Error for a depth image without a camera or a cloud without points.
LabelGrid make_label_grid(const Frame& frame, const Gravity& gravity);

/// Labels with no labeled pixels.
FrameLabels empty_labels(const LabelGrid& grid, const std::string& depth_sha256);

/// A least-squares plane through points. Its normal faces the sensor (offset <= 0), or up in a
/// cloud; the area is that of its pixels.
struct FittedPlane {
  Vec3d normal = Vec3d::UnitZ();  // sensor frame
  double offset_m = 0;            // normal . x = offset
  Vec3d centroid = Vec3d::Zero();
  double rms_m = 0;
  double area_m2 = 0;
  double tilt_deg = 0;  // normal against up; NaN if gravity is unknown
  std::size_t points = 0;

  double distance_m(const Vec3f& point) const {
    return normal.dot(point.cast<double>()) - offset_m;
  }
};
/// Fewer than three points, or all in a line: `points` has their number, the normal is +z.
FittedPlane fit_plane(const LabelGrid& grid, std::span<const std::uint32_t> pixels);

/// The fit with its normal towards the sensor; nullopt if there are fewer than three points or all
/// are in a line, so that they determine no plane.
std::optional<PlaneFit> facing_sensor(PlaneFit fit);

/// The angle between a normal and up, both in the sensor's frame; NaN if gravity is unknown.
double tilt_of(const Vec3d& normal, const Gravity& gravity);
/// h if the normal is within 45 degrees of up or down, as in the paper's classes; unknown if the
/// tilt is.
Label class_of_tilt(double tilt_deg);

/// Fits normal, offset, RMS and fragments of these planes again from their pixels, and removes
/// planes without pixels from the list. `ids` empty: all planes.
void refit_planes(FrameLabels& labels, const LabelGrid& grid, std::span<const int> ids = {});

/// Surface properties around each point of a cloud (point_graph.cpp).
struct PointSurface {
  PointGraph graph;  // of the 12 nearest places; only the first point at a place has these
                     // neighbors, and it is the neighbor of the others
  std::vector<Vec3f> normals;  // unit, either direction; zero if unknown
  std::vector<float> area_m2;  // surface area per point
  double noise_m = 0;          // across a smooth surface
  double spacing_m = 0;        // median between points
};
/// `measured`: 0 for invalid points, which have no neighbors.
PointSurface surface_of_points(std::span<const Vec3f> points,
                               std::span<const std::uint8_t> measured);

}  // namespace planescope::labels
