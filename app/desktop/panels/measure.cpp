// What is measured between two clicks, in words and over the views.

#include "core/debug/explain/measure.hpp"

#include <cmath>
#include <functional>
#include <tuple>

#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"
#include "render/view.hpp"

namespace planescope::desktop {
namespace {

/// Where a place in the sensor's axes is on screen; nothing where it is not.
using ToScreen = std::function<std::optional<ImVec2>(const Vec3d&)>;

/// Legs shorter than this say nothing of their own.
constexpr double kLeastLeg_m = 0.01;

void draw_line(const Ui& ui, const ToScreen& to_screen, const Vec3d& a, const Vec3d& b, float px) {
  const auto from = to_screen(a), to = to_screen(b);
  if (!from || !to) return;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddLine(*from, *to, IM_COL32(0, 0, 0, 160), ui.px(px + 2));
  draw->AddLine(*from, *to, ui.colors.warning, ui.px(px));
}

void draw_end(const Ui& ui, const ToScreen& to_screen, const Vec3d& at) {
  const auto middle = to_screen(at);
  if (!middle) return;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddCircleFilled(*middle, ui.px(5), IM_COL32(0, 0, 0, 200));
  draw->AddCircleFilled(*middle, ui.px(3.5f), ui.colors.warning);
}

/// Beside the middle of a line, on the side that is given: -1 left, 1 right.
void draw_text(const Ui& ui,
               const ToScreen& to_screen,
               const Vec3d& middle,
               float side,
               const std::string& text) {
  const auto at = to_screen(middle);
  if (!at) return;
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float left = side > 0 ? at->x + ui.px(10) : at->x - ui.px(10) - size.x;
  const ImVec2 corner(left, at->y - size.y / 2);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(ImVec2(corner.x - ui.px(5), corner.y - ui.px(2)),
                      ImVec2(corner.x + size.x + ui.px(5), corner.y + size.y + ui.px(2)),
                      with_alpha(ui.colors.panel, 220), ui.px(4));
  draw->AddText(corner, ui.colors.text, text.c_str());
}

void draw_over(const Ui& ui, const ToScreen& to_screen) {
  const std::vector<debug::MeasureEnd>& ends = ui.state.view.measured;
  if (ends.empty()) return;
  if (ends.size() < 2) return draw_end(ui, to_screen, ends[0].point);
  const debug::Measurement measured = debug::measure(*ui.state.run()->subject, ends[0], ends[1]);
  const auto& [from, to, corner] = std::tie(measured.from, measured.to, measured.corner);
  // Up and across apart, where the line is neither.
  const double up_m = std::abs(measured.height_m.value_or(0));
  const bool has_legs = up_m >= kLeastLeg_m && (corner - from).norm() >= kLeastLeg_m;
  if (has_legs) {
    draw_line(ui, to_screen, from, corner, 1);
    draw_line(ui, to_screen, corner, to, 1);
  }
  draw_line(ui, to_screen, from, to, 2);
  draw_end(ui, to_screen, from);
  draw_end(ui, to_screen, to);
  const auto a = to_screen((from + to) / 2), b = to_screen((corner + to) / 2);
  const float side = has_legs && a && b && b->x > a->x ? 1.0f : -1.0f;
  draw_text(ui, to_screen, (from + to) / 2, -side, measured.label);
  if (has_legs)
    draw_text(ui, to_screen, (corner + to) / 2, side, debug::height_text(*measured.height_m));
}

}  // namespace

void draw_measure_line(const Ui& ui) {
  const std::vector<debug::MeasureEnd>& ends = ui.state.view.measured;
  const std::string what = ui.state.view.click == Click::plane ? "plane" : "point";
  std::string text = "Click a " + what + " to measure from. Esc cancels.";
  if (ends.size() == 1) text = "Click a " + what + " to measure to. Esc cancels.";
  if (ends.size() == 2) text = debug::measure(*ui.state.run()->subject, ends[0], ends[1]).text;
  ImGui::AlignTextToFramePadding();
  paragraph(ui.colors.warning, text);
  ui.name("measure.line");
  same_line_if_fits("points  planes  ");
  action_button(ui, "measure.points", "points");
  ImGui::SameLine();
  action_button(ui, "measure.planes", "planes");
}

void draw_measured(const Ui& ui, const ScenePlacement& placed) {
  const double aspect = static_cast<double>(placed.width) / placed.height;
  const render::View view =
      render::make_view(scene_camera(ui.state, aspect), placed.width, placed.height);
  ImGui::GetWindowDrawList()->PushClipRect(placed.min, placed.max, true);
  draw_over(ui, [&](const Vec3d& at) -> std::optional<ImVec2> {
    const auto point = render::project(view, debug::in_scene(*ui.state.run()->subject, at));
    if (!point) return std::nullopt;
    return ImVec2(placed.min.x + static_cast<float>(point->px.x()),
                  placed.min.y + static_cast<float>(point->px.y()));
  });
  ImGui::GetWindowDrawList()->PopClipRect();
}

void draw_measured(const Ui& ui, const ImagePlacement& placed) {
  const Intrinsics& k = ui.state.run()->subject->frame.intrinsics;
  draw_over(ui, [&](const Vec3d& at) -> std::optional<ImVec2> {
    if (at.z() <= 0) return std::nullopt;
    // Of lenses that distort a little beside the pixel.
    return placed.to_screen(static_cast<float>(k.fx * at.x() / at.z() + k.cx + 0.5),
                            static_cast<float>(k.fy * at.y() / at.z() + k.cy + 0.5));
  });
}

}  // namespace planescope::desktop
