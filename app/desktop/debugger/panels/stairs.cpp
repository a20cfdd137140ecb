// What a finished plane is worth, and what leads from one to another: flights of stairs, kerbs,
// ramps.

#include <fmt/format.h>

#include "app/desktop/debugger/plane_text.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

/// Why there is nothing to tell at the cursor; empty where there is.
std::string why_untold(const State& state) {
  if (!state.run()->subject->prepared.gravity.known())
    return "Stairs, kerbs and ramps need gravity, which is unknown.";
  if (!state.planes()) return "Measuring the planes …";
  return state.view.step == state.run()->steps() ? "" : "Available at the last step.";
}

void draw_entry(const Ui& ui, const StairsEntry& entry, std::size_t number) {
  heading(ui, entry.title);
  ui.name(fmt::format("stairs.{}", number));
  for (const std::string& line : entry.lines) paragraph(ui.colors.muted, line);
  for (std::size_t i = 0; i < entry.planes.size(); ++i) {
    const std::string name = debug::plane_name(*ui.state.run(), entry.planes[i]);
    if (i > 0) same_line_if_fits(name);
    if (ImGui::SmallButton(fmt::format("{}##{}.{}", name, number, i).c_str()))
      ui.emit("select.plane", name);
    ui.name(fmt::format("stairs.{}.{}", number, name));
  }
  ImGui::Spacing();
}

}  // namespace

void draw_plane_facts(const Ui& ui, std::int32_t plane) {
  const std::string verdict = verdict_text(ui.state, plane);
  if (!verdict.empty()) {
    paragraph(verdict == "steppable" ? ui.colors.good : ui.colors.bad, verdict);
    ui.name("inspector.verdict");
  }
  for (const PlaneLine& line : plane_lines(ui.state, plane)) {
    fact(ui, line.name.c_str(), line.value);
    tooltip(line.meaning);
  }
  for (const std::string& text : no_steps_of(ui.state, plane)) paragraph(ui.colors.muted, text);
}

void draw_stairs(const Ui& ui) {
  if (!ui.state.run()) return paragraph(ui.colors.muted, "No frame");
  action_button(ui, "show.stairs", "Show in the scene");
  if (const std::string why = why_untold(ui.state); !why.empty())
    return paragraph(ui.colors.muted, why);
  const std::vector<StairsEntry> entries = stairs_entries(ui.state);
  for (std::size_t i = 0; i < entries.size(); ++i) draw_entry(ui, entries[i], i);
  if (entries.empty()) paragraph(ui.colors.muted, "No flight, kerb or ramp found.");
  const std::vector<std::string> missed = no_steps_of(ui.state, ui.state.view.selected.plane);
  if (!missed.empty())
    heading(ui, "No step at " + debug::plane_name(*ui.state.run(), ui.state.view.selected.plane));
  for (const std::string& text : missed) paragraph(ui.colors.text, text);
  if (missed.empty())
    paragraph(ui.colors.muted, "Select a horizontal plane to see why no step leads up to it.");
}

}  // namespace planescope::desktop
