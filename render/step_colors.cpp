// Voxel colors at a step of a run, by case, label, plane or measured quantity.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/step_scene.hpp"

namespace planescope::render {

// ---- Measured quantities of voxels ----

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Computes a quantity for the state of a run at a step.
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
    const PlaneFit& fit = run.facts[node].fit;
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

/// Range of a quantity over a sample of the final points.
ValueRange range_of(const debug::Run& run, ColorBy by) {
  constexpr std::size_t kEnough = 4096;
  const Measures measures{run, by, run.steps()};
  const std::size_t n = run.subject->voxel_count();
  std::vector<float> values;
  for (std::size_t v = 0; v < n; v += std::max<std::size_t>(1, n / kEnough)) {
    const std::int32_t own = run.timeline.point_at(static_cast<int>(v), run.steps()).plane;
    // For unassigned points the RMS is arbitrary.
    if (by == ColorBy::rms && own < 0) continue;
    values.push_back(measures.of(v, own));
  }
  if (by != ColorBy::rms && by != ColorBy::distance) return robust_range(std::move(values));
  ValueRange range = range_from_zero(std::move(values));
  if (by == ColorBy::distance) range.low_m = -range.high_m;
  return range;
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
  return look.step == run.steps() ? "no planes found" : "no planes at this step yet";
}

std::vector<float> voxel_values(const StepState& state) {
  const Measures measures = measures_of(state.run, state.look);
  std::vector<float> values(state.run.subject->voxel_count());
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
  scale.at_high = "in front";
  return scale;
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
      return fmt::format("{:.1f} mm {} {}", 1000 * std::abs(value),
                         value < 0 ? "behind" : "in front of",
                         debug::plane_name(run, look.plane >= 0 ? look.plane : own));
  }
}

// ---- Colors ----

namespace {

/// Colors of the values; `unknown` for missing values, and for points beyond the scale's range that
/// are not on the selected plane.
std::vector<Rgba> scaled_colors(const StepState& state, Rgba unknown) {
  const StepLook& look = state.look;
  const ColorScale scale = color_scale(state.run, look);
  const bool to_one = look.color_by == ColorBy::distance && look.plane >= 0;
  std::vector<Rgba> colors;
  const std::vector<float> values = voxel_values(state);
  for (std::size_t v = 0; v < values.size(); ++v) {
    const float value = values[v];
    const bool far_off = value < scale.range.low_m || value > scale.range.high_m;
    const bool is_known =
        std::isfinite(value) && !(to_one && far_off && state.plane_of[v] != look.plane);
    colors.push_back(is_known ? scale.color(value) : unknown);
  }
  return colors;
}

/// Mean color of the image or cloud at each voxel; gray if there is none.
std::vector<Rgba> camera_colors(const debug::Subject& subject) {
  const Frame& frame = subject.frame;
  const planes::Cloud& cloud = subject.prepared.cloud;
  const planes::VoxelCloud& voxels = subject.prepared.voxels;
  std::vector<Rgba> colors(voxels.points.size(), Rgba{150, 153, 158, 255});
  const std::vector<std::uint8_t>* rgb = nullptr;
  if (frame.is_cloud() && !frame.cloud->rgb.empty()) rgb = &frame.cloud->rgb;
  if (!frame.is_cloud() && has_aligned_color(frame)) rgb = &frame.color.data;
  if (rgb == nullptr) return colors;

  std::vector<std::array<std::uint32_t, 4>> sums(colors.size());  // r, g, b, count
  for (std::size_t i = 0; i < cloud.source.size(); ++i) {
    const std::uint32_t voxel = voxels.voxel_of[i];
    if (voxel == planes::kNoVoxel) continue;
    for (std::size_t c = 0; c < 3; ++c)
      sums[voxel][c] += (*rgb)[3 * std::size_t{cloud.source[i]} + c];
    ++sums[voxel][3];
  }
  for (std::size_t v = 0; v < colors.size(); ++v) {
    const auto& [r, g, b, count] = sums[v];
    if (count == 0) continue;
    colors[v] = {static_cast<std::uint8_t>(r / count), static_cast<std::uint8_t>(g / count),
                 static_cast<std::uint8_t>(b / count), 255};
  }
  return colors;
}

/// Whether a plane of the trace is steppable; nullopt if unknown at this step.
std::optional<bool> verdict_of(const StepState& state, std::int32_t plane) {
  const debug::Run& run = state.run;
  const StepLook& look = state.look;
  if (look.step != run.steps() || !look.planes) return std::nullopt;
  return look.planes->verdict(run.timeline.result_of_plane(plane));
}

/// Color of a voxel; `waiting` if its value is unknown.
Rgba color_at_step(const StepState& state, ColorBy by, std::size_t voxel, Rgba waiting) {
  const debug::Run& run = state.run;
  const planes::Classification& classified = run.subject->prepared.classification;
  const std::int32_t plane = state.plane_of[voxel];
  switch (by) {
    case ColorBy::cases:
      return state.case_of[voxel] == planes::Case::none ? waiting
                                                        : case_color(state.case_of[voxel]);
    case ColorBy::labels:  // the classifier's labels or, for methods without them, the
                           // planes' labels
      if (run.is_ours() && !run.is_on_image()) return label_color(classified.labels[voxel]);
      return label_color(plane >= 0 ? run.timeline.label_of_plane(plane) : Label::unknown);
    case ColorBy::margins:
      return margin_color(classified.labels[voxel], classified.margins[voxel]);
    case ColorBy::steppable: {
      const bool is_known = state.look.step == run.steps() && state.look.planes;
      if (plane < 0) return is_known ? leftover_color() : waiting;
      const std::optional<bool> verdict = verdict_of(state, plane);
      return verdict ? verdict_color(*verdict) : waiting;
    }
    case ColorBy::truth: {
      const debug::VoxelTruth& truth = run.subject->voxel_truth;
      if (!truth.known() || truth.plane[voxel] < 0) return waiting;  // not scored
      return truth.plane[voxel] == 0 ? leftover_color()
                                     : color_of(truth.plane[voxel], state.look.color_of_truth);
    }
    default:
      if (plane == StepState::kLeftover) return leftover_color();
      return plane >= 0 ? state.look.plane_color(plane) : waiting;
  }
}

/// Stripes distinguish dead ends of the octree and planes that are not steppable, in addition to
/// hue: diagonals in the image or, for voxels on a grid, in space.
void add_stripes(const StepState& state, ColorBy by, std::vector<Rgba>& colors) {
  if (by != ColorBy::cases && by != ColorBy::steppable) return;
  constexpr int kPeriod = 8, kWidth = 3;  // pixels; half as many voxels
  constexpr double kShade = 0.5;
  const Rgba ground = theme_colors(state.look.theme).background_bottom;
  const planes::PreparedFrame& prepared = state.run.subject->prepared;
  const auto shade = [&](std::size_t voxel) {
    const std::int32_t plane = state.plane_of[voxel];
    const bool is_striped = by == ColorBy::cases
                                ? state.case_of[voxel] == planes::Case::II
                                : plane >= 0 && !verdict_of(state, plane).value_or(true);
    if (is_striped) colors[voxel] = mix(colors[voxel], ground, kShade);
  };
  if (state.run.is_on_image()) {
    const auto width = static_cast<std::uint32_t>(state.run.subject->frame.depth.width);
    for (std::size_t i = 0; i < prepared.cloud.source.size(); ++i) {
      const std::uint32_t voxel = prepared.voxels.voxel_of[i], source = prepared.cloud.source[i];
      if (voxel != planes::kNoVoxel && (source % width + source / width) % kPeriod < kWidth)
        shade(voxel);
    }
    return;
  }
  const double size = std::max(prepared.voxels.size_m, 1e-3) * kPeriod / 2;
  for (std::size_t v = 0; v < colors.size(); ++v) {
    const double along = prepared.voxels.points[v].sum() / size;
    if (along - std::floor(along) < static_cast<double>(kWidth) / kPeriod) shade(v);
  }
}

}  // namespace

Rgba StepLook::plane_color(std::int32_t of) const { return color_of(of + 1, color_of_plane); }

StepState step_state(const debug::Run& run, const StepLook& look) {
  const std::int32_t step = look.step;
  const planes::Octree& octree = run.octree();
  const std::size_t n = run.subject->voxel_count();
  StepState state{.run = run, .look = look};
  state.case_of.assign(n, planes::Case::none);
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    if (!is_settled_leaf(run, static_cast<std::int32_t>(i), step)) continue;
    for (const std::uint32_t voxel : members(octree, octree.nodes[i]))
      state.case_of[voxel] = octree.nodes[i].decided;
  }
  for (std::size_t v = 0; v < n; ++v) {
    const planes::PointChange change = run.timeline.point_at(static_cast<std::int32_t>(v), step);
    state.plane_of.push_back(change.plane >= 0 ? change.plane
                             : change.leftover ? StepState::kLeftover
                                               : StepState::kOpen);
  }
  if (const planes::TraceEvent* event = look.show_current ? run.event_at(step) : nullptr) {
    state.node = event->node >= 0 || event->point < 0
                     ? event->node
                     : run.timeline.node_of_point(event->point, step);
    state.plane = event->plane;
    state.other = event->other;
    state.voxel = event->point;
  }
  return state;
}

ColorBy effective_color_by(const debug::Run& run, ColorBy asked) {
  // Without labels all points have margin 0.
  const bool labeled = run.subject->prepared.gravity.known() && !run.is_on_image();
  if (asked == ColorBy::margins && !labeled) return ColorBy::labels;
  if (run.is_ours()) return asked;
  if (asked == ColorBy::cases) return ColorBy::planes;
  return asked == ColorBy::margins ? ColorBy::labels : asked;
}

bool is_settled_leaf(const debug::Run& run, std::int32_t node, std::int32_t step) {
  const auto i = static_cast<std::size_t>(node);
  return run.timeline.decided_at()[i] <= step && run.octree().nodes[i].first_child < 0;
}

HighlightColors highlight_colors(Theme theme) {
  const bool dark = theme == Theme::dark;
  return {.selected = dark ? Rgba{255, 64, 160, 255} : Rgba{225, 0, 122, 255},
          .current = dark ? Rgba{255, 255, 255, 255} : Rgba{0, 0, 0, 255},
          .marked = {255, 236, 64, 255},
          .waiting = dark ? Rgba{86, 92, 102, 255} : Rgba{201, 205, 211, 255}};
}

std::vector<std::uint8_t> concerned_voxels(const StepState& state) {
  const debug::Run& run = state.run;
  const StepLook& look = state.look;
  std::vector<std::uint8_t> concerned(run.subject->voxel_count(), 0);
  const auto add_node = [&](std::int32_t i) {
    if (i < 0 || run.timeline.queued_at()[i] > look.step) return;
    for (const std::uint32_t voxel : members(run.octree(), run.octree().nodes[i]))
      concerned[voxel] = 1;
  };
  add_node(look.node);
  add_node(state.node);
  for (const std::int32_t plane : {look.plane, state.plane, state.other})
    for (std::size_t v = 0; plane >= 0 && v < concerned.size(); ++v)
      if (state.plane_of[v] == plane) concerned[v] = 1;
  // The plane has no points left: use the node where it began.
  if (look.show_current && std::ranges::count(concerned, 1) == 0)
    add_node(debug::node_at_step(run, look.step));
  const auto count = std::ranges::count(concerned, 1);
  if (count == 0 || count == std::ssize(concerned)) concerned.clear();
  return concerned;
}

std::vector<Rgba> voxel_colors(const StepState& state) {
  constexpr double kHighlight = 0.55;  // share of the highlight; the color below remains visible
  const debug::Run& run = state.run;
  const StepLook& look = state.look;
  const HighlightColors highlights = highlight_colors(look.theme);
  const ColorBy by = effective_color_by(run, look.color_by);
  std::vector<Rgba> colors;
  if (by == ColorBy::camera) {
    colors = camera_colors(*run.subject);
  } else if (is_along_scale(by)) {
    colors = scaled_colors(state, highlights.waiting);
  } else {
    for (std::size_t v = 0; v < state.plane_of.size(); ++v)
      colors.push_back(color_at_step(state, by, v, highlights.waiting));
    add_stripes(state, by, colors);
  }
  for (const std::uint32_t voxel : look.marked)
    if (voxel < colors.size()) colors[voxel] = mix(colors[voxel], highlights.marked, kHighlight);
  // The node of the step: lighter on dark themes, darker on light ones.
  constexpr double kLit = 0.3;
  if (state.node >= 0 && state.node < std::ssize(run.octree().nodes)) {
    const planes::OctreeNode& node = run.octree().nodes[state.node];
    if (node.size() != colors.size())
      for (const std::uint32_t voxel : members(run.octree(), node))
        colors[voxel] = mix(colors[voxel], highlights.current, kLit);
  }
  const auto replace = [&](std::int32_t voxel, Rgba mark) {
    if (voxel >= 0 && voxel < std::ssize(colors)) colors[voxel] = mark;
  };
  replace(state.voxel, highlights.current);
  replace(look.voxel, highlights.selected);
  return colors;
}

}  // namespace planescope::render
