#include "app/desktop/views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/look.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

constexpr float kLeastRoom_px = 16;
constexpr ImGuiButtonFlags kAllButtons = ImGuiButtonFlags_MouseButtonLeft |
                                         ImGuiButtonFlags_MouseButtonRight |
                                         ImGuiButtonFlags_MouseButtonMiddle;

/// An image of that size at the top left corner `at` of its room.
ImagePlacement place_image(const ViewState& view, ImVec2 at, ImVec2 room, int width, int height) {
  ImagePlacement placed;
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

/// Shows another part: image point `uv` comes to stand at `at` on screen.
void show_image_part(const Ui& ui, const ImagePlacement& now, double zoom, ImVec2 uv, ImVec2 at) {
  zoom = std::clamp(zoom, 1.0, 64.0);
  const double scale = now.scale * zoom / ui.state.view.image_zoom;
  const double middle_x = (now.area_min.x + now.area_max.x) / 2;
  const double middle_y = (now.area_min.y + now.area_max.y) / 2;
  ui.emit("image.view",
          fmt::format("{:.6g},{:.6g},{:.6g}", zoom, (uv.x + (middle_x - at.x) / scale) / now.width,
                      (uv.y + (middle_y - at.y) / scale) / now.height));
}

}  // namespace

void draw_image_tools(const Ui& ui, const char* of_opacity) {
  const ViewState& view = ui.state.view;
  action_button(ui, "image.backdrop",
                view.backdrop == render::Backdrop::color ? "colour" : "depth");
  ImGui::SameLine();
  if (ImGui::Button("fit")) ui.emit("image.view", "1,0.5,0.5");
  ui.name("image.fit");
  tooltip("the whole image");
  ImGui::SameLine();
  auto percent = static_cast<float>(100 * view.overlay_opacity);
  const std::string text = fmt::format("{:.0f} %", percent);
  // The number stands beside the slider: on it, the grab would hide it.
  const float number = ImGui::CalcTextSize("100 %").x + ui.px(6);
  ImGui::SetNextItemWidth(std::max(ui.px(24), ImGui::GetContentRegionAvail().x - number));
  if (ImGui::SliderFloat("##opacity", &percent, 0, 100, ""))
    ui.emit("image.opacity", fmt::format("{:.4g}", percent / 100));
  ui.name("image.opacity");
  tooltip(of_opacity);
  ImGui::SameLine(0, ui.px(6));
  ImGui::TextDisabled("%s", text.c_str());
}

std::optional<ImagePlacement> draw_image_room(const Ui& ui,
                                              int width,
                                              int height,
                                              const std::function<TextureId(Canvas&)>& picture) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < kLeastRoom_px || room.y < kLeastRoom_px) return std::nullopt;
  const ImagePlacement placed =
      place_image(ui.state.view, ImGui::GetCursorScreenPos(), room, width, height);
  const ImVec2 first = placed.to_screen(0, 0);
  const ImVec2 last = placed.to_screen(static_cast<float>(width), static_cast<float>(height));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(placed.area_min, placed.area_max, true);
  draw->AddRectFilled(placed.area_min, placed.area_max, ui.colors.panel);
  if (ui.canvas) draw->AddImage(imgui_texture(picture(*ui.canvas)), first, last);
  draw->PopClipRect();
  ImGui::InvisibleButton("pixels", room, kAllButtons);
  // Of the image itself, so that shares of the widget are shares of the image.
  ui.name("image", first, last);
  return placed;
}

void zoom_image(const Ui& ui, const ImagePlacement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && io.MouseWheel != 0)
    show_image_part(ui, placed, ui.state.view.image_zoom * std::pow(1.2, io.MouseWheel),
                    placed.to_image(io.MousePos), io.MousePos);
}

void drag_image(const Ui& ui, const ImagePlacement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  if (!ImGui::IsItemActive() || (io.MouseDelta.x == 0 && io.MouseDelta.y == 0)) return;
  const ImVec2 before(io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y);
  show_image_part(ui, placed, ui.state.view.image_zoom, placed.to_image(before), io.MousePos);
}

std::optional<ScenePlacement> draw_scene_room(
    const Ui& ui,
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>&
        picture) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  ScenePlacement placed;
  placed.width = static_cast<int>(room.x);
  placed.height = static_cast<int>(room.y);
  if (room.x < kLeastRoom_px || room.y < kLeastRoom_px) return std::nullopt;
  const auto w = static_cast<float>(placed.width), h = static_cast<float>(placed.height);
  placed.min = ImGui::GetCursorScreenPos();
  placed.max = ImVec2(placed.min.x + w, placed.min.y + h);
  if (ui.canvas) {
    const TextureId texture =
        picture(*ui.canvas, fitted(camera_of(ui.state), w / h), placed.width, placed.height);
    // Row 0 of the texture is at the bottom.
    ImGui::GetWindowDrawList()->AddImage(imgui_texture(texture), placed.min, placed.max,
                                         ImVec2(0, 1), ImVec2(1, 0));
  }
  ImGui::InvisibleButton("scene", ImVec2(w, h), kAllButtons);
  ui.name("view3d");
  return placed;
}

void zoom_scene(const Ui& ui) {
  const float wheel = ImGui::GetIO().MouseWheel;
  if (ImGui::IsItemHovered() && wheel != 0)
    ui.emit("camera.zoom", fmt::format("{:.6g}", std::pow(1.15, wheel)));
}

void orbit_scene(const Ui& ui, int height) {
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  const auto h = static_cast<float>(height);
  ui.emit("camera.orbit", fmt::format("{:.6g},{:.6g}", 250 * moved.x / h, 250 * moved.y / h));
}

void pan_scene(const Ui& ui, int height) {
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  const auto h = static_cast<float>(height);
  ui.emit("camera.pan", fmt::format("{:.6g},{:.6g}", -moved.x / h, moved.y / h));
}

void draw_absence(const Ui& ui) {
  const Results& results = ui.state.results;
  if (!results.refusal.empty()) return draw_notice(ui, results.refusal, ui.colors.bad);
  if (results.loading) return draw_notice(ui, "Reading the frame …", ui.colors.muted);
  if (!ui.state.document.current())
    draw_notice(ui, "No recording is open. Press Ctrl+O to open one.", ui.colors.muted);
}

void draw_label_absence(const Ui& ui) {
  const std::string& refusal = ui.state.results.label.refusal;
  if (!refusal.empty()) return draw_notice(ui, refusal, ui.colors.bad);
  if (!ui.state.run()) return draw_absence(ui);
  draw_notice(ui, "Making the frame ready for labels …", ui.colors.muted);
}

}  // namespace planescope::desktop
