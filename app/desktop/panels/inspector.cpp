// Why: every criterion of the selected node, every term of the merge and every distance of the
// leftover point that the cursor is on.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/check_table.hpp"
#include "app/desktop/panels.hpp"
#include "core/explain/explain.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kMostPartners = 5;

void link_to_step(const Ui& ui, const std::string& text, std::int32_t step) {
  ImGui::PushStyleColor(ImGuiCol_Text, ui.colors.accent);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
  if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  if (ImGui::IsItemClicked()) ui.emit("step.goto", std::to_string(step));
}

std::string vector_text(const Vec3d& v) {
  return fmt::format("{:.3f}  {:.3f}  {:.3f}", v.x(), v.y(), v.z());
}

void fact(const Ui& ui, const char* what, const std::string& value) {
  ImGui::TextDisabled("%s", what);
  ImGui::SameLine(ui.px(110));
  ImGui::TextUnformatted(value.c_str());
}

void draw_fit(const Ui& ui, const PlaneFit& fit) {
  if (fit.count < 3) return;
  fact(ui, "normal", vector_text(fit.normal));
  fact(ui, "eigenvalues",
       fmt::format("{:.3g}  {:.3g}  {:.3g} m²", fit.eigenvalues[0], fit.eigenvalues[1],
                   fit.eigenvalues[2]));
  fact(ui, "RMS", length_text_cm(fit.rms_m()));
}

void draw_node(const Ui& ui, const Run& run, std::int32_t index) {
  const Octree& octree = run.octree();
  const OctreeNode& node = octree.nodes[static_cast<std::size_t>(index)];
  const std::int32_t step = ui.state.view.step;
  const NodeState now = run.timeline.node_state(index, step);
  const NodeFacts& facts = run.facts[static_cast<std::size_t>(index)];
  const std::int32_t decided = run.timeline.decided_at()[static_cast<std::size_t>(index)];

  if (now == NodeState::settled) {
    case_badge(ui, node.decided);
    ImGui::SameLine();
  }
  ImGui::PushFont(ui.bold);
  ImGui::Text("Node %d", index);
  ImGui::PopFont();
  ImGui::SameLine();
  ImGui::TextDisabled("depth %d, cell %s", node.depth,
                      length_text_cm(octree.node_edge_m(node)).c_str());
  if (node.parent >= 0) {
    ImGui::SameLine();
    if (ImGui::SmallButton("parent")) ui.emit("select.parent");
    ui.name("inspector.parent");
  }
  fact(ui, "points",
       fmt::format("{}: {} h, {} v", node.size(), node.count_h, node.size() - node.count_h));
  fact(ui, "inliers",
       fmt::format("{} {}, {} outliers", facts.purity.n_in,
                   facts.purity.inlier == Label::h ? "h" : "v", facts.purity.n_out));
  if (facts.truth_planes > 0)
    fact(ui, "truth",
         fmt::format("{} of them on true plane {}{}", facts.truth_points, facts.truth_plane,
                     facts.truth_planes > 1
                         ? fmt::format(", others on {} more", facts.truth_planes - 1)
                         : ""));
  if (now != NodeState::settled) {
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(ui.colors.warning), "%s",
                       now == NodeState::unborn   ? "not there yet at this step"
                       : now == NodeState::queued ? "waits in the queue"
                                                  : "dequeued, not decided yet");
    if (decided != kNever) {
      ImGui::SameLine();
      link_to_step(ui, fmt::format("to its decision, step {}", decided), decided);
      ui.name("inspector.decision");
    }
    return;
  }
  const NodeReport report = explain_node(run, index);
  ImGui::Spacing();
  draw_checks(ui, "node", report.checks);
  ImGui::PushStyleColor(ImGuiCol_Text, ui.colors.muted);
  ImGui::TextWrapped("%s", report.stopped.c_str());
  ImGui::PopStyleColor();
  if (std::any_of(report.checks.begin(), report.checks.end(), [](const Check& c) {
        return c.criterion == "PCA" && c.verdict != Verdict::not_asked;
      }))
    draw_fit(ui, facts.fit);
  ImGui::TextWrapped("%s", report.outcome.c_str());
  for (const std::int32_t later : report.outcome_steps) {
    if (later <= step && later == step) continue;
    link_to_step(ui, fmt::format("step {}: {}", later, describe_event(run, later)), later);
  }
}

void draw_partner(const Ui& ui, const PartnerReport& partner, std::int32_t result) {
  const std::string state = partner.chosen        ? "joined"
                            : partner.never_asked ? "not asked, a partner had been found"
                            : partner.coplanar    ? "coplanar too, but not the best"
                                                  : "not coplanar";
  ImGui::PushStyleColor(ImGuiCol_Text, partner.chosen ? ui.colors.good : ui.colors.text);
  const bool open =
      ImGui::TreeNodeEx(fmt::format("P{}", partner.plane + 1).c_str(),
                        partner.chosen ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None,
                        "%s: %s%s", plane_name(partner.plane).c_str(), state.c_str(),
                        result > 0 ? fmt::format(" (plane {} of the result)", result).c_str() : "");
  ui.name("inspector.partner." + plane_name(partner.plane));
  ImGui::PopStyleColor();
  if (!open) return;
  draw_checks(ui, plane_name(partner.plane), partner.checks);
  ImGui::TreePop();
}

void draw_merge(const Ui& ui, const Run& run, std::int32_t step) {
  const MergeReport report = explain_merge(run, step);
  if (report.partners.empty() && report.outcome.empty()) return;
  ImGui::Separator();
  ImGui::PushFont(ui.bold);
  ImGui::TextUnformatted("Merging");
  ImGui::PopFont();
  ImGui::TextWrapped("%s", report.outcome.c_str());
  fact(ui, "candidate",
       fmt::format("{} points {}{}", report.points, report.label == Label::v ? "v" : "h",
                   report.node >= 0 ? fmt::format(" of node {}", report.node) : ""));
  draw_fit(ui, report.candidate);
  const std::size_t shown = std::min(kMostPartners, report.partners.size());
  for (std::size_t i = 0; i < shown; ++i)
    draw_partner(ui, report.partners[i], run.timeline.result_of_plane(report.partners[i].plane));
  if (shown < report.partners.size())
    ImGui::TextDisabled("and %zu planes farther off", report.partners.size() - shown);
}

void draw_leftover(const Ui& ui, const Run& run, std::int32_t step) {
  const LeftoverReport report = explain_leftover(run, step);
  if (report.point < 0) return;
  ImGui::PushFont(ui.bold);
  ImGui::Text("Leftover point %d", report.point);
  ImGui::PopFont();
  ImGui::TextWrapped("%s", report.outcome.c_str());
  if (!report.planes.empty() &&
      ImGui::BeginTable("##leftover", 4,
                        ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) {
    for (const char* title : {"plane", "distance", "limit", ""}) ImGui::TableSetupColumn(title);
    ImGui::TableHeadersRow();
    for (const LeftoverPlane& plane : report.planes) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      if (ImGui::Selectable(plane_name(plane.plane).c_str(), false,
                            ImGuiSelectableFlags_SpanAllColumns))
        ui.emit("select.plane", plane_name(plane.plane));
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(length_text_cm(plane.distance_m).c_str());
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(length_text_cm(plane.limit_m).c_str());
      ImGui::TableNextColumn();
      ImGui::PushStyleColor(ImGuiCol_Text, plane.chosen ? ui.colors.good : ui.colors.muted);
      ImGui::TextUnformatted(plane.chosen ? "joined" : plane.why_not.c_str());
      ImGui::PopStyleColor();
    }
    ImGui::EndTable();
  }
  if (ImGui::SmallButton("its whole life")) ui.emit("point.life");
  ui.name("inspector.life");
  ImGui::Separator();
}

void draw_plane(const Ui& ui, const Run& run, std::int32_t plane) {
  const PlaneChange* now = run.timeline.plane_at(plane, ui.state.view.step);
  ImGui::Separator();
  ImGui::PushFont(ui.bold);
  ImGui::Text("Plane %s", plane_name(plane).c_str());
  ImGui::PopFont();
  ImGui::SameLine();
  ImGui::TextDisabled("%s", run.timeline.label_of_plane(plane) == Label::v ? "v" : "h");
  const auto changes = run.timeline.changes_of_plane(plane);
  if (!now) {
    ImGui::TextDisabled("not founded yet at this step");
    if (!changes.empty())
      link_to_step(ui, fmt::format("to its founding, step {}", changes.front().step),
                   changes.front().step);
    return;
  }
  fact(ui, "fitted to", fmt::format("{:.0f} points", now->fit.count));
  draw_fit(ui, now->fit);
  fact(ui, "offset", length_text_cm(now->fit.offset_m()));
  if (!now->alive)
    fact(ui, "state", now->into >= 0 ? "merged into " + plane_name(now->into) : "dropped");
  std::size_t past = 0;
  for (const PlaneChange& change : changes) past += change.step <= ui.state.view.step ? 1 : 0;
  if (past > 0) {
    link_to_step(ui, fmt::format("founded at step {}", changes.front().step), changes.front().step);
    ImGui::SameLine();
    link_to_step(ui, fmt::format("last changed at step {}", changes[past - 1].step),
                 changes[past - 1].step);
  }
}

}  // namespace

void draw_inspector(const Ui& ui) {
  const Run* run = ui.state.run();
  if (!run) {
    ImGui::TextWrapped(
        "%s", ui.state.results.loading ? "reading the frame …" : ui.state.results.refusal.c_str());
    return;
  }
  const std::int32_t step = ui.state.view.step;
  const Selection& selected = ui.state.view.selected;
  ImGui::PushStyleColor(ImGuiCol_Text, ui.colors.muted);
  ImGui::TextWrapped(
      "%s", step == 0 ? "Before the first event: the root waits in the queue."
                      : fmt::format("Step {}: {}", step, describe_event(*run, step)).c_str());
  ImGui::PopStyleColor();
  ImGui::Separator();
  const TraceEvent* event = ui.state.event();
  if (event && event->point >= 0 && event->point == selected.voxel) draw_leftover(ui, *run, step);
  if (selected.node >= 0) draw_node(ui, *run, selected.node);
  // The terms belong to the event under the cursor, so they show where that is what is selected.
  const bool at_event = event && (event->node == selected.node || event->node < 0);
  if (at_event) draw_merge(ui, *run, step);
  if (selected.plane >= 0) draw_plane(ui, *run, selected.plane);
}

}  // namespace planescope::desktop
