// Image view and scene view: layout, zoom, pan, orbit, A/B divider and color scale.

#include "app/desktop/views.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "app/desktop/widgets.hpp"
#include "core/planes/cloud/camera.hpp"
#include "render/step_scene.hpp"

namespace planescope::desktop {
namespace {

constexpr float kLeastRoom_px = 16;
constexpr ImGuiButtonFlags kAllButtons = ImGuiButtonFlags_MouseButtonLeft |
                                         ImGuiButtonFlags_MouseButtonRight |
                                         ImGuiButtonFlags_MouseButtonMiddle;

/// Places an image of this size in an area with top left corner `at`.
ImagePlacement place_image(const ViewState& view, ImVec2 at, ImVec2 room, int width, int height) {
  ImagePlacement placed;
  placed.area_min = at;
  placed.area_max = ImVec2(at.x + room.x, at.y + room.y);
  placed.width = width;
  placed.height = height;
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  placed.scale = std::min(room.x / w, room.y / h) * static_cast<float>(view.image_zoom);
  // Center an image that is smaller than its area.
  const auto begin = [&](float room_px, float image_px, double center) {
    if (image_px <= room_px) return (room_px - image_px) / 2;
    return std::clamp(room_px / 2 - static_cast<float>(center) * image_px, room_px - image_px,
                      0.0f);
  };
  placed.origin = ImVec2(at.x + begin(room.x, placed.scale * w, view.image_center.x()),
                         at.y + begin(room.y, placed.scale * h, view.image_center.y()));
  return placed;
}

/// Moves image point `uv` to screen position `at` at a new zoom.
void show_image_part(const Ui& ui, const ImagePlacement& now, double zoom, ImVec2 uv, ImVec2 at) {
  zoom = std::clamp(zoom, 1.0, 64.0);
  const double scale = now.scale * zoom / ui.state.view.image_zoom;
  const double middle_x = (now.area_min.x + now.area_max.x) / 2;
  const double middle_y = (now.area_min.y + now.area_max.y) / 2;
  ui.act("image.view", std::array{zoom, (uv.x + (middle_x - at.x) / scale) / now.width,
                                  (uv.y + (middle_y - at.y) / scale) / now.height});
}

float wiper_x(const Ui& ui, ImVec2 min, ImVec2 max) {
  return std::round(min.x + static_cast<float>(ui.state.view.wiper_at) * (max.x - min.x));
}

/// Area of the other run: A is left of the divider.
std::pair<ImVec2, ImVec2> other_side(const Ui& ui, ImVec2 min, ImVec2 max) {
  const float x = wiper_x(ui, min, max);
  return ui.state.view.flash ? std::pair{ImVec2(x, min.y), max} : std::pair{min, ImVec2(x, max.y)};
}

/// Draws the divider. Must come before the item below it to receive the mouse first.
void draw_wiper(const Ui& ui, const char* name, ImVec2 min, ImVec2 max) {
  const float x = wiper_x(ui, min, max), reach = ui.px(5);
  const ImVec2 back = ImGui::GetCursorScreenPos();
  ImGui::SetCursorScreenPos(ImVec2(x - reach, min.y));
  ImGui::InvisibleButton(name, ImVec2(2 * reach, max.y - min.y));
  ui.name(name);
  const bool hot = ImGui::IsItemActive() || ImGui::IsItemHovered();
  if (hot) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (ImGui::IsItemActive() && ImGui::GetIO().MouseDelta.x != 0)
    ui.act("wiper.set", (ImGui::GetIO().MousePos.x - min.x) / (max.x - min.x));
  ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(x - ui.px(1), min.y),
                                            ImVec2(x + ui.px(1), max.y),
                                            hot ? ui.colors.text : ui.colors.accent);
  ImGui::SetCursorScreenPos(back);
}

void draw_side(const Ui& ui, const std::string& text, ImVec2 corner) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(corner, ImVec2(corner.x + ui.px(26), corner.y + ui.px(24)), ui.colors.accent,
                      ui.px(4));
  draw->AddText(ui.bold, ui.px(18), ImVec2(corner.x + ui.px(7), corner.y + ui.px(2)),
                ui.colors.panel, text.c_str());
}

}  // namespace

bool mouse_is_here(const Ui& ui, ImVec2 min, ImVec2 max) {
  if (!ui.state.other_view()) return true;
  return (ImGui::GetIO().MousePos.x < wiper_x(ui, min, max)) == ui.state.view.flash;
}

void draw_sides(const Ui& ui, const char* view, ImVec2 min, ImVec2 max) {
  if (!ui.state.results.pinned) return;
  const ImVec2 right(max.x - ui.px(34), min.y + ui.px(8)), left(min.x + ui.px(8), min.y + ui.px(8));
  if (ui.state.view.wiper) draw_side(ui, "A", left);
  draw_side(ui, ui.state.view.wiper || !ui.state.view.flash ? "B" : "A", right);
  ui.name(std::string(view) + ".side", right, ImVec2(right.x + ui.px(26), right.y + ui.px(24)));
}

void draw_scale_bar(const Ui& ui, const render::ColorScale& scale, ImVec2 min, ImVec2 max) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  ImGui::PushFont(ui.small);
  const bool words = !scale.at_low.empty();
  const float line = ImGui::GetTextLineHeight(), gap = ui.px(3), bar = ui.px(10);
  const render::ScaleTicks ticks = render::ticks_of(scale);
  const std::string title = fmt::format("{} [{}]", scale.what, ticks.unit);
  const float width = std::max(ui.px(190), ImGui::CalcTextSize(title.c_str()).x);
  const float edge = ui.px(14), below_badge = ui.px(ui.state.results.pinned ? 40 : 8);
  const ImVec2 from(max.x - width - edge - ui.px(8), min.y + below_badge + gap + line + gap);
  const ImVec2 box_min(from.x - edge, min.y + below_badge);
  const ImVec2 box_max(from.x + width + edge,
                       from.y + bar + ui.px(5) + (words ? 2 : 1) * line + 2 * gap);
  draw->AddRectFilled(box_min, box_max, with_alpha(ui.colors.panel, 225), ui.px(4));
  ui.name("scale", box_min, box_max);
  ui.name("scale.bar", from, ImVec2(from.x + width, from.y + bar));
  const auto text = [&](float x, float y, float align, const std::string& what) {
    const float extent = ImGui::CalcTextSize(what.c_str()).x;
    draw->AddText(ImVec2(std::round(x - align * extent), y), ui.colors.text, what.c_str());
  };
  const double span = scale.range.high_m - scale.range.low_m;
  text(from.x, box_min.y + gap, 0, title);
  const auto columns = static_cast<int>(width);
  for (int x = 0; x < columns; ++x) {
    const double share = (x + 0.5) / columns;
    draw->AddRectFilled(ImVec2(from.x + static_cast<float>(x), from.y),
                        ImVec2(from.x + static_cast<float>(x) + 1, from.y + bar),
                        to_imgui(scale.color(scale.range.low_m + share * span)));
  }
  const float below = from.y + bar + ui.px(4);
  float room_from = box_min.x;
  for (const render::ScaleTick& tick : ticks.ticks) {
    const auto share = static_cast<float>((tick.value_m - scale.range.low_m) / span);
    const float x = from.x + share * width;
    draw->AddLine(ImVec2(x, from.y + bar), ImVec2(x, below), ui.colors.text, ui.px(1));
    const float extent = ImGui::CalcTextSize(tick.text.c_str()).x;
    const float left = std::clamp(x - extent / 2, box_min.x + gap, box_max.x - extent - gap);
    if (left < room_from) continue;
    text(left, below, 0, tick.text);
    room_from = left + extent + ui.px(4);
  }
  if (words) {
    text(from.x, below + line, 0, scale.at_low);
    text(from.x + width, below + line, 1, scale.at_high);
  }
  ImGui::PopFont();
}

void draw_color_scale(const Ui& ui, ImVec2 min, ImVec2 max) {
  const render::StepLook look = look_of(ui.state);
  if (!render::is_along_scale(look.color_by)) return;
  ImGui::GetWindowDrawList()->PushClipRect(min, max, true);
  if (const std::string why = render::why_no_values(*ui.state.run(), look); why.empty()) {
    draw_scale_bar(ui, render::color_scale(*ui.state.run(), look), min, max);
  } else {
    const ImVec2 extent = ImGui::CalcTextSize(why.c_str());
    const ImVec2 from(max.x - extent.x - ui.px(22),
                      min.y + ui.px(ui.state.results.pinned ? 40 : 8));
    const ImVec2 to(max.x - ui.px(8), from.y + extent.y + ui.px(8));
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled(from, to, with_alpha(ui.colors.panel, 225), ui.px(4));
    draw->AddText(ImVec2(from.x + ui.px(7), from.y + ui.px(4)), ui.colors.text, why.c_str());
    ui.name("scale.absent", from, to);
  }
  ImGui::GetWindowDrawList()->PopClipRect();
}

std::optional<std::size_t> pixel_of_nothing(const debug::Subject& subject,
                                            const render::View& view,
                                            const Vec2d& at) {
  const Image16& depth = subject.frame.depth;
  if (depth.empty()) return std::nullopt;
  double nearest = 1e300, depth_m = 0;
  for (const Vec3f& point : subject.prepared.voxels.points)
    if (const auto seen = render::project(view, point))
      if (const double apart = (seen->px - at).squaredNorm(); apart < nearest) {
        nearest = apart;
        depth_m = seen->depth_m;
      }
  if (nearest > 1e200) return std::nullopt;
  const double along = view.orthographic ? 1 : depth_m;
  const Vec3d eye((2 * at.x() / view.width - 1) * along / view.proj(0, 0),
                  (1 - 2 * at.y() / view.height) * along / view.proj(1, 1), -depth_m);
  const Vec3d scene = (view.view.cast<double>().inverse() * eye.homogeneous()).hnormalized();
  const planes::Cloud& cloud = subject.prepared.cloud;
  const Vec3d seen = cloud.T_world_sensor.inverse() * (scene + cloud.origin);
  if (!(seen.z() > 0)) return std::nullopt;
  const Vec2d lands = planes::ray_to_pixel(subject.frame.intrinsics, seen.head<2>() / seen.z());
  const double u = std::floor(lands.x() + 0.5), v = std::floor(lands.y() + 0.5);
  if (!(u >= 0 && v >= 0 && u < depth.width && v < depth.height)) return std::nullopt;
  const std::size_t pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(depth.width) +
                            static_cast<std::size_t>(u);
  return subject.voxel_of_source(pixel) == planes::kNoVoxel ? std::optional(pixel) : std::nullopt;
}

double picture_shape(const State& state) {
  const debug::Run* run = state.run();
  const OpenRecording* open = state.document.current();
  if (open && !open->recording->info().knows_camera()) return 0;  // only a form is shown
  if (!run) return 4.0 / 3;
  const Image16& depth = run->subject->frame.depth;
  return depth.empty() ? 0 : static_cast<double>(depth.width) / depth.height;
}

bool shows_image(const State& state) {
  return picture_shape(state) > 0 && state.view.views != Views::scene;
}

void draw_image_tools(const Ui& ui, const char* of_opacity) {
  const ViewState& view = ui.state.view;
  action_button(ui, "image.backdrop", view.backdrop == render::Backdrop::depth ? "depth" : "color");
  ImGui::SameLine();
  if (ImGui::Button("fit")) ui.act("image.view", std::array{1.0, 0.5, 0.5});
  ui.name("image.fit");
  tooltip("Whole image");
  ImGui::SameLine();
  auto percent = static_cast<float>(100 * view.overlay_opacity);
  const std::string text = fmt::format("{:.0f} %", percent);
  // Draw the number beside the slider, where the grab cannot hide it.
  const float number = ImGui::CalcTextSize("100 %").x + ui.px(6);
  ImGui::SetNextItemWidth(std::max(ui.px(24), ImGui::GetContentRegionAvail().x - number));
  if (ImGui::SliderFloat("##opacity", &percent, 0, 100, ""))
    ui.act("image.opacity", percent / 100.0);
  ui.name("image.opacity");
  tooltip(of_opacity);
  ImGui::SameLine(0, ui.px(6));
  ImGui::TextDisabled("%s", text.c_str());
}

std::optional<ImagePlacement> draw_image_room(const Ui& ui,
                                              int width,
                                              int height,
                                              const std::function<TextureId(Canvas&)>& picture,
                                              const std::function<TextureId(Canvas&)>& beside) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < kLeastRoom_px || room.y < kLeastRoom_px) return std::nullopt;
  const ImagePlacement placed =
      place_image(ui.state.view, ImGui::GetCursorScreenPos(), room, width, height);
  const ImVec2 first = placed.to_screen(0, 0);
  const ImVec2 last = placed.to_screen(static_cast<float>(width), static_cast<float>(height));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->PushClipRect(placed.area_min, placed.area_max, true);
  draw->AddRectFilled(placed.area_min, placed.area_max, ui.colors.panel);
  if (ui.canvas) {
    draw->AddImage(imgui_texture(picture(*ui.canvas)), first, last);
    if (beside) {
      const auto [min, max] = other_side(ui, placed.area_min, placed.area_max);
      draw->PushClipRect(min, max, true);
      draw->AddImage(imgui_texture(beside(*ui.canvas)), first, last);
      draw->PopClipRect();
    }
  }
  draw->PopClipRect();
  if (beside) draw_wiper(ui, "wiper.image", placed.area_min, placed.area_max);
  ImGui::InvisibleButton("pixels", room, kAllButtons);
  // Name the image itself, so that fractions of the widget are fractions of the image.
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
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>& picture,
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>& beside) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  ScenePlacement placed;
  placed.width = static_cast<int>(room.x);
  placed.height = static_cast<int>(room.y);
  if (room.x < kLeastRoom_px || room.y < kLeastRoom_px) return std::nullopt;
  const auto w = static_cast<float>(placed.width), h = static_cast<float>(placed.height);
  placed.min = ImGui::GetCursorScreenPos();
  placed.max = ImVec2(placed.min.x + w, placed.min.y + h);
  if (ui.canvas) {
    const render::Camera camera = scene_camera(ui.state, w / h);
    ImDrawList* draw = ImGui::GetWindowDrawList();
    const auto add = [&](TextureId texture) {  // row 0 is at the bottom
      draw->AddImage(imgui_texture(texture), placed.min, placed.max, ImVec2(0, 1), ImVec2(1, 0));
    };
    add(picture(*ui.canvas, camera, placed.width, placed.height));
    if (beside) {
      const auto [min, max] = other_side(ui, placed.min, placed.max);
      draw->PushClipRect(min, max, true);
      add(beside(*ui.canvas, camera, placed.width, placed.height));
      draw->PopClipRect();
    }
  }
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  if (beside) draw_wiper(ui, "wiper", placed.min, placed.max);
  ImGui::SetCursorScreenPos(corner);
  ImGui::InvisibleButton("scene", ImVec2(w, h), kAllButtons);
  ui.name("view3d");
  if (ImGui::IsItemActivated()) ui.act("camera.hold", "on");
  if (ImGui::IsItemDeactivated()) ui.act("camera.hold", "off");
  return placed;
}

void zoom_scene(const Ui& ui) {
  const float wheel = ImGui::GetIO().MouseWheel;
  if (ImGui::IsItemHovered() && wheel != 0) ui.act("camera.zoom", std::pow(1.15, wheel));
}

void orbit_scene(const Ui& ui, int height) {
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  ui.act("camera.orbit", std::array{250.0 * moved.x / height, 250.0 * moved.y / height});
}

void pan_scene(const Ui& ui, int height) {
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  ui.act("camera.pan", std::array{-1.0 * moved.x / height, 1.0 * moved.y / height});
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
  draw_notice(ui, "Preparing the frame for labels …", ui.colors.muted);
}

// ---- Layout of the scene and the image ----------------------------------------------------------

namespace {

/// Area of a picture that fits below its toolbar.
float area_of(const Rect& room, float picture, float bar) {
  const float width = std::max(0.0F, std::min(room.w, (room.h - bar) * picture));
  return width * width / picture;
}

Arrangement side_by_side(const Rect& room, float picture, float share, float bar, float grip) {
  const float most = std::max(room.h - bar, 0.0F) * picture + bar / 2;
  const float image = std::round(std::min(share * room.w, most));
  const float scene = room.w - image - grip;
  return {.scene = Rect{room.x, room.y, scene, room.h},
          .image = Rect{room.x + room.w - image, room.y, image, room.h},
          .between = Rect{room.x + scene, room.y, grip, room.h},
          .beside = true};
}

Arrangement stacked(const Rect& room, float picture, float share, float bar, float grip) {
  const float most = room.w / picture + 1.5F * bar;
  const float image = std::round(std::min(share * room.h, most));
  const float scene = room.h - image - grip;
  return {.scene = Rect{room.x, room.y, room.w, scene},
          .image = Rect{room.x, room.y + room.h - image, room.w, image},
          .between = Rect{room.x, room.y + scene, room.w, grip}};
}

}  // namespace

Arrangement arrange(
    const Rect& room, double picture, Views shown, double share, float bar, float grip) {
  if (picture <= 0 || shown == Views::scene) return {.scene = room};
  if (shown == Views::image) return {.image = room};
  const auto of_image = static_cast<float>(picture), part = static_cast<float>(share);
  constexpr float kOfScene = 4.0F / 3;
  const auto worth = [&](const Arrangement& views) {
    return area_of(*views.scene, kOfScene, bar) * area_of(*views.image, of_image, bar);
  };
  const Arrangement a = side_by_side(room, of_image, part, bar, grip);
  const Arrangement b = stacked(room, of_image, part, bar, grip);
  return worth(b) > worth(a) ? b : a;
}

}  // namespace planescope::desktop
