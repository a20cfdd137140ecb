// Timeline of tracks: one row per track, frames from left to right, clickable gaps.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/panels.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "app/desktop/widgets.hpp"
#include "core/world/files/map_files.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

using world::Absence;
using world::Moment;
using world::Track;

/// Frames on screen.
struct Axis {
  float x = 0, width = 0;
  int first = 0, last = 0;

  float frame_width() const { return width / static_cast<float>(std::max(1, last - first + 1)); }
  float begin(int frame) const { return x + frame_width() * static_cast<float>(frame - first); }
  int frame_at(float screen_x) const {
    return std::clamp(first + static_cast<int>((screen_x - x) / frame_width()), first, last);
  }
};

ImU32 track_color(const Ui& ui, const MapView& view, const Track& track) {
  const auto i = static_cast<std::size_t>(track.id) - 1;
  constexpr double kMostArea_m2 = 2, kMostRms_m = 0.01;
  switch (ui.state.view.tracks.color_by) {
    case TrackColor::area:
      return to_imgui(render::ramp_color(std::sqrt(std::min(1.0, view.area_m2[i] / kMostArea_m2))));
    case TrackColor::rms:
      return to_imgui(render::ramp_color(std::min(1.0, track.fit.rms_m() / kMostRms_m)));
    case TrackColor::track:
      break;
  }
  return to_imgui(render::plane_color(view.colors[i]));
}

/// Color of a missed frame: plane not detected, not matched to the track, or absent.
ImU32 gap_color(const Ui& ui, Absence why) {
  return why == Absence::not_detected  ? ui.colors.bad
         : why == Absence::not_matched ? ui.colors.warning
                                       : ui.colors.muted;
}

/// Draws a missed frame. Stripes distinguish the reasons besides color: falling if no plane was
/// found, rising if another plane is there, none if the plane is gone.
void draw_gap(const Ui& ui, Absence why, ImVec2 min, ImVec2 max) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImU32 color = gap_color(ui, why);
  draw->AddRectFilled(min, max, with_alpha(color, 90));
  draw->PushClipRect(min, max, true);
  const float height = max.y - min.y, period = ui.px(5);
  const bool falls = why == Absence::not_detected, rises = why == Absence::not_matched;
  // Start at multiples of the period, so that adjacent gaps share one pattern.
  for (float x = std::floor((min.x - height) / period) * period; (falls || rises) && x < max.x;
       x += period)
    draw->AddLine(ImVec2(x, falls ? min.y : max.y), ImVec2(x + height, falls ? max.y : min.y),
                  color, ui.px(1.5f));
  draw->PopClipRect();
  draw->AddRect(min, max, color);
}

void draw_legend(const Ui& ui) {
  static constexpr std::pair<Absence, const char*> kStates[] = {
      {Absence::not_detected, "no plane found"},
      {Absence::not_matched, "different plane found"},
      {Absence::seen_through, "gone, or frame excluded"}};
  const ImVec2 size(ui.px(20), ImGui::GetTextLineHeight() * 0.8f);
  bool first = true;
  for (const auto& [why, text] : kStates) {
    if (!first && !same_line_if_room(size.x + ImGui::CalcTextSize(text).x + ui.px(6), ui.px(14)))
      return;
    first = false;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    draw_gap(ui, why, ImVec2(at.x, at.y + ui.px(2)),
             ImVec2(at.x + size.x, at.y + size.y + ui.px(2)));
    ImGui::Dummy(size);
    ImGui::SameLine(0, ui.px(6));
    colored(ui.colors.muted, text);
  }
}

void draw_row(const Ui& ui,
              const MapView& view,
              const Track& track,
              const Axis& axis,
              ImVec2 at,
              float height) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float middle = at.y + height / 2, thin = std::max(1.0f, ui.px(1)), half = height / 2 - thin;
  const auto span = [&](int from, int to) {
    const float begin = axis.begin(from);
    return std::pair{begin, std::max(axis.begin(to + 1), begin + 1)};
  };
  for (const world::Gap& gap : track.gaps) {
    const auto [begin, end] = span(gap.first, gap.last);
    if (is_miss(gap.why))
      draw_gap(ui, gap.why, ImVec2(begin, middle - half),
               ImVec2(std::max(end, begin + ui.px(2)), middle + half));
    else
      draw->AddLine(ImVec2(begin, middle), ImVec2(end, middle), ui.colors.grid, thin);
  }
  const ImU32 color = track_color(ui, view, track);
  // Consecutive frames are one bar, which is lower if only minor planes represent the track.
  for (std::size_t i = 0; i < track.sightings.size();) {
    std::size_t end = i + 1;
    while (end < track.sightings.size() &&
           track.sightings[end].frame <= track.sightings[end - 1].frame + 1 &&
           track.sightings[end].minor == track.sightings[i].minor)
      ++end;
    const auto [from, to] = span(track.sightings[i].frame, track.sightings[end - 1].frame);
    const float low = track.sightings[i].minor ? half / 3 : half;
    draw->AddRectFilled(ImVec2(from, middle - low), ImVec2(to, middle + low), color);
    i = end;
  }
}

std::string name_of(const MapView& view, const Track& track) {
  const double area = view.area_m2[static_cast<std::size_t>(track.id) - 1];
  const std::string label =
      track.label == Label::unknown ? "" : fmt::format(" {}", to_string(track.label));
  return area > 0 ? fmt::format("T{}{}  {:.2f} m²", track.id, label, area)
                  : fmt::format("T{}{}", track.id, label);
}

void draw_timeline_of(const Ui& ui, const MapView& view, const std::vector<const Track*>& rows) {
  ImGui::BeginChild("rows");
  const float names = ui.px(118), height = ui.px(17);
  Axis axis;
  axis.x = ImGui::GetCursorScreenPos().x + names;
  axis.width = std::max(ui.px(40), ImGui::GetContentRegionAvail().x - names);
  std::tie(axis.first, axis.last) = view.frames();
  const int selected = ui.state.view.tracks.track, frame = ui.state.document.frame;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, 0));
  // Scroll to the selected track when it changes.
  double& scrolled_to = ui.memory.numbers["tracks.scrolled_to"];
  if (scrolled_to != selected) {
    const auto row = std::ranges::find(rows, selected, &Track::id);
    if (row != rows.end()) scroll_to_row(static_cast<int>(row - rows.begin()), height);
    scrolled_to = selected;
  }
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()), height);
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const Track& track = *rows[static_cast<std::size_t>(i)];
      const ImVec2 at = ImGui::GetCursorScreenPos();
      ImGui::PushID(track.id);
      const bool clicked = ImGui::InvisibleButton("track", ImVec2(names + axis.width, height));
      ImGui::PopID();
      ui.name(fmt::format("tracks.{}", track.id), ImVec2(axis.x, at.y),
              ImVec2(axis.x + axis.width, at.y + height));
      const float mouse = ImGui::GetIO().MousePos.x;
      const bool on_axis = mouse >= axis.x;
      if (clicked)
        ui.act("track.show",
               on_axis ? TrackFrame{track.id, axis.frame_at(mouse)} : TrackFrame{track.id});
      if (ImGui::IsItemHovered() && on_axis)
        tooltip(world::moment_text(view.tracker(), track, axis.frame_at(mouse)));
      ImDrawList* draw = ImGui::GetWindowDrawList();
      if (track.id == selected)
        draw->AddRectFilled(at, ImVec2(axis.x + axis.width, at.y + height),
                            ImGui::GetColorU32(ImGuiCol_Header));
      const bool held = view.area_m2[static_cast<std::size_t>(track.id) - 1] > 0;
      draw->AddText(ImVec2(at.x + ui.px(2), at.y), held ? ui.colors.text : ui.colors.muted,
                    name_of(view, track).c_str());
      draw_row(ui, view, track, axis, at, height);
    }
  ImGui::PopStyleVar();
  const float x = axis.begin(frame) + axis.frame_width() / 2;
  const ImVec2 min = ImGui::GetWindowPos();
  ImGui::GetWindowDrawList()->AddLine(ImVec2(x, min.y), ImVec2(x, min.y + ImGui::GetWindowHeight()),
                                      ui.colors.accent, ui.px(1.5f));
  ImGui::EndChild();
}

void draw_filter(const Ui& ui) {
  const TracksView& view = ui.state.view.tracks;
  std::string text = view.filter;
  ImGui::SetNextItemWidth(ui.px(230));
  if (ImGui::InputTextWithHint("##filter", "filter: gap && length>5", &text))
    ui.act("track.filter", text);
  ui.name("tracks.filter");
  if (!view.filter_problem.empty()) tooltip(view.filter_problem);
}

void draw_colors(const Ui& ui) {
  static constexpr const char* kTitles[] = {"by track", "by area", "by RMS"};
  const auto now = static_cast<std::size_t>(ui.state.view.tracks.color_by);
  ImGui::SetNextItemWidth(ui.px(88));
  if (ImGui::BeginCombo("##color", kTitles[now])) {
    for (std::size_t i = 0; i < std::size(kTitles); ++i)
      if (ImGui::Selectable(kTitles[i], i == now))
        ui.act("track.color", static_cast<TrackColor>(i));
    ImGui::EndCombo();
  }
  ui.name("tracks.color");
}

/// Returns true if there is something to show.
bool draw_state(const Ui& ui, const MapView* view) {
  const MapResults& results = ui.state.results.map;
  if (results.running) {
    const auto total = static_cast<float>(std::max(1, results.total));
    ImGui::ProgressBar(
        static_cast<float>(results.done) / total, ImVec2(ui.px(260), 0),
        results.total > 0
            ? fmt::format("{} {} of {}", results.stage, results.done, results.total).c_str()
            : "begins …");
    ui.name("tracks.progress");
    ImGui::SameLine();
    action_button(ui, "map.stop", "stop");
    return view != nullptr;
  }
  if (!view) {
    paragraph(ui.colors.muted,
              "Match planes from frame to frame. Poses come from the recording, or are estimated "
              "from its images.");
    action_button(ui, "map.make", "Track planes");
    return false;
  }
  if (!is_fresh(*view, ui.state.document)) {
    colored(ui.colors.warning, "Options have changed.");
    ImGui::SameLine();
    action_button(ui, "map.make", "Track again");
  }
  return true;
}

}  // namespace

void draw_tracks(const Ui& ui) {
  const MapView* view = ui.state.map();
  if (!draw_state(ui, view)) return;
  draw_filter(ui);
  ImGui::SameLine();
  draw_colors(ui);
  static constexpr ToolButton kButtons[] = {
      {"show.map", "map"}, {"track.previous", "←"}, {"track.next", "→"}, {"track.gap.next", "gap"}};
  toolbar(ui, "tracks.more", kButtons);
  const TracksView& shown = ui.state.view.tracks;
  const std::string about = track_text(ui.state);
  const std::vector<const Track*> rows = track_rows(ui.state);
  if (!shown.filter_problem.empty())
    paragraph(ui.colors.bad, shown.filter_problem);
  else if (rows.empty())
    paragraph(ui.colors.muted, "No track matches the filter.");
  else if (!about.empty())
    paragraph(ui.colors.text, about);
  else
    paragraph(ui.colors.muted, fmt::format("{}: {}", counted(rows.size(), "track"),
                                           world::stability_text(view->map.stability)));
  ui.name("tracks.about");
  draw_legend(ui);
  draw_timeline_of(ui, *view, rows);
}

}  // namespace planescope::desktop
