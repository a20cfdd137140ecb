#include "app/desktop/debugger/panels/leftover.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/widgets.hpp"
#include "core/debug/explain/explain.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kMostRows = 5;   // one for each of the nearest planes
constexpr std::size_t kMostNames = 6;  // of the planes that have none

/// Planes that were measured and refused for the same reason, in one line: there may be a hundred.
void draw_refused(const Ui& ui, const std::vector<debug::LeftoverPlane>& planes, std::size_t from) {
  std::vector<std::string> reasons;
  for (std::size_t i = from; i < planes.size(); ++i)
    if (!planes[i].chosen &&
        std::find(reasons.begin(), reasons.end(), planes[i].why_not) == reasons.end())
      reasons.push_back(planes[i].why_not);
  for (const std::string& reason : reasons) {
    std::vector<std::string> names;
    for (std::size_t i = from; i < planes.size(); ++i)
      if (!planes[i].chosen && planes[i].why_not == reason)
        names.push_back(debug::plane_name(planes[i].plane));
    const std::size_t shown = std::min<std::size_t>(names.size(), kMostNames);
    paragraph(
        ui.colors.muted,
        fmt::format("{}: {}{}", reason,
                    fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                    names.size() > shown ? fmt::format(" and {} more", names.size() - shown) : ""));
  }
}

void draw_distances(const Ui& ui, const std::vector<debug::LeftoverPlane>& planes) {
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
      if (ImGui::Selectable(debug::plane_name(plane.plane).c_str(), false,
                            ImGuiSelectableFlags_SpanAllColumns))
        ui.emit("select.plane", debug::plane_name(plane.plane));
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(length_text_cm(plane.distance_m).c_str());
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(length_text_cm(plane.limit_m).c_str());
      ImGui::TableNextColumn();
      paragraph(plane.chosen ? ui.colors.good : ui.colors.muted,
                plane.chosen ? "joined" : plane.why_not);
    }
    ImGui::EndTable();
  }
  draw_refused(ui, planes, shown);
}

}  // namespace

void draw_leftover(const Ui& ui, const debug::Run& run, std::int32_t step) {
  const debug::LeftoverReport report = debug::explain_leftover(run, step);
  if (report.point < 0) return;
  heading(ui, fmt::format("Leftover point {}", report.point));
  paragraph(ui.colors.text, report.outcome);
  draw_distances(ui, report.planes);
  if (ImGui::SmallButton("its whole life")) ui.emit("point.life");
  ui.name("inspector.life");
  ImGui::Separator();
}

}  // namespace planescope::desktop
