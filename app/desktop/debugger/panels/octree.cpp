// The octree as a tree: what of it is there at the cursor, folded where it is settled.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/debugger/filter_box.hpp"
#include "app/desktop/debugger/octree_rows.hpp"
#include "app/desktop/debugger/panels/node_shapes.hpp"
#include "app/desktop/math_text.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

const planes::OctreeNode& node_of(const debug::Run& run, std::int32_t node) {
  return run.octree().nodes[static_cast<std::size_t>(node)];
}

/// By what it was settled: "N_out 12", "e_n 0.0071".
std::string reason_of(const debug::Run& run, std::int32_t node) {
  const debug::NodeFacts& facts = run.facts[static_cast<std::size_t>(node)];
  switch (node_of(run, node).decided) {
    case planes::Case::none:
      return {};
    case planes::Case::I:
      return fmt::format("N_out {}", facts.purity.n_out);
    case planes::Case::II:
      return fmt::format("N_in {}", facts.purity.n_in);
    case planes::Case::III:
    case planes::Case::IV:
      return run.segment_options.noise.rms_criterion3 ? "RMS " + length_text_cm(facts.e_n)
                                                      : fmt::format("e_n {:.2g}", facts.e_n);
  }
  return {};
}

/// How the nodes below a folded one were settled, as shares of a bar.
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
  const std::string text =
      decided <= step
          ? debug::describe_event(run, decided)
          : fmt::format("node {} (depth {}): {} points, not settled yet", node, n.depth, n.size());
  std::string below;
  if (n.first_child >= 0) below = "\nbar: how the nodes below it were settled, + how many";
  ImGui::SetTooltip("%s\ncell of %s; double click: to its decision%s", text.c_str(),
                    length_text_cm(run.octree().node_edge_m(n)).c_str(), below.c_str());
}

/// The triangle that opens and closes a node; takes the clicks on it.
void draw_fold(const Ui& ui, const OctreeRow& row, ImVec2 centre, bool clicked) {
  const float r = ui.px(4);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  if (row.open)
    draw->AddTriangleFilled(ImVec2(centre.x - r, centre.y - r * 0.6f),
                            ImVec2(centre.x + r, centre.y - r * 0.6f),
                            ImVec2(centre.x, centre.y + r), ui.colors.muted);
  else
    draw->AddTriangleFilled(ImVec2(centre.x - r * 0.6f, centre.y - r),
                            ImVec2(centre.x + r, centre.y),
                            ImVec2(centre.x - r * 0.6f, centre.y + r), ui.colors.muted);
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
    ui.emit("select.node", std::to_string(row.node));
    if (ImGui::IsMouseDoubleClicked(0)) ui.emit("step.decision");
  }
  if (ImGui::IsItemHovered() && !on_fold) draw_tooltip(run, step, row.node);
  if (row.has_children) {
    ui.name(fmt::format("octree.fold.{}", row.node), ImVec2(left, min.y), ImVec2(fold_end, max.y));
    draw_fold(ui, row, ImVec2(left + line * 0.4f, at.y + line * 0.5f), clicked && on_fold);
  }

  const debug::NodeState state = run.timeline.node_state(row.node, step);
  const bool settled = state == debug::NodeState::settled;
  draw_node_shape(ui, ImVec2(fold_end + line * 0.45f, at.y + line * 0.5f), line * 0.38f,
                  {state, node.decided, node.at_max_depth, node.impure_fit});
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

/// A node that was selected elsewhere is unfolded and scrolled to.
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

void scroll_to(int row, float row_height) {
  const float top = static_cast<float>(row) * row_height;
  const float height = ImGui::GetWindowHeight();
  if (top < ImGui::GetScrollY() || top + row_height > ImGui::GetScrollY() + height)
    ImGui::SetScrollY(std::max(0.0f, top - height * 0.4f));
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
    if (at != rows.end()) scroll_to(static_cast<int>(at - rows.begin()), row_height);
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
  if (!run) return paragraph(ui.colors.muted, "The nodes of a frame's octree come here.");
  if (!problem.message.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, ui.colors.bad);
    ImGui::TextUnformatted(problem.message.c_str());
    ImGui::PopStyleColor();
  } else {
    draw_shape_key(ui);
  }
  ImGui::BeginChild("##octree");
  draw_rows(ui, *run, rows, follow);
  if (searching && rows.empty()) ImGui::TextDisabled("No node so far.");
  ImGui::EndChild();
}

}  // namespace planescope::desktop
