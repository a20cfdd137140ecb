// Uncertainty, surface properties and free space of each plane for a robot's foot.

#include "core/planes/foot/footholds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/model/plane.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/outline/polygons.hpp"

namespace planescope::planes {

// ---- Certainty ----

namespace {

// Voxels, clouds and the part that changes between frames: sigma_offset^2 = sigma^2 (kAlike / n +
// kOffsetBias^2); for the tilts the same, divided by the squared lever arm. n voxels are worth
// n / kAlike independent ones, because stereo errors are correlated over more than a voxel. Errors
// common to all voxels do not average out: points of another surface tilt the plane, and a floor
// between two layers of voxels shifts to their middle.
constexpr double kAlike = 1.44;
constexpr double kTiltBias = 0.07;
constexpr double kOffsetBias = 0.18;
// Depth images: kAlikePixels neighboring pixels share their noise, and the bow is measured in
// squares of 1/kSquaresAcross of the image's width. Real depth has an error with a correlation
// length of 10 to 100 px that differs between sensors, scenes and surfaces (docs/footholds.md).
constexpr double kAlikePixels = 15;
constexpr int kSquaresAcross = 12;
// Regularizes the fit without one square: the remaining pixels may be on a line.
constexpr double kLeastRest = 0.01;

/// Sums over a plane's voxels, in plane coordinates.
struct Extent {
  double count = 0;
  Vec2d sum = Vec2d::Zero();
  double xx = 0, xy = 0, yy = 0;

  void add(const Vec2d& p) {
    count += 1;
    sum += p;
    xx += p.x() * p.x();
    xy += p.x() * p.y();
    yy += p.y() * p.y();
  }
};

/// Certainty of a plane fitted in inverse depth, by the jackknife: the plane is refitted without
/// each square of the image in turn, and the squared changes add up. They contain the sensor's bow
/// and pixels of other surfaces. The independent noise of pixels is added.
void measure_by_squares(const FrameResult& result,
                        const std::vector<PointRun>& runs,
                        const PlaneFit& fit,
                        Certainty& certainty) {
  const Cloud& cloud = result.cloud;
  const Pose T_camera_local = cloud.T_world_sensor.inverse();
  const int side = std::max(1, cloud.width / kSquaresAcross), columns = cloud.width / side + 1;
  std::vector<InverseSums> squares(static_cast<std::size_t>(columns) * (cloud.height / side + 1));
  for (const PointRun& run : runs)
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const int x = static_cast<int>(cloud.source[i]) % cloud.width;
      const int y = static_cast<int>(cloud.source[i]) / cloud.width;
      const Vec3d p = T_camera_local * (cloud.points[i].cast<double>() + cloud.origin);
      squares[y / side * columns + x / side].add(p / p.z(), 1 / p.z());
    }
  InverseSums all;
  for (const InverseSums& square : squares) all += square;
  if (all.count <= 3) return;
  const planescope::InversePlane plane = all.fit();
  const Mat3d rr = all.rr() + 1e-9 * all.rr().trace() * Mat3d::Identity();
  const double sigma = std::max(result.segmentation.noise.growth_per_m, plane.rms);
  Mat3d moves = Mat3d::Zero();
  double seen = 0;
  for (const InverseSums& square : squares) {
    if (square.count == 0) continue;
    ++seen;
    const Vec3d error = square.rw() - square.rr() * plane.w_of_ray;
    const Vec3d move = ((1 + kLeastRest) * rr - square.rr()).ldlt().solve(error);
    moves += move * move.transpose();
  }
  // The fit takes three degrees of freedom from the squares.
  const double scale = seen / std::max(1.0, seen - 3);
  const Mat3d covariance = kAlikePixels * sigma * sigma * rr.inverse() + scale * moves;
  // Changes of w = normal / offset (camera frame) give the plane's tilt and offset.
  const auto sigma_along = [&](const Vec3d& v) {
    return std::sqrt(v.dot(covariance * v)) / plane.w_of_ray.norm();
  };
  for (int i = 0; i < 2; ++i)
    certainty.sigma_tilt_rad[i] = sigma_along(T_camera_local.linear() * certainty.axes[i]);
  certainty.sigma_offset_m = sigma_along(T_camera_local * (fit.centroid + cloud.origin));
}

}  // namespace

Mat3d Certainty::covariance(const Vec3d& centroid) const {
  const Vec3d d_offset(axes[0].dot(centroid), axes[1].dot(centroid), 1);
  const double variances[3] = {sigma_tilt_rad[0] * sigma_tilt_rad[0],
                               sigma_tilt_rad[1] * sigma_tilt_rad[1],
                               sigma_offset_m * sigma_offset_m};
  Mat3d covariance = Mat3d::Zero();
  for (int i = 0; i < 3; ++i) {
    Vec3d effect = Vec3d::Unit(i);
    effect.z() = d_offset[i];
    covariance += variances[i] * effect * effect.transpose();
  }
  return covariance;
}

std::vector<Certainty> certainties_of(const FrameResult& result, bool against_truth) {
  const Segmentation& segmentation = result.segmentation;
  const std::size_t n = segmentation.planes.size();
  std::vector<PlaneBasis> bases;
  for (const PlaneRegion& plane : segmentation.planes)
    bases.push_back(plane_basis(plane.fit.normal));
  std::vector<Extent> extents(n);
  for (std::size_t i = 0; i < segmentation.plane_of.size(); ++i) {
    const std::int32_t id = segmentation.plane_of[i];
    if (id <= 0) continue;
    const PlaneBasis& basis = bases[id - 1];
    const Vec3d at =
        result.voxels.points[i].cast<double>() - segmentation.planes[id - 1].fit.centroid;
    extents[id - 1].add({basis.u.dot(at), basis.v.dot(at)});
  }
  const auto runs = runs_of_planes(result);
  std::vector<Certainty> certainties(n);
  for (std::size_t k = 0; k < n; ++k) {
    const PlaneFit& fit = segmentation.planes[k].fit;
    const Extent& extent = extents[k];
    Certainty& certainty = certainties[k];
    certainty.eigenvalues_m2 = fit.eigenvalues;
    const double count = std::max(3.0, fit.count);
    const double own_m = std::sqrt(fit.eigenvalues[0] / std::max(1.0, count - 3));
    certainty.sigma_m =
        std::max(own_m, segmentation.noise.sigma((fit.centroid - result.sensor()).norm()));
    const auto sigma_m = [&](double bias) {
      return certainty.sigma_m * std::sqrt(kAlike / count + bias * bias);
    };
    certainty.sigma_offset_m = sigma_m(kOffsetBias);

    // Mean squares along the two axes, relative to the mean of the voxels.
    const double size = std::max(1.0, extent.count);
    const Vec2d mean = extent.sum / size;
    const double xx = extent.xx / size - mean.x() * mean.x();
    const double xy = extent.xy / size - mean.x() * mean.y();
    const double yy = extent.yy / size - mean.y() * mean.y();
    const double half_sum = (xx + yy) / 2, half_gap = std::hypot((xx - yy) / 2, xy);
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const double spread_m2[2] = {half_sum + half_gap, half_sum - half_gap};
    certainty.axes[0] = std::cos(angle) * bases[k].u + std::sin(angle) * bases[k].v;
    certainty.axes[1] = -std::sin(angle) * bases[k].u + std::cos(angle) * bases[k].v;
    for (int i = 0; i < 2; ++i)
      certainty.sigma_tilt_rad[i] = sigma_m(kTiltBias) / std::sqrt(std::max(1e-12, spread_m2[i]));
    if (result.of_pixels && against_truth) measure_by_squares(result, runs[k], fit, certainty);
  }
  return certainties;
}

// ---- Surfaces ----

namespace {

/// Plane of each pixel; 0: none.
std::vector<std::int32_t> planes_by_pixel(const Frame& frame, const FrameResult& result) {
  std::vector<std::int32_t> plane_of(frame.depth.data.size(), 0);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    plane_of[result.cloud.source[i]] = result.plane_of[i];
  return plane_of;
}

/// Share of the pixels within the outline that belong to the plane; nullopt if there are none.
std::optional<double> support_by_pixels(const std::vector<PixelRun>& within,
                                        const std::vector<std::int32_t>& plane_of,
                                        int width,
                                        std::int32_t id) {
  double all = 0, seen = 0;
  for (const PixelRun& run : within) {
    const std::int32_t* row = plane_of.data() + static_cast<std::size_t>(run.y) * width;
    all += run.x1 - run.x0;
    seen += static_cast<double>(std::count(row + run.x0, row + run.x1, id));
  }
  return all > 0 ? std::optional(seen / all) : std::nullopt;
}

double support_by_places(const Places& places, const Outline& outline) {
  double within_m2 = outline.area_m2;
  for (const Outline::Part& part : outline.parts)
    for (const PolygonRing& hole : part.unknown) within_m2 -= polygon_area(hole);
  return within_m2 > 0 ? std::min(1.0, places.covered_m2() / within_m2) : 0;
}

}  // namespace

std::vector<Surface> surfaces_of(const Frame& frame,
                                 const FrameResult& result,
                                 const std::vector<Outline>& outlines,
                                 const std::vector<Places>& places) {
  constexpr double kCircle_m = 0.005;  // tolerance of the search for the best position
  constexpr double kMostSteps = 0.95;
  std::vector<std::int32_t> plane_of;
  if (!frame.is_cloud()) plane_of = planes_by_pixel(frame, result);
  const Pose T_sensor_world = result.cloud.T_world_sensor.inverse();
  std::vector<Surface> surfaces(outlines.size());
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const Outline& outline = outlines[k];
    Surface& surface = surfaces[k];
    const double level = std::min(1.0, std::abs(result.segmentation.planes[k].fit.normal.z()));
    surface.slope_deg =
        result.gravity.known() ? std::acos(level) * 180 / std::numbers::pi : std::nan("");
    surface.rough_rms_m = places[k].rough_rms_m();
    surface.rough_step_m = places[k].step_m(kMostSteps);
    std::optional<double> support;
    if (!frame.is_cloud())
      if (const auto within = pixels_within(outline, frame.intrinsics, T_sensor_world, true))
        support = support_by_pixels(*within, plane_of, frame.intrinsics.width,
                                    static_cast<std::int32_t>(k) + 1);
    surface.support = support ? *support : support_by_places(places[k], outline);
    const Circle circle = largest_circle(polygons_of(outline), kCircle_m);
    surface.clearance_m = circle.radius_m;
    surface.best_place = outline.world(circle.center);
  }
  return surfaces;
}

// ---- Free space for the center of a foot ----

namespace {

/// Few corners make few convex pieces: inset the area by this much more, and simplify it by
/// as much.
constexpr double kCorners_m = 0.005;

/// Includes unknown holes that are too large to step over.
Polygons ground_of(const Outline& outline, double least_hole_m2) {
  Polygons ground;
  for (const Outline::Part& part : outline.parts) {
    Polygon& polygon = ground.emplace_back(Polygon{part.outer, part.holes});
    for (const PolygonRing& hole : part.unknown)
      if (-polygon_area(hole) >= least_hole_m2) polygon.holes.push_back(hole);
  }
  return ground;
}

}  // namespace

FootSpace foot_space(const Outline& outline, const Places& places, const FootOptions& options) {
  const double foot_m2 = std::numbers::pi * options.radius_m * options.radius_m;
  const double inset_m = options.radius_m + options.margin_m + kCorners_m;
  FootSpace space;
  const Polygons exact =
      without(inset(ground_of(outline, options.unknown_share * foot_m2), inset_m),
              places.near_off(options.max_off_m, inset_m));
  space.area = simplified(exact, kCorners_m);
  if (!is_valid(space.area)) space.area = exact;
  space.area_m2 = area(space.area);
  space.pieces = convex_pieces(space.area);
  return space;
}

// ---- Footholds ----

namespace {

std::string reasons_against(Label label,
                            const Surface& surface,
                            const FootSpace& space,
                            const FootOptions& limits) {
  std::vector<std::string> reasons;
  if (label == Label::v)
    reasons.emplace_back("upright, v");
  else if (std::isnan(surface.slope_deg))
    reasons.emplace_back("slope unknown: gravity is unknown");
  else if (surface.slope_deg > limits.max_slope_deg)
    reasons.push_back(
        fmt::format("slope {:.1f} deg, limit {}", surface.slope_deg, limits.max_slope_deg));
  if (space.area.empty())
    reasons.emplace_back("no room for the foot");
  else if (space.area_m2 < limits.min_area_m2)
    reasons.push_back(fmt::format("{:.0f} cm2 for the foot's center, limit {:g}",
                                  space.area_m2 * 1e4, limits.min_area_m2 * 1e4));
  if (surface.rough_rms_m > limits.max_rough_m)
    reasons.push_back(fmt::format("{:.3g} mm rough, limit {:g}", surface.rough_rms_m * 1e3,
                                  limits.max_rough_m * 1e3));
  if (surface.support < limits.min_support)
    reasons.push_back(fmt::format("{:.0f} % measured, limit {:g}", surface.support * 100,
                                  limits.min_support * 100));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace

std::vector<Foothold> footholds_of(const Frame& frame,
                                   const FrameResult& result,
                                   const std::vector<Outline>& outlines,
                                   double cell_m,
                                   const FootOptions& options) {
  const std::vector<Places> places = places_of(result, outlines, cell_m);
  const std::vector<Surface> surfaces = surfaces_of(frame, result, outlines, places);
  const std::vector<Certainty> certainties = certainties_of(result);
  std::vector<Foothold> footholds(outlines.size());
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    Foothold& foothold = footholds[k];
    foothold.surface = surfaces[k];
    foothold.certainty = certainties[k];
    const PlaneBasis& basis = outlines[k].basis;
    const Vec3d& axis = certainties[k].axes[0];
    foothold.cut = places[k].cut(Vec2d::Zero(), {basis.u.dot(axis), basis.v.dot(axis)});
    if (!(options.radius_m > 0)) continue;
    foothold.space = foot_space(outlines[k], places[k], options);
    foothold.why_not =
        reasons_against(result.segmentation.planes[k].label, surfaces[k], *foothold.space, options);
    foothold.steppable = foothold.why_not.empty();
  }
  return footholds;
}

}  // namespace planescope::planes
