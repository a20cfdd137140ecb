// What would fix this? A plane of the ground truth or a marked region, the smallest changes that
// recover it, and what each of them does to the other frames.

#include "core/debug/explain/fix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "app/desktop/debugger/fix_table.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

/// A column as wide as buttons with these texts.
void button_column(const Ui& ui, std::initializer_list<const char*> texts) {
  const float spacing = ImGui::GetStyle().ItemSpacing.x;
  float width = -spacing;
  for (const char* text : texts) width += button_width(text) + spacing;
  ImGui::TableSetupColumn(" ", ImGuiTableColumnFlags_WidthFixed, width + ui.px(1));
}

ImU32 color_of(const Ui& ui, debug::TruthVerdict verdict) {
  return verdict == debug::TruthVerdict::detected ? ui.colors.good : ui.colors.bad;
}

void draw_truth_planes(const Ui& ui, const RunView& view) {
  if (!view.score) return;
  const debug::Run& run = *view.run;
  const std::vector<debug::TruthMatch>& planes = view.score->planes;
  const std::vector<debug::TruthVerdict> verdicts =
      debug::verdicts_of(*view.score, run.segmentation.plane_of, run.subject->voxel_truth);
  std::vector<std::size_t> order(planes.size());  // the worst first
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return planes[a].iou < planes[b].iou; });
  if (!ImGui::BeginTable("truth", 4, kTable)) return;
  ImGui::TableSetupColumn("true plane", ImGuiTableColumnFlags_WidthStretch);
  fixed_column("", "detected");
  fixed_column("IoU", "0.00");
  button_column(ui, {"Find a fix"});
  ImGui::TableHeadersRow();
  for (const std::size_t i : order) {
    const debug::TruthMatch& match = planes[i];
    const debug::TruthVerdict verdict = verdicts[i];
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::Text("%d", match.truth);
    ImGui::SameLine();
    ImGui::TextDisabled("%u voxels", match.points);
    ImGui::TableNextColumn();
    colored(color_of(ui, verdict), debug::to_string(verdict));
    ImGui::TableNextColumn();
    ImGui::Text("%.2f", match.iou);
    ImGui::TableNextColumn();
    if (verdict != debug::TruthVerdict::detected && run.is_ours() &&
        button(ui, "Find a fix", fmt::format("fix.plane.{}", match.truth)))
      ui.emit("fix.plane", std::to_string(match.truth));
  }
  ImGui::EndTable();
}

void draw_marked(const Ui& ui) {
  const std::size_t marked = ui.state.document.marked.size();
  if (button(ui, ui.state.view.marking ? "Drag on the image" : "Mark a region", "fix.mark"))
    ui.emit("mark.toggle");
  ImGui::SameLine();
  if (button(ui, "Fix region", "fix.marked", marked > 0)) ui.emit("fix.marked");
  ImGui::SameLine();
  if (marked > 0) ImGui::TextDisabled("%s marked", counted(marked, "voxel").c_str());
}

void draw_fixes(const Ui& ui, const FixSearch& fix) {
  const RunView* current = ui.state.results.current.get();
  draw_fix_table(ui, fix, current && current->score);
}

std::string ids_text(const std::vector<std::int32_t>& ids) {
  return ids.empty() ? "–" : fmt::format("{}", fmt::join(ids, ", "));
}

void draw_effects(const Ui& ui, const FixSearch& fix) {
  int recovered = 0, broken = 0;
  for (const debug::FixEffect& effect : fix.effects) {
    recovered += static_cast<int>(effect.recovered.size());
    broken += static_cast<int>(effect.broken.size());
  }
  const debug::Fix& chosen = fix.fixes[static_cast<std::size_t>(fix.checked)];
  heading(ui, fmt::format("{} = {} on {}", chosen.option, chosen.after,
                          counted(fix.effects.size(), "labeled frame")));
  paragraph(broken > recovered ? ui.colors.warning : ui.colors.text,
            fmt::format("Recovers {} {}, breaks {}.", recovered,
                        recovered == 1 ? "plane" : "planes", broken));
  if (!ImGui::BeginTable("effects", 5, kTable)) return;
  fixed_column("frame", "000");
  fixed_column("detected", "10→10 of 10");
  fixed_column("mean IoU", "0.00→0.00");
  for (const char* title : {"recovers", "breaks"})
    ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableHeadersRow();
  for (const debug::FixEffect& effect : fix.effects) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    if (link(ui, std::to_string(effect.frame), fmt::format("fix.frame.{}", effect.frame)))
      ui.emit("frame.show", std::to_string(effect.frame));
    ImGui::TableNextColumn();
    ImGui::Text("%d→%d of %d", effect.detected_before, effect.detected_after, effect.planes_truth);
    ImGui::TableNextColumn();
    ImGui::Text("%.2f→%.2f", effect.iou_before, effect.iou_after);
    ImGui::TableNextColumn();
    paragraph(effect.recovered.empty() ? ui.colors.muted : ui.colors.good,
              ids_text(effect.recovered));
    ImGui::TableNextColumn();
    paragraph(effect.broken.empty() ? ui.colors.muted : ui.colors.bad, ids_text(effect.broken));
  }
  ImGui::EndTable();
}

void draw_search(const Ui& ui, const FixSearch& fix) {
  heading(ui, fix.asked ? "Fix for the clicked point" : "Fix for " + fix.target.name);
  if (fix.running) draw_fix_progress(ui, fix);
  if (!fix.running || !fix.fixes.empty()) draw_fixes(ui, fix);
  if (!fix.running) {
    if (fix.checked >= 0 && fix.checked < static_cast<int>(fix.fixes.size())) draw_effects(ui, fix);
  }
  ImGui::Spacing();
  ImGui::Separator();
}

/// What to do here, before any search.
std::string invitation(const RunView& view, bool marked) {
  if (marked)
    return "Fix region tries every option for the smallest change that "
           "makes the marked region one plane.";
  const std::string tried = " Every option is tried for the smallest change that does it.";
  if (!view.score) return "Mark a region of the image that should be one plane." + tried;
  if (view.score->detected == static_cast<int>(view.score->planes.size()))
    return "All true planes of this frame are found. Mark a region to search for another plane." +
           tried;
  return "Choose a lost plane, or mark a region that should be one plane." + tried;
}

}  // namespace

void draw_fix(const Ui& ui) {
  const RunView* view = ui.state.results.current.get();
  if (!view) return paragraph(ui.colors.muted, "Open a frame to search for fixes.");
  if (!view->run->is_ours()) {
    paragraph(ui.colors.muted, "Fixes are available for method ours.");
    return draw_truth_planes(ui, *view);
  }
  const bool image = !view->run->subject->frame.depth.empty();
  if (!view->score && !image)
    return paragraph(ui.colors.muted,
                     "Fixes need ground truth or a region marked in an image; "
                     "this cloud has neither. Click a point instead.");
  const FixSearch& fix = ui.state.results.fix;
  if (fix.running || fix.finished)
    draw_search(ui, fix);
  else
    paragraph(ui.colors.muted, invitation(*view, !ui.state.document.marked.empty()));
  draw_truth_planes(ui, *view);
  if (image) draw_marked(ui);
}

}  // namespace planescope::desktop
