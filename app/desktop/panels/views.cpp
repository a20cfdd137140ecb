// The scene view and the image view at the cursor, and measurements drawn over them.

#include "app/desktop/views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"
#include "core/debug/explain/measure.hpp"
#include "render/draw_list.hpp"

namespace planescope::desktop {

// ---- Scene: drag to orbit and pan, click to select, right-click for a menu ----------------------

namespace {

void draw_tools(const Ui& ui) {
  const ColorChoice& chosen = kColorChoices[static_cast<std::size_t>(ui.state.view.color_by)];
  ImGui::SetNextItemWidth(ui.px(96));
  const bool open = ImGui::BeginCombo("##color", chosen.name);
  ui.name("view3d.color");
  if (!open) tooltip("Color by   1 to 9, 0, Shift+0");
  if (open) {
    for (const ColorChoice& color : kColorChoices) {
      if (ImGui::Selectable(color.name, color.by == chosen.by)) ui.act(color.action);
      ui.name(std::string("view3d.color.") + color.name);
    }
    ImGui::EndCombo();
  }
  static constexpr ToolButton kButtons[] = {
      {"show.queue", "queue"},       {"show.settled", "boxes"},       {"show.planes", "planes"},
      {"show.foot", "foot"},         {"show.stairs", "stairs"},       {"camera.home", "home"},
      {"camera.selected", "frame"},  {"camera.top", "top"},           {"camera.side", "side"},
      {"camera.front", "front"},     {"camera.orthographic", "flat"}, {"isolate", "isolate"},
      {"measure.points", "measure"}, {"views.next", "views"}};
  toolbar(ui, "view3d.more", kButtons);
}

void move_by_mouse(const Ui& ui, int height) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool right = ImGui::IsMouseDown(1), middle = ImGui::IsMouseDown(2);
  const bool pans = (right && was_dragged(1)) || middle || io.KeyShift;
  if (ImGui::IsItemActive() && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    if (pans)
      pan_scene(ui, height);
    else if (was_dragged() && !right)
      orbit_scene(ui, height);
  }
  zoom_scene(ui);
}

render::Picked seen_at_mouse(const Ui& ui, const ScenePlacement& placed) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (!ui.canvas) return {};
  return ui.canvas->pick(static_cast<int>(mouse.x - placed.min.x),
                         static_cast<int>(mouse.y - placed.min.y), static_cast<int>(ui.px(4)));
}

/// The visible item under the mouse or, if there is none, the depth pixel in that direction.
PointedAt pointed_at(const Ui& ui, const ScenePlacement& placed) {
  PointedAt found{.what = seen_at_mouse(ui, placed)};
  if (found.what.kind != render::Picked::Kind::nothing) return found;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double aspect = static_cast<double>(placed.width) / placed.height;
  const render::View view =
      render::make_view(scene_camera(ui.state, aspect), placed.width, placed.height);
  if (const auto pixel = pixel_of_nothing(*ui.state.run()->subject, view,
                                          Vec2d(mouse.x - placed.min.x, mouse.y - placed.min.y)))
    found.source = static_cast<std::int64_t>(*pixel);
  return found;
}

void select(const Ui& ui, const PointedAt& at) {
  const render::Picked& what = at.what;
  if (const char* action = click_action(ui.state.view.click)) {
    if (what.kind == render::Picked::Kind::voxel)
      return ui.act(action, Clicked{Clicked::On::voxel, {}, what.index});
    if (what.kind == render::Picked::Kind::plane)
      return ui.act(action, Clicked{Clicked::On::plane, {}, what.index});
    return ui.act(action, Clicked{});
  }
  const int width = ui.state.run()->subject->frame.depth.width;
  switch (what.kind) {
    case render::Picked::Kind::voxel:
      if (ImGui::GetIO().KeyCtrl && ui.state.view.selected.voxel >= 0)
        return ui.act("join.show", Clicked{Clicked::On::voxel, {}, what.index});
      return ui.act("select.voxel", what.index);
    case render::Picked::Kind::node:
      return ui.act("select.node", what.index);
    case render::Picked::Kind::plane:
      return ui.act("select.plane", PlaneRef{what.index});
    default:
      if (at.source < 0) return ui.act("select.none");
      return ui.act("why.pixel", pixel_of(at.source, width));
  }
}

void draw_tooltip(const Ui& ui, const render::Picked& what) {
  if (what.kind == render::Picked::Kind::voxel)
    tooltip_at_mouse(describe_voxel(ui.state, what.index));
  if (what.kind == render::Picked::Kind::node)
    tooltip_at_mouse(describe_node(ui.state, what.index));
  if (what.kind == render::Picked::Kind::plane)
    tooltip_at_mouse(describe_plane(ui.state, what.index));
}

}  // namespace

void draw_view3d(const Ui& ui) {
  if (draw_camera_setup(ui)) return;
  draw_tools(ui);
  if (!ui.state.run()) return draw_absence(ui);
  if (!shows_image(ui.state)) draw_click_line(ui);
  using Picture = std::function<TextureId(Canvas&, const render::Camera&, int, int)>;
  const RunView* other = ui.state.other_view();
  const Picture here = [&](Canvas& canvas, const render::Camera& camera, int width, int height) {
    return canvas.scene(ui.state.run_view()->run, look_of(ui.state), camera, width, height);
  };
  const Picture beside = [&](Canvas& canvas, const render::Camera& camera, int width, int height) {
    return canvas.scene(other->run, other_look_of(ui.state), camera, width, height, Side::beside);
  };
  const auto placed = draw_scene_room(ui, here, other ? beside : Picture());
  if (!placed) return;
  draw_color_scale(ui, placed->min, placed->max);
  draw_measured(ui, *placed);
  move_by_mouse(ui, placed->height);
  std::optional<PointedAt> clicked;
  const bool here_below = mouse_is_here(ui, placed->min, placed->max);
  if (ImGui::IsItemHovered() && !here_below) tooltip("The other run; Space switches to it");
  if (ImGui::IsItemHovered() && here_below) {
    const bool pressed = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
    const bool released = ImGui::IsMouseReleased(0) && !was_dragged();
    const bool playing = ui.state.view.playing.direction != 0;  // too fast to read
    if (ImGui::IsMouseReleased(1) && !was_dragged(1)) clicked = pointed_at(ui, *placed);
    if (!pressed && !clicked && (released || !playing)) {
      if (released)
        select(ui, pointed_at(ui, *placed));
      else
        draw_tooltip(ui, seen_at_mouse(ui, *placed));
    }
    if (ImGui::IsMouseDoubleClicked(0) && ui.state.view.click == Click::selects)
      ui.act("camera.selected");
  }
  draw_context_menu(ui, clicked);
  draw_sides(ui, "view3d", placed->min, placed->max);
}

// ---- Image: click to select, drag to pan or to mark a region ------------------------------------

namespace {

/// Handles marking a rectangle.
void mark_by_mouse(const Ui& ui, const ImagePlacement& placed) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemActive()) {
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled(io.MouseClickedPos[0], io.MousePos, with_alpha(ui.colors.warning, 60));
    draw->AddRect(io.MouseClickedPos[0], io.MousePos, ui.colors.warning, 0, 0, ui.px(1.5f));
  }
  if (!ImGui::IsItemDeactivated()) return;
  const ImVec2 from = placed.to_image(io.MouseClickedPos[0]), to = placed.to_image(io.MousePos);
  const auto whole = [](float px) { return static_cast<double>(std::round(px)); };
  ui.act("mark.pixels", std::array{whole(from.x), whole(from.y), whole(to.x + 1), whole(to.y + 1)});
}

/// The item under the mouse; nullopt outside the image.
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

/// Handles the mouse; returns the right-clicked item.
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
    const Pixel pixel = pixel_of(at->source, placed.width);
    if (action || (second && !nothing))
      ui.act(action ? action : "join.show", Clicked{Clicked::On::pixel, pixel});
    else
      ui.act(nothing ? "why.pixel" : "select.pixel", pixel);
  }
  return ImGui::IsMouseReleased(1) && !was_dragged(1) ? at : std::nullopt;
}

/// "u 320, v 240: 1.234 m" and the voxel's description.
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

// ---- Measurements, in words and over the views --------------------------------------------------

namespace {

/// Projects a point in sensor coordinates to the screen; nullopt if it is not visible.
using ToScreen = std::function<std::optional<ImVec2>(const Vec3d&)>;

/// Shorter legs are not worth showing.
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

/// Draws text beside the middle of a line, on the given side: -1 left, 1 right.
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
  // Show horizontal and vertical legs of a slanted line.
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
    // Slightly off the pixel for lenses with distortion.
    return placed.to_screen(static_cast<float>(k.fx * at.x() / at.z() + k.cx + 0.5),
                            static_cast<float>(k.fy * at.y() / at.z() + k.cy + 0.5));
  });
}

}  // namespace planescope::desktop
