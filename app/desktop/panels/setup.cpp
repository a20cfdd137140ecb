// What a recording needs before its frames can be run, and what was assumed about it.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/desktop/assumptions.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/io/folder/camera_files.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr std::array<const char*, 4> kFields = {"fx", "fy", "cx", "cy"};
constexpr const char* kUnit = "setup.unit";

std::string& field(const Ui& ui, const char* name) {
  return ui.memory.texts[std::string("setup.") + name];
}

void fill_in(const Ui& ui, const Intrinsics& k, double depth_unit_m) {
  const std::array<double, 4> values = {k.fx, k.fy, k.cx, k.cy};
  for (std::size_t i = 0; i < values.size(); ++i)
    field(ui, kFields[i]) = fmt::format("{:.6g}", values[i]);
  ui.memory.texts[kUnit] = fmt::format("{:g}", depth_unit_m);
}

/// Choices and fields of this recording, found once.
const std::vector<io::CameraChoice>& choices_of(const Ui& ui, const OpenRecording& open) {
  CameraForm& form = ui.memory.camera_form;
  if (form.of != open.recording) {
    const io::RecordingInfo& info = open.recording->info();
    form = {open.recording, io::camera_choices(info)};
    for (const char* name : kFields) field(ui, name).clear();
    if (info.knows_camera()) fill_in(ui, info.intrinsics, info.depth_unit_m);
    ui.memory.texts[kUnit] = fmt::format("{:g}", info.depth_unit_m);
  }
  return form.choices;
}

/// A labeled box in a table; true if it holds a number above 0.
bool draw_field(const Ui& ui, const char* title, const std::string& widget, std::string& text) {
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();  // all titles at one height
  ImGui::TextDisabled("%s", title);
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText(("##" + widget).c_str(), &text);
  ui.name(widget);
  const auto value = parse_number(text);
  return value && *value > 0;
}

void draw_choices(const Ui& ui, const std::vector<io::CameraChoice>& choices) {
  for (const bool files : {true, false}) {
    bool titled = false;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const io::CameraChoice& choice = choices[i];
      if (choice.from_file != files) continue;
      if (!titled) {
        ImGui::Spacing();
        ImGui::TextDisabled(
            "%s", files ? "Found near the recording" : "Nominal values, a percent or two off");
      }
      titled = true;
      const Intrinsics& k = choice.intrinsics;
      const std::string text =
          fmt::format("{}   {:.5g}, {:.5g}, {:.5g}, {:.5g}   {:g} m", choice.name, k.fx, k.fy, k.cx,
                      k.cy, choice.depth_unit_m);
      if (link(ui, text, fmt::format("setup.choice.{}", i))) fill_in(ui, k, choice.depth_unit_m);
    }
  }
}

}  // namespace

bool draw_camera_setup(const Ui& ui) {
  const OpenRecording* open = ui.state.document.current();
  if (!open || open->recording->info().width == 0) return false;
  const io::RecordingInfo& info = open->recording->info();
  if (info.knows_camera() && !ui.state.view.edits_intrinsics) return false;
  const std::vector<io::CameraChoice>& choices = choices_of(ui, *open);
  ImGui::BeginChild("setup", ImVec2(0, 0), false, ImGuiWindowFlags_AlwaysUseWindowPadding);
  heading(ui, "Camera intrinsics");
  paragraph(ui.colors.text,
            info.knows_camera()
                ? fmt::format("Currently from {}.", info.intrinsics_source)
                : fmt::format("{} does not contain the intrinsics of its {}x{} depth camera. Enter "
                              "them, or choose a camera.",
                              open->path.filename().string(), info.width, info.height));
  ImGui::Spacing();
  std::string wrong;  // the first field without a number above 0
  std::string values;
  std::string& unit = ui.memory.texts[kUnit];
  const float width = std::min(ui.px(560), ImGui::GetContentRegionAvail().x);
  if (ImGui::BeginTable("fields", width < ui.px(420) ? 3 : 5, ImGuiTableFlags_SizingStretchSame,
                        ImVec2(width, 0))) {
    for (const char* name : kFields) {
      if (!draw_field(ui, fmt::format("{} [px]", name).c_str(), std::string("setup.") + name,
                      field(ui, name)) &&
          wrong.empty())
        wrong = name;
      values += (values.empty() ? "" : ",") + field(ui, name);
    }
    if (!draw_field(ui, "m per count", kUnit, unit) && wrong.empty()) wrong = "m per count";
    ImGui::EndTable();
  }
  if (!wrong.empty()) {
    colored(ui.colors.warning, fmt::format("{} must be a number above 0", wrong));
    ui.name("setup.wrong");
  }
  if (button(ui, info.knows_camera() ? "Apply" : "Open", "setup.apply", wrong.empty())) {
    const bool remember = ui.memory.numbers["setup.remember"] != 0;
    ui.emit("intrinsics.set", values + " " + unit + (remember ? " remember" : ""));
  }
  if (info.knows_camera()) {
    ImGui::SameLine();
    if (button(ui, "Cancel", "setup.cancel")) ui.emit("intrinsics.edit");
  }
  const char* title = "Remember beside the recording";
  same_line_if_room(ImGui::CalcTextSize(title).x + 2 * ImGui::GetFrameHeight(), ui.px(16));
  double& remembers = ui.memory.numbers["setup.remember"];
  bool remember = remembers != 0;
  if (ImGui::Checkbox(title, &remember)) remembers = remember ? 1 : 0;
  ui.name("setup.remember");
  tooltip(fmt::format(
      "Stores them in {}, which every command reads. The recording itself is not changed.",
      io::camera_file(info).string()));
  draw_choices(ui, choices);
  ImGui::EndChild();
  return true;
}

void draw_assumptions(const Ui& ui, const std::vector<Assumption>& all) {
  std::string rest;
  const float close = button_width("×") + ui.px(24);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Assumption& one = all[i];
    const float width =
        ImGui::CalcTextSize(one.text.c_str()).x + button_width(one.button) + ui.px(28) + close;
    if (!rest.empty() || (i > 0 && !same_line_if_room(width, ui.px(20)))) {
      rest += (rest.empty() ? "" : "\n") + one.text;
      continue;
    }
    ImGui::AlignTextToFramePadding();
    colored(ui.colors.warning, one.text);
    tooltip(one.why);
    ImGui::SameLine();
    if (button(ui, one.button, fmt::format("assumption.{}", i))) ui.emit(one.action, one.argument);
    tooltip(one.why);
  }
  if (!rest.empty()) {
    ImGui::SameLine();
    ImGui::TextDisabled("…");
    tooltip(rest);
  }
  ImGui::SameLine(ImGui::GetWindowWidth() - button_width("×") - ui.px(8));
  if (button(ui, "×", "assumption.hide")) ui.emit("assumptions.hide");
  tooltip("Hide these for this recording");
}

}  // namespace planescope::desktop
