#pragma once

// Points evenly spread over surfaces; the paper's evaluation set (Sec. V), stairs of random size
// with a tread and a riser per step; and clouds with any number of points or planes. Noise is added
// after sampling, because farthest point sampling of noisy points would prefer outliers. The paper
// does not specify the order.

#include <cstdint>
#include <span>
#include <vector>

#include "core/lab/synthetic/scene.hpp"
#include "core/model/frame.hpp"
#include "core/model/random.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::lab {

// ---- Surfaces ----

struct Rectangle {
  Vec3d corner;
  Vec3d side_u;
  Vec3d side_v;
  Vec3d normal;         // unit, outward
  bool halved = false;  // only the triangle at `corner`, cut along the diagonal
  double area() const {
    return halved ? side_u.cross(side_v).norm() / 2 : side_u.norm() * side_v.norm();
  }
};

struct SurfacePoints {
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> rectangle;  // of each point
};

/// `count` points evenly spread over the surface, rotated about the origin: farthest points of a
/// dense random sampling; 0 = the whole dense sampling.
SurfacePoints sample_surface(std::span<const Rectangle> rectangles,
                             std::size_t count,
                             const Mat3d& turn,
                             Random& random);

/// A point with Gaussian noise of standard deviation `sigma_m` on every coordinate; draws nothing
/// if that is 0.
Vec3f with_noise(const Vec3f& point, double sigma_m, Random& random);

/// Farthest point sampling: indices of `count` points (or all, if there are fewer), each the one
/// farthest from those before it, starting with point 0; ties go to the lower index.
std::vector<std::uint32_t> farthest_points(std::span<const Vec3f> points, std::size_t count);

// ---- Stairs ----

struct StairsOptions {
  std::uint64_t seed = 1;
  int points = 8192;       // farthest point sampling from a dense sampling; 0 = dense
  double noise_m = 0;      // standard deviation, on every coordinate, after sampling
  bool random_yaw = true;  // false: axis-aligned
  int min_steps = 2, max_steps = 6;
  double min_length_m = 0.2, max_length_m = 0.4;
  double min_width_m = 0.3, max_width_m = 1.5;
  double min_height_m = 0.1, max_height_m = 0.3;
};

/// A staircase with its exact truth: `cloud.label` h on treads, v on risers; `cloud.instance` from
/// 1.
struct Stairs {
  PointSet cloud;
  std::vector<Vec3d> normals;  // by instance - 1, unit, outward
  int steps = 0;
  double length_m = 0, width_m = 0, height_m = 0, yaw_rad = 0;
};

/// Staircase `index` of the set, independent of previous calls.
Stairs make_stairs(int index, const StairsOptions& options);

/// Its risers and treads, in the cloud's coordinates.
std::vector<TruePolygon> true_polygons(const Stairs& stairs);

/// Its points and labels. Points within 2 cm of a face of the other label are near an edge.
planes::LabeledCloud labeled(const Stairs& stairs);

// ---- Clouds with many points or planes, for measuring scaling ----

struct PointsOnPlanes {
  std::vector<Vec3f> points;  // z up [m]
  std::vector<Label> labels;  // true
};

/// Level tiles, `side` by `side` on a square of 5 m, each a few centimeters above or below its
/// neighbors, with 2 mm of noise. Tiles are separate planes except for a few neighbors that happen
/// to have the same height.
PointsOnPlanes tiles(int side, int points);

/// A staircase of the paper's set, with points scattered evenly over it and 2 mm of noise. Unlike
/// make_stairs(), its time grows only with the number of points.
PointsOnPlanes scattered_stairs(int points);

}  // namespace planescope::lab
