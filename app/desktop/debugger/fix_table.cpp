#include "app/desktop/debugger/fix_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/desktop/widgets.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kMostShown = 4;  // in an answer

const char* unit_of(const debug::Run& run) { return run.is_on_image() ? "px" : "voxels"; }

/// "31 900": groups of three digits.
std::string grouped(std::int64_t number) {
  const std::string digits = std::to_string(std::abs(number));
  std::string text = number < 0 ? "−" : "";
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ' ';
    text += digits[i];
  }
  return text;
}

void draw_buttons(const Ui& ui, std::size_t i, bool check) {
  const std::string number = std::to_string(i);
  button(ui, "Preview", "fix.preview." + number);
  if (ImGui::IsItemActivated()) ui.emit("fix.preview", number);
  if (ImGui::IsItemDeactivated()) ui.emit("fix.preview", "");
  tooltip("Shows the result while you hold the button");
  ImGui::SameLine();
  if (button(ui, "Apply", "fix.apply." + number)) ui.emit("fix.apply", number);
  if (!check) return;
  ImGui::SameLine();
  if (button(ui, "Check", "fix.check." + number, ui.state.results.fix.finished))
    ui.emit("fix.check", number);
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

/// What holds without a change.
const char* granted_text(debug::Wish wish) {
  switch (wish) {
    case debug::Wish::own_plane:
      return "It already is a separate plane.";
    case debug::Wish::no_plane:
      return "It already is in no plane.";
    case debug::Wish::joined:
      return "They already are one plane.";
    default:
      return "It already is in a plane.";
  }
}

std::string unit_suffix(const planes::OptionInfo& info) {
  const bool none =
      info.unit.empty() || info.unit == "1" || info.unit == "share" || !info.is_number();
  return none ? "" : " " + info.unit;
}

/// "step 49" as a link, and what was decided there.
void draw_decision(const Ui& ui, const char* role, std::int32_t step, const std::string& text) {
  colored(ui.colors.muted, role);
  ImGui::SameLine();
  if (link(ui, fmt::format("step {}", step), fmt::format("answer.{}", role)))
    ui.emit("point.step", std::to_string(step));
  math_paragraph(ui, ui.colors.text, text);
}

void draw_decisions(const Ui& ui,
                    const std::shared_ptr<const debug::Run>& of,
                    const FixSearch* fix) {
  const debug::Run& run = *of;
  const auto& selected = ui.state.view.selected;
  const std::size_t source =
      selected.source >= 0
          ? static_cast<std::size_t>(selected.source)
          : debug::source_of_voxel(*run.subject, static_cast<std::uint32_t>(selected.voxel));
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

/// What is asked of the selected point.
struct Answer {
  std::shared_ptr<const debug::Run> run;
  const FixSearch* fix;  // null: nothing was searched yet
};

/// Which search answers what is selected; null: none.
const FixSearch* search_of(const Ui& ui, std::int32_t voxel) {
  const FixSearch& fix = ui.state.results.fix;
  const bool is_of_run = fix.of.get() == ui.state.run_view() || ui.state.view.preview;
  const bool is_of_point = fix.asked && static_cast<std::int32_t>(fix.asked->voxel) == voxel;
  return is_asked(fix) && is_of_point && (is_of_run || !fix.begun) ? &fix : nullptr;
}

/// Nothing if the point is in a plane and no search is about it.
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
  if (button(ui, "Stop", "fix.cancel")) ui.emit("fix.cancel");
}

void draw_fix_table(const Ui& ui, const FixSearch& fix, bool check) {
  if (fix.granted && fix.fixes.empty())
    return paragraph(ui.colors.good, granted_text(fix.target.wish));
  if (fix.fixes.empty()) {
    paragraph(ui.colors.warning, fix.target.far
                                     ? "No single option helps; several may be needed."
                                     : "No single option helps, even changed by a factor of 3.");
    if (!fix.target.far && button(ui, "Search a wider range", "fix.far")) ui.emit("fix.far");
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
    ui.emit("tab.tool", "fix");
}

bool draw_try(const Ui& ui) {
  const std::int32_t voxel = ui.state.view.selected.voxel;
  const std::optional<Answer> answer = answer_of(ui, voxel);
  if (!answer) return false;
  ImGui::Spacing();
  if (!answer->fix) {
    if (button(ui, "Find a fix", "answer.search")) ui.emit("fix.point", "plane");
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

}  // namespace planescope::desktop
