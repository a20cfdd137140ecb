#include "app/desktop/debugger/frame_summary.hpp"

#include <fmt/format.h>

#include "app/desktop/widgets.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr double kLeast = 0.001;  // share of a row

/// The brightness of a reason's grey: neighbors in the bar differ.
ImU32 color_of_reason(const Ui& ui, std::size_t i) {
  return with_alpha(ui.colors.muted, i % 2 == 0 ? 200 : 120);
}

/// Shares beside each other, over the whole width.
void draw_bar(const Ui& ui, const debug::FrameSummary& summary) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ui.px(10);
  float x = at.x;
  const auto add = [&](std::size_t sources, ImU32 color) {
    const float to = x + width * static_cast<float>(summary.share(sources));
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(x, at.y), ImVec2(to, at.y + height), color);
    x = to;
  };
  add(summary.on_planes - summary.on_undecided, ui.colors.accent);
  add(summary.on_undecided, with_alpha(ui.colors.accent, 120));
  for (std::size_t i = 0; i < summary.lost.size(); ++i)
    add(summary.lost[i].sources, color_of_reason(ui, i));
  ImGui::Dummy(ImVec2(width, height));
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

}  // namespace

void draw_frame_summary(const Ui& ui, const RunView& view) {
  const debug::FrameSummary& summary = view.summary;
  const double on = summary.share(summary.on_planes);
  const double outside = summary.share(summary.out_of_range);
  std::string title = fmt::format("{} on {} · {} unassigned", percent(on),
                                  counted(static_cast<std::size_t>(summary.planes), "plane"),
                                  percent(1 - on - outside));
  if (outside >= kLeast) title += fmt::format(" · {} out of range", percent(outside));
  heading(ui, title);
  draw_bar(ui, summary);
  if (summary.undecided > 0)
    paragraph(ui.colors.muted,
              fmt::format("{}, {} of all points, undecided: slightly different noise could drop "
                          "or merge them",
                          counted(static_cast<std::size_t>(summary.undecided), "plane"),
                          percent(summary.share(summary.on_undecided))));
  for (std::size_t i = 0; i < summary.lost.size(); ++i) {
    const debug::Lost& lost = summary.lost[i];
    if (summary.share(lost.sources) < kLeast) continue;
    const std::string text =
        fmt::format("{:.1f} %  {}", 100 * summary.share(lost.sources), lost.reason);
    const std::string widget = fmt::format("lost.{}", i);
    if (lost.middle < 0) {
      colored(ui.colors.muted, text);
      ui.name(widget);
      continue;
    }
    if (link(ui, text, widget)) ui.emit("lost.show", std::to_string(i));
    tooltip("Mark these points and explain the largest part");
  }
}

}  // namespace planescope::desktop
