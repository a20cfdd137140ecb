// Mouse handling and overlays of the views in which label tools draw.

#include "app/desktop/labeling/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/desktop/labeling/panels/parts.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/model/text.hpp"
#include "render/palette.hpp"

namespace planescope::desktop {
namespace {

// ---- Mouse -------------------------------------------------------------------------------------

constexpr float kStep = 1.5f;    // [px] between points of a path
constexpr double kNotch = 1.15;  // factor per wheel notch

/// Whether the tool draws. With Alt or Ctrl, the wand draws a lasso that limits it.
bool draws(const Ui& ui) {
  const LabelTool tool = ui.state.view.label.tool;
  const ImGuiIO& io = ImGui::GetIO();
  if (tool == LabelTool::wand) return io.KeyAlt || io.KeyCtrl || ui.memory.label_drag.on;
  return tool != LabelTool::polygon;
}

/// Ctrl subtracts like Alt, because many window managers intercept Alt-drag.
labels::PaintMode mode_of(const ImGuiIO& io) {
  return io.KeyShift               ? labels::PaintMode::add
         : io.KeyAlt || io.KeyCtrl ? labels::PaintMode::subtract
                                   : labels::PaintMode::over;
}

LabelGesture gesture_of(const Ui& ui, const DrawingSurface& surface, const LabelDrag& drag) {
  LabelGesture gesture;
  gesture.where = surface.where;
  gesture.width = surface.width;
  gesture.height = surface.height;
  gesture.mode = drag.mode;
  gesture.path = drag.path;
  const LabelView& view = ui.state.view.label;
  if (view.tool == LabelTool::brush) gesture.radius_px = static_cast<float>(view.brush_px);
  if (view.tool == LabelTool::rectangle) {
    const labels::Vec2f a = drag.path.front(), b = drag.path.back();
    gesture.path = {a, {b.x(), a.y()}, b, {a.x(), b.y()}};
  }
  return gesture;
}

/// Returns true if the path has changed.
bool follow(const DrawingSurface& surface, LabelTool tool, LabelDrag& drag) {
  const labels::Vec2f at = surface.to_view(ImGui::GetIO().MousePos);
  if ((at - drag.path.back()).norm() * surface.scale < kStep) return false;
  const bool two_ends = tool == LabelTool::rectangle || tool == LabelTool::cut;
  if (two_ends && drag.path.size() > 1)
    drag.path.back() = at;
  else
    drag.path.push_back(at);
  return true;
}

void finish(const Ui& ui, const DrawingSurface& surface, const LabelDrag& drag) {
  const LabelTool tool = ui.state.view.label.tool;
  const bool closes = tool == LabelTool::lasso || tool == LabelTool::wand;
  const std::size_t least = tool == LabelTool::brush ? 1 : closes ? 3 : 2;
  if (drag.path.size() < least) return;
  if (tool == LabelTool::wand) {
    LabelGesture gesture = gesture_of(ui, surface, drag);
    gesture.mode = labels::PaintMode::over;
    return ui.act("label.wand.within", gesture);
  }
  const char* action = tool == LabelTool::brush ? "label.stroke"
                       : tool == LabelTool::cut ? "label.cut"
                                                : "label.area";
  ui.act(action, gesture_of(ui, surface, drag));
}

void drag_tool(const Ui& ui, const DrawingSurface& surface) {
  LabelDrag& drag = ui.memory.label_drag;
  const LabelTool tool = ui.state.view.label.tool;
  bool changed = false;
  if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(0)) {
    drag = {.on = true,
            .where = surface.where,
            .mode = mode_of(ImGui::GetIO()),
            .path = {surface.to_view(ImGui::GetIO().MousePos)}};
    changed = true;
  }
  if (!drag.on || drag.where != surface.where) return;
  if (went_down(ImGuiKey_Escape, false)) {
    drag.on = false;
    return;
  }
  changed |= follow(surface, tool, drag);
  if (!ImGui::IsMouseDown(0)) {
    drag.on = false;
    finish(ui, surface, drag);
    return;
  }
  if (changed && tool != LabelTool::cut && tool != LabelTool::wand)
    ui.act("label.preview", gesture_of(ui, surface, drag));
}

void click_tool(const Ui& ui, const DrawingSurface& surface) {
  const ImGuiIO& io = ImGui::GetIO();
  LabelDrag& drag = ui.memory.label_drag;
  if (!ImGui::IsItemHovered()) return;
  if (ImGui::IsMouseDoubleClicked(0)) {
    drag.ignore_release = true;
    return ui.act("label.accept");
  }
  if (!ImGui::IsMouseReleased(0) || std::exchange(drag.ignore_release, false)) return;
  if (was_dragged()) return;
  drag.mode = mode_of(io);
  drag.path = {surface.to_view(io.MousePos)};
  LabelGesture gesture = gesture_of(ui, surface, drag);
  if (ui.state.view.label.tool == LabelTool::polygon) return ui.act("label.corner", gesture);
  gesture.mode = labels::PaintMode::over;
  ui.act(drag.mode == labels::PaintMode::add ? "label.wand.add" : "label.wand", gesture);
}

/// The item under the mouse is a depth pixel, or in a cloud a point.
void click_gravity(const Ui& ui) {
  const LabelFrame* frame = ui.state.label_frame();
  if (!frame || !ImGui::IsItemHovered() || !ImGui::IsMouseReleased(0)) return;
  if (was_dragged()) return;
  const std::int64_t pixel = ui.state.view.label.hover;
  Clicked what;
  if (pixel >= 0 && !frame->grid.is_cloud()) {
    what = {Clicked::On::pixel, pixel_of(pixel, frame->grid.width)};
  } else if (const debug::Run* run = ui.state.run(); pixel >= 0 && run) {
    const auto voxel = run->subject->voxel_of_source(static_cast<std::size_t>(pixel));
    if (voxel != planes::kNoVoxel)
      what = {Clicked::On::voxel, {}, static_cast<std::int32_t>(voxel)};
  }
  ui.act(click_action(ui.state.view.click), what);
}

void point(const Ui& ui, const DrawingSurface& surface) {
  LabelPointing& pointing = ui.memory.label_pointing;
  if (!ImGui::IsItemHovered()) {
    if (pointing.now && pointing.where == surface.where)
      ui.act("label.hover", std::optional<LabelGesture>());
    if (pointing.where == surface.where) pointing.now = false;
    return;
  }
  const bool pressed = ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
  const labels::Vec2f at = surface.to_view(ImGui::GetIO().MousePos);
  const bool same = pointing.now && pointing.where == surface.where && pointing.at == at;
  if (pressed || same) return;
  pointing = {.now = true, .where = surface.where, .at = at};
  LabelGesture gesture;
  gesture.where = surface.where;
  gesture.width = surface.width;
  gesture.height = surface.height;
  gesture.path = {at};
  ui.act("label.hover", gesture);
}

// ---- Overlays ----------------------------------------------------------------------------------

constexpr ImU32 kInk = IM_COL32(255, 255, 255, 255), kHalo = IM_COL32(0, 0, 0, 190);

void draw_names(const Ui& ui, const DrawingSurface& surface) {
  const std::shared_ptr<const FrameLabels> labels = ui.state.labels();
  LabelNames& names = ui.memory.label_names;
  if (names.of != labels)
    names = {labels, render::label_places(*labels, ui.state.label_frame()->grid)};
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float size = ui.bold->FontSize;
  std::vector<render::LabelPlace> places = names.places;
  const int active = ui.state.view.label.plane;
  std::stable_partition(places.begin(), places.end(),
                        [&](const render::LabelPlace& one) { return one.plane == active; });
  // Names must not overlap. If there is no room for all of them, zoom in.
  std::vector<ImVec4> drawn;  // as x, y, z, w: left, top, right, bottom
  for (const render::LabelPlace& place : places) {
    const std::optional<ImVec2> at = surface.screen_of_pixel(place.pixel);
    if (!at) continue;
    const std::string name = fmt::format("P{}", place.plane);
    const ImVec2 extent = ui.bold->CalcTextSizeA(size, FLT_MAX, 0, name.c_str());
    const ImVec2 corner(at->x - extent.x / 2, at->y - extent.y / 2);
    const ImVec4 box(corner.x, corner.y, corner.x + extent.x, corner.y + extent.y);
    const auto covers = [&](const ImVec4& other) {
      return box.x < other.z && other.x < box.z && box.y < other.w && other.y < box.w;
    };
    if (std::ranges::any_of(drawn, covers)) continue;
    drawn.push_back(box);
    if (place.plane == active) {
      draw->AddRectFilled(ImVec2(corner.x - ui.px(5), corner.y - ui.px(1)),
                          ImVec2(corner.x + extent.x + ui.px(5), corner.y + extent.y + ui.px(1)),
                          IM_COL32(0, 0, 0, 200), ui.px(4));
    } else {
      for (const auto& [dx, dy] : {std::pair{-1.0f, 0.0f}, {1, 0}, {0, -1}, {0, 1}, {1, 1}})
        draw->AddText(ui.bold, size, ImVec2(corner.x + ui.px(dx), corner.y + ui.px(dy)), kHalo,
                      name.c_str());
    }
    draw->AddText(ui.bold, size, corner, kInk, name.c_str());
  }
}

void draw_line(const Ui& ui, const std::vector<ImVec2>& line, bool closed) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImDrawFlags flags = closed ? ImDrawFlags_Closed : ImDrawFlags_None;
  const int count = static_cast<int>(line.size());
  draw->AddPolyline(line.data(), count, kHalo, flags, ui.px(3.5f));
  draw->AddPolyline(line.data(), count, kInk, flags, ui.px(1.5f));
}

void draw_circle(const Ui& ui, ImVec2 middle, float radius) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddCircle(middle, radius, kHalo, 0, ui.px(3));
  draw->AddCircle(middle, radius, kInk, 0, ui.px(1.5f));
}

/// Draws the path of a drag, and the circle of the brush.
void draw_drag(const Ui& ui, const DrawingSurface& surface) {
  const LabelView& view = ui.state.view.label;
  const LabelDrag& drag = ui.memory.label_drag;
  const bool here = drag.on && drag.where == surface.where;
  if (view.tool == LabelTool::brush) {
    if (here || ImGui::IsItemHovered())
      draw_circle(ui, ImGui::GetIO().MousePos, static_cast<float>(view.brush_px) * surface.scale);
    return;
  }
  if (!here) return;
  std::vector<ImVec2> line;
  for (const labels::Vec2f& place : drag.path) line.push_back(surface.to_screen(place));
  if (view.tool == LabelTool::rectangle && line.size() > 1)
    line = {line[0], ImVec2(line[1].x, line[0].y), line[1], ImVec2(line[0].x, line[1].y)};
  draw_line(ui, line, view.tool != LabelTool::cut);
}

/// Includes the line that a click would add.
void draw_polygon(const Ui& ui, const DrawingSurface& surface) {
  const std::optional<OpenPolygon>& open = ui.state.view.label.polygon;
  if (!open || open->where != surface.where) return;
  std::vector<ImVec2> line;
  for (const labels::Vec2f& corner : open->corners) line.push_back(surface.to_screen(corner));
  for (const ImVec2& corner : line) draw_circle(ui, corner, ui.px(3));
  if (ImGui::IsItemHovered()) line.push_back(ImGui::GetIO().MousePos);
  draw_line(ui, line, line.size() > 2);
}

/// Draws the lasso that limits the wand, in the view in which it was drawn.
void draw_bound(const Ui& ui, const DrawingSurface& surface) {
  const std::shared_ptr<const WandBound>& bound = ui.state.view.label.bound;
  if (!bound || bound->drawn.where != surface.where) return;
  const bool moved =
      surface.where == DrawnIn::space && !same_camera(bound->drawn.camera, camera_of(ui.state));
  if (moved) return;
  std::vector<ImVec2> line;
  for (const labels::Vec2f& corner : bound->drawn.corners)
    line.push_back(surface.to_screen(corner));
  draw_line(ui, line, true);
}

/// Draws the mouse position in the other view.
void draw_pointed(const Ui& ui, const DrawingSurface& surface) {
  const std::int64_t pixel = ui.state.view.label.hover;
  if (pixel < 0 || ui.memory.label_pointing.where == surface.where) return;
  if (const auto at = surface.screen_of_pixel(static_cast<std::uint32_t>(pixel)))
    draw_circle(ui, *at, ui.px(5));
}

void draw_seeds(const Ui& ui, const DrawingSurface& surface) {
  for (const std::uint32_t seed : ui.state.view.label.wand.seeds)
    if (const auto at = surface.screen_of_pixel(seed)) draw_circle(ui, *at, ui.px(3));
}

std::vector<std::string> wand_lines(const LabelView& view, const char* sample) {
  std::vector<std::string> lines;
  if (!view.wand.found) {
    lines.push_back(view.wand.why_not.empty() ? "No plane here" : view.wand.why_not);
  } else {
    const labels::WandResult& found = *view.wand.found;
    const labels::FittedPlane& plane = found.plane;
    const char* label = found.label == Label::h   ? "horizontal"
                        : found.label == Label::v ? "vertical"
                                                  : "class unknown";
    lines.push_back(fmt::format("{}   RMS {:.1f} mm   {}   {}", label, 1000 * plane.rms_m,
                                area_text(plane.area_m2), tilt_text(plane.tilt_deg)));
    lines.push_back(fmt::format("normal {:.3f}, {:.3f}, {:.3f}   {}", plane.normal.x(),
                                plane.normal.y(), plane.normal.z(),
                                counted(found.pixels.size(), sample)));
  }
  lines.push_back(view.wand.found
                      ? "Enter accepts, Shift+click adds a part, scrolling changes the tolerance"
                      : "Scroll to increase the tolerance");
  return lines;
}

std::string pointed_text(const State& state) {
  const std::int64_t pixel = state.view.label.hover;
  const labels::LabelGrid& grid = state.label_frame()->grid;
  if (pixel < 0 || pixel >= static_cast<std::int64_t>(grid.pixels())) return {};
  const auto at = static_cast<std::size_t>(pixel);
  std::string text = grid.is_cloud()
                         ? fmt::format("point {}", pixel)
                         : fmt::format("{}, {}", pixel % grid.width, pixel / grid.width);
  if (!grid.measured[at]) return text + "   no measurement";
  if (grid.is_cloud()) {
    const Vec3d point = grid.origin + grid.points[at].cast<double>();
    text += fmt::format("   {:.3f}, {:.3f}, {:.3f} m", point.x(), point.y(), point.z());
  } else {
    text += fmt::format("   {:.3f} m", grid.points[at].z());
  }
  if (const std::optional<render::Residual> residual = residual_of(state))
    text += fmt::format("   {:+.1f} mm of {}", 1000 * residual->distance_m(grid.points[at]),
                        residual->name);
  const FrameLabels& labels = *state.labels();
  const int id = labels.plane.data[at], hv = labels.hv.data[at];
  const char* label = hv == 1 ? " h" : hv == 2 ? " v" : "";
  if (id == kPlaneIgnore) return text + "   ignored";
  if (id == 0) return text + "   unlabeled" + label;
  text += fmt::format("   P{}{}", id, label);
  if (const LabelPlane* plane = labels::find_plane(labels, id))
    text += std::string(plane->locked ? ", locked" : "") + (plane->hidden ? ", hidden" : "");
  return text;
}

/// Draws the scale of residual colors.
void draw_residual_scale(const Ui& ui, const DrawingSurface& surface) {
  if (const std::optional<render::Residual> residual = residual_of(ui.state))
    draw_scale_bar(
        ui,
        {.what = "distance to " + (residual->plane == 0 ? "the wand's plane" : residual->name),
         .range = {-residual->most_m, residual->most_m},
         .map = render::ColorScale::Map::diverging,
         .at_low = "behind",
         .at_high = "before"},
        surface.min, surface.max);
}

/// Drawn in a left corner of the view that the mouse is or was last over, away from the mouse.
void draw_facts(const Ui& ui, const DrawingSurface& surface) {
  const LabelPointing& pointing = ui.memory.label_pointing;
  if (pointing.where != surface.where) return;
  const LabelView& view = ui.state.view.label;
  std::vector<std::string> lines;
  if (!view.wand.seeds.empty())
    lines = wand_lines(view, sample_name(*ui.state.label_frame()));
  else if (std::string text = pointed_text(ui.state); !text.empty())
    lines = {std::move(text)};
  if (lines.empty()) return;
  const std::string text = fmt::format("{}", fmt::join(lines, "\n"));
  const float height = ImGui::CalcTextSize(text.c_str()).y + ui.px(8);
  const float middle = (surface.min.y + surface.max.y) / 2;
  const bool above = lines.size() > 1 && surface.to_screen(pointing.at).y > middle;
  const float below_badge = ui.px(surface.where == DrawnIn::space ? 42 : 8);
  const ImVec2 at(surface.min.x + ui.px(8),
                  above ? surface.min.y + below_badge : surface.max.y - ui.px(8) - height);
  const ImU32 ground = with_alpha(ui.colors.panel, 225);
  draw_badge(ui, at, text, ground, ui.colors.text);
}

}  // namespace

float draw_badge(const Ui& ui, ImVec2 at, const std::string& text, ImU32 ground, ImU32 ink) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 extent = ImGui::CalcTextSize(text.c_str());
  const ImVec2 end(at.x + extent.x + ui.px(14), at.y + extent.y + ui.px(8));
  draw->AddRectFilled(at, end, ground, ui.px(4));
  draw->AddText(ImVec2(at.x + ui.px(7), at.y + ui.px(4)), ink, text.c_str());
  return end.y - at.y;
}

bool left_button_moves(const Ui& ui) {
  return ui.state.view.label.tool == LabelTool::wand && !ui.memory.label_drag.on;
}

bool wheel_sizes(const Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  const LabelView& view = ui.state.view.label;
  const bool wand = view.tool == LabelTool::wand && !view.wand.seeds.empty();
  if (io.KeyCtrl || io.MouseWheel == 0 || (!wand && view.tool != LabelTool::brush)) return false;
  const double factor = std::pow(kNotch, io.MouseWheel);
  if (wand)
    ui.act("label.wand.tolerance", view.wand_options.tolerance_m * factor);
  else
    ui.act("label.brush", view.brush_px * factor);
  return true;
}

void use_label_tool(const Ui& ui, const DrawingSurface& surface) {
  // Forget a drag that was released under another tool or mode, so that it is not completed later.
  if (!ImGui::IsMouseDown(0) && !ImGui::IsMouseReleased(0)) ui.memory.label_drag.on = false;
  if (picks_gravity(ui.state.view.click)) {
    click_gravity(ui);
    return point(ui, surface);
  }
  draws(ui) ? drag_tool(ui, surface) : click_tool(ui, surface);
  point(ui, surface);
}

void draw_label_overlay(const Ui& ui, const DrawingSurface& surface) {
  ImGui::GetWindowDrawList()->PushClipRect(surface.min, surface.max, true);
  draw_names(ui, surface);
  draw_seeds(ui, surface);
  draw_pointed(ui, surface);
  draw_drag(ui, surface);
  draw_polygon(ui, surface);
  draw_bound(ui, surface);
  draw_residual_scale(ui, surface);
  draw_facts(ui, surface);
  ImGui::GetWindowDrawList()->PopClipRect();
}

}  // namespace planescope::desktop
