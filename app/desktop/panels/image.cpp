// The camera's image at the cursor: a click picks the pixel's voxel, a drag moves the image or
// marks a region.

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

/// The rectangle that is being marked.
void mark_by_mouse(const Ui& ui, const ImagePlacement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemActive()) {
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled(io.MouseClickedPos[0], io.MousePos, with_alpha(ui.colors.warning, 60));
    draw->AddRect(io.MouseClickedPos[0], io.MousePos, ui.colors.warning, 0, 0, ui.px(1.5f));
  }
  if (!ImGui::IsItemDeactivated()) return;
  const ImVec2 from = placed.to_image(io.MouseClickedPos[0]), to = placed.to_image(io.MousePos);
  ui.emit("mark.pixels",
          fmt::format("{:.0f},{:.0f},{:.0f},{:.0f}", from.x, from.y, to.x + 1, to.y + 1));
}

/// What is at the mouse; nothing off the image.
std::optional<PointedAt> pointed_at(const State& state, const ImagePlacement& placed) {
  const ImVec2 uv = placed.to_image(ImGui::GetIO().MousePos);
  if (!placed.holds(uv)) return std::nullopt;
  PointedAt at;
  at.source = static_cast<std::int64_t>(uv.y) * placed.width + static_cast<std::int64_t>(uv.x);
  const std::uint32_t voxel =
      state.run()->subject->voxel_of_source(static_cast<std::size_t>(at.source));
  if (voxel != planes::kNoVoxel)
    at.what = {render::Picked::Kind::voxel, static_cast<std::int32_t>(voxel)};
  return at;
}

/// What was clicked with the right button.
std::optional<PointedAt> handle_mouse(const Ui& ui, const ImagePlacement& placed) {
  zoom_image(ui, placed);
  const bool dragged = was_dragged();
  if (ui.state.view.marking && !ImGui::IsMouseDown(1) && !ImGui::IsMouseDown(2)) {
    if (dragged) mark_by_mouse(ui, placed);
  } else if ((dragged || !ImGui::IsMouseDown(0)) && (!ImGui::IsMouseDown(1) || was_dragged(1))) {
    drag_image(ui, placed);
  }
  if (!ImGui::IsItemHovered() || !mouse_is_here(ui, placed.area_min, placed.area_max)) return {};
  const std::optional<PointedAt> at = pointed_at(ui.state, placed);
  if (ImGui::IsMouseReleased(0) && !dragged && at) {
    const bool nothing = at->what.kind == render::Picked::Kind::nothing;
    const char* action = click_action(ui.state.view.click);
    const bool second = ImGui::GetIO().KeyCtrl && ui.state.view.selected.voxel >= 0;
    ui.emit(action    ? action
            : nothing ? "why.pixel"
            : second  ? "join.show"
                      : "select.pixel",
            fmt::format("{},{}", at->source % placed.width, at->source / placed.width));
  }
  return ImGui::IsMouseReleased(1) && !was_dragged(1) ? at : std::nullopt;
}

/// "u 320, v 240: 1.234 m" and what is known of the voxel.
std::string readout(const State& state, ImVec2 uv) {
  const debug::Subject& subject = *state.run()->subject;
  const int u = static_cast<int>(uv.x), v = static_cast<int>(uv.y);
  const std::uint16_t count = subject.frame.depth.at(u, v);
  std::string text = fmt::format("u {}, v {}: ", u, v);
  if (count == 0 || count == 65535) return text + "no measurement";
  text += fmt::format("{:.3f} m", count * subject.frame.depth_unit_m);
  const std::uint32_t voxel =
      subject.voxel_of_source(static_cast<std::size_t>(v) * subject.frame.depth.width + u);
  if (voxel == planes::kNoVoxel) return text + ", out of range";
  return text + "\n" + describe_voxel(state, static_cast<std::int32_t>(voxel));
}

}  // namespace

void draw_image(const Ui& ui) {
  const debug::Run* run = ui.state.run();
  ImGui::BeginDisabled(!run);
  action_button(ui, "mark.toggle", "mark");
  ImGui::SameLine();
  draw_image_tools(ui, "Overlay opacity");
  ImGui::EndDisabled();
  if (!run) return draw_absence(ui);
  draw_click_line(ui);
  const Image16& depth = run->subject->frame.depth;
  const ViewState& view = ui.state.view;
  const RunView* other = ui.state.other_view();
  const std::function<TextureId(Canvas&)> here = [&](Canvas& canvas) {
    return canvas.image(ui.state.run_view()->run, look_of(ui.state), view.backdrop,
                        view.overlay_opacity);
  };
  const std::function<TextureId(Canvas&)> beside = [&](Canvas& canvas) {
    return canvas.image(other->run, other_look_of(ui.state), view.backdrop, view.overlay_opacity,
                        Side::beside);
  };
  const auto placed = draw_image_room(ui, depth.width, depth.height, here,
                                      other ? beside : std::function<TextureId(Canvas&)>());
  if (!placed) return;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(placed->area_min, placed->area_max, true);
  const std::optional<PointedAt> clicked = handle_mouse(ui, *placed);
  const std::int64_t source = view.selected.source;
  if (source >= 0) {
    const std::int64_t row = source / depth.width, column = source % depth.width;
    const auto u = static_cast<float>(column), v = static_cast<float>(row);
    const float reach = std::max(ui.px(5), placed->scale);
    const ImVec2 middle = placed->to_screen(u + 0.5f, v + 0.5f);
    draw->AddCircle(middle, reach + ui.px(1), IM_COL32(0, 0, 0, 200), 0, ui.px(3));
    draw->AddCircle(middle, reach + ui.px(1), IM_COL32_WHITE, 0, ui.px(1.5f));
  }
  if (view.views == Views::image) draw_color_scale(ui, placed->area_min, placed->area_max);
  draw_measured(ui, *placed);
  draw->PopClipRect();
  const ImVec2 uv = placed->to_image(ImGui::GetIO().MousePos);
  const bool still = !ImGui::IsMouseDown(0) && !ImGui::IsMouseDown(1) && !ImGui::IsMouseDown(2);
  const bool here_below = mouse_is_here(ui, placed->area_min, placed->area_max);
  if (still && placed->holds(uv) && here_below) tooltip(readout(ui.state, uv));
  draw_context_menu(ui, clicked);
  draw_sides(ui, "image", placed->area_min, placed->area_max);
}

}  // namespace planescope::desktop
