// Panels of open recordings and of the current recording's frames, and the status bar.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/desktop/labeling/work.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {

namespace {

void draw_recordings(const Ui& ui) {
  const Document& document = ui.state.document;
  for (std::size_t i = 0; i < document.recordings.size(); ++i) {
    const OpenRecording& open = document.recordings[i];
    std::string name = open.path.filename().string();
    if (name.empty()) name = open.path.parent_path().filename().string();
    ImGui::PushID(static_cast<int>(i));
    const bool chosen = document.recording == static_cast<int>(i);
    name = fitted(ui, name, ImGui::GetContentRegionAvail().x);
    if (ImGui::Selectable(name.c_str(), chosen) && !chosen) ui.act("recording.show", i);
    ImGui::PopID();
    ui.name(fmt::format("recording.{}", i));
    tooltip(fmt::format("{}\n{}, {} frames", open.path.string(), open.recording->info().format,
                        open.recording->frame_count()));
  }
  action_button(ui, "recording.open", "open …");
}

void draw_progress(const Ui& ui) {
  const int done = ui.state.results.strip_done;
  const auto total = static_cast<int>(ui.state.results.strip.size());
  if (done >= total) return;
  const bool stopped = ui.state.view.strip_stopped;
  const float stop = stopped ? 0 : ImGui::CalcTextSize("stop").x + ui.px(18);
  ImGui::ProgressBar(static_cast<float>(done) / static_cast<float>(std::max(total, 1)),
                     ImVec2(ImGui::GetContentRegionAvail().x - stop, 0),
                     fmt::format("{} of {}", done, total).c_str());
  ui.name("frames.progress");
  if (stopped) return;
  ImGui::SameLine();
  action_button(ui, "strip.cancel", "stop");
}

/// A cheap hash that detects changes by sampling some of the bytes.
std::uint64_t version_of(const Image8& image) {
  std::uint64_t hash = 1469598103934665603u ^ image.data.size();
  for (std::size_t i = 0; i < image.data.size(); i += 97)
    hash = (hash ^ image.data[i]) * 1099511628211u;
  return hash;
}

constexpr ImU32 kFlagGround = IM_COL32(16, 18, 22, 215);

/// Draws a short text on a thumbnail, with a colored edge on the left and the upper right corner at
/// `corner`.
WidgetRect draw_flag(
    const Ui& ui, ImVec2 corner, const std::string& text, ImU32 edge, float indent) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImVec2 from(corner.x - size.x - ui.px(3) - indent, corner.y);
  const ImVec2 to(corner.x, from.y + size.y + ui.px(4));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(from, to, kFlagGround, ui.px(3));
  draw->AddRectFilled(from, ImVec2(from.x + ui.px(3), to.y), edge, ui.px(3));
  draw->AddText(ImVec2(from.x + indent, from.y + ui.px(2)), IM_COL32_WHITE, text.c_str());
  return {from, to};
}

/// Number of planes labeled in a frame of clouds, in label mode; nullopt in other modes and for
/// unopened frames.
std::optional<std::size_t> labeled_planes(const Ui& ui, int frame) {
  const labels::LabelStore* store = ui.state.document.current()->labels.get();
  const LabelFrame* shown = ui.state.label_frame();
  if (ui.state.view.mode != Mode::labels || !store || !shown || !shown->grid.is_cloud())
    return std::nullopt;
  const std::shared_ptr<const FrameLabels> labels = store->labels(frame);
  if (!labels) return std::nullopt;
  return labels->planes.size();
}

/// Draws the result in the thumbnail's corner: planes found out of the true ones, labeled out of
/// the found ones, or just found.
void draw_outcome(const Ui& ui, const Thumbnail& thumbnail, int frame, ImVec2 corner) {
  if (thumbnail.planes < 0 && thumbnail.refusal.empty()) return;
  std::string text = counted(static_cast<std::size_t>(std::max(0, thumbnail.planes)), "plane");
  ImU32 color = ui.colors.muted;
  if (!thumbnail.refusal.empty()) {
    text = "rejected";
    color = ui.colors.bad;
  } else if (thumbnail.score) {
    const auto total = static_cast<int>(thumbnail.score->planes.size());
    const int found = thumbnail.score->detected;
    text = fmt::format("{} / {}", found, total);
    color = found == total       ? ui.colors.good
            : 2 * found >= total ? ui.colors.warning
                                 : ui.colors.bad;
  } else if (const auto labeled = labeled_planes(ui, frame)) {
    text = fmt::format("{} of {} labeled", *labeled, thumbnail.planes);
    color = *labeled > 0 ? ui.colors.accent : ui.colors.muted;
  }
  draw_flag(ui, ImVec2(corner.x - ui.px(4), corner.y + ui.px(4)), text, color, ui.px(5));
}

std::string describe(const Thumbnail& thumbnail, int frame) {
  std::string text = fmt::format("frame {}", frame);
  if (!thumbnail.ready) {
    text += ": not segmented yet";
  } else if (!thumbnail.refusal.empty()) {
    text += ": cannot be segmented: " + thumbnail.refusal;
  } else if (thumbnail.planes < 0) {
    text += ": not segmented in label mode";
  } else if (thumbnail.score) {
    const std::size_t total = thumbnail.score->planes.size();
    text += fmt::format(
        ": {} of {} true planes found, mean IoU {:.2f}\n"
        "Green: all found; yellow: at least half; red: fewer",
        thumbnail.score->detected, total, thumbnail.score->mean_iou);
  } else {
    text += fmt::format(": {} found; no ground truth",
                        counted(static_cast<std::size_t>(thumbnail.planes), "plane"));
  }
  return text;
}

void draw_label_mark(const Ui& ui, int frame, ImVec2 corner) {
  const labels::LabelStore* store = ui.state.document.current()->labels.get();
  if (ui.state.view.mode != Mode::labels || !store) return;
  const FrameMark mark = frame_mark(ui.state, frame);
  const bool unsaved = store->unsaved(frame);
  if (!mark.labeled && !unsaved) return;
  const std::string text =
      std::string(mark.reviewed ? "reviewed" : "labels") + (unsaved ? " *" : "");
  const float height = ImGui::GetTextLineHeight() + ui.px(4);
  const auto [from, to] =
      draw_flag(ui, ImVec2(corner.x - ui.px(4), corner.y - ui.px(4) - height), text,
                mark.reviewed ? ui.colors.good : ui.colors.accent, ui.px(6));
  ui.name(fmt::format("frame.{}.labels", frame), from, to);
}

void draw_thumbnail(const Ui& ui, int frame, ImVec2 size) {
  const Thumbnail& thumbnail = ui.state.results.strip[static_cast<std::size_t>(frame)];
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 end(at.x + size.x, at.y + size.y);
  ImGui::PushID(frame);
  if (ImGui::InvisibleButton("frame", size)) ui.act("frame.show", frame);
  ImGui::PopID();
  ui.name(fmt::format("frame.{}", frame));
  tooltip(describe(thumbnail, frame));

  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(at, end, ui.colors.panel, ui.px(3));
  if (ui.canvas && !thumbnail.image.empty()) {
    const TextureId texture =
        ui.canvas->picture(fmt::format("frame.{}.{}", ui.state.document.recording, frame),
                           thumbnail.image, version_of(thumbnail.image));
    // Fit the picture, keeping its aspect ratio.
    const float scale = std::min(size.x / static_cast<float>(thumbnail.image.width),
                                 size.y / static_cast<float>(thumbnail.image.height));
    const float w = scale * static_cast<float>(thumbnail.image.width);
    const float h = scale * static_cast<float>(thumbnail.image.height);
    const ImVec2 from(at.x + (size.x - w) / 2, at.y + (size.y - h) / 2);
    draw->AddImage(imgui_texture(texture), from, ImVec2(from.x + w, from.y + h));
  }
  if (thumbnail.ready) draw_outcome(ui, thumbnail, frame, ImVec2(end.x, at.y));
  draw_label_mark(ui, frame, end);
  const std::string number = std::to_string(frame);
  const ImVec2 extent = ImGui::CalcTextSize(number.c_str());
  const ImVec2 foot(at.x + ui.px(4), end.y - extent.y - ui.px(5));
  draw->AddRectFilled(ImVec2(foot.x - ui.px(1), foot.y - ui.px(1)),
                      ImVec2(foot.x + extent.x + ui.px(5), end.y - ui.px(3)), kFlagGround,
                      ui.px(3));
  draw->AddText(ImVec2(foot.x + ui.px(2), foot.y), IM_COL32_WHITE, number.c_str());
  if (const std::string side = ui.state.shown_side();
      !side.empty() && frame == ui.state.document.frame) {
    const auto [from, to] = draw_flag(
        ui, ImVec2(at.x + ImGui::CalcTextSize(side.c_str()).x + ui.px(16), at.y + ui.px(4)), side,
        ui.colors.accent, ui.px(6));
    ui.name("frames.side", from, to);
  }
  if (frame == ui.state.document.frame)
    draw->AddRect(at, end, ui.colors.accent, ui.px(3), 0, ui.px(2.5f));
}

void draw_strip(const Ui& ui) {
  const auto count = static_cast<int>(ui.state.results.strip.size());
  ImGui::BeginChild("strip");
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 size(width, std::round(0.75f * width));
  const float row = size.y + ImGui::GetStyle().ItemSpacing.y;
  // Scroll to the current frame when it changes, but let the user scroll away from it.
  double& shown = ui.memory.numbers["frames.shown"];
  const auto wanted = static_cast<double>(1 + ui.state.document.frame);
  if (shown != wanted && count > 0) {
    const float top = row * static_cast<float>(ui.state.document.frame);
    const float scroll = ImGui::GetScrollY(), height = ImGui::GetWindowHeight();
    if (top < scroll || top + row > scroll + height) ImGui::SetScrollY(top - (height - row) / 2);
    // A new list can only be scrolled from its second frame on.
    if (ImGui::GetScrollMaxY() > 0 || row * static_cast<float>(count) <= height) shown = wanted;
  }
  ImGuiListClipper clipper;
  clipper.Begin(count, row);
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) draw_thumbnail(ui, i, size);
  ImGui::EndChild();
}

}  // namespace

void draw_frames(const Ui& ui) {
  draw_recordings(ui);
  ImGui::Separator();
  draw_progress(ui);
  draw_strip(ui);
}

namespace {

/// The current recording and frame, and its gravity.
std::string left_text(const State& state) {
  const OpenRecording* open = state.document.current();
  if (!open) return "No recording is open";
  // Frames are numbered from 0 everywhere.
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

/// State of the labels; anything that prevents saving comes first.
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

/// Draws a wrapped message above the status bar.
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
  const bool shows_progress =
      carry.running || map.running || spread.running || (saving && !saving->hidden);
  const std::string& message =
      state.view.message.empty() || shows_progress ? busy : state.view.message;
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
