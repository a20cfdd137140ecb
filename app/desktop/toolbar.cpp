#include "app/desktop/toolbar.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace planescope::desktop {

void action_button(const Ui& ui, const char* action, const char* label) {
  const Action& what = find_action(action);
  const bool enabled = !what.enabled || what.enabled(ui.state);
  const bool lit = what.checked && what.checked(ui.state);
  if (!enabled) ImGui::BeginDisabled();
  if (lit) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_Header]);
  ImGui::PushID(action);
  if (ImGui::Button(label)) ui.emit(action);
  ImGui::PopID();
  if (lit) ImGui::PopStyleColor();
  if (!enabled) ImGui::EndDisabled();
  ui.name(std::string("button.") + action);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "%s", what.keys.empty() ? what.title.c_str() : (what.title + "   " + what.keys).c_str());
}

void draw_image_tools(const Ui& ui, const char* of_opacity) {
  const ViewState& view = ui.state.view;
  action_button(ui, "image.backdrop",
                view.backdrop == render::Backdrop::color ? "colour" : "depth");
  ImGui::SameLine();
  if (ImGui::Button("fit")) ui.emit("image.view", "1,0.5,0.5");
  ui.name("image.fit");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("the whole image");
  ImGui::SameLine();
  auto percent = static_cast<float>(100 * view.overlay_opacity);
  const std::string text = fmt::format("{:.0f} %", percent);
  // The number stands beside the slider: on it, the grab would hide it.
  const float number = ImGui::CalcTextSize("100 %").x + ui.px(6);
  ImGui::SetNextItemWidth(std::max(ui.px(24), ImGui::GetContentRegionAvail().x - number));
  if (ImGui::SliderFloat("##opacity", &percent, 0, 100, ""))
    ui.emit("image.opacity", fmt::format("{:.4g}", percent / 100));
  ui.name("image.opacity");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", of_opacity);
  ImGui::SameLine(0, ui.px(6));
  ImGui::TextDisabled("%s", text.c_str());
}

void draw_notice(const Ui& ui, const std::string& text, ImU32 color) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float wrap = std::min(room.x, ui.px(420));
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const ImVec2 at = ImGui::GetCursorPos();
  ImGui::SetCursorPos(
      ImVec2(at.x + (room.x - size.x) / 2, at.y + std::max(0.0f, room.y - size.y) / 2));
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + wrap);
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
}

void draw_absence(const Ui& ui) {
  const Results& results = ui.state.results;
  if (!results.refusal.empty()) return draw_notice(ui, results.refusal, ui.colors.bad);
  if (results.loading) return draw_notice(ui, "Reading the frame …", ui.colors.muted);
  if (!ui.state.document.current())
    draw_notice(ui, "No recording is open. Press Ctrl+O to open one.", ui.colors.muted);
}

void draw_label_absence(const Ui& ui) {
  const std::string& refusal = ui.state.results.label.refusal;
  if (!refusal.empty()) return draw_notice(ui, refusal, ui.colors.bad);
  if (!ui.state.run()) return draw_absence(ui);
  draw_notice(ui, "Making the frame ready for labels …", ui.colors.muted);
}

std::string describe_node(const State& state, std::int32_t node) {
  const debug::Run& run = *state.run();
  const planes::OctreeNode& what = run.octree().nodes[static_cast<std::size_t>(node)];
  std::string text = fmt::format("node {}, depth {}, {} points", node, what.depth, what.size());
  switch (run.timeline.node_state(node, state.view.step)) {
    case debug::NodeState::settled:
      return text + ", case " + planes::to_string(what.decided);
    case debug::NodeState::visited:
      return text + ", being judged";
    case debug::NodeState::queued:
      return text + ", in the queue";
    default:
      return text;
  }
}

std::string describe_voxel(const State& state, std::int32_t voxel) {
  const debug::Run& run = *state.run();
  const std::int32_t step = state.view.step;
  const planes::PointChange now = run.timeline.point_at(voxel, step);
  std::string text = fmt::format("voxel {}", voxel);
  if (run.is_ours()) {
    const std::vector<Label>& labels = run.subject->prepared.classification.labels;
    const Label label = labels[static_cast<std::size_t>(voxel)];
    text += label == Label::h ? " (h)" : label == Label::v ? " (v)" : "";
  }
  text += ", ";
  if (now.plane >= 0)
    text += "in " + debug::plane_name(now.plane);
  else
    text += now.leftover ? "left over" : "not settled";
  if (run.subject->voxel_truth.known()) {
    const std::int32_t truth = run.subject->voxel_truth.plane[static_cast<std::size_t>(voxel)];
    if (truth > 0) text += fmt::format(", true plane {}", truth);
  }
  const std::int32_t node = run.timeline.node_of_point(voxel, step);
  return node >= 0 ? text + "\n" + describe_node(state, node) : text;
}

}  // namespace planescope::desktop
