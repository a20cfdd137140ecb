// Why: every criterion of the selected node, every term of the merge and every distance of the
// leftover point that the cursor is on.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/debugger/check_table.hpp"
#include "app/desktop/debugger/panels/leftover.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/debug/explain/explain.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kMostPartners = 5;

void link_to_step(const Ui& ui, const std::string& text, std::int32_t step) {
  if (link(ui, text, fmt::format("inspector.step.{}", step)))
    ui.emit("step.goto", std::to_string(step));
}

const char* word_of(Label label) {
  return label == Label::v ? "vertical" : label == Label::h ? "horizontal" : "unlabelled";
}

std::string vector_text(const Vec3d& v) {
  return fmt::format("{:.3f}  {:.3f}  {:.3f}", v.x(), v.y(), v.z());
}

void fact(const Ui& ui, const char* what, const std::string& value) {
  ImGui::TextDisabled("%s", what);
  ImGui::SameLine(ui.px(92));
  paragraph(ui.colors.text, value);
}

void draw_fit(const Ui& ui, const PlaneFit& fit) {
  if (fit.count < 3) return;
  fact(ui, "normal", vector_text(fit.normal));
  fact(ui, "eigenvalues",
       fmt::format("{:.3g}  {:.3g}  {:.3g} m²", fit.eigenvalues[0], fit.eigenvalues[1],
                   fit.eigenvalues[2]));
  fact(ui, "RMS", length_text_cm(fit.rms_m()));
}

void draw_node(const Ui& ui, const debug::Run& run, std::int32_t index) {
  const planes::Octree& octree = run.octree();
  const planes::OctreeNode& node = octree.nodes[static_cast<std::size_t>(index)];
  const std::int32_t step = ui.state.view.step;
  const debug::NodeState now = run.timeline.node_state(index, step);
  const debug::NodeFacts& facts = run.facts[static_cast<std::size_t>(index)];
  const std::int32_t decided = run.timeline.decided_at()[static_cast<std::size_t>(index)];

  if (now == debug::NodeState::settled) {
    case_badge(ui, node.decided);
    ImGui::SameLine();
  }
  heading(ui, fmt::format("Node {}", index));
  ImGui::SameLine();
  ImGui::TextDisabled("depth %d, cell %s", node.depth,
                      length_text_cm(octree.node_edge_m(node)).c_str());
  if (node.parent >= 0) {
    same_line_if_fits("parent");
    if (ImGui::SmallButton("parent")) ui.emit("select.parent");
    ui.name("inspector.parent");
  }
  const bool labelled = run.subject->prepared.gravity.known();
  fact(ui, "points",
       labelled ? fmt::format("{}: {} horizontal, {} vertical", node.size(), node.count_h,
                              node.size() - node.count_h)
                : fmt::format("{}, of no class: gravity is not known", node.size()));
  fact(ui, "inliers",
       fmt::format("{} {}, {} outliers", facts.purity.n_in, word_of(facts.purity.inlier),
                   facts.purity.n_out));
  if (facts.truth_planes > 0)
    fact(ui, "truth",
         fmt::format("{} {} on true plane {}{}", facts.truth_points,
                     facts.truth_points == 1 ? "point" : "points", facts.truth_plane,
                     facts.truth_planes > 1
                         ? fmt::format(", the others on {} more", facts.truth_planes - 1)
                         : ""));
  if (now != debug::NodeState::settled) {
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(ui.colors.warning), "%s",
                       now == debug::NodeState::unborn   ? "not there yet at this step"
                       : now == debug::NodeState::queued ? "waits in the queue"
                                                         : "dequeued, not decided yet");
    if (decided != planes::kNever) {
      link_to_step(ui, fmt::format("to its decision, step {}", decided), decided);
      ui.name("inspector.decision");
    }
    return;
  }
  const debug::NodeReport report = debug::explain_node(run, index);
  ImGui::Spacing();
  draw_checks(ui, "node", report.checks);
  paragraph(ui.colors.muted, report.stopped);
  if (std::any_of(report.checks.begin(), report.checks.end(), [](const debug::Check& c) {
        return c.criterion == "PCA" && c.verdict != debug::Verdict::not_asked;
      }))
    draw_fit(ui, facts.fit);
  math_paragraph(ui, ui.colors.text, report.outcome);
  for (const std::int32_t later : report.outcome_steps) {
    if (later <= step && later == step) continue;
    link_to_step(ui, fmt::format("step {}: {}", later, debug::describe_event(run, later)), later);
  }
}

void draw_partner(const Ui& ui, const debug::PartnerReport& partner, std::int32_t result) {
  const std::string state = partner.chosen        ? "joined"
                            : partner.never_asked ? "not asked, a partner had been found"
                            : partner.coplanar    ? "coplanar too, but not the best"
                                                  : "not coplanar";
  ImGui::PushStyleColor(ImGuiCol_Text, partner.chosen ? ui.colors.good : ui.colors.text);
  const bool open =
      ImGui::TreeNodeEx(fmt::format("P{}", partner.plane + 1).c_str(),
                        partner.chosen ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None,
                        "%s: %s%s", debug::plane_name(partner.plane).c_str(), state.c_str(),
                        result > 0 ? fmt::format(" (plane {} of the result)", result).c_str() : "");
  ui.name("inspector.partner." + debug::plane_name(partner.plane));
  ImGui::PopStyleColor();
  if (!open) return;
  draw_checks(ui, debug::plane_name(partner.plane), partner.checks);
  ImGui::TreePop();
}

void draw_merge(const Ui& ui, const debug::Run& run, std::int32_t step) {
  const debug::MergeReport report = debug::explain_merge(run, step);
  if (report.partners.empty() && report.outcome.empty()) return;
  ImGui::Separator();
  heading(ui, "Merging");
  math_paragraph(ui, ui.colors.text, report.outcome);
  fact(ui, "candidate",
       fmt::format("{} {} points{}", report.points, word_of(report.label),
                   report.node >= 0 ? fmt::format(" of node {}", report.node) : ""));
  draw_fit(ui, report.candidate);
  const std::size_t shown = std::min(kMostPartners, report.partners.size());
  for (std::size_t i = 0; i < shown; ++i)
    draw_partner(ui, report.partners[i], run.timeline.result_of_plane(report.partners[i].plane));
  if (shown < report.partners.size())
    ImGui::TextDisabled("and %zu planes farther off", report.partners.size() - shown);
}

void draw_plane(const Ui& ui, const debug::Run& run, std::int32_t plane) {
  const planes::PlaneChange* now = run.timeline.plane_at(plane, ui.state.view.step);
  ImGui::Separator();
  heading(ui, "Plane " + debug::plane_name(plane));
  ImGui::SameLine();
  ImGui::TextDisabled("%s", word_of(run.timeline.label_of_plane(plane)));
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
    fact(ui, "state", now->into >= 0 ? "merged into " + debug::plane_name(now->into) : "dropped");
  std::size_t past = 0;
  for (const planes::PlaneChange& change : changes)
    past += change.step <= ui.state.view.step ? 1 : 0;
  if (past > 0 && run.is_ours()) {
    link_to_step(ui, fmt::format("founded at step {}", changes.front().step), changes.front().step);
    same_line_if_fits(fmt::format("last changed at step {}", changes[past - 1].step));
    link_to_step(ui, fmt::format("last changed at step {}", changes[past - 1].step),
                 changes[past - 1].step);
  }
}

/// While there is no run: its refusal is told where the scene would be.
void draw_why_empty(const Ui& ui) {
  paragraph(ui.colors.muted, ui.state.results.loading ? "Reading the frame …"
                             : ui.state.document.current()
                                 ? "This frame was refused. Choose another one on the left."
                                 : "Open a recording with Ctrl+O.");
}

}  // namespace

void draw_inspector(const Ui& ui) {
  const debug::Run* run = ui.state.run();
  if (!run) return draw_why_empty(ui);
  const std::int32_t step = ui.state.view.step;
  const Selection& selected = ui.state.view.selected;
  paragraph(ui.colors.muted,
            step == 0 && run->is_ours() ? "Before the first event: the root waits in the queue."
            : run->is_ours() ? fmt::format("Step {}: {}", step, debug::describe_event(*run, step))
                             : debug::describe_event(*run, step));
  ImGui::Separator();
  const planes::TraceEvent* event = ui.state.event();
  if (event && event->point >= 0 && event->point == selected.voxel) draw_leftover(ui, *run, step);
  if (selected.node >= 0) draw_node(ui, *run, selected.node);
  // The terms belong to the event under the cursor, so they show where that is what is selected.
  const bool at_event = event && (event->node == selected.node || event->node < 0);
  if (at_event) draw_merge(ui, *run, step);
  if (selected.plane >= 0) draw_plane(ui, *run, selected.plane);
  if (selected.node < 0 && selected.plane < 0 && selected.voxel < 0)
    paragraph(ui.colors.muted,
              run->is_ours()
                  ? "Click a box, a point or a plane, or a row of the lists below, to see every "
                    "criterion that decided it."
                  : "Click a point or a plane to see its fit.");
}

}  // namespace planescope::desktop
