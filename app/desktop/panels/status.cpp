#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

/// The recording and the frame that is looked at, with its gravity.
std::string left_text(const State& state) {
  const OpenRecording* open = state.document.current();
  if (!open) return "No recording is open";
  // Numbered from 0, as everywhere.
  const int frames = open->recording->frame_count();
  std::string text = fmt::format("{}  ·  frame {} ({} frame{})", open->path.filename().string(),
                                 state.document.frame, frames, frames == 1 ? "" : "s");
  if (const debug::Run* run = state.run()) {
    const planes::PreparedFrame& prepared = run->subject->prepared;
    text += fmt::format("  ·  {} {}  ·  gravity: {}", prepared.voxels.points.size(),
                        prepared.of_pixels           ? "pixels"
                        : prepared.voxels.size_m > 0 ? "voxels"
                                                     : "points",
                        prepared.gravity.known() ? to_string(prepared.gravity.source) : "unknown");
    if (prepared.gravity.known() && prepared.gravity.confidence < 1)
      text += fmt::format(" ({:.0f} %)", 100 * prepared.gravity.confidence);
  }
  return text;
}

/// The state of the labels: what keeps them from being saved comes first.
std::string label_text(const State& state) {
  const labels::LabelStore* store = state.document.current()->labels.get();
  if (!store) return "";
  if (!store->read_only().empty()) return store->read_only();
  const std::string& problem = state.results.label.save_problem;
  if (!problem.empty()) return "Not saved (in the journal): " + problem;
  return fmt::format("labels by {}  ·  {}", store->annotator(),
                     store->any_unsaved() ? "not saved yet" : "saved");
}
bool labels_are_barred(const State& state) {
  const labels::LabelStore* store = state.document.current()->labels.get();
  return store && (!store->read_only().empty() || !state.results.label.save_problem.empty());
}

std::string right_text(const State& state) {
  if (state.view.mode == Mode::labels) return label_text(state);
  const debug::Run* run = state.run();
  if (!run) return "";
  std::string text = state.shown_side();
  if (!text.empty()) text += "  ·  ";
  if (state.view.isolated) text = "isolated  ·  " + text;
  if (run->is_ours())
    text += fmt::format("{}  ·  {}", planes::to_string(run->segment_options.profile),
                        run->options.classifier);
  else
    text += fmt::format("method {}", planes::to_string(run->options.method));
  if (state.run_view()->score) {
    const debug::QuickScore& score = *state.run_view()->score;
    text += fmt::format("  ·  {} of {} true planes found", score.detected, score.planes.size());
  } else {
    text += "  ·  " + counted(run->segmentation.planes.size(), "plane");
  }
  return text;
}

/// Above the status bar, wrapped.
void draw_long_message(const Ui& ui, const std::string& message, ImU32 color) {
  const ImVec2 bar = ImGui::GetWindowPos();
  const float margin = ui.px(8), width = std::min(ui.px(640), ImGui::GetWindowWidth() - 2 * margin);
  const ImVec2 text = ImGui::CalcTextSize(message.c_str(), nullptr, false, width - 2 * margin);
  const ImVec2 max(bar.x + margin + std::min(width, text.x + 2 * margin), bar.y - margin);
  const ImVec2 min(bar.x + margin, max.y - text.y - 2 * margin);
  ImDrawList* draw = ImGui::GetForegroundDrawList();
  draw->AddRectFilled(min, max, ImGui::GetColorU32(ImGuiCol_PopupBg), ui.px(4));
  draw->AddRect(min, max, color, ui.px(4));
  draw->AddText(nullptr, 0, ImVec2(min.x + margin, min.y + margin), color, message.c_str(), nullptr,
                width - 2 * margin);
  ui.name("status.message", min, max);
}

}  // namespace

void draw_status(const Ui& ui) {
  const State& state = ui.state;
  ImGui::TextUnformatted(left_text(state).c_str());
  const std::string right = right_text(state);
  const float width = ImGui::CalcTextSize(right.c_str()).x;
  const float at = ImGui::GetWindowWidth() - width - ui.px(12);
  std::string busy;
  if (state.results.loading) busy = "Reading the frame …";
  const int frames = static_cast<int>(state.results.strip.size());
  if (busy.empty() && state.results.strip_done < frames && !state.view.strip_stopped)
    busy = fmt::format("thumbnails {} of {} …", state.results.strip_done, frames);
  const CarryJob& carry = state.results.label.carry;
  if (carry.running)
    busy = fmt::format("Carrying labels from frame {}, {:.0f} % …  Esc cancels", carry.from,
                       100 * carry.progress);
  const MapResults& map = state.results.map;
  if (map.running)
    busy = fmt::format("Tracking planes: {} {} of {} …", map.stage, map.done, map.total);
  const SpreadWork& spread = state.results.label.spread;
  if (spread.running)
    busy = fmt::format("Proposing labels from frame {}, {} of {} frames …  Esc cancels",
                       spread.from, spread.done, spread.total);
  const std::optional<StepsSaving>& saving = state.view.saving;
  if (saving && !saving->hidden)
    busy = fmt::format("{} of {} steps saved …  Esc cancels", saving->written, saving->count());
  const bool tells = carry.running || map.running || spread.running || (saving && !saving->hidden);
  const std::string& message = state.view.message.empty() || tells ? busy : state.view.message;
  if (!message.empty()) {
    ImGui::SameLine(0, ui.px(24));
    const float room = at - ImGui::GetCursorPosX() - ui.px(16);
    const ImU32 color = state.view.message_is_error ? ui.colors.bad : ui.colors.accent;
    if (ImGui::CalcTextSize(message.c_str()).x <= room) {
      colored(color, message);
      ui.name("status.message");
    } else {
      draw_long_message(ui, message, color);
    }
  }
  ImGui::SameLine(std::max(at, ui.px(8)));
  const bool barred = state.view.mode == Mode::labels && labels_are_barred(state);
  colored(barred ? ui.colors.bad : ui.colors.text, right);
  ui.name("status.right");
}

}  // namespace planescope::desktop
