// The octree's nodes as they stand at a step.

#include <algorithm>
#include <string>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/step_parts.hpp"
#include "render/theme.hpp"

namespace planescope::render {
namespace {

// A traversal to the leaves makes thousands of nodes. Children come after their parents, so the
// first of a kind are the largest; the small ones show by their voxels' colour.
constexpr std::size_t kMostSettled = 250;
constexpr std::size_t kMostWaiting = 120;
constexpr std::size_t kMostNumerals = 60;

struct Boxes {
  const debug::Run& run;
  const StepLook& look;
  const StepState& state;
  DrawList& list;

  const planes::OctreeNode& node(std::int32_t i) const {
    return run.octree().nodes[static_cast<std::size_t>(i)];
  }
  /// The part of its cell that holds its points.
  DrawBox tile(std::int32_t i) const {
    DrawBox box = points_box(run.octree(), node(i), run.subject->prepared.voxels.size_m);
    box.id = pick_id(Picked::Kind::node, i);
    return box;
  }
  void add_settled() const;
  void add_waiting() const;
  void add_numerals(const std::vector<std::int32_t>& settled) const;
  void add_parents(std::int32_t of, Rgba color) const;
  void add_frame(std::int32_t i, Rgba color, float width_px, const std::string& text) const;
};

void Boxes::add_settled() const {
  const bool by_case = look.color_by == ColorBy::cases;
  std::vector<std::int32_t> settled;
  const auto n = static_cast<std::int32_t>(run.octree().nodes.size());
  for (std::int32_t i = 0; i < n && settled.size() < kMostSettled; ++i)
    if (is_settled_leaf(run, i, look.step)) settled.push_back(i);
  for (const std::int32_t i : settled) {
    DrawBox box = tile(i);
    box.color = case_color(node(i).decided);
    if (!by_case)
      box.color.a = 110;  // outlines alone: a tint would spoil the colours that were asked for
    else
      box.style = node(i).at_max_depth ? BoxStyle::hatched : BoxStyle::tinted;
    list.boxes.push_back(box);
  }
  if (by_case) add_numerals(settled);
}

/// Numerals on the largest, so that cases need not be told by colour alone.
void Boxes::add_numerals(const std::vector<std::int32_t>& settled) const {
  const planes::Octree& octree = run.octree();
  const double least_edge_m = 0.05 * robust_bounds(run.subject->prepared.voxels.points).diagonal();
  std::size_t count = 0;
  for (const std::int32_t i : settled) {
    if (octree.node_edge_m(node(i)) < least_edge_m || ++count > kMostNumerals) return;
    const DrawBox box = tile(i);
    list.labels.push_back(
        {(box.min + box.max) / 2,
         std::string(planes::to_string(node(i).decided)) + (node(i).impure_fit ? "*" : ""),
         theme_colors(look.theme).ink, 15, true, true});
  }
}

/// The head of the queue.
void Boxes::add_waiting() const {
  Rgba color = theme_colors(look.theme).muted;
  color.a = 90;
  const auto n = static_cast<std::int32_t>(run.octree().nodes.size());
  std::size_t count = 0;
  for (std::int32_t i = 0; i < n && count < kMostWaiting; ++i) {
    if (run.timeline.node_state(i, look.step) != debug::NodeState::queued) continue;
    DrawBox box = tile(i);
    box.color = color;
    list.boxes.push_back(box);
    ++count;
  }
}

/// The nearest cells that the node lies in, so that its place in the tree is seen.
void Boxes::add_parents(std::int32_t of, Rgba color) const {
  color.a = 45;
  std::int32_t i = node(of).parent;
  for (int levels = 3; levels > 0 && i >= 0; --levels, i = node(i).parent) {
    DrawBox box = cell_box(run.octree(), node(i));
    box.color = color;
    list.boxes.push_back(box);
  }
}

void Boxes::add_frame(std::int32_t i, Rgba color, float width_px, const std::string& text) const {
  DrawBox box = tile(i);
  DrawLines edges;
  edges.width_px = width_px;
  edges.shine_through = true;
  each_edge(box, [&](const Vec3f& from, const Vec3f& to) {
    edges.positions.push_back(from);
    edges.positions.push_back(to);
    edges.colors.push_back(color);
  });
  list.lines.push_back(std::move(edges));
  box.color = color;
  list.boxes.push_back(box);  // to be picked by
  // Below: above it stands the name of its voxel.
  const Vec3f foot((box.min.x() + box.max.x()) / 2, (box.min.y() + box.max.y()) / 2, box.min.z());
  list.labels.push_back({foot, text, color, 15, true});
}

}  // namespace

void add_node_boxes(const debug::Run& run,
                    const StepLook& look,
                    const StepState& state,
                    DrawList& list) {
  const Boxes boxes{run, look, state, list};
  const MarkColors marks = mark_colors(look.theme);
  if (look.show_settled) boxes.add_settled();
  if (look.show_queue) boxes.add_waiting();
  const bool selected = look.node >= 0 && run.timeline.queued_at()[look.node] <= look.step;
  const auto name = [](std::int32_t node) { return "node " + std::to_string(node); };
  if (state.node >= 0 && state.node != look.node) {
    boxes.add_parents(state.node, marks.current);
    boxes.add_frame(state.node, marks.current, 3, name(state.node));
  }
  if (selected) {
    boxes.add_parents(look.node, marks.selected);
    boxes.add_frame(look.node, marks.selected, look.node == state.node ? 5.0F : 3.0F,
                    name(look.node));
  }
}

}  // namespace planescope::render
