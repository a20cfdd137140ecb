// The planes of the result, one a row.

#include <fmt/format.h>

#include "app/desktop/debugger/plane_table.hpp"
#include "app/desktop/debugger/plane_text.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

void draw_filter(const Ui& ui) {
  std::string& text = ui.memory.texts["planes.filter"];
  if (!ImGui::IsAnyItemActive()) text = ui.state.view.planes.filter;
  ImGui::SetNextItemWidth(std::max(ui.px(60), ImGui::GetContentRegionAvail().x -
                                                  button_width("Copy as CSV") -
                                                  ImGui::GetStyle().ItemSpacing.x));
  if (ImGui::InputTextWithHint("##filter", "filter: vertical, P3", &text))
    ui.emit("planes.filter", text);
  ui.name("planes.filter");
  ImGui::SameLine();
  action_button(ui, "planes.copy", "Copy as CSV");
}

/// A click sorts by the column, a second one the other way round.
void draw_header(const Ui& ui) {
  const PlanesView& view = ui.state.view.planes;
  ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
  for (std::size_t c = 0; c < std::size(kPlaneColumns); ++c) {
    const PlaneColumnInfo& column = kPlaneColumns[c];
    ImGui::TableNextColumn();
    const bool sorted = static_cast<std::size_t>(view.sorted_by) == c;
    const std::string title = fmt::format("{}{}", column.title,
                                          !sorted           ? ""
                                          : view.descending ? "▾"
                                                            : "▴");
    if (ImGui::Selectable((title + "###" + column.name).c_str(), false))
      ui.emit("planes.sort", column.name);
    ui.name(std::string("planes.sort.") + column.name);
    tooltip(column.meaning);
  }
}

void draw_row(const Ui& ui, const PlaneRow& row) {
  const std::string widget = fmt::format("planes.{}", row.id);
  const std::vector<std::string> cells = cells_of(row);
  const bool selected = ui.state.view.selected.plane == row.plane;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  if (ImGui::Selectable((cells[0] + "##" + widget).c_str(), selected,
                        ImGuiSelectableFlags_SpanAllColumns))
    selected ? ui.emit("select.none") : ui.emit("select.plane", cells[0]);
  ui.name(widget);
  if (ImGui::IsItemHovered()) tooltip(describe_plane(ui.state, row.plane));
  // One that was selected elsewhere comes into sight, once.
  double& shown = ui.memory.numbers["planes.shown"];
  if (selected && shown != row.plane + 1) {
    shown = row.plane + 1;
    if (!ImGui::IsItemVisible()) ImGui::SetScrollHereY(0.5f);
  }
  for (std::size_t c = 1; c < cells.size(); ++c) cell(cells[c]);
}

}  // namespace

void draw_planes(const Ui& ui) {
  if (!ui.state.run()) return paragraph(ui.colors.muted, "No frame");
  if (!ui.state.planes()) return paragraph(ui.colors.muted, "Measuring the planes …");
  const std::size_t all = ui.state.planes()->found.summaries.size();
  if (all == 0) return paragraph(ui.colors.muted, "No planes in this frame");
  draw_filter(ui);
  const std::vector<PlaneRow> rows = plane_rows(ui.state);
  if (rows.size() < all) {
    ImGui::TextDisabled("%zu of %s", rows.size(), counted(all, "plane").c_str());
    ui.name("planes.found");
  }
  if (ui.state.view.selected.plane < 0) ui.memory.numbers["planes.shown"] = 0;
  const ImGuiTableFlags flags = kTable | ImGuiTableFlags_ScrollX | ImGuiTableFlags_ScrollY;
  if (!ImGui::BeginTable("##planes", static_cast<int>(std::size(kPlaneColumns)), flags)) return;
  static constexpr const char* kWidest[] = {"P000",   "h",     "00.000 m²", "00.0°",    "00.0 mm",
                                            "000000", "000 %", "yes",       "0.0e-00 ~"};
  for (std::size_t c = 0; c < std::size(kPlaneColumns); ++c)
    fixed_column(kPlaneColumns[c].title, kWidest[c],
                 ImGui::CalcTextSize("▾").x * (c == 2 || c == 5 ? 0.0f : 1.0f));
  ImGui::TableSetupScrollFreeze(1, 1);
  draw_header(ui);
  for (const PlaneRow& row : rows) draw_row(ui, row);
  ImGui::EndTable();
}

}  // namespace planescope::desktop
