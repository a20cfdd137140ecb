#include "render/step_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace planescope::render {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// What a quantity is asked of: the run as it stands at a step.
struct Measures {
  const debug::Run& run;
  ColorBy by;
  std::int32_t step;
  std::int32_t selected = -1;  // plane of the trace

  const planes::PreparedFrame& prepared() const { return run.subject->prepared; }
  const Vec3f& point(std::size_t voxel) const { return prepared().voxels.points[voxel]; }

  float depth_m(std::size_t voxel) const {
    const Vec3d from_sensor = point(voxel).cast<double>() - prepared().sensor();
    if (prepared().from_cloud) return static_cast<float>(from_sensor.norm());
    return static_cast<float>(prepared().cloud.T_world_sensor.linear().col(2).dot(from_sensor));
  }
  float height_m(std::size_t voxel) const {
    if (!prepared().gravity.known()) return kUnknown;
    return static_cast<float>(point(voxel).z() + prepared().cloud.origin.z());
  }
  const planes::PlaneChange* plane(std::int32_t of) const {
    const planes::PlaneChange* change = of >= 0 ? run.timeline.plane_at(of, step) : nullptr;
    return change && change->alive ? change : nullptr;
  }
  float rms_m(std::int32_t of, std::int32_t node) const {
    if (const planes::PlaneChange* change = plane(of))
      return static_cast<float>(change->fit.rms_m());
    if (node < 0 || !is_settled_leaf(run, node, step)) return kUnknown;
    const PlaneFit& fit = run.facts[static_cast<std::size_t>(node)].fit;
    return fit.count >= 3 ? static_cast<float>(fit.rms_m()) : kUnknown;
  }
  float distance_m(std::size_t voxel, std::int32_t own) const {
    const std::int32_t of = selected >= 0 ? selected : own;
    const planes::PlaneChange* change = plane(of);
    if (!change) return kUnknown;
    const Vec3d normal =
        planes::outward_normal(change->fit, run.timeline.label_of_plane(of), prepared().sensor());
    return static_cast<float>(normal.dot(point(voxel).cast<double>() - change->fit.centroid));
  }
  float of(std::size_t voxel, std::int32_t own) const {
    switch (by) {
      case ColorBy::depth:
        return depth_m(voxel);
      case ColorBy::height:
        return height_m(voxel);
      case ColorBy::rms:
        return rms_m(own, own < 0 ? run.timeline.node_of_point(static_cast<int>(voxel), step) : -1);
      default:
        return distance_m(voxel, own);
    }
  }
};

/// Enough of the points to know their range by, as the run leaves them.
ValueRange range_of(const debug::Run& run, ColorBy by) {
  constexpr std::size_t kEnough = 4096;
  const Measures measures{run, by, run.steps()};
  const std::size_t n = run.subject->voxel_count();
  std::vector<float> values;
  for (std::size_t v = 0; v < n; v += std::max<std::size_t>(1, n / kEnough)) {
    const std::int32_t own = run.timeline.point_at(static_cast<int>(v), run.steps()).plane;
    // Of what is in no plane the RMS says how little it is one: it may be anything.
    if (by == ColorBy::rms && own < 0) continue;
    values.push_back(measures.of(v, own));
  }
  if (by == ColorBy::rms) return range_from_zero(std::move(values));
  if (by == ColorBy::distance) return range_about_zero(std::move(values));
  return robust_range(std::move(values));
}

std::string what_of(const debug::Run& run, const StepLook& look) {
  const bool cloud = run.subject->prepared.from_cloud;
  switch (look.color_by) {
    case ColorBy::depth:
      return cloud ? "distance from the origin" : "depth";
    case ColorBy::height:
      return cloud ? "height" : "height above the camera";
    case ColorBy::rms:
      return "RMS of plane or node";
    default:
      return look.plane >= 0 ? "distance to " + debug::plane_name(run, look.plane)
                             : "distance to its plane";
  }
}

Measures measures_of(const debug::Run& run, const StepLook& look) {
  return {run, look.color_by, look.step, look.plane};
}

}  // namespace

bool is_along_scale(ColorBy by) {
  return by == ColorBy::depth || by == ColorBy::height || by == ColorBy::rms ||
         by == ColorBy::distance;
}

std::string why_no_values(const debug::Run& run, const StepLook& look) {
  if (look.color_by == ColorBy::height && !run.subject->prepared.gravity.known())
    return "height is unknown: gravity is unknown";
  if (look.color_by != ColorBy::rms && look.color_by != ColorBy::distance) return "";
  const Measures measures = measures_of(run, look);
  if (look.color_by == ColorBy::distance && look.plane >= 0 && !measures.plane(look.plane))
    return debug::plane_name(run, look.plane) + " is not a plane at this step";
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane)
    if (measures.plane(plane)) return "";
  if (look.color_by == ColorBy::rms)
    for (std::size_t node = 0; node < run.octree().nodes.size(); ++node)
      if (std::isfinite(measures.rms_m(-1, static_cast<std::int32_t>(node)))) return "";
  return look.step == run.steps() ? "no planes found" : "there is not a plane at this step yet";
}

std::vector<float> voxel_values(const debug::Run& run,
                                const StepLook& look,
                                const StepState& state) {
  const Measures measures = measures_of(run, look);
  std::vector<float> values(run.subject->voxel_count());
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = measures.of(v, state.plane_of[v]);
  return values;
}

ColorScale color_scale(const debug::Run& run, const StepLook& look) {
  ColorScale scale{.what = what_of(run, look),
                   .range = look.range ? *look.range : range_of(run, look.color_by)};
  if (look.color_by == ColorBy::depth) scale.map = ColorScale::Map::falling;
  if (look.color_by != ColorBy::distance) return scale;
  scale.map = ColorScale::Map::diverging;
  scale.at_low = "behind";
  scale.at_high = "before";
  return scale;
}

std::vector<Rgba> scaled_colors(const debug::Run& run,
                                const StepLook& look,
                                const StepState& state,
                                Rgba unknown) {
  const ColorScale scale = color_scale(run, look);
  const bool to_one = look.color_by == ColorBy::distance && look.plane >= 0;
  std::vector<Rgba> colors;
  const std::vector<float> values = voxel_values(run, look, state);
  for (std::size_t v = 0; v < values.size(); ++v) {
    const float value = values[v];
    const bool far_off = value < scale.range.low_m || value > scale.range.high_m;
    const bool told =
        std::isfinite(value) && !(to_one && far_off && state.plane_of[v] != look.plane);
    colors.push_back(told ? scale.color(value) : unknown);
  }
  return colors;
}

std::string value_text(const debug::Run& run, const StepLook& look, std::int32_t voxel) {
  if (!is_along_scale(look.color_by)) return "";
  const std::int32_t own = run.timeline.point_at(voxel, look.step).plane;
  const float value = measures_of(run, look).of(static_cast<std::size_t>(voxel), own);
  if (!std::isfinite(value)) return "";
  switch (look.color_by) {
    case ColorBy::depth:
    case ColorBy::height:
      return fmt::format("{} {:.3f} m", what_of(run, look), value);
    case ColorBy::rms:
      return fmt::format("RMS {:.1f} mm", 1000 * value);
    default:
      return fmt::format("{:.1f} mm {} {}", 1000 * std::abs(value), value < 0 ? "behind" : "before",
                         debug::plane_name(run, look.plane >= 0 ? look.plane : own));
  }
}

}  // namespace planescope::render
