// Where gravity is from, and the clicks that pick it.

#include <fmt/format.h>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

void draw_click_buttons(const Ui& ui) {
  action_button(ui, "gravity.click.floor", "floor");
  ImGui::SameLine();
  action_button(ui, "gravity.click.wall", "wall");
}

std::string source_text(const Gravity& gravity) {
  if (!gravity.known()) return "unknown: " + gravity.note;
  const Vec3d& d = gravity.direction;
  const std::string note = gravity.note.starts_with(to_string(gravity.source))
                               ? gravity.note
                               : fmt::format("{}, {}", to_string(gravity.source), gravity.note);
  return fmt::format("{:.3f}, {:.3f}, {:.3f}  ·  {}", d.x(), d.y(), d.z(), note);
}

}  // namespace

void draw_click_line(const Ui& ui) {
  const debug::Run* run = ui.state.run();
  if (!run) return;
  const Click click = ui.state.view.click;
  if (measures(click)) return draw_measure_line(ui);
  const Gravity& gravity = run->subject->prepared.gravity;
  if (click == Click::selects && gravity.known()) return;
  std::string text =
      "Gravity is unknown, so nothing is horizontal or vertical. Click a floor or a wall:";
  if (click == Click::floor) text = "Click a floor. Esc cancels.";
  if (click == Click::wall) text = "Click a wall. Esc cancels.";
  ImGui::AlignTextToFramePadding();  // beside the buttons, where there is room
  paragraph(ui.colors.warning, text);
  ui.name("gravity.line");
  same_line_if_fits("floor  wall  ");
  draw_click_buttons(ui);
}

void draw_gravity(const Ui& ui) {
  const debug::Run* run = ui.state.run();
  if (run) paragraph(ui.colors.text, source_text(run->subject->prepared.gravity));
  ui.name("gravity.source");
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Click a");
  ImGui::SameLine();
  draw_click_buttons(ui);
  ImGui::SameLine();
  action_button(ui, "gravity.forget", "forget");
  bool all = ui.state.view.gravity_of_recording;
  if (ImGui::RadioButton("This frame", !all) && all) ui.emit("gravity.all_frames");
  ui.name("gravity.this_frame");
  ImGui::SameLine();
  if (ImGui::RadioButton("All frames", all) && !all) ui.emit("gravity.all_frames");
  ui.name("gravity.all_frames");
}

}  // namespace planescope::desktop
