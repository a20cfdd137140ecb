// Draw lists and images of a single step of a run, and of labels.

#include "render/step_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/debug/explain/provenance.hpp"
#include "render/scenes.hpp"
namespace planescope::render {
namespace {

// Pick id: the kind in the upper bits, the index below.
constexpr int kKindShift = 30;
constexpr std::uint32_t kIndexMask = (1u << kKindShift) - 1;

std::uint32_t pick_id(Picked::Kind kind, std::int32_t index) {
  return static_cast<std::uint32_t>(kind) << kKindShift | static_cast<std::uint32_t>(index);
}

// ---- Octree nodes at the step ----

// A traversal to the leaves creates thousands of nodes. Children follow their parents, so the first
// nodes of a kind are the largest; small ones are visible by their voxels' color.
constexpr std::size_t kMostSettled = 250;
constexpr std::size_t kMostWaiting = 120;

Rgba waiting_color(Theme theme) { return with_alpha(theme_colors(theme).muted, 90); }

struct Boxes {
  const StepState& state;
  DrawList& list;
  const debug::Run& run = state.run;
  const StepLook& look = state.look;

  const planes::OctreeNode& node(std::int32_t i) const { return run.octree().nodes[i]; }
  /// The bounding box of its points.
  DrawBox tile(std::int32_t i, Rgba color) const {
    DrawBox box = points_box(run.octree(), node(i), run.subject->prepared.voxels.size_m);
    box.id = pick_id(Picked::Kind::node, i);
    box.color = color;
    return box;
  }
  std::int32_t node_count() const { return static_cast<std::int32_t>(run.octree().nodes.size()); }
  bool is_waiting(std::int32_t i) const {
    return run.timeline.node_state(i, look.step) == debug::NodeState::queued;
  }

  void add_settled() const {
    const bool by_case = look.color_by == ColorBy::cases;
    // Makes cases distinguishable without color.
    const bool numerals = by_case && look.show_numerals;
    const double least_edge_m =
        numerals ? least_numeral_edge_m(run.subject->prepared.voxels.points) : 0;
    std::size_t settled = 0, numbered = 0;
    for (std::int32_t i = 0; i < node_count() && settled < kMostSettled; ++i) {
      if (!is_settled_leaf(run, i, look.step)) continue;
      ++settled;
      DrawBox box = tile(i, case_color(node(i).decided));
      if (!by_case)
        box.color.a = 110;  // outlines only: a tint would change the requested colors
      else
        box.style = node(i).at_max_depth ? BoxStyle::hatched : BoxStyle::tinted;
      list.boxes.push_back(box);
      if (numerals && numbered < kMostNumerals &&
          numeral_edge_m(run.octree(), node(i), box) >= least_edge_m) {
        list.labels.push_back({middle_of(box), case_numeral(node(i)), theme_colors(look.theme).ink,
                               15, kNumeralLabel});
        ++numbered;
      }
    }
  }

  /// Adds the nodes at the head of the queue.
  void add_waiting() const {
    std::size_t count = 0;
    for (std::int32_t i = 0; i < node_count() && count < kMostWaiting; ++i) {
      if (!is_waiting(i)) continue;
      list.boxes.push_back(tile(i, waiting_color(look.theme)));
      ++count;
    }
  }

  /// Adds the smallest cells that contain the node, to show its position in the tree.
  void add_parents(std::int32_t of, Rgba color) const {
    color.a = 45;
    std::int32_t i = node(of).parent;
    for (int levels = 3; levels > 0 && i >= 0; --levels, i = node(i).parent) {
      DrawBox box = cell_box(run.octree(), node(i));
      box.color = color;
      list.boxes.push_back(box);
    }
  }

  /// Adds the children into which the node is divided at this step.
  void add_children(std::int32_t of) const {
    const std::int32_t first = node(of).first_child;
    for (std::int32_t i = first; first >= 0 && i < node_count() && node(i).parent == of; ++i)
      if (is_waiting(i)) list.boxes.push_back(tile(i, waiting_color(look.theme)));
  }

  void add_frame(std::int32_t i, Rgba color, float width_px, LabelRank rank) const {
    const DrawBox box = tile(i, color);
    DrawLines edges;
    edges.width_px = width_px;
    edges.shine_through = true;
    each_edge(box, [&](const Vec3f& from, const Vec3f& to) {
      edges.positions.push_back(from);
      edges.positions.push_back(to);
      edges.colors.push_back(color);
    });
    list.lines.push_back(std::move(edges));
    list.boxes.push_back(box);  // for picking
    // Below, because the name of its voxel is above.
    Vec3f foot = middle_of(box);
    for (const Vec3f& corner : box.corners) foot.z() = std::min(foot.z(), corner.z());
    list.labels.push_back({foot, "node " + std::to_string(i), color, 15, rank});
  }
};

void add_node_boxes(const StepState& state, DrawList& list) {
  const Boxes boxes{state, list};
  const StepLook& look = state.look;
  const HighlightColors highlights = highlight_colors(look.theme);
  const bool alone = look.isolated && (state.node >= 0 || look.node >= 0);
  if (look.show_settled && !alone) boxes.add_settled();
  if (look.show_queue && !alone) boxes.add_waiting();
  const bool selected = look.node >= 0 && state.run.timeline.queued_at()[look.node] <= look.step;
  if (state.node >= 0 && !look.show_queue) boxes.add_children(state.node);
  if (state.node >= 0 && state.node != look.node) {
    boxes.add_parents(state.node, highlights.current);
    boxes.add_frame(state.node, highlights.current, 3, kCurrentLabel);
  }
  if (selected) {
    boxes.add_parents(look.node, highlights.selected);
    boxes.add_frame(look.node, highlights.selected, look.node == state.node ? 5.0F : 3.0F,
                    kSelectedLabel);
  }
}

// ---- Planes of the trace at the step ----

/// Voxels of each plane at this step.
std::vector<std::vector<Vec3f>> points_by_plane(const StepState& state) {
  const std::vector<Vec3f>& points = state.run.subject->prepared.voxels.points;
  std::vector<std::vector<Vec3f>> own(state.run.timeline.plane_count());
  for (std::size_t v = 0; v < points.size(); ++v)
    if (state.plane_of[v] >= 0) own[state.plane_of[v]].push_back(points[v]);
  return own;
}

/// Analysis of the finished planes if this is the last step; null at other steps.
const PlaneScene* finished(const debug::Run& run, const StepLook& look) {
  return look.step == run.steps() ? look.planes.get() : nullptr;
}

/// Adds the outline or, without one, the convex hull of the voxels; returns false if it has
/// no area.
bool add_plane(const PlaneShape* shape,
               const PlaneFit& fit,
               std::span<const Vec3f> voxels,
               const ShapeLook& look,
               DrawList& list) {
  if (shape && !shape->rings.empty()) {
    add_shape(*shape, look, list);
    return true;
  }
  DrawPolygon hull;
  hull.corners = outline_on_plane(fit, voxels);
  if (hull.corners.size() < 3) return false;
  hull.fill = with_alpha(look.fill, look.fill.a / 2);
  hull.outline = with_alpha(look.line, look.line.a / 2);
  hull.outline_px = 0.6f * look.width_px;  // not pickable: much of it is empty
  list.polygons.push_back(std::move(hull));
  return true;
}

void add_planes(const StepState& state, DrawList& list) {
  const debug::Run& run = state.run;
  const StepLook& look = state.look;
  const std::vector<Vec3f>& points = run.subject->prepared.voxels.points;
  const float most_arrow_m = normal_arrow_m(points);
  const double size_m = run.subject->prepared.voxels.size_m;
  const auto voxel_m = static_cast<float>(size_m > 0 ? size_m : 0.02);  // approximate for pixels
  const Rgba ink = theme_colors(look.theme).ink;
  const Rgba selected_color = highlight_colors(look.theme).selected;
  const auto members = points_by_plane(state);
  const PlaneScene* shapes = finished(run, look);
  const bool any_stands_out = look.plane >= 0 || state.plane >= 0 || state.other >= 0;
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane) {
    const planes::PlaneChange* change = run.timeline.plane_at(plane, look.step);
    if (change == nullptr || !change->alive) continue;
    const auto& own = members[plane];
    const bool selected = plane == look.plane;
    const bool current = plane == state.plane || plane == state.other;
    const bool recedes = any_stands_out && !selected && !current;
    if (recedes && look.isolated) continue;
    const Rgba color = look.plane_color(plane);
    const Rgba strong = selected ? selected_color : mix(color, ink, 0.35);
    const auto k = static_cast<std::size_t>(run.timeline.result_of_plane(plane)) - 1;
    const PlaneShape* shape = shapes && k < shapes->shapes.size() ? &shapes->shapes[k] : nullptr;
    if (!add_plane(shape, change->fit, own,
                   {.fill = with_alpha(color, recedes ? 20 : 45),
                    .line = with_alpha(strong, recedes ? 100 : 235),
                    .width_px = selected || current ? 3.0F : 1.6F,
                    .id = pick_id(Picked::Kind::plane, plane)},
                   list))
      continue;

    // While planes grow, name the large ones; at the end name those of the result, unless names
    // would clutter the stairs.
    const bool among_stairs = shapes && look.show_stairs && shapes->has_stairs();
    const bool named =
        shapes ? run.timeline.result_of_plane(plane) > 0 : is_named(own.size(), points.size());
    if ((!named || among_stairs) && !selected && !current) continue;
    const Vec3f from = place_on_plane(change->fit.centroid, own, voxel_m);
    const double voxel_m2 = size_m > 0 ? size_m * size_m : planes::area_per_point(change->fit);
    const float arrow_m =
        std::clamp(0.5F * static_cast<float>(std::sqrt(voxel_m2 * static_cast<double>(own.size()))),
                   most_arrow_m / 3, most_arrow_m);
    // Toward the viewer: up, or to the sensor's side.
    const Vec3f normal = planes::outward_normal(change->fit, run.timeline.label_of_plane(plane),
                                                run.subject->prepared.sensor())
                             .cast<float>();
    if (look.show_normals)
      list.arrows.push_back({from, from + arrow_m * normal, strong, selected ? 3.5F : 2.5F});
    if (!look.show_names && !selected && !current) continue;
    const std::int32_t rank = selected  ? kSelectedLabel
                              : current ? kCurrentLabel
                                        : plane_label_rank(own.size(), points.size());
    list.labels.push_back({from + (look.show_normals ? 1.35F * arrow_m : 0.0F) * normal,
                           debug::plane_name(run, plane), selected ? selected_color : ink,
                           selected ? 19.0F : 16.0F, rank});
  }
}

// ---- Legend ----

using Symbol = LegendEntry::Symbol;

/// Legend entries for a step.
struct Legend {
  const StepState& state;
  DrawList& list;
  const debug::Run& run = state.run;
  const StepLook& look = state.look;
  Rgba waiting = highlight_colors(look.theme).waiting;

  void add(Rgba color, const std::string& text, Symbol mark = Symbol::dot) const {
    list.explain(color, text, mark);
  }
  void add(Rgba color,
           const std::string& text,
           std::ptrdiff_t count,
           Symbol mark = Symbol::dot) const {
    add(color, text + "  " + std::to_string(count), mark);
  }

  void add_cases() const {
    std::size_t count[5] = {};
    std::ptrdiff_t hatched = 0, queued = 0;
    for (std::size_t i = 0; i < run.octree().nodes.size(); ++i) {
      const planes::OctreeNode& node = run.octree().nodes[i];
      if (run.timeline.decided_at()[i] <= look.step) {
        ++count[static_cast<int>(node.decided)];
        hatched += node.at_max_depth;
      } else {
        queued += run.timeline.queued_at()[i] <= look.step;
      }
    }
    add_case_legend(count, run.is_on_image(), list);
    if (hatched > 0)
      add(case_color(planes::Case::III), "at the deepest level: unassigned", hatched,
          Symbol::hatched_box);
    if (queued > 0) add(waiting, "queued", queued);
  }

  void add_plane_states() const {
    const auto left = std::ranges::count(state.plane_of, StepState::kLeftover);
    const auto open = std::ranges::count(state.plane_of, StepState::kOpen);
    if (left > 0) add(leftover_color(), "unassigned", left);
    if (open > 0) add(waiting, "not visited yet", open);
  }

  /// Reason why foot verdicts are missing; empty if available.
  std::string no_verdicts() const {
    if (look.step != run.steps()) return "available at the last step";
    if (!look.planes || !look.planes->complete) return "computing …";
    return look.planes->foot.empty() && !look.planes->shapes.empty() ? "no foot: set foot_radius_m"
                                                                     : "";
  }

  void add_verdicts() const {
    if (const std::string why = no_verdicts(); !why.empty()) return add(waiting, why);
    const std::vector<bool>& steppable = look.planes->steppable;
    const auto yes = std::ranges::count(steppable, true);
    add(verdict_color(true), "steppable", yes);
    add(verdict_color(false), "not steppable", std::ssize(steppable) - yes, Symbol::hatched_box);
    add(leftover_color(), "unassigned");
  }

  void add_colors() const {
    switch (effective_color_by(run, look.color_by)) {
      case ColorBy::cases:
        return add_cases();
      case ColorBy::planes:
        return add_plane_states();
      case ColorBy::labels:
        if (!run.subject->prepared.gravity.known())
          return add(label_color(Label::unknown), "no class: gravity is unknown");
        add(label_color(Label::h), "horizontal");
        add(label_color(Label::v), "vertical");
        if (!run.is_ours()) add(label_color(Label::unknown), "unassigned");
        return;
      case ColorBy::margins:
        add(margin_color(Label::h, 1), "horizontal, sure");
        add(margin_color(Label::v, 1), "vertical, sure");
        return add(margin_color(Label::h, 0), "unsure");
      case ColorBy::truth:
        if (!run.subject->voxel_truth.known())
          return add(waiting, "this frame has no ground truth");
        add(leftover_color(), "in no true plane");
        return add(waiting, "not scored");
      case ColorBy::steppable:
        return add_verdicts();
      default:  // the camera needs no legend; scales have their own bar
        return;
    }
  }

  void add_all() const {
    add_colors();
    const PlaneScene* planes = finished(run, look);
    if (look.show_stairs && planes && planes->complete && !planes->has_stairs())
      add(waiting,
          run.subject->prepared.gravity.known() ? "no stairs, kerb, or ramp"
                                                : "stairs need gravity, which is unknown",
          Symbol::line);
    if (look.show_foot && look.color_by != ColorBy::steppable)
      if (const std::string why = no_verdicts(); !why.empty())
        add(waiting, "foot space: " + why, Symbol::line);
    if (!look.marked.empty())
      add(highlight_colors(look.theme).marked, "marked", std::ssize(look.marked));
  }
};

// ---- Whole scene ----

/// Adds an enlarged voxel, to make it visible among its neighbors.
void add_voxel(
    const debug::Run& run, std::int32_t voxel, Rgba color, LabelRank rank, DrawList& list) {
  if (voxel < 0) return;
  const Vec3f at = run.subject->prepared.voxels.points[voxel];
  DrawPoints dot = voxel_points(planes::VoxelCloud{});
  dot.positions = {at};
  dot.colors = {color};
  dot.ids = {pick_id(Picked::Kind::voxel, voxel)};
  dot.min_px = 14;
  list.points.push_back(std::move(dot));
  const auto above = static_cast<float>(1.5 * run.subject->prepared.voxels.size_m + 0.01);
  list.labels.push_back({at + Vec3f(0, 0, above), debug::point_name(run, voxel), color, 15, rank});
}

void keep_only(const std::vector<std::uint8_t>& kept, DrawPoints& points) {
  const auto keep = [&](auto& values) {
    std::size_t v = 0;
    std::erase_if(values, [&](const auto&) { return !kept[v++]; });
  };
  keep(points.positions);
  keep(points.colors);
  keep(points.ids);
}

}  // namespace

Picked picked(std::uint32_t id) {
  const auto kind = static_cast<Picked::Kind>(id >> kKindShift);
  if (kind == Picked::Kind::nothing) return {};
  return {kind, static_cast<std::int32_t>(id & kIndexMask)};
}

DrawList scene_step(const debug::Run& run, const StepLook& look) {
  const StepState state = step_state(run, look);
  const HighlightColors highlights = highlight_colors(look.theme);
  DrawList list;
  list.pick_points_first = true;
  DrawPoints points = voxel_points(run.subject->prepared.voxels);
  points.colors = voxel_colors(state);
  // Lightness highlights the voxels of the step; hue shows the colors.
  constexpr double kReceded = 0.45;
  const std::vector<std::uint8_t> concerned = concerned_voxels(state);
  for (std::size_t v = 0; v < concerned.size(); ++v)
    if (!concerned[v])
      points.colors[v] =
          mix(points.colors[v], theme_colors(look.theme).background_bottom, kReceded);
  points.ids.resize(points.positions.size());
  std::iota(points.ids.begin(), points.ids.end(), pick_id(Picked::Kind::voxel, 0));
  const bool alone = look.isolated && !concerned.empty();
  if (alone) keep_only(concerned, points);
  points.size_m *= static_cast<float>(look.point_size);
  points.max_px = 120;  // keeps surfaces closed at close range
  if (look.show_points) list.points.push_back(std::move(points));
  add_node_boxes(state, list);
  if (look.show_planes) add_planes(state, list);
  if (const PlaneScene* planes = finished(run, look)) {
    if (look.show_foot && !alone) add_foot_space(*planes, look.theme, list);
    if (look.show_stairs && !alone) add_stairs(*planes, look.theme, list);
  }
  if (look.map && !alone) list.lines.insert(list.lines.end(), look.map->begin(), look.map->end());
  if (state.voxel != look.voxel)
    add_voxel(run, state.voxel, highlights.current, kCurrentLabel, list);
  add_voxel(run, look.voxel, highlights.selected, kSelectedLabel, list);
  Legend{state, list}.add_all();
  return list;
}

std::vector<Vec3f> node_points(const debug::Run& run, std::int32_t node) {
  std::vector<Vec3f> points;
  for (const std::uint32_t voxel : members(run.octree(), run.octree().nodes[node]))
    points.push_back(run.subject->prepared.voxels.points[voxel]);
  return points;
}

std::vector<Vec3f> plane_points(const debug::Run& run, std::int32_t plane, std::int32_t step) {
  const std::vector<Vec3f>& all = run.subject->prepared.voxels.points;
  std::vector<Vec3f> points;
  for (std::size_t v = 0; v < all.size(); ++v)
    if (run.timeline.point_at(static_cast<std::int32_t>(v), step).plane == plane)
      points.push_back(all[v]);
  return points;
}

}  // namespace planescope::render
