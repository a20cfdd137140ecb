// The camera's image at the cursor: a click picks the pixel's voxel, a drag moves the image or
// marks a region.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/image_placement.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/toolbar.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

void handle_mouse(const Ui& ui, const ImagePlacement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 uv = placed.to_image(io.MousePos);
  if (ImGui::IsItemHovered() && io.MouseWheel != 0)
    show_image_part(ui, placed, ui.state.view.image_zoom * std::pow(1.2, io.MouseWheel), uv,
                    io.MousePos);
  const GravityClick picks = ui.state.view.gravity_click;
  const bool dragged = was_dragged();
  const bool marking = ui.state.view.marking && !ImGui::IsMouseDown(1) && !ImGui::IsMouseDown(2);
  if (marking) {
    const ImVec2 from = placed.to_image(io.MouseClickedPos[0]);
    if (ImGui::IsItemActive() && dragged) {
      ImDrawList* draw = ImGui::GetWindowDrawList();
      draw->AddRectFilled(io.MouseClickedPos[0], io.MousePos,
                          (ui.colors.warning & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 60));
      draw->AddRect(io.MouseClickedPos[0], io.MousePos, ui.colors.warning, 0, 0, ui.px(1.5f));
    }
    if (ImGui::IsItemDeactivated() && dragged)
      return ui.emit("mark.pixels", fmt::format("{:.0f},{:.0f},{:.0f},{:.0f}", from.x, from.y,
                                                uv.x + 1, uv.y + 1));
  } else if (ImGui::IsItemActive() && (dragged || !ImGui::IsMouseDown(0)) &&
             (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    const ImVec2 before(io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y);
    show_image_part(ui, placed, ui.state.view.image_zoom, placed.to_image(before), io.MousePos);
  }
  if (ImGui::IsItemHovered() && ImGui::IsMouseReleased(0) && !dragged && placed.holds(uv))
    ui.emit(picks == GravityClick::floor  ? "gravity.floor"
            : picks == GravityClick::wall ? "gravity.wall"
                                          : "select.pixel",
            fmt::format("{},{}", static_cast<int>(uv.x), static_cast<int>(uv.y)));
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
  const bool pictured = run && !run->subject->frame.depth.empty();
  ImGui::BeginDisabled(!pictured);
  action_button(ui, "mark.toggle", "mark");
  ImGui::SameLine();
  draw_image_tools(ui, "how strongly the segmentation covers the camera's image");
  ImGui::EndDisabled();
  if (!run) return draw_absence(ui);
  draw_gravity_line(ui);
  if (!pictured) return draw_notice(ui, "A point cloud has no image.", ui.colors.muted);
  const Image16& depth = run->subject->frame.depth;
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < 16 || room.y < 16) return;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImagePlacement placed = place_image(ui.state.view, at, room, depth.width, depth.height);
  const ImVec2 first = placed.to_screen(0, 0);
  const ImVec2 last =
      placed.to_screen(static_cast<float>(depth.width), static_cast<float>(depth.height));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(placed.area_min, placed.area_max, true);
  draw->AddRectFilled(placed.area_min, placed.area_max, ui.colors.panel);
  if (ui.canvas) {
    const ViewState& view = ui.state.view;
    const TextureId texture = ui.canvas->image(ui.state.run_view()->run, look_of(ui.state),
                                               view.backdrop, view.overlay_opacity);
    draw->AddImage(reinterpret_cast<ImTextureID>(texture), first, last);
  }
  ImGui::InvisibleButton("pixels", room,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  // Of the image itself, so that shares of the widget are shares of the image.
  ui.name("image", first, last);
  handle_mouse(ui, placed);
  const std::int64_t source = ui.state.view.selected.source;
  if (source >= 0) {
    const auto u = static_cast<float>(source % depth.width);
    const auto v = static_cast<float>(source / depth.width);
    const float reach = std::max(ui.px(5), placed.scale);
    const ImVec2 middle = placed.to_screen(u + 0.5f, v + 0.5f);
    draw->AddCircle(middle, reach + ui.px(1), IM_COL32(0, 0, 0, 200), 0, ui.px(3));
    draw->AddCircle(middle, reach + ui.px(1), IM_COL32_WHITE, 0, ui.px(1.5f));
  }
  draw->PopClipRect();
  const ImVec2 uv = placed.to_image(ImGui::GetIO().MousePos);
  const bool still = !ImGui::IsMouseDown(0) && !ImGui::IsMouseDown(1) && !ImGui::IsMouseDown(2);
  if (ImGui::IsItemHovered() && still && placed.holds(uv))
    ImGui::SetTooltip("%s", readout(ui.state, uv).c_str());
}

}  // namespace planescope::desktop
