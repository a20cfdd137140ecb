// Scores outlines, uncertainties and footholds against synthetic truth.

#include "core/lab/experiments/measure_outlines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lab/synthetic/d435.hpp"
#include "core/model/plane.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"

namespace planescope::lab {
namespace {

using planes::FrameResult;
using planes::Outline;
using planes::PixelRun;
using planes::Polygon;
using planes::PolygonRing;

constexpr double kOffM = 0.02;

/// The truth of a frame, in its sensor's axes.
class TrueScene {
 public:
  TrueScene(const EvaluationFrame& frame, const planes::Cloud& cloud, double max_range_m)
      : frame_(frame) {
    const FrameLabels& labels = *frame.labels;
    const Intrinsics& k = labels.intrinsics;
    for (const LabelPlane& plane : labels.planes) {
      if (plane.id >= static_cast<int>(planes_.size())) planes_.resize(plane.id + 1);
      planes_[plane.id] = plane;
    }
    in_range_.assign(labels.plane.data.size(), 0);
    visible_m2_.assign(planes_.size(), 0);
    for (std::size_t i = 0; i < in_range_.size(); ++i) {
      const int id = labels.plane.data[i];
      if (id == 0) continue;
      const double z = depth_m(id, i);
      if (!(z > 0 && z <= max_range_m)) continue;
      if (is_left_of_right_eye(i, z) || is_outside(cloud, z * ray(i))) {
        in_range_[i] = kUnseen;
        continue;
      }
      in_range_[i] = id;
      visible_m2_[id] += pixel_m2(id, i);
    }
    width_ = k.width;
  }
  int last() const { return static_cast<int>(planes_.size()) - 1; }
  const LabelPlane& plane(int id) const { return planes_[id]; }
  double visible_m2(int id) const { return visible_m2_[id]; }
  const std::vector<std::int32_t>& in_range() const { return in_range_; }

  Vec3d ray(std::size_t pixel) const {
    const Intrinsics& k = frame_.labels->intrinsics;
    return {(static_cast<double>(pixel % k.width) - k.cx) / k.fx,
            (static_cast<double>(pixel / k.width) - k.cy) / k.fy, 1};
  }
  /// Depth of a pixel's ray at a plane; negative: behind the camera.
  double depth_m(int id, std::size_t pixel) const {
    return planes_[id].offset_m / planes_[id].normal.dot(ray(pixel));
  }
  /// Area of a plane covered by a pixel, at most 0.01 m2 for grazing rays.
  double pixel_m2(int id, std::size_t pixel) const {
    constexpr double kMost = 0.01;
    const Intrinsics& k = frame_.labels->intrinsics;
    const double z = depth_m(id, pixel);
    if (!(z > 0)) return kMost;
    return std::min(kMost, z * z / (k.fx * k.fy * std::abs(planes_[id].normal.dot(ray(pixel)))));
  }

  static bool is_outside(const planes::Cloud& cloud, const Vec3d& p) {
    const Vec3d in_cube = cloud.T_world_sensor * p - cloud.origin - cloud.cube.min_corner;
    return in_cube.minCoeff() < 0 || in_cube.maxCoeff() >= cloud.cube.edge_m;
  }
  /// The band at the left edge that the right imager cannot see at this depth.
  bool is_left_of_right_eye(std::size_t pixel, double z) const {
    const Intrinsics& k = frame_.labels->intrinsics;
    return static_cast<double>(pixel % k.width) < k.fx * D435Model().baseline_m / z;
  }

  double iou(int id, const std::vector<PixelRun>& found) const {
    double both = 0, either = visible_m2_[id];
    for (const PixelRun& run : found)
      for (int x = run.x0; x < run.x1; ++x) {
        const std::size_t i = static_cast<std::size_t>(run.y) * width_ + x;
        if (in_range_[i] == id)
          both += pixel_m2(id, i);
        else if (in_range_[i] != kUnseen)
          either += pixel_m2(id, i);
      }
    return both / either;
  }

  /// Whether the point is off the nearest surface.
  bool is_off(const Vec3d& p) const {
    return std::ranges::none_of(frame_.polygons, [&](const TruePolygon& polygon) {
      return distance_m(polygon, p) <= kOffM;
    });
  }
  /// Whether a surface more than 2 cm above the plane through `p` hides it.
  bool is_hidden(const Vec3d& p, const Vec3d& normal) const {
    const Intrinsics& k = frame_.labels->intrinsics;
    const int u = static_cast<int>(std::lround(k.fx * p.x() / p.z() + k.cx));
    const int v = static_cast<int>(std::lround(k.fy * p.y() / p.z() + k.cy));
    if (p.z() <= 0 || u < 0 || v < 0 || u >= k.width || v >= k.height) return false;
    const std::size_t pixel = static_cast<std::size_t>(v) * k.width + u;
    const int id = frame_.labels->plane.data[pixel];
    if (id == 0) return false;
    const Vec3d seen = depth_m(id, pixel) * ray(pixel);
    return seen.norm() < p.norm() && std::abs(normal.dot(seen - p)) > kOffM;
  }

 private:
  const EvaluationFrame& frame_;
  int width_ = 0;
  static constexpr std::int32_t kUnseen = -1;
  std::vector<LabelPlane> planes_;      // by id
  std::vector<std::int32_t> in_range_;  // per pixel, the true plane; kUnseen: in one imager only
  std::vector<double> visible_m2_;      // by id, in range
};

std::array<double, 3> off_sigmas(const LabelPlane& truth,
                                 const planes::PlaneRegion& found,
                                 const planes::Certainty& certainty,
                                 const FrameResult& result) {
  const Pose& T_world_sensor = result.cloud.T_world_sensor;
  Vec3d normal = T_world_sensor.linear() * truth.normal;
  double offset = truth.offset_m + normal.dot(T_world_sensor.translation());
  const double along = normal.dot(found.fit.normal);
  normal /= along;
  offset /= along;
  const Vec3d centroid = result.cloud.origin + found.fit.centroid;
  return {certainty.axes[0].dot(normal) / certainty.sigma_tilt_rad[0],
          certainty.axes[1].dot(normal) / certainty.sigma_tilt_rad[1],
          (offset - normal.dot(centroid)) / certainty.sigma_offset_m};
}

bool is_convex(const PolygonRing& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d in = ring[(i + 1) % ring.size()] - ring[i];
    const Vec2d out = ring[(i + 2) % ring.size()] - ring[(i + 1) % ring.size()];
    if (in.x() * out.y() - in.y() * out.x() < -1e-12) return false;
  }
  return ring.size() >= 3;
}

void add_space(const planes::FootSpace& space, FootScore& score) {
  constexpr double kOutsideM2 = 1e-8;
  if (space.area.empty()) return;
  ++score.spaces;
  bool sound = planes::is_valid(space.area) && std::ranges::all_of(space.pieces, is_convex);
  double covered_m2 = 0;
  for (const PolygonRing& piece : space.pieces) {
    covered_m2 += polygon_area(piece);
    if (sound)
      sound = polygon_area(piece) - planes::area(planes::common({{piece, {}}}, space.area)) <=
              kOutsideM2;
  }
  score.invalid += !sound;
  score.area_m2 += space.area_m2;
  score.covered_m2 += covered_m2;
  score.pieces += static_cast<int>(space.pieces.size());
  score.least_covered = std::min(score.least_covered, covered_m2 / space.area_m2);
}

/// Counts whether a foot would be off every surface, or at a hidden place.
void add_place(const TrueScene& scene,
               const Outline& outline,
               const Vec2d& center,
               double radius_m,
               const Pose& T_sensor_world,
               FootScore& score) {
  const Vec3d normal = T_sensor_world.linear() * outline.basis.u.cross(outline.basis.v);
  bool off = false, hidden = false;
  for (int i = 0; i < 9; ++i) {
    const double angle = i * M_PI / 4;
    const Vec2d rim = (i < 8 ? radius_m : 0) * Vec2d(std::cos(angle), std::sin(angle));
    const Vec3d p = T_sensor_world * outline.world(center + rim);
    off |= scene.is_off(p);
    hidden |= scene.is_hidden(p, normal);
  }
  ++score.places;
  score.off += off;
  score.hidden += hidden;
}

void add_places(const TrueScene& scene,
                const Outline& outline,
                const Polygon& area,
                double radius_m,
                const Pose& T_sensor_world,
                FootScore& score) {
  constexpr double kGridM = 0.02;
  Vec2d low = area.outer[0], high = area.outer[0];
  for (const Vec2d& p : area.outer) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (double y = std::ceil(low.y() / kGridM) * kGridM; y <= high.y(); y += kGridM)
    for (double x = std::ceil(low.x() / kGridM) * kGridM; x <= high.x(); x += kGridM) {
      const Vec2d center(x, y);
      if (planes::is_in(area.outer, center) &&
          std::ranges::none_of(area.holes,
                               [&](const auto& hole) { return planes::is_in(hole, center); }))
        add_place(scene, outline, center, radius_m, T_sensor_world, score);
    }
}

/// A result in which the true planes were found, with all pixels measured on them.
FrameResult drawn_result(const TrueScene& scene, const FrameResult& found) {
  FrameResult drawn = found;
  const Pose& T_world_sensor = found.cloud.T_world_sensor;
  drawn.segmentation.planes.clear();
  for (int id = 1; id <= scene.last(); ++id) {
    planes::PlaneRegion& plane = drawn.segmentation.planes.emplace_back();
    plane.id = id;
    plane.fit.normal = T_world_sensor.linear() * scene.plane(id).normal;
    plane.fit.centroid = T_world_sensor * Vec3d(scene.plane(id).offset_m * scene.plane(id).normal) -
                         found.cloud.origin;
  }
  for (std::size_t i = 0; i < drawn.plane_of.size(); ++i)
    drawn.plane_of[i] = std::max(0, scene.in_range()[found.cloud.source[i]]);
  return drawn;
}

}  // namespace

OutlineFrameScore score_outlines(const EvaluationFrame& frame,
                                 const planes::PipelineOptions& options,
                                 const planes::Classifier* classifier) {
  const FrameResult result = planes::run_frame(frame.frame, options, classifier);
  const std::vector<Outline> outlines =
      planes::outlines_of(frame.frame, result, options.cloud.voxel_size_m);
  const std::vector<planes::Foothold> footholds =
      planes::footholds_of(frame.frame, result, outlines, options.cloud.voxel_size_m, options.foot);
  const Pose T_sensor_world = result.cloud.T_world_sensor.inverse();
  const TrueScene scene(frame, result.cloud, options.cloud.max_range_m);

  const std::vector<Outline> drawn =
      planes::outlines_of(frame.frame, drawn_result(scene, result), options.cloud.voxel_size_m);
  const auto iou = [&](int id, const Outline& outline) {
    const auto within =
        planes::pixels_within(outline, frame.frame.intrinsics, T_sensor_world, false);
    return within ? scene.iou(id, *within) : 0;
  };

  std::vector<std::int32_t> plane_of(scene.in_range().size(), 0);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    plane_of[result.cloud.source[i]] = result.plane_of[i];
  const std::vector<int> match = planes::found_of_truth(planes::count_truth_overlap(
      scene.in_range(), plane_of, scene.last(), static_cast<int>(outlines.size())));

  OutlineFrameScore score;
  for (int id = 1; id <= scene.last(); ++id) {
    if (scene.visible_m2(id) == 0) continue;
    OutlineScore& plane = score.planes.emplace_back();
    plane.true_m2 = scene.visible_m2(id);
    plane.drawn_iou = iou(id, drawn[static_cast<std::size_t>(id) - 1]);
    plane.found = match[id - 1];
    if (plane.found == 0) continue;
    const std::size_t k = static_cast<std::size_t>(plane.found) - 1;
    const planes::PlaneRegion& found = result.segmentation.planes[k];
    plane.iou = iou(id, outlines[k]);
    plane.off_sigmas = off_sigmas(scene.plane(id), found, footholds[k].certainty, result);
    plane.range_m = (found.fit.centroid - result.sensor()).norm();
    plane.voxels = found.fit.count;
  }
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const planes::Foothold& foothold = footholds[k];
    if (!foothold.space) continue;
    add_space(*foothold.space, score.foot);
    if (!foothold.steppable) continue;
    ++score.foot.steppable;
    for (const Polygon& area : foothold.space->area)
      add_places(scene, outlines[k], area, options.foot.radius_m, T_sensor_world, score.foot);
  }
  return score;
}

}  // namespace planescope::lab
