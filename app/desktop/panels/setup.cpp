// Panels for missing intrinsics, assumptions about a recording, and gravity.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/io/folder/folder_files.hpp"

namespace planescope::desktop {

// ---- Intrinsics ---------------------------------------------------------------------------------

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

/// Camera choices and fields of this recording, computed once.
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

/// Draws a labeled input box in a table; returns its number if it is above 0.
std::optional<double> draw_field(const Ui& ui, const char* title, const std::string& widget) {
  std::string& text = ui.memory.texts[widget];
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();  // aligns all titles
  ImGui::TextDisabled("%s", title);
  ImGui::SetNextItemWidth(-1);
  ImGui::InputText(("##" + widget).c_str(), &text);
  ui.name(widget);
  const auto value = parse_number(text);
  return value && *value > 0 ? value : std::nullopt;
}

void draw_choices(const Ui& ui, const std::vector<io::CameraChoice>& choices) {
  for (const bool files : {true, false}) {
    bool titled = false;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const io::CameraChoice& choice = choices[i];
      if (choice.from_file != files) continue;
      if (!titled) {
        ImGui::Spacing();
        ImGui::TextDisabled("%s",
                            files ? "Found near the recording" : "Nominal values (1 to 2 % off)");
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
  std::string wrong;  // the first field whose value is not above 0
  CameraEntry entry;
  const float width = std::min(ui.px(560), ImGui::GetContentRegionAvail().x);
  if (ImGui::BeginTable("fields", width < ui.px(420) ? 3 : 5, ImGuiTableFlags_SizingStretchSame,
                        ImVec2(width, 0))) {
    for (std::size_t i = 0; i < kFields.size(); ++i) {
      const std::string widget = std::string("setup.") + kFields[i];
      const auto value = draw_field(ui, fmt::format("{} [px]", kFields[i]).c_str(), widget);
      if (!value && wrong.empty()) wrong = kFields[i];
      entry.intrinsics[i] = value.value_or(0);
    }
    entry.depth_unit_m = draw_field(ui, "m per count", kUnit);
    if (!entry.depth_unit_m && wrong.empty()) wrong = "m per count";
    ImGui::EndTable();
  }
  if (!wrong.empty()) {
    colored(ui.colors.warning, fmt::format("{} must be a number above 0", wrong));
    ui.name("setup.wrong");
  }
  if (button(ui, info.knows_camera() ? "Apply" : "Open", "setup.apply", wrong.empty())) {
    entry.remember = ui.memory.numbers["setup.remember"] != 0;
    ui.act("intrinsics.set", entry);
  }
  if (info.knows_camera()) {
    ImGui::SameLine();
    if (button(ui, "Cancel", "setup.cancel")) ui.act("intrinsics.edit");
  }
  const char* title = "Save next to the recording";
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
    if (one.button.empty()) continue;
    ImGui::SameLine();
    if (button(ui, one.button, fmt::format("assumption.{}", i))) ui.commands.push_back(one.command);
    tooltip(one.why);
  }
  if (!rest.empty()) {
    ImGui::SameLine();
    ImGui::TextDisabled("…");
    tooltip(rest);
  }
  ImGui::SameLine(ImGui::GetWindowWidth() - button_width("×") - ui.px(8));
  if (button(ui, "×", "assumption.hide")) ui.act("assumptions.hide");
  tooltip("Hide these for this recording");
}

// ---- Assumptions --------------------------------------------------------------------------------

namespace {

constexpr double kFarShare = 0.1;         // of the measured points
constexpr double kLeastConfidence = 0.5;  // of estimated gravity
constexpr double kPointsPerEdge = 2.5;    // along a voxel edge; fewer are not too coarse

/// The next wider range to try; 0: none.
double wider_range(double range_m) {
  for (const double wider : {4.0, 10.0})
    if (range_m < 0.99 * wider) return wider;
  return 0;
}

/// Distance between neighboring points, assuming that each voxel contains a square of surface.
double spacing_m(const debug::Subject& subject) {
  const auto points = static_cast<double>(subject.prepared.cloud.points.size());
  const auto voxels = static_cast<double>(subject.voxel_count());
  return voxels > 0 ? subject.prepared.voxels.size_m / std::sqrt(points / voxels) : 0;
}

/// Warnings about a recording: the first one, shortened, and the number of others.
Assumption of_warnings(const std::vector<std::string>& warnings, bool has_camera) {
  constexpr std::size_t kMostLetters = 72;
  std::string text =
      shortened(warnings[0], [](const std::string& s) { return s.size() <= kMostLetters; });
  if (warnings.size() > 1) text += fmt::format(" (+{} more)", warnings.size() - 1);
  return {text,
          has_camera ? "edit" : "",
          fmt::format("{}", fmt::join(warnings, "\n")),
          {"intrinsics.edit"}};
}

/// The smallest of the usual sizes that still contains several points.
double voxel_for(double spacing_m) {
  for (const double size : {0.002, 0.005, 0.01})
    if (size > kPointsPerEdge * spacing_m) return size;
  return 0.02;
}

}  // namespace

std::vector<Assumption> assumptions_of(const State& state) {
  const RunView* view = state.run_view();
  const OpenRecording* open = state.document.current();
  if (!view || !open || open->path == state.view.assumptions_hidden) return {};
  const debug::Subject& subject = *view->run->subject;
  const planes::PipelineOptions& options = view->run->options;
  const io::RecordingInfo& info = open->recording->info();
  std::vector<Assumption> all;
  if (!info.warnings.empty()) all.push_back(of_warnings(info.warnings, info.width > 0));
  if (info.intrinsics_source.starts_with("assumed"))
    all.push_back({fmt::format("Intrinsics {}", info.intrinsics_source),
                   "edit",
                   "The recording has no intrinsics. Wrong ones bend planes and change sizes.",
                   {"intrinsics.edit"}});
  else if (const std::string camera = io::nominal_camera(info.intrinsics); !camera.empty())
    all.push_back({fmt::format("Intrinsics nominal ({})", camera),
                   "edit",
                   "Individual cameras differ by 1 to 2 %.",
                   {"intrinsics.edit"}});
  if (!subject.frame.is_cloud() && info.depth_unit_source.starts_with("assumed"))
    all.push_back({fmt::format("Depth unit {:g} mm assumed", 1000 * info.depth_unit_m),
                   "edit",
                   "The recording has no depth unit. A wrong one scales all lengths.",
                   {"intrinsics.edit"}});
  const double beyond = view->summary.share(view->summary.beyond);
  const double wider = wider_range(options.cloud.max_range_m);
  if (beyond > kFarShare && wider > 0)
    all.push_back({fmt::format("{:.0f} % beyond {:g} m", 100 * beyond, options.cloud.max_range_m),
                   fmt::format("show {:g} m", wider),
                   "Points beyond the option max_range_m are not segmented.",
                   command("option.set", OptionValue{"max_range_m", fmt::format("{:g}", wider)})});
  const Gravity& gravity = subject.prepared.gravity;
  if (gravity.known() && gravity.confidence < kLeastConfidence)
    all.push_back({fmt::format("Gravity uncertain ({:.0f} %)", 100 * gravity.confidence),
                   "click the floor",
                   "Gravity was estimated from the scene. Click a floor or a wall to set it.",
                   {"gravity.click.floor"}});
  if (const std::string doubt =
          planes::doubt_in_voxels(subject.prepared.cloud, options.cloud.voxel_size_m);
      !doubt.empty()) {
    all.push_back({doubt, "use 20 mm", "Voxels that contain the whole scene hide its planes.",
                   command("option.set", OptionValue{"voxel_size_m", "0.02"})});
  } else if (subject.frame.is_cloud()) {
    const double size = subject.prepared.voxels.size_m, spacing = spacing_m(subject);
    const double finer = voxel_for(spacing);
    if (size > kPointsPerEdge * spacing && finer < 0.99 * size)
      all.push_back(
          {fmt::format("Voxel {:g} mm, points every {:.2g} mm", 1000 * size, 1000 * spacing),
           fmt::format("use {:g} mm", 1000 * finer),
           "Voxels much coarser than the points hide small planes.",
           command("option.set", OptionValue{"voxel_size_m", fmt::format("{:g}", finer)})});
  }
  if (info.color_note.starts_with("assumed aligned") && subject.frame.color.channels == 3)
    all.push_back({"Color assumed aligned",
                   "check",
                   "Color and depth have the same size, but the recording does not declare them "
                   "aligned. Compare the depth edges with the color image to check.",
                   {"image.edges"}});
  if (view->run->segmentation.planes.empty())
    all.push_back({"0 planes", "", "Check the depth unit, maximum range, and voxel size.", {}});
  return all;
}

// ---- Gravity ------------------------------------------------------------------------------------

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
  ImGui::AlignTextToFramePadding();  // align with the buttons beside it
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
  if (ImGui::RadioButton("This frame", !all) && all) ui.act("gravity.all_frames");
  ui.name("gravity.this_frame");
  ImGui::SameLine();
  if (ImGui::RadioButton("All frames", all) && !all) ui.act("gravity.all_frames");
  ui.name("gravity.all_frames");
}

}  // namespace planescope::desktop
