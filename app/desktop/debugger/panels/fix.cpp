// "What would fix this?": for a true plane or a marked region, finds the smallest option changes
// that recover it and their effects on other frames. Also answers clicks on points.

#include "core/debug/explain/fix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {

// ---- Changes, and answers to clicks -------------------------------------------------------------

namespace {

constexpr std::size_t kMostShown = 4;  // in an answer

const char* unit_of(const debug::Run& run) { return run.is_on_image() ? "px" : "voxels"; }

void draw_buttons(const Ui& ui, std::size_t i, bool check) {
  const std::string number = std::to_string(i);
  button(ui, "Preview", "fix.preview." + number);
  if (ImGui::IsItemActivated()) ui.act("fix.preview", i);
  if (ImGui::IsItemDeactivated()) ui.act("fix.preview");
  tooltip("Shows the result while you hold the button");
  ImGui::SameLine();
  if (button(ui, "Apply", "fix.apply." + number)) ui.act("fix.apply", i);
  if (!check) return;
  ImGui::SameLine();
  if (button(ui, "Check", "fix.check." + number, ui.state.results.fix.finished))
    ui.act("fix.check", i);
  tooltip("Effect on every labeled frame of the recording");
}

/// "+31 900 px, planes 8 → 9, 212 px change elsewhere".
std::string effect_text(const debug::Run& run, const debug::Fix& fix, debug::Wish wish) {
  const char* unit = unit_of(run);
  const bool frees = wish == debug::Wish::no_plane;  // `gained` counts points that leave the plane
  const char* sign = frees ? "" : fix.gained >= 0 ? "+" : "";
  return fmt::format("{}{} {}{}, planes {} → {}, {} {} change elsewhere", sign, grouped(fix.gained),
                     unit, frees ? " freed" : "", fix.planes_before, fix.planes_after,
                     grouped(fix.elsewhere), unit);
}

bool is_asked(const FixSearch& fix) { return fix.running || fix.finished; }

const char* question(const PointAsked& asked) {
  switch (asked.wish) {
    case debug::Wish::own_plane:
      return asked.with >= 0 ? "Why are these two points in one plane?"
                             : "Why is this not a separate plane?";
    case debug::Wish::no_plane:
      return "How did this get into a plane?";
    case debug::Wish::joined:
      return "Why are these not one plane?";
    default:
      return "Why is this unassigned?";
  }
}

/// The message if no change is needed.
const char* granted_text(debug::Wish wish) {
  switch (wish) {
    case debug::Wish::own_plane:
      return "It is already a separate plane.";
    case debug::Wish::no_plane:
      return "It is already unassigned.";
    case debug::Wish::joined:
      return "They are already one plane.";
    default:
      return "It is already in a plane.";
  }
}

std::string unit_suffix(const planes::OptionInfo& info) {
  const bool none =
      info.unit.empty() || info.unit == "1" || info.unit == "share" || !info.is_number();
  return none ? "" : " " + info.unit;
}

/// Shows "step 49" as a link, and the decision made there.
void draw_decision(const Ui& ui, const char* role, std::int32_t step, const std::string& text) {
  colored(ui.colors.muted, role);
  ImGui::SameLine();
  if (link(ui, fmt::format("step {}", step), fmt::format("answer.{}", role)))
    ui.act("point.step", step);
  math_paragraph(ui, ui.colors.text, text);
}

void draw_decisions(const Ui& ui,
                    const std::shared_ptr<const debug::Run>& of,
                    const FixSearch* fix) {
  const debug::Run& run = *of;
  const std::size_t source = *source_of(ui.state.view.selected, *run.subject);
  PointAnswer& kept = ui.memory.answer;
  if (kept.of.lock() != of || kept.source != source)
    kept = {of, source, debug::why_not(run, source)};
  const debug::WhyNot& why = kept.why;
  std::string answer = why.answer;
  if (const std::string lost = fmt::format("Lost at step {}: ", why.step); answer.starts_with(lost))
    answer.erase(0, lost.size());
  const bool decided = fix && !fix->fixes.empty() && fix->fixes.front().step > 0 &&
                       fix->fixes.front().step != why.step;
  if (decided)
    draw_decision(ui, "cause", fix->fixes.front().step,
                  debug::describe_event(run, fix->fixes.front().step));
  if (why.step > 0)
    draw_decision(ui, decided ? "effect" : "cause", why.step, answer);
  else
    math_paragraph(ui, ui.colors.text, answer);
}

/// The answer about the selected point.
struct Answer {
  std::shared_ptr<const debug::Run> run;
  const FixSearch* fix;  // null: not searched yet
};

/// The search about this point; null: none.
const FixSearch* search_of(const Ui& ui, std::int32_t voxel) {
  const FixSearch& fix = ui.state.results.fix;
  const bool is_of_run = fix.of.get() == ui.state.run_view() || ui.state.view.preview;
  const bool is_of_point = fix.asked && static_cast<std::int32_t>(fix.asked->voxel) == voxel;
  return is_asked(fix) && is_of_point && (is_of_run || !fix.begun) ? &fix : nullptr;
}

/// nullopt if the point is in a plane and no search is about it.
std::optional<Answer> answer_of(const Ui& ui, std::int32_t voxel) {
  const RunView* view = ui.state.run_view();
  if (!view || !view->run->is_ours() || voxel < 0) return {};
  const debug::Run& run = *view->run;
  if (voxel >= static_cast<std::int32_t>(run.subject->voxel_count())) return {};
  const FixSearch* fix = search_of(ui, voxel);
  if (!fix && run.segmentation.plane_of[voxel] > 0) return {};
  return Answer{fix && fix->of ? fix->of->run : view->run, fix};
}

}  // namespace

void draw_fix_progress(const Ui& ui, const FixSearch& fix) {
  const float share =
      fix.total > 0 ? static_cast<float>(fix.done) / static_cast<float>(fix.total) : 0;
  ImGui::ProgressBar(
      share, ImVec2(-ui.px(70), 0),
      fix.total > 0 ? fmt::format("option {} of {}", fix.done, fix.total).c_str() : "searching …");
  ImGui::SameLine();
  if (button(ui, "Stop", "fix.cancel")) ui.act("fix.cancel");
}

void draw_fix_table(const Ui& ui, const FixSearch& fix, bool check) {
  if (fix.granted && fix.fixes.empty())
    return paragraph(ui.colors.good, granted_text(fix.target.wish));
  if (fix.fixes.empty()) {
    paragraph(ui.colors.warning,
              fix.target.far ? "No single option helps; several may be needed."
                             : "No single option helps, even when changed by a factor of 3.");
    if (!fix.target.far && button(ui, "Search a wider range", "fix.far")) ui.act("fix.far");
    return;
  }
  const debug::Run& run = *fix.of->run;
  const std::size_t shown = check ? fix.fixes.size() : std::min(kMostShown, fix.fixes.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const debug::Fix& one = fix.fixes[i];
    if (static_cast<int>(i) == fix.checked) colored(ui.colors.accent, "Checked below");
    const planes::OptionInfo& info = planes::find_option(one.option);
    math_text(ui, ui.colors.text,
              fmt::format("{} {} → {}{}", info.title, one.before, one.after, unit_suffix(info)));
    tooltip(info.meaning);
    same_line_if_room(ImGui::CalcTextSize(info.name.c_str()).x, ui.px(8));
    colored(ui.colors.muted, info.name);
    if (one.restores) {
      ImGui::SameLine();
      colored(ui.colors.good, "profile default");
    }
    paragraph(ui.colors.muted, effect_text(run, one, fix.target.wish));
    if (check && !one.score.planes.empty())
      paragraph(ui.colors.muted, fmt::format("IoU {:.2f}, {} of {} true planes detected", one.share,
                                             one.score.detected, one.score.planes.size()));
    if (info.get(ui.state.document.options) == one.after && !ui.state.view.preview)
      colored(ui.colors.good, "Applied");
    else
      draw_buttons(ui, i, check);
    ImGui::Spacing();
  }
  if (shown < fix.fixes.size() &&
      link(ui, fmt::format("{} more in Fix", fix.fixes.size() - shown), "answer.more"))
    ui.act("tab.tool", "fix");
}

bool draw_try(const Ui& ui) {
  const std::int32_t voxel = ui.state.view.selected.voxel;
  const std::optional<Answer> answer = answer_of(ui, voxel);
  if (!answer) return false;
  ImGui::Spacing();
  if (!answer->fix) {
    if (button(ui, "Find a fix", "answer.search")) ui.act("fix.point", PointWish{});
    return true;
  }
  heading(ui, "Try");
  if (answer->fix->running) draw_fix_progress(ui, *answer->fix);
  if (answer->fix->finished || !answer->fix->fixes.empty()) draw_fix_table(ui, *answer->fix, false);
  return true;
}

void draw_answer(const Ui& ui) {
  const std::optional<Answer> answer = answer_of(ui, ui.state.view.selected.voxel);
  if (!answer) return;
  const bool granted = answer->fix && answer->fix->granted && answer->fix->fixes.empty();
  if (granted)
    heading(ui, granted_text(answer->fix->target.wish));
  else
    heading(ui, question(answer->fix ? *answer->fix->asked : PointAsked{}));
  draw_decisions(ui, answer->run, answer->fix);
  if (granted) return ImGui::Separator();
  draw_try(ui);
  ImGui::Separator();
}

// ---- Tab ----------------------------------------------------------------------------------------

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
  std::vector<std::size_t> order(planes.size());  // worst first
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
      ui.act("fix.plane", match.truth);
  }
  ImGui::EndTable();
}

void draw_marked(const Ui& ui) {
  const std::size_t marked = ui.state.document.marked.size();
  if (button(ui, ui.state.view.marking ? "Drag on the image" : "Mark a region", "fix.mark"))
    ui.act("mark.toggle");
  ImGui::SameLine();
  if (button(ui, "Fix region", "fix.marked", marked > 0)) ui.act("fix.marked");
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
      ui.act("frame.show", effect.frame);
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

/// Instructions shown before any search.
std::string invitation(const RunView& view, bool marked) {
  if (marked)
    return "Fix region tries every option for the smallest change that "
           "makes the marked region one plane.";
  const std::string tried = " Every option is tried to find the smallest change that fixes it.";
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
