// The camera's image at the cursor: a click picks the pixel's voxel, a drag moves the image or
// marks a region.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/look.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/toolbar.hpp"

namespace planescope::desktop {
namespace {

constexpr float kClickSlack = 4;  // [px] that the mouse may move in a click

/// Where the image lies on screen.
struct Placement {
  ImVec2 area_min, area_max;
  ImVec2 origin;    // of the image's upper left corner
  float scale = 1;  // screen pixels per image pixel
  int width = 0, height = 0;

  ImVec2 to_screen(float u, float v) const {
    return ImVec2(origin.x + scale * u, origin.y + scale * v);
  }
  ImVec2 to_image(ImVec2 at) const {
    return ImVec2((at.x - origin.x) / scale, (at.y - origin.y) / scale);
  }
  bool holds(ImVec2 uv) const {
    return uv.x >= 0 && uv.y >= 0 && uv.x < static_cast<float>(width) &&
           uv.y < static_cast<float>(height);
  }
};

Placement place(const ViewState& view, ImVec2 at, ImVec2 room, int width, int height) {
  Placement placed;
  placed.area_min = at;
  placed.area_max = ImVec2(at.x + room.x, at.y + room.y);
  placed.width = width;
  placed.height = height;
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  placed.scale = std::min(room.x / w, room.y / h) * static_cast<float>(view.image_zoom);
  // An image that is smaller than its room stands in the middle.
  const auto begin = [&](float room_px, float image_px, double center) {
    if (image_px <= room_px) return (room_px - image_px) / 2;
    return std::clamp(room_px / 2 - static_cast<float>(center) * image_px, room_px - image_px,
                      0.0f);
  };
  placed.origin = ImVec2(at.x + begin(room.x, placed.scale * w, view.image_center.x()),
                         at.y + begin(room.y, placed.scale * h, view.image_center.y()));
  return placed;
}

void draw_tools(const Ui& ui) {
  const ViewState& view = ui.state.view;
  action_button(ui, "image.backdrop", view.backdrop == Backdrop::color ? "colour" : "depth");
  ImGui::SameLine();
  action_button(ui, "mark.toggle", "mark");
  ImGui::SameLine();
  if (ImGui::Button("fit")) ui.emit("image.view", "1,0.5,0.5");
  ui.name("image.fit");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("the whole image");
  ImGui::SameLine();
  auto percent = static_cast<float>(100 * view.overlay_opacity);
  const std::string text = fmt::format("{:.0f} %", percent);
  // The number stands beside the slider: on it, the grab would hide it.
  const float number = ImGui::CalcTextSize("100 %").x + ui.px(6);
  ImGui::SetNextItemWidth(std::max(ui.px(24), ImGui::GetContentRegionAvail().x - number));
  if (ImGui::SliderFloat("##opacity", &percent, 0, 100, ""))
    ui.emit("image.opacity", fmt::format("{:.4g}", percent / 100));
  ui.name("image.opacity");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("how strongly the segmentation covers the camera's image");
  ImGui::SameLine(0, ui.px(6));
  ImGui::TextDisabled("%s", text.c_str());
}

/// The part shown, so that image point `uv` comes to stand at `at`.
void show_part(const Ui& ui, const Placement& now, double zoom, ImVec2 uv, ImVec2 at) {
  zoom = std::clamp(zoom, 1.0, 64.0);
  const double scale = now.scale * zoom / ui.state.view.image_zoom;
  const double middle_x = (now.area_min.x + now.area_max.x) / 2;
  const double middle_y = (now.area_min.y + now.area_max.y) / 2;
  ui.emit("image.view",
          fmt::format("{:.6g},{:.6g},{:.6g}", zoom, (uv.x + (middle_x - at.x) / scale) / now.width,
                      (uv.y + (middle_y - at.y) / scale) / now.height));
}

void handle_mouse(const Ui& ui, const Placement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 uv = placed.to_image(io.MousePos);
  if (ImGui::IsItemHovered() && io.MouseWheel != 0)
    show_part(ui, placed, ui.state.view.image_zoom * std::pow(1.2, io.MouseWheel), uv, io.MousePos);
  const bool dragged = io.MouseDragMaxDistanceSqr[0] > kClickSlack * kClickSlack;
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
    show_part(ui, placed, ui.state.view.image_zoom, placed.to_image(before), io.MousePos);
  }
  if (ImGui::IsItemHovered() && ImGui::IsMouseReleased(0) && !dragged && placed.holds(uv))
    ui.emit("select.pixel", fmt::format("{},{}", static_cast<int>(uv.x), static_cast<int>(uv.y)));
}

/// "u 320, v 240: 1.234 m" and what is known of the voxel.
std::string readout(const State& state, ImVec2 uv) {
  const Subject& subject = *state.run()->subject;
  const int u = static_cast<int>(uv.x), v = static_cast<int>(uv.y);
  const std::uint16_t count = subject.frame.depth.at(u, v);
  std::string text = fmt::format("u {}, v {}: ", u, v);
  if (count == 0 || count == 65535) return text + "no measurement";
  text += fmt::format("{:.3f} m", count * subject.frame.depth_unit_m);
  const std::uint32_t voxel =
      subject.voxel_of_source(static_cast<std::size_t>(v) * subject.frame.depth.width + u);
  if (voxel == kNoVoxel) return text + ", out of range";
  return text + "\n" + describe_voxel(state, static_cast<std::int32_t>(voxel));
}

}  // namespace

void draw_image(const Ui& ui) {
  const Run* run = ui.state.run();
  const bool pictured = run && !run->subject->frame.depth.empty();
  ImGui::BeginDisabled(!pictured);
  draw_tools(ui);
  ImGui::EndDisabled();
  if (!run) return draw_absence(ui);
  if (!pictured) return draw_notice(ui, "A point cloud has no image.", ui.colors.muted);
  const Image16& depth = run->subject->frame.depth;
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < 16 || room.y < 16) return;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const Placement placed = place(ui.state.view, at, room, depth.width, depth.height);
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
