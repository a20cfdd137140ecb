// Normals after Holzer et al. 2012 ("Adaptive neighborhood selection for real-time surface normal
// estimation"): summed-area tables make the cost independent of window size, and the distance to
// the next depth edge limits that size. Here the windows are fitted in inverse depth.

#include "core/labels/model/grid.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/labels/model/pixel_sets.hpp"
#include "core/model/error.hpp"
#include "core/planes/cloud/camera.hpp"

namespace planescope::labels {
namespace {

/// On a plane, inverse depth is linear in the ray (x, y, 1), and stereo measures it with the same
/// accuracy at any range.
struct InverseDepth {
  int width = 0, height = 0;
  std::vector<Vec2d> rays;    // per pixel
  std::vector<double> per_m;  // 1 / z; 0 where not measured
};

struct DepthSurface {
  double noise = 0;            // standard deviation of the measured inverse depth [1/m]
  std::vector<Vec3f> normals;  // unit, towards the sensor; zero if too little is measured nearby
};

constexpr int kBlock_px = 48;  // stereo noise is correlated over some 20 pixels
constexpr int kBlockStep_px = 16;
constexpr double kLeastNoise = 0.0005;  // [1/m]
constexpr double kMostNoise = 0.012;    // anything rougher is shape, not noise [1/m]
constexpr double kUsualNoise = 0.004;   // if the image has no block to measure it
constexpr double kLeastFill = 0.6;      // share of a block that must be measured
constexpr std::size_t kSmoothPart = 5;  // assume one block in five is entirely smooth
constexpr int kLeastReach_px = 2;       // of a normal's window from its center
constexpr int kWanted_px = 4;           // radius with hardly any noise
constexpr double kReachNoises = 6;      // radius in space: tilts the fit by about ten degrees
constexpr int kMostReach_px = 24;
constexpr int kGap_px = 8;             // unmeasured gap across which edges are detected
constexpr double kEdgeRatio = 0.025;   // of depth: a greater step between pixels is an edge
constexpr double kEdgeNoises = 5;      // and at least this many times the noise
constexpr std::uint8_t kFarAway = 64;  // from any edge [px]

/// Sums over a window; x and y are the ray, w the inverse depth.
enum Sum { kN, kX, kY, kW, kXX, kXY, kYY, kXW, kYW, kWW, kSums };
using Sums = std::array<double, kSums>;

class SummedArea {
 public:
  explicit SummedArea(const InverseDepth& depth)
      : across_(depth.width + 1),
        table_(static_cast<std::size_t>(depth.width + 1) * (depth.height + 1)) {
    for (int v = 0; v < depth.height; ++v) {
      Sums row{};
      for (int u = 0; u < depth.width; ++u) {
        const std::size_t i = static_cast<std::size_t>(v) * depth.width + u;
        if (const double w = depth.per_m[i]; w > 0) {
          const double x = depth.rays[i].x(), y = depth.rays[i].y();
          const Sums add{1, x, y, w, x * x, x * y, y * y, x * w, y * w, w * w};
          for (int k = 0; k < kSums; ++k) row[k] += add[k];
        }
        const Sums& above = at(u + 1, v);
        Sums& here = at(u + 1, v + 1);
        for (int k = 0; k < kSums; ++k) here[k] = above[k] + row[k];
      }
    }
  }
  /// Sums over [u0, u1) x [v0, v1).
  Sums window(int u0, int v0, int u1, int v1) const {
    const Sums &a = at(u0, v0), &b = at(u1, v0), &c = at(u0, v1), &d = at(u1, v1);
    Sums sums;
    for (int k = 0; k < kSums; ++k) sums[k] = d[k] - b[k] - c[k] + a[k];
    return sums;
  }

 private:
  Sums& at(int u, int v) { return table_[static_cast<std::size_t>(v) * across_ + u]; }
  const Sums& at(int u, int v) const { return table_[static_cast<std::size_t>(v) * across_ + u]; }

  int across_;
  std::vector<Sums> table_;
};

/// w = a x + b y + c by least squares.
struct Fit {
  bool solved = false;
  double a = 0, b = 0, c = 0;
  double rms = 0;
};

Fit fit(const Sums& s) {
  Fit result;
  const double n = s[kN];
  if (n < 6) return result;
  const double mx = s[kX] / n, my = s[kY] / n, mw = s[kW] / n;
  const double xx = s[kXX] / n - mx * mx, xy = s[kXY] / n - mx * my, yy = s[kYY] / n - my * my;
  const double xw = s[kXW] / n - mx * mw, yw = s[kYW] / n - my * mw, ww = s[kWW] / n - mw * mw;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-4 * xx * yy)) return result;  // pixels in a line
  result.solved = true;
  result.a = (xw * yy - yw * xy) / determinant;
  result.b = (yw * xx - xw * xy) / determinant;
  result.c = mw - result.a * mx - result.b * my;
  result.rms = std::sqrt(std::max(0.0, ww - result.a * xw - result.b * yw) * n / (n - 3));
  return result;
}

/// Whether there is a depth edge between two pixels of a row or column, `steps` apart.
bool is_edge(double w0, double w1, int steps, double noise) {
  return std::abs(w1 - w0) >
         std::max(kEdgeNoises * noise, kEdgeRatio * std::min(w0, w1) * std::min(steps, 3));
}

/// Distance to the nearest depth edge in pixels, diagonals count as 1; 0 on both sides of an edge.
std::vector<std::uint8_t> distance_to_edge(const InverseDepth& depth, double noise) {
  const int width = depth.width, height = depth.height;
  std::vector<std::uint8_t> distance(depth.per_m.size(), kFarAway);
  const auto mark_line = [&](std::size_t first, std::size_t step, int count) {
    int last = -1;  // the last measured one
    for (int k = 0; k < count; ++k) {
      const double w = depth.per_m[first + k * step];
      if (!(w > 0)) continue;
      if (last >= 0 && k - last <= kGap_px + 1 &&
          is_edge(depth.per_m[first + last * step], w, k - last, noise))
        for (int j = last; j <= k; ++j) distance[first + j * step] = 0;
      last = k;
    }
  };
  for (int v = 0; v < height; ++v) mark_line(static_cast<std::size_t>(v) * width, 1, width);
  for (int u = 0; u < width; ++u)
    mark_line(static_cast<std::size_t>(u), static_cast<std::size_t>(width), height);

  const auto nearer = [&](std::size_t i, std::size_t j) {
    distance[i] = std::min<std::uint8_t>(distance[i], static_cast<std::uint8_t>(distance[j] + 1));
  };
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * width + u;
      if (u > 0) nearer(i, i - 1);
      if (v == 0) continue;
      for (int du = -1; du <= 1; ++du)
        if (u + du >= 0 && u + du < width) nearer(i, i - width + du);
    }
  for (int v = height - 1; v >= 0; --v)
    for (int u = width - 1; u >= 0; --u) {
      const std::size_t i = static_cast<std::size_t>(v) * width + u;
      if (u + 1 < width) nearer(i, i + 1);
      if (v + 1 == height) continue;
      for (int du = -1; du <= 1; ++du)
        if (u + du >= 0 && u + du < width) nearer(i, i + width + du);
    }
  return distance;
}

/// No window fits beside an edge: these pixels copy normals from neighbors farther from the edge.
void spread_towards_edges(const InverseDepth& depth,
                          double noise,
                          const std::vector<std::uint8_t>& distance,
                          std::vector<Vec3f>& normals) {
  const int width = depth.width, height = depth.height;
  for (int ring = kLeastReach_px; ring >= 0; --ring)
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const std::size_t i = static_cast<std::size_t>(v) * width + u;
        if (distance[i] != ring || !(depth.per_m[i] > 0)) continue;
        Vec3f sum = Vec3f::Zero();
        for (int dv = -1; dv <= 1; ++dv)
          for (int du = -1; du <= 1; ++du) {
            if (u + du < 0 || u + du >= width || v + dv < 0 || v + dv >= height) continue;
            const std::size_t j = i + static_cast<std::size_t>(dv * width + du);
            if (distance[j] > ring && depth.per_m[j] > 0 &&
                !is_edge(depth.per_m[i], depth.per_m[j], 1, noise))
              sum += normals[j];
          }
        if (const float length = sum.norm(); length > 0) normals[i] = sum / length;
      }
}

/// Standard deviation of inverse depth, from the residuals of large blocks [1/m].
double noise_of(const InverseDepth& depth, const SummedArea& sums) {
  std::vector<double> roughness;
  for (int v = 0; v + kBlock_px <= depth.height; v += kBlockStep_px)
    for (int u = 0; u + kBlock_px <= depth.width; u += kBlockStep_px) {
      const Sums block = sums.window(u, v, u + kBlock_px, v + kBlock_px);
      if (block[kN] < kLeastFill * kBlock_px * kBlock_px) continue;
      if (const Fit f = fit(block); f.solved) roughness.push_back(f.rms);
    }
  if (roughness.empty()) return kUsualNoise;
  // Most blocks contain edges and clutter; the smoothest ones show the noise.
  const auto smooth =
      roughness.begin() + static_cast<std::ptrdiff_t>(roughness.size() / kSmoothPart);
  std::nth_element(roughness.begin(), smooth, roughness.end());
  return std::clamp(*smooth, kLeastNoise, kMostNoise);
}

/// The windows of normals end at depth edges and grow with the noise.
DepthSurface measure_surface(const InverseDepth& depth, double focal_px) {
  const SummedArea sums(depth);
  DepthSurface surface;
  surface.noise = noise_of(depth, sums);
  surface.normals.resize(depth.per_m.size(), Vec3f::Zero());
  const std::vector<std::uint8_t> distance = distance_to_edge(depth, surface.noise);
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * depth.width + u;
      const double w = depth.per_m[i];
      if (!(w > 0) || distance[i] <= kLeastReach_px) continue;
      const double wanted = kReachNoises * surface.noise / w * focal_px;
      const int reach = std::clamp(static_cast<int>(std::min(wanted, double{kMostReach_px})),
                                   kWanted_px, kMostReach_px);
      const int r = std::min(reach, distance[i] - 1);
      const Fit f =
          fit(sums.window(std::max(0, u - r), std::max(0, v - r), std::min(depth.width, u + r + 1),
                          std::min(depth.height, v + r + 1)));
      // Towards the sensor: the ray's z and the inverse depth are positive.
      if (f.solved) surface.normals[i] = -Vec3d(f.a, f.b, f.c).normalized().cast<float>();
    }
  spread_towards_edges(depth, surface.noise, distance, surface.normals);
  return surface;
}

constexpr double kLeastCosine = 0.05;  // bounds the area of a surface seen edge-on

/// Some files have a constant color field, which cannot distinguish surfaces.
bool has_colors(const PointSet& set) {
  if (set.rgb.size() != 3 * set.points.size()) return false;
  for (std::size_t i = 3; i < set.rgb.size(); ++i)
    if (set.rgb[i] != set.rgb[i - 3]) return true;
  return false;
}

LabelGrid grid_of_cloud(const Frame& frame, const Gravity& gravity) {
  const PointSet& set = *frame.cloud;
  if (set.points.empty()) throw Error("frame " + frame.name + ": has no points to label");
  LabelGrid grid;
  grid.width = static_cast<int>(set.points.size());
  grid.height = 1;
  grid.intrinsics.width = grid.width;
  grid.intrinsics.height = grid.height;
  grid.gravity = gravity;
  grid.origin = set.origin;
  grid.points = set.points;
  grid.measured.reserve(set.points.size());
  for (const Vec3f& point : set.points)
    grid.measured.push_back(point.allFinite() && !point.isZero(0));
  grid.measured_count = static_cast<std::size_t>(std::ranges::count(grid.measured, 1));
  PointSurface surface = surface_of_points(grid.points, grid.measured);
  grid.normals = std::move(surface.normals);
  grid.graph = std::move(surface.graph);
  grid.point_area_m2 = std::move(surface.area_m2);
  grid.spacing_m = surface.spacing_m;
  grid.sigma_m.resize(grid.pixels(), static_cast<float>(surface.noise_m));
  if (has_colors(set)) {
    grid.color = Image8(grid.width, 1, 3);
    grid.color.data = set.rgb;
  }
  return grid;
}

}  // namespace

LabelGrid make_label_grid(const Frame& frame, const Gravity& gravity) {
  if (frame.is_cloud()) return grid_of_cloud(frame, gravity);
  planes::check_camera(frame);
  LabelGrid grid;
  grid.width = frame.depth.width;
  grid.height = frame.depth.height;
  grid.intrinsics = frame.intrinsics;
  grid.depth_unit_m = frame.depth_unit_m;
  grid.gravity = gravity;
  const std::size_t pixels = frame.depth.pixels();
  grid.measured.resize(pixels, 0);
  grid.points.resize(pixels, Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  grid.sigma_m.resize(pixels, 0);

  InverseDepth inverse{grid.width, grid.height, planes::rays_of_pixels(frame.intrinsics), {}};
  inverse.per_m.resize(pixels, 0);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t counts = frame.depth.data[i];
    const Vec2d& ray = inverse.rays[i];
    if (counts == planes::kNoDepth || counts == planes::kFarOutlier || std::isnan(ray.x()))
      continue;
    const double z = counts * frame.depth_unit_m;
    grid.measured[i] = 1;
    grid.points[i] = Vec3d(ray.x() * z, ray.y() * z, z).cast<float>();
    inverse.per_m[i] = 1 / z;
    ++grid.measured_count;
  }
  DepthSurface surface = measure_surface(inverse, std::abs(frame.intrinsics.fx));
  const double count_sigma_m = frame.depth_unit_m / std::sqrt(12.0);  // of rounding to counts
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!grid.measured[i]) continue;
    const double z = 1 / inverse.per_m[i],
                 sigma_z = std::hypot(surface.noise * z * z, count_sigma_m);
    const double stretch = std::sqrt(1 + inverse.rays[i].squaredNorm());  // along the ray
    grid.sigma_m[i] = static_cast<float>(sigma_z * stretch);
  }
  grid.normals = std::move(surface.normals);
  if (frame.color_aligned && frame.color.channels == 3 && frame.color.width == grid.width &&
      frame.color.height == grid.height)
    grid.color = frame.color;
  return grid;
}

double LabelGrid::pixel_area_m2(std::uint32_t pixel, const Vec3d* normal) const {
  if (!measured[pixel]) return 0;
  if (is_cloud()) return static_cast<double>(point_area_m2[pixel]);
  const Vec3d point = points[pixel].cast<double>();
  const Vec3d facing = normal ? *normal : normals[pixel].cast<double>();
  if (facing.isZero()) return 0;
  // A pixel's cone cuts z^2 / (fx fy) out of a surface facing along z. On a slanted surface the
  // area is larger by 1 / (normal . ray), where the ray is (x, y, 1).
  const double slant = std::abs(facing.dot(point)) / point.z();
  const double least = kLeastCosine * point.norm() / point.z();
  return point.z() * point.z() / (std::abs(intrinsics.fx * intrinsics.fy) * std::max(slant, least));
}

double LabelGrid::area_m2(std::span<const std::uint32_t> pixels, const Vec3d* normal) const {
  double area = 0;
  for (const std::uint32_t pixel : pixels) area += pixel_area_m2(pixel, normal);
  return area;
}

std::optional<std::uint32_t> LabelGrid::pixel_that_sees(const Vec3d& point) const {
  if (!(point.z() > 0) || is_cloud()) return std::nullopt;
  const Vec2d at = planes::ray_to_pixel(intrinsics, point.head<2>() / point.z());
  const double u = std::round(at.x()), v = std::round(at.y());
  if (!(u >= 0 && v >= 0 && u < width && v < height)) return std::nullopt;
  return static_cast<std::uint32_t>(v) * static_cast<std::uint32_t>(width) +
         static_cast<std::uint32_t>(u);
}

FrameLabels empty_labels(const LabelGrid& grid, const std::string& depth_sha256) {
  FrameLabels labels;
  labels.depth_sha256 = depth_sha256;
  labels.intrinsics = grid.intrinsics;
  labels.depth_unit_m = grid.depth_unit_m;
  labels.gravity = grid.gravity;
  labels.origin = grid.origin;
  labels.plane = Image16(grid.width, grid.height);
  labels.hv = Image8(grid.width, grid.height);
  labels.review_state = "unreviewed";
  return labels;
}

// A plane through points of the grid.
namespace {

/// Middle over largest eigenvalue of the scatter: below it, the points are in a line.
constexpr double kLine = 1e-6;

}  // namespace

FittedPlane fit_plane(const LabelGrid& grid, std::span<const std::uint32_t> pixels) {
  FittedPlane plane;
  // Relative to one of the points, to avoid cancellation.
  Vec3d origin = Vec3d::Zero();
  Moments moments;
  for (const std::uint32_t pixel : pixels) {
    if (!grid.measured[pixel]) continue;
    const Vec3d point = grid.points[pixel].cast<double>();
    if (moments.count == 0) origin = point;
    moments.add(point - origin);
  }
  plane.points = static_cast<std::size_t>(moments.count);
  if (plane.points == 0) return plane;
  PlaneFit fit = fit_plane(moments);
  fit.centroid += origin;
  plane.centroid = fit.centroid;
  plane.offset_m = plane.normal.dot(plane.centroid);
  if (plane.points < 3) return plane;
  const auto facing = facing_sensor(fit);
  if (!facing) {
    plane.points = 2;
    return plane;
  }
  plane.normal = facing->normal;
  plane.offset_m = facing->offset_m();
  if (grid.is_cloud() && plane.normal.dot(grid.gravity.direction) > 0) {  // no known sensor
    plane.normal = -plane.normal;
    plane.offset_m = -plane.offset_m;
  }
  plane.rms_m = facing->rms_m();
  plane.area_m2 = grid.area_m2(pixels, &plane.normal);
  plane.tilt_deg = tilt_of(plane.normal, grid.gravity);
  return plane;
}

std::optional<PlaneFit> facing_sensor(PlaneFit fit) {
  if (fit.count < 3 || !(fit.eigenvalues[1] > kLine * fit.eigenvalues[2])) return std::nullopt;
  if (fit.offset_m() > 0) fit.normal = -fit.normal;
  return fit;
}

double tilt_of(const Vec3d& normal, const Gravity& gravity) {
  if (!gravity.known()) return std::nan("");
  return std::acos(std::clamp(-normal.dot(gravity.direction), -1.0, 1.0)) * 180 / std::numbers::pi;
}

Label class_of_tilt(double tilt_deg) {
  if (std::isnan(tilt_deg)) return Label::unknown;
  return label_of_cosine(std::cos(tilt_deg * std::numbers::pi / 180));
}

void refit_planes(FrameLabels& labels, const LabelGrid& grid, std::span<const int> ids) {
  assert(labels.plane.pixels() == grid.pixels());
  std::vector<int> slot(kPlaneIgnore + 1, -1);  // index in the list of planes to fit
  for (std::size_t k = 0; k < labels.planes.size(); ++k) {
    const int id = labels.planes[k].id;
    if (ids.empty() || std::ranges::find(ids, id) != ids.end()) slot[id] = static_cast<int>(k);
  }
  std::vector<PixelSet> pixels(labels.planes.size());
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i)
    if (const int k = slot[labels.plane.data[i]]; k >= 0)
      pixels[k].push_back(static_cast<std::uint32_t>(i));

  const std::vector<int> fragments = count_fragments(labels.plane, &grid);
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    if (pixels[k].empty()) continue;
    LabelPlane& plane = labels.planes[k];
    const FittedPlane fit = fit_plane(grid, pixels[k]);
    plane.normal = fit.normal;
    plane.offset_m = fit.offset_m;
    plane.rms_m = fit.rms_m;
    plane.fragments = fragments[static_cast<std::size_t>(plane.id)];
  }
  std::erase_if(labels.planes, [&](const LabelPlane& plane) {
    return slot[plane.id] >= 0 && pixels[slot[plane.id]].empty();
  });
}

}  // namespace planescope::labels
