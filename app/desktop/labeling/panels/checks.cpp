// What looks wrong in the frame's labels, by kind; each leads to its place.

#include <fmt/format.h>

#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

const char* title_of(labels::FindingKind kind) {
  switch (kind) {
    case labels::FindingKind::camera:
      return "Drawn with another camera";
    case labels::FindingKind::rms:
      return "Plane does not fit its pixels";
    case labels::FindingKind::outliers:
      return "Pixels far from the plane";
    case labels::FindingKind::parts:
      return "Separate pieces";
    case labels::FindingKind::tiny:
      return "Very small";
    case labels::FindingKind::class_normal:
      return "Class contradicts tilt";
    default:
      return "Not labeled";
  }
}

void draw_finding(const Ui& ui, std::size_t index, const labels::Finding& finding) {
  const std::string widget = fmt::format("checks.{}", index);
  const bool chosen = ui.state.view.label.finding == static_cast<int>(index);
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 at = ImGui::GetCursorPos();
  const float height = ImGui::CalcTextSize(finding.text.c_str(), nullptr, false, width).y;
  if (ImGui::Selectable(("##" + widget).c_str(), chosen, 0, ImVec2(width, height)))
    ui.emit("check.show", std::to_string(index));
  ui.name(widget);
  const ImVec2 after = ImGui::GetCursorPos();
  ImGui::SetCursorPos(at);
  paragraph(ui.colors.text, finding.text);
  if (ImGui::GetCursorPosY() < after.y) ImGui::SetCursorPos(after);
}

}  // namespace

void draw_label_checks(const Ui& ui) {
  const std::shared_ptr<const FrameLabels> labels = labels_to_show(ui);
  if (!labels) return;
  const Audit* audit = ui.state.results.label.audit.get();
  if (!audit) return paragraph(ui.colors.muted, "Checking the labels …");
  if (audit->findings.empty()) {
    paragraph(ui.colors.good,
              labels->planes.empty() ? "There are no labels to check." : "No problems found.");
    return;
  }
  ImGui::AlignTextToFramePadding();
  paragraph(ui.colors.muted, counted(audit->findings.size(), "finding"));
  ImGui::SameLine();
  action_button(ui, "check.next", "next");
  ImGui::BeginChild("findings");
  for (std::size_t i = 0; i < audit->findings.size(); ++i) {
    const labels::Finding& finding = audit->findings[i];
    if (i == 0 || audit->findings[i - 1].kind != finding.kind) {
      ImGui::Spacing();
      heading(ui, title_of(finding.kind));
    }
    draw_finding(ui, i, finding);
  }
  ImGui::EndChild();
}

}  // namespace planescope::desktop
