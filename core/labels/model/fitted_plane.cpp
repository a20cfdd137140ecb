#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/labels/model/grid.hpp"
#include "core/labels/model/pixel_sets.hpp"

namespace planescope::labels {
namespace {

/// The middle of the scatter's eigenvalues over the largest: below it the points are in a line.
constexpr double kLine = 1e-6;

}  // namespace

FittedPlane fit_plane(const LabelGrid& grid, std::span<const std::uint32_t> pixels) {
  FittedPlane plane;
  // About one of the points, so that nothing cancels.
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
  if (grid.is_cloud() && plane.normal.dot(grid.gravity.direction) > 0) {  // no sensor is known
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
  std::vector<int> slot(kPlaneIgnore + 1, -1);  // in the list of planes, of those to be fitted
  for (std::size_t k = 0; k < labels.planes.size(); ++k) {
    const int id = labels.planes[k].id;
    if (ids.empty() || std::ranges::find(ids, id) != ids.end()) slot[id] = static_cast<int>(k);
  }
  std::vector<PixelSet> pixels(labels.planes.size());
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i)
    if (const int k = slot[labels.plane.data[i]]; k >= 0)
      pixels[k].push_back(static_cast<std::uint32_t>(i));

  const std::vector<int> fragments = count_fragments(labels.plane, grid);
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
