// The octree at the cursor as a tree; settled subtrees are folded.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

// ---- Node shapes -------------------------------------------------------------------------------

// As in Gist's search trees, both shape and color show the outcome of a node: circles were divided,
// squares are dead ends, diamonds are planes.

struct NodeShape {
  debug::NodeState state = debug::NodeState::queued;
  planes::Case decided = planes::Case::none;  // if settled
  bool at_max_depth = false;                  // hatched: its points became leftovers
  bool by_label = false;                      // a dot: fitted per label
};

/// Draws a regular polygon; its first corner is at `turn` of a full turn from the right.
void polygon(ImDrawList* draw, ImVec2 center, float radius, int corners, float turn, ImU32 color) {
  for (int i = 0; i < corners; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> *
                        (turn + static_cast<float>(i) / static_cast<float>(corners));
    draw->PathLineTo(
        ImVec2(center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)));
  }
  draw->PathFillConvex(color);
}

void fill_case(ImDrawList* draw, ImVec2 center, float radius, planes::Case decided, ImU32 color) {
  using planes::Case;
  if (decided == Case::I) draw->AddCircleFilled(center, radius, color, 20);
  if (decided == Case::II) polygon(draw, center, radius * 1.15f, 4, 0.125f, color);
  if (decided == Case::III) polygon(draw, center, radius * 1.1f, 6, 0, color);
  if (decided == Case::IV) polygon(draw, center, radius * 1.2f, 4, 0, color);
}

void hatch(const Ui& ui, ImDrawList* draw, ImVec2 c, float r) {
  for (const float shift : {-0.55f, 0.0f, 0.55f})
    draw->AddLine(ImVec2(c.x + (shift - 0.6f) * r, c.y + (shift + 0.6f) * r),
                  ImVec2(c.x + (shift + 0.6f) * r, c.y + (shift - 0.6f) * r), ui.colors.panel,
                  ui.px(1.4f));
}

void draw_node_shape(const Ui& ui, ImVec2 center, float radius, const NodeShape& shape) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  if (shape.state == debug::NodeState::queued) {
    draw->AddCircle(center, radius * 0.85f, ui.colors.muted, 20, ui.px(1.3f));
  } else if (shape.state == debug::NodeState::visited) {
    draw->AddCircle(center, radius * 0.85f, ui.colors.accent, 20, ui.px(2));
    draw->AddCircleFilled(center, radius * 0.4f, ui.colors.accent, 12);
  } else if (shape.state == debug::NodeState::settled) {
    fill_case(draw, center, radius, shape.decided, to_imgui(render::case_color(shape.decided)));
    if (shape.at_max_depth) hatch(ui, draw, center, radius);
    if (shape.by_label) draw->AddCircleFilled(center, radius * 0.4f, ui.colors.panel, 10);
  }
}

/// Legend of the shapes in one line.
void draw_shape_key(const Ui& ui, bool on_image) {
  struct Entry {
    NodeShape shape;
    const char* name;
    const char* meaning;
  };
  const debug::NodeState settled = debug::NodeState::settled;
  std::vector<Entry> entries = {
      {{debug::NodeState::queued}, "queued", "In the queue Q_N"},
      {{settled, planes::Case::I},
       "I",
       on_image ? "case I, more than one plane: divided" : "case I, impure: divided"},
      {{settled, planes::Case::II},
       "II",
       on_image ? "case II, too few of its pixels: divided"
                : "case II, too few inliers: dead end, its points are unassigned"},
      {{settled, planes::Case::III},
       "III",
       on_image ? "case III, not flat: divided" : "case III, not planar: divided"},
      {{settled, planes::Case::IV}, "IV", "case IV: a plane candidate"},
      {{settled, planes::Case::III, true}, "deepest", "I or III at the deepest level: unassigned"},
      {{settled, planes::Case::I, false, true},
       "labels",
       "each label's points were fitted separately instead of dividing the node"},
  };
  if (on_image) entries.pop_back();
  const float line = ImGui::GetTextLineHeight();
  bool first = true;
  for (const Entry& entry : entries) {
    const float width = line + ImGui::CalcTextSize(entry.name).x + ui.px(2);
    if (!first && !same_line_if_room(width, ui.px(9)))
      return;  // a narrow panel shows only the first ones
    first = false;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy(ImVec2(width, line));
    tooltip(entry.meaning);
    draw_node_shape(ui, ImVec2(at.x + line * 0.4f, at.y + line * 0.5f), line * 0.34f, entry.shape);
    ImGui::GetWindowDrawList()->AddText(ImVec2(at.x + line, at.y), ui.colors.muted, entry.name);
  }
}

// ---- Rows --------------------------------------------------------------------------------------

const planes::OctreeNode& node_of(const debug::Run& run, std::int32_t node) {
  return run.octree().nodes[static_cast<std::size_t>(node)];
}

/// The deciding quantity: "N_out 12", "e_n 0.0071"; on a depth image "cost 3.1", "40 % filled".
std::string reason_of(const debug::Run& run, std::int32_t node) {
  const debug::NodeFacts& facts = run.facts[static_cast<std::size_t>(node)];
  const bool on_image = run.is_on_image();
  switch (node_of(run, node).decided) {
    case planes::Case::none:
      break;
    case planes::Case::I:
      if (!on_image) return fmt::format("N_out {}", facts.purity.n_out);
      return facts.e_n >= planes::kNotFlat ? "not flat inside"
                                           : fmt::format("cost {:.3g}", facts.e_n);
    case planes::Case::II:
      return on_image ? fmt::format("{:.0f} % filled", 100 * facts.e_n)
                      : fmt::format("N_in {}", facts.purity.n_in);
    case planes::Case::III:
    case planes::Case::IV:
      if (on_image) return fmt::format("variance {:.2g}", facts.e_n);
      return run.segment_options.by_objective() ? "RMS " + length_text(facts.e_n)
                                                : fmt::format("e_n {:.2g}", facts.e_n);
  }
  return {};
}

/// Draws the cases of the nodes below a folded one as fractions of a bar.
void draw_subtree_bar(const Ui& ui, ImVec2 at, const SubtreeCounts& counts) {
  std::uint32_t all = 0;
  for (const std::uint32_t count : counts) all += count;
  if (all == 0) return;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float width = ui.px(36), height = ui.px(7);
  const float top = at.y + (ImGui::GetTextLineHeight() - height) / 2;
  float x = at.x;
  for (const std::size_t c : {4u, 1u, 3u, 2u, 0u}) {
    const float share = width * static_cast<float>(counts[c]) / static_cast<float>(all);
    const ImU32 color =
        c == 0 ? ui.colors.muted : to_imgui(render::case_color(static_cast<planes::Case>(c)));
    draw->AddRectFilled(ImVec2(x, top), ImVec2(x + share, top + height), color);
    x += share;
  }
  draw->AddText(ImVec2(at.x + width + ui.px(6), at.y), ui.colors.muted,
                fmt::format("+{}", all).c_str());
}

void draw_tooltip(const debug::Run& run, std::int32_t step, std::int32_t node) {
  const std::int32_t decided = run.timeline.decided_at()[static_cast<std::size_t>(node)];
  const planes::OctreeNode& n = node_of(run, node);
  const std::string text = decided <= step ? debug::describe_event(run, decided)
                                           : fmt::format("node {} (depth {}): {} points, undecided",
                                                         node, n.depth, n.size());
  std::string below;
  if (n.first_child >= 0) below = "\nBar: decisions of the nodes below, + their number";
  ImGui::SetTooltip("%s\ncell of %s; double-click: its decision%s", text.c_str(),
                    planes::cell_size_text(run.octree(), n.depth).c_str(), below.c_str());
}

/// Draws the triangle that opens and closes a node, and handles its clicks.
void draw_fold(const Ui& ui, const OctreeRow& row, ImVec2 center, bool clicked) {
  const float r = ui.px(4);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  if (row.open)
    draw->AddTriangleFilled(ImVec2(center.x - r, center.y - r * 0.6f),
                            ImVec2(center.x + r, center.y - r * 0.6f),
                            ImVec2(center.x, center.y + r), ui.colors.muted);
  else
    draw->AddTriangleFilled(ImVec2(center.x - r * 0.6f, center.y - r),
                            ImVec2(center.x + r, center.y),
                            ImVec2(center.x - r * 0.6f, center.y + r), ui.colors.muted);
  if (clicked) ui.memory.octree_open[row.node] = !row.open;
}

void draw_row(const Ui& ui, const debug::Run& run, const OctreeRow& row) {
  const std::int32_t step = ui.state.view.step;
  const planes::OctreeNode& node = node_of(run, row.node);
  const float line = ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::PushID(row.node);
  const bool clicked = ImGui::Selectable("##node", row.node == ui.state.view.selected.node,
                                         ImGuiSelectableFlags_AllowDoubleClick, ImVec2(0, line));
  ImGui::PopID();
  const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
  const float left = at.x + static_cast<float>(row.indent) * ui.px(10) + ui.px(3);
  const float fold_end = left + line;
  ui.name(fmt::format("octree.node.{}", row.node), ImVec2(fold_end, min.y), max);
  const bool on_fold = row.has_children && ImGui::GetIO().MousePos.x < fold_end;
  if (clicked && !on_fold) {
    ui.act("select.node", row.node);
    if (ImGui::IsMouseDoubleClicked(0)) ui.act("step.decision");
  }
  if (ImGui::IsItemHovered() && !on_fold) draw_tooltip(run, step, row.node);
  if (row.has_children) {
    ui.name(fmt::format("octree.fold.{}", row.node), ImVec2(left, min.y), ImVec2(fold_end, max.y));
    draw_fold(ui, row, ImVec2(left + line * 0.4f, at.y + line * 0.5f), clicked && on_fold);
  }

  const debug::NodeState state = run.timeline.node_state(row.node, step);
  const bool settled = state == debug::NodeState::settled;
  draw_node_shape(ui, ImVec2(fold_end + line * 0.45f, at.y + line * 0.5f), line * 0.38f,
                  {state, node.decided, node.at_max_depth, node.by_label});
  ImDrawList* draw = ImGui::GetWindowDrawList();
  float x = fold_end + line * 1.15f;
  const auto write = [&](const std::string& text, ImU32 color, float room) {
    draw_math(ui, draw, ImVec2(x, at.y), color, text);
    x += std::max(ui.px(room), math_width(ui, text) + ui.px(8));
  };
  write(settled                             ? planes::to_string(node.decided)
        : state == debug::NodeState::queued ? "–"
                                            : "?",
        ui.colors.text, 24);
  write(std::to_string(row.node), ui.colors.text, 36);
  write(fmt::format("{} pts", node.size()), ui.colors.muted, 66);
  if (row.has_children && !row.open)
    draw_subtree_bar(ui, ImVec2(x, at.y), count_subtree(run, step, row.node));
  else if (settled)
    write(reason_of(run, row.node), ui.colors.muted, 0);
}

/// Unfolds and scrolls to a node that was selected elsewhere.
bool follow_selection(const Ui& ui, const debug::Run& run) {
  const std::int32_t selected = ui.state.view.selected.node;
  if (ui.memory.octree_scrolled_to == selected) return false;
  ui.memory.octree_scrolled_to = selected;
  if (selected < 0 || selected >= static_cast<std::int32_t>(run.octree().nodes.size()))
    return false;
  for (std::int32_t n = node_of(run, selected).parent; n >= 0; n = node_of(run, n).parent)
    ui.memory.octree_open.erase(n);
  return true;
}

void draw_rows(const Ui& ui,
               const debug::Run& run,
               const std::vector<OctreeRow>& rows,
               bool follow) {
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, ui.px(3)));
  const float row_height = ImGui::GetTextLineHeightWithSpacing();
  if (follow) {
    const auto at = std::find_if(rows.begin(), rows.end(), [&](const OctreeRow& row) {
      return row.node == ui.state.view.selected.node;
    });
    if (at != rows.end()) scroll_to_row(static_cast<int>(at - rows.begin()), row_height);
  }
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()), row_height);
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
      draw_row(ui, run, rows[static_cast<std::size_t>(i)]);
  ImGui::PopStyleVar();
}

}  // namespace

void draw_octree(const Ui& ui) {
  const ViewState& view = ui.state.view;
  const debug::Run* run = ui.state.run();
  if (run && !run->is_ours())
    return paragraph(ui.colors.muted, fmt::format("Method {} has no octree.",
                                                  planes::to_string(run->options.method)));
  const bool searching = view.octree_search.find_first_not_of(' ') != std::string::npos;
  const bool follow = run && follow_selection(ui, *run);
  debug::FilterProblem problem;
  std::vector<OctreeRow> rows;
  if (run)
    rows = searching ? octree_matches(*run, view.step, view.octree_search, problem)
                     : octree_rows(*run, view.step, view.selected.node, ui.memory.octree_open);
  draw_filter_box(ui,
                  {.widget = "octree.search",
                   .hint = "find: 41, case==III",
                   .text = view.octree_search,
                   .problem = &problem,
                   .action = "octree.search",
                   .on_enter = {}},
                  ImGui::GetContentRegionAvail().x);
  if (!run) return paragraph(ui.colors.muted, "Octree of the frame");
  if (!problem.message.empty()) {
    colored(ui.colors.bad, problem.message);
  } else {
    draw_shape_key(ui, run->is_on_image());
  }
  ImGui::BeginChild("##octree");
  draw_rows(ui, *run, rows, follow);
  if (searching && rows.empty()) ImGui::TextDisabled("No matching node");
  ImGui::EndChild();
}

}  // namespace planescope::desktop
