// Inspector: all criteria of the selected node, terms of the merge at the cursor, and distances of
// the leftover point at the cursor.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/debug/explain/explain.hpp"

namespace planescope::desktop {
namespace {

// ---- Criteria ----------------------------------------------------------------------------------

/// Draws the margin as a bar from the middle, to the right if the check passes, clipped at the size
/// of the threshold.
void draw_margin(const Ui& ui, const debug::Check& check) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = std::max(ui.px(24), ImGui::GetContentRegionAvail().x);
  const float height = ImGui::GetTextLineHeight();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float middle = at.x + width / 2;
  draw->AddLine(ImVec2(middle, at.y), ImVec2(middle, at.y + height), ui.colors.grid);
  if (check.verdict != debug::Verdict::not_evaluated && std::isfinite(check.margin)) {
    const float reach = static_cast<float>(std::clamp(check.margin, -1.0, 1.0)) * width / 2;
    const float x0 = std::min(middle, middle + reach), x1 = std::max(middle, middle + reach);
    draw->AddRectFilled(ImVec2(x0, at.y + height * 0.25f),
                        ImVec2(std::max(x1, x0 + ui.px(2)), at.y + height * 0.8f),
                        check.verdict == debug::Verdict::pass ? ui.colors.good : ui.colors.bad);
  }
  ImGui::Dummy(ImVec2(width, height));
}

/// "e_n" and "= 0.00712 ≤ 0.005 m²", with three digits and one unit. Values that were never
/// computed are omitted.
struct Comparison {
  std::string quantity, rest;
};

Comparison comparison_of(const debug::Check& check) {
  const bool millimetres = check.unit == "m" && check.threshold < 1;
  const auto text = [&](double value) {
    if (!std::isfinite(value) || value == std::floor(value)) return number_text(value);
    return fmt::format("{:.3g}", millimetres ? 1000 * value : value);
  };
  std::string unit = check.unit == "points" || check.unit.empty() ? "" : " " + check.unit;
  if (millimetres) unit = " mm";
  if (check.unit == "deg") unit = "°";
  const bool valued = check.verdict != debug::Verdict::not_evaluated || std::isfinite(check.value);
  const std::string value = valued ? "= " + text(check.value) : "";
  if (check.op.empty()) return {check.quantity, valued ? value + unit : ""};
  return {check.quantity, fmt::format("{}{}{} {}{}", value, valued ? " " : "", check.op,
                                      text(check.threshold), unit)};
}

/// Uses one line if there is room, otherwise puts the numbers below.
void draw_comparison(const Ui& ui, const debug::Check& check, ImU32 color) {
  const Comparison comparison = comparison_of(check);
  const std::string line = comparison.quantity + " " + comparison.rest;
  if (math_width(ui, line) <= ImGui::GetContentRegionAvail().x) return math_text(ui, color, line);
  math_text(ui, color, comparison.quantity);
  math_text(ui, color, comparison.rest);
}

const char* word_of(debug::Verdict verdict) {
  return verdict == debug::Verdict::pass ? "pass" : verdict == debug::Verdict::fail ? "fail" : "–";
}

void draw_tooltip(const debug::Check& check) {
  std::string text =
      fmt::format("{}, {}\n{}: {}", check.criterion, check.equation, check.quantity, check.meaning);
  if (check.verdict == debug::Verdict::not_evaluated && !check.op.empty())
    text += "\nNot evaluated: an earlier criterion decided";
  if (!check.option.empty()) text += "\nThreshold: option " + check.option + "; click to show it";
  tooltip_at_mouse(text);
}

/// Texts of a row's criterion and equation.
struct Name {
  std::string criterion, equation;
  bool beside = false;  // show the equation beside the criterion instead of replacing it
};

/// A criterion with several rows has its equation in the second row; one with a single row has it
/// beside its name if the panel is wide enough.
std::vector<Name> names_of(const std::vector<debug::Check>& checks, bool wide) {
  std::vector<Name> names(checks.size());
  for (std::size_t begin = 0, end = 0; begin < checks.size(); begin = end) {
    while (end < checks.size() && checks[end].criterion == checks[begin].criterion) ++end;
    names[begin].criterion = checks[begin].criterion;
    names[begin].beside = wide && end == begin + 1;
    if (names[begin].beside) names[begin].equation = checks[begin].equation;
    if (end > begin + 1) names[begin + 1].equation = checks[begin + 1].equation;
  }
  return names;
}

float width_of(const Ui& ui, const Name& name) {
  const float criterion = ImGui::CalcTextSize(name.criterion.c_str()).x;
  ImGui::PushFont(ui.small);
  const float equation = ImGui::CalcTextSize(name.equation.c_str()).x;
  ImGui::PopFont();
  return name.beside ? criterion + ui.px(6) + equation : std::max(criterion, equation);
}

/// The whole row is clickable.
void draw_name(const Ui& ui, const debug::Check& check, const Name& name, const std::string& id) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (ImGui::Selectable((name.criterion + "##" + id).c_str(), false,
                        ImGuiSelectableFlags_SpanAllColumns) &&
      !check.option.empty())
    ui.act("option.show", check.option);
  ui.name(id);
  if (ImGui::IsItemHovered()) draw_tooltip(check);
  const float beside = name.beside ? ImGui::CalcTextSize(name.criterion.c_str()).x + ui.px(6) : 0;
  const float drop = ImGui::GetTextLineHeight() - height_of(*ui.small);  // align baselines
  ImGui::GetWindowDrawList()->AddText(ui.small, height_of(*ui.small),
                                      ImVec2(at.x + beside, at.y + drop), ui.colors.muted,
                                      name.equation.c_str());
}

/// Criteria as `value  op  threshold  -> pass / fail  margin`, in evaluation order. If the
/// threshold is an option, clicking the row shows its slider.
void draw_checks(const Ui& ui, const std::string& name, const std::vector<debug::Check>& checks) {
  const bool wide = ImGui::GetContentRegionAvail().x > ui.px(330);  // for equations and margins
  const std::vector<Name> names = names_of(checks, wide);
  float widest = 0;
  for (const Name& one : names) widest = std::max(widest, width_of(ui, one));
  if (!ImGui::BeginTable(("##checks." + name).c_str(), wide ? 4 : 3,
                         ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH))
    return;
  ImGui::TableSetupColumn("criterion", ImGuiTableColumnFlags_WidthFixed, widest);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("verdict", ImGuiTableColumnFlags_WidthFixed, ui.px(32));
  if (wide) ImGui::TableSetupColumn("margin", ImGuiTableColumnFlags_WidthFixed, ui.px(40));
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const debug::Check& check = checks[i];
    const bool asked = check.verdict != debug::Verdict::not_evaluated;
    const ImU32 color = asked ? ui.colors.text : ui.colors.muted;
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    draw_name(ui, check, names[i], fmt::format("check.{}.{}", name, i));
    ImGui::TableNextColumn();
    draw_comparison(ui, check, color);
    ImGui::TableNextColumn();
    const ImU32 verdict = !asked                                  ? ui.colors.muted
                          : check.verdict == debug::Verdict::pass ? ui.colors.good
                                                                  : ui.colors.bad;
    if (!check.op.empty()) colored(verdict, word_of(check.verdict));
    if (wide) ImGui::TableNextColumn();
    if (wide && !check.op.empty()) draw_margin(ui, check);
    ImGui::PopStyleColor();
  }
  ImGui::EndTable();
}

// ---- Nodes, merges, planes ---------------------------------------------------------------------

constexpr std::size_t kMostPartners = 5;

void link_to_step(const Ui& ui, const std::string& text, std::int32_t step) {
  if (link(ui, text, fmt::format("inspector.step.{}", step))) ui.act("step.goto", step);
}

const char* word_of(Label label) {
  return label == Label::v ? "vertical" : label == Label::h ? "horizontal" : "unlabeled";
}

std::string vector_text(const Vec3d& v) {
  return fmt::format("{:.3f}  {:.3f}  {:.3f}", v.x(), v.y(), v.z());
}

void draw_fit(const Ui& ui, const PlaneFit& fit) {
  if (fit.count < 3) return;
  fact(ui, "normal", vector_text(fit.normal));
  // Square roots of the eigenvalues per point are lengths that are easy to picture.
  const auto spread = [&](int axis) { return std::sqrt(fit.eigenvalues[axis] / fit.count); };
  fact(ui, "spread", length_text(spread(2)) + " × " + length_text(spread(1)));
  tooltip("Standard deviations of its points along its two axes");
  fact(ui, "RMS", length_text(fit.rms_m()));
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
                      planes::cell_size_text(octree, node.depth).c_str());
  if (node.parent >= 0) {
    same_line_if_fits("parent");
    if (ImGui::SmallButton("parent")) ui.act("select.parent");
    ui.name("inspector.parent");
  }
  const bool labeled = run.subject->prepared.gravity.known();
  fact(ui, "points",
       run.is_on_image() ? std::to_string(node.size())
       : labeled         ? fmt::format("{}: {} horizontal, {} vertical", node.size(), node.count_h,
                                       node.size() - node.count_h)
                         : fmt::format("{}, no class: gravity is unknown", node.size()));
  if (!run.is_on_image())
    fact(ui, "inliers",
         fmt::format("{} {}, {} outliers", facts.purity.n_in, word_of(facts.purity.inlier),
                     facts.purity.n_out));
  if (facts.truth_planes > 0)
    fact(ui, "truth",
         fmt::format("{} {} on true plane {}{}", facts.truth_points,
                     facts.truth_points == 1 ? "point" : "points", facts.truth_plane,
                     facts.truth_planes > 1
                         ? fmt::format(", the rest on {} more", facts.truth_planes - 1)
                         : ""));
  if (now != debug::NodeState::settled) {
    colored(ui.colors.warning, now == debug::NodeState::unborn   ? "Does not exist yet at this step"
                               : now == debug::NodeState::queued ? "Queued"
                                                                 : "Dequeued, undecided");
    if (decided != planes::kNever) {
      link_to_step(ui, fmt::format("Decision, step {}", decided), decided);
      ui.name("inspector.decision");
    }
    return;
  }
  const debug::NodeReport report = debug::explain_node(run, index);
  ImGui::Spacing();
  draw_checks(ui, "node", report.checks);
  paragraph(ui.colors.muted, report.stopped);
  if (std::any_of(report.checks.begin(), report.checks.end(), [](const debug::Check& c) {
        return (c.criterion == "PCA" || c.option == "flat") &&
               c.verdict != debug::Verdict::not_evaluated;
      }))
    draw_fit(ui, facts.fit);
  math_paragraph(ui, ui.colors.text, report.outcome);
  for (const std::int32_t later : report.outcome_steps) {
    if (later <= step && later == step) continue;
    link_to_step(ui, fmt::format("step {}: {}", later, debug::describe_event(run, later)), later);
  }
}

void draw_partner(const Ui& ui, const debug::PartnerReport& partner, const std::string& name) {
  const std::string state = partner.chosen          ? "joined"
                            : partner.not_evaluated ? "not evaluated: a partner was found"
                            : partner.coplanar      ? "coplanar, but not the best"
                                                    : "not coplanar";
  ImGui::PushStyleColor(ImGuiCol_Text, partner.chosen ? ui.colors.good : ui.colors.text);
  const bool open = ImGui::TreeNodeEx(
      name.c_str(), partner.chosen ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None,
      "%s: %s", name.c_str(), state.c_str());
  ui.name("inspector.partner." + name);
  ImGui::PopStyleColor();
  if (!open) return;
  draw_checks(ui, name, partner.checks);
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
    draw_partner(ui, report.partners[i], debug::plane_name(run, report.partners[i].plane));
  if (shown < report.partners.size())
    ImGui::TextDisabled("and %zu planes farther away", report.partners.size() - shown);
}

void draw_plane(const Ui& ui, const debug::Run& run, std::int32_t plane) {
  const planes::PlaneChange* now = run.timeline.plane_at(plane, ui.state.view.step);
  ImGui::Separator();
  heading(ui, "Plane " + debug::plane_name(run, plane));
  ImGui::SameLine();
  const char* stays = run.timeline.result_of_plane(plane) > 0 ? "" : ", not in the result";
  ImGui::TextDisabled("%s%s", word_of(run.timeline.label_of_plane(plane)), stays);
  const auto changes = run.timeline.changes_of_plane(plane);
  if (!now) {
    ImGui::TextDisabled("Not created yet at this step");
    if (!changes.empty())
      link_to_step(ui, fmt::format("Created at step {}", changes.front().step),
                   changes.front().step);
    return;
  }
  fact(ui, "fit", fmt::format("{:.0f} points", now->fit.count));
  draw_fit(ui, now->fit);
  fact(ui, "offset", length_text(now->fit.offset_m()));
  if (!now->alive)
    fact(ui, "state",
         now->into >= 0 ? "merged into " + debug::plane_name(run, now->into) : "dropped");
  draw_plane_facts(ui, plane);
  std::size_t past = 0;
  for (const planes::PlaneChange& change : changes)
    past += change.step <= ui.state.view.step ? 1 : 0;
  if (past > 0 && run.is_ours()) {
    link_to_step(ui, fmt::format("Created at step {}", changes.front().step), changes.front().step);
    same_line_if_fits(fmt::format("Changed at step {}", changes[past - 1].step));
    link_to_step(ui, fmt::format("Changed at step {}", changes[past - 1].step),
                 changes[past - 1].step);
  }
}

// ---- Leftover points ---------------------------------------------------------------------------

constexpr std::size_t kMostRows = 5;   // one per nearest plane
constexpr std::size_t kMostNames = 6;  // names of remaining planes to list

/// Summarizes planes that were rejected for the same reason in one line, as there may be a hundred.
void draw_refused(const Ui& ui,
                  const debug::Run& run,
                  const std::vector<debug::LeftoverPlane>& planes,
                  std::size_t from) {
  std::vector<std::string> reasons;
  for (std::size_t i = from; i < planes.size(); ++i)
    if (!planes[i].chosen &&
        std::find(reasons.begin(), reasons.end(), planes[i].why_not) == reasons.end())
      reasons.push_back(planes[i].why_not);
  for (const std::string& reason : reasons) {
    std::vector<std::string> names;
    for (std::size_t i = from; i < planes.size(); ++i)
      if (!planes[i].chosen && planes[i].why_not == reason)
        names.push_back(debug::plane_name(run, planes[i].plane));
    const std::size_t shown = std::min<std::size_t>(names.size(), kMostNames);
    paragraph(
        ui.colors.muted,
        fmt::format("{}: {}{}", reason,
                    fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                    names.size() > shown ? fmt::format(" and {} more", names.size() - shown) : ""));
  }
}

void draw_distances(const Ui& ui,
                    const debug::Run& run,
                    const std::vector<debug::LeftoverPlane>& planes) {
  if (planes.empty()) return;
  std::size_t shown = std::min(kMostRows, planes.size());
  for (std::size_t i = shown; i < planes.size(); ++i)
    if (planes[i].chosen) shown = i + 1;
  if (ImGui::BeginTable("##leftover", 4, ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("plane", ImGuiTableColumnFlags_WidthFixed, ui.px(40));
    ImGui::TableSetupColumn("distance", ImGuiTableColumnFlags_WidthFixed, ui.px(70));
    ImGui::TableSetupColumn("limit", ImGuiTableColumnFlags_WidthFixed, ui.px(60));
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableHeadersRow();
    for (std::size_t i = 0; i < shown; ++i) {
      const debug::LeftoverPlane& plane = planes[i];
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      if (ImGui::Selectable(debug::plane_name(run, plane.plane).c_str(), false,
                            ImGuiSelectableFlags_SpanAllColumns))
        ui.act("select.plane", PlaneRef{plane.plane});
      cell(length_text(plane.distance_m));
      cell(length_text(plane.limit_m));
      ImGui::TableNextColumn();
      paragraph(plane.chosen ? ui.colors.good : ui.colors.muted,
                plane.chosen ? "joined" : plane.why_not);
    }
    ImGui::EndTable();
  }
  draw_refused(ui, run, planes, shown);
}

/// Shows a leftover point's distances to the planes considered at the step, and why it joined one
/// or none. Draws nothing if the step is a different event.
void draw_leftover(const Ui& ui, const debug::Run& run, std::int32_t step) {
  const debug::LeftoverReport report = debug::explain_leftover(run, step);
  if (report.point < 0) return;
  heading(ui, fmt::format("Unassigned point {}", report.point));
  paragraph(ui.colors.text, report.outcome);
  draw_distances(ui, run, report.planes);
  if (ImGui::SmallButton("History")) ui.act("point.life");
  ui.name("inspector.life");
  ImGui::Separator();
}

// ---- Frame -------------------------------------------------------------------------------------

constexpr double kLeast = 0.001;  // minimum fraction for a row

/// Alternates gray levels, so that neighboring reasons in the bar differ.
ImU32 color_of_reason(const Ui& ui, std::size_t i) {
  return with_alpha(ui.colors.muted, i % 2 == 0 ? 200 : 120);
}

/// Draws fractions beside each other across the whole width.
void draw_bar(const Ui& ui, const debug::FrameSummary& summary) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ui.px(10);
  float x = at.x;
  const auto add = [&](std::size_t sources, ImU32 color) {
    const float to = x + width * static_cast<float>(summary.share(sources));
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(x, at.y), ImVec2(to, at.y + height), color);
    x = to;
  };
  add(summary.on_planes - summary.on_undecided, ui.colors.accent);
  add(summary.on_undecided, with_alpha(ui.colors.accent, 120));
  for (std::size_t i = 0; i < summary.lost.size(); ++i)
    add(summary.lost[i].sources, color_of_reason(ui, i));
  ImGui::Dummy(ImVec2(width, height));
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

/// Shows the fraction of the frame on planes, and reasons for the rest.
void draw_frame_summary(const Ui& ui, const RunView& view) {
  const debug::FrameSummary& summary = view.summary;
  const double on = summary.share(summary.on_planes);
  const double outside = summary.share(summary.out_of_range);
  std::string title = fmt::format("{} on {} · {} unassigned", percent(on),
                                  counted(static_cast<std::size_t>(summary.planes), "plane"),
                                  percent(1 - on - outside));
  if (outside >= kLeast) title += fmt::format(" · {} out of range", percent(outside));
  heading(ui, title);
  draw_bar(ui, summary);
  if (summary.undecided > 0)
    paragraph(ui.colors.muted,
              fmt::format("{}, {} of all points, undecided: slightly different noise could drop "
                          "or merge them",
                          counted(static_cast<std::size_t>(summary.undecided), "plane"),
                          percent(summary.share(summary.on_undecided))));
  for (std::size_t i = 0; i < summary.lost.size(); ++i) {
    const debug::Lost& lost = summary.lost[i];
    if (summary.share(lost.sources) < kLeast) continue;
    const std::string text =
        fmt::format("{:.1f} %  {}", 100 * summary.share(lost.sources), lost.reason);
    const std::string widget = fmt::format("lost.{}", i);
    if (lost.middle < 0) {
      colored(ui.colors.muted, text);
      ui.name(widget);
      continue;
    }
    if (link(ui, text, widget)) ui.act("lost.show", i);
    tooltip("Mark these points and explain the largest part");
  }
}

/// Shown while there is no run. The reason for refusing a frame is shown in the scene view.
void draw_why_empty(const Ui& ui) {
  const OpenRecording* open = ui.state.document.current();
  paragraph(ui.colors.muted,
            !open                                     ? "Open a recording with Ctrl+O."
            : !open->recording->info().knows_camera() ? "Waiting for the camera's intrinsics."
            : ui.state.results.loading
                ? "Reading the frame …"
                : "This frame cannot be segmented. Choose another one on the left.");
}

}  // namespace

void draw_inspector(const Ui& ui) {
  const debug::Run* run = ui.state.run();
  if (!run) return draw_why_empty(ui);
  const std::int32_t step = ui.state.view.step;
  const Selection& selected = ui.state.view.selected;
  paragraph(ui.colors.muted,
            step == 0 && run->is_ours() ? "Before the first event: the root is queued."
            : run->is_ours() ? fmt::format("Step {}: {}", step, debug::describe_event(*run, step))
                             : debug::describe_event(*run, step));
  ImGui::Separator();
  draw_answer(ui);
  const planes::TraceEvent* event = ui.state.event();
  if (event && event->point >= 0 && event->point == selected.voxel) draw_leftover(ui, *run, step);
  if (selected.node >= 0) draw_node(ui, *run, selected.node);
  // Merge terms belong to the event at the cursor, so show them only if it matches the selection.
  const bool at_event = event && (event->node == selected.node || event->node < 0);
  if (at_event) draw_merge(ui, *run, step);
  if (selected.plane >= 0) draw_plane(ui, *run, selected.plane);
  if (selected.node < 0 && selected.plane < 0 && selected.voxel < 0) {
    draw_frame_summary(ui, *ui.state.run_view());
    ImGui::Spacing();
    paragraph(ui.colors.muted,
              run->is_ours()
                  ? "Click a box, a point, a plane, or a row of the lists below to see every "
                    "criterion of the decision."
                  : "Click a point or a plane to see its fit.");
  }
}

}  // namespace planescope::desktop
