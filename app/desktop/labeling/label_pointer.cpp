#include "app/desktop/labeling/label_pointer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

constexpr float kStep = 1.5f;    // [px] of a path
constexpr double kNotch = 1.15;  // of the wheel

bool draws(LabelTool tool) { return tool != LabelTool::wand && tool != LabelTool::polygon; }

/// Window managers like to keep drags with Alt to themselves: Ctrl takes off, too.
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

/// True where the path has changed.
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
  const std::size_t least = tool == LabelTool::brush ? 1 : tool == LabelTool::lasso ? 3 : 2;
  if (drag.path.size() < least) return;
  const char* action = tool == LabelTool::brush ? "label.stroke"
                       : tool == LabelTool::cut ? "label.cut"
                                                : "label.area";
  ui.emit(action, gesture_text(gesture_of(ui, surface, drag)));
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
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
    drag.on = false;
    return;
  }
  changed |= follow(surface, tool, drag);
  if (!ImGui::IsMouseDown(0)) {
    drag.on = false;
    finish(ui, surface, drag);
    return;
  }
  if (changed && tool != LabelTool::cut)
    ui.emit("label.preview", gesture_text(gesture_of(ui, surface, drag)));
}

void click_tool(const Ui& ui, const DrawingSurface& surface) {
  const ImGuiIO& io = ImGui::GetIO();
  LabelDrag& drag = ui.memory.label_drag;
  if (!ImGui::IsItemHovered()) return;
  if (ImGui::IsMouseDoubleClicked(0)) {
    drag.ignore_release = true;
    return ui.emit("label.accept");
  }
  if (!ImGui::IsMouseReleased(0) || std::exchange(drag.ignore_release, false)) return;
  if (was_dragged()) return;
  drag.mode = mode_of(io);
  drag.path = {surface.to_view(io.MousePos)};
  LabelGesture gesture = gesture_of(ui, surface, drag);
  if (ui.state.view.label.tool == LabelTool::polygon)
    return ui.emit("label.corner", gesture_text(gesture));
  gesture.mode = labels::PaintMode::over;
  ui.emit(drag.mode == labels::PaintMode::add ? "label.wand.add" : "label.wand",
          gesture_text(gesture));
}

/// What is under the mouse in either view is a depth pixel.
void click_gravity(const Ui& ui) {
  const LabelFrame* frame = ui.state.label_frame();
  if (!frame || !ImGui::IsItemHovered() || !ImGui::IsMouseReleased(0)) return;
  if (was_dragged()) return;
  const std::int64_t pixel = ui.state.view.label.hover;
  const bool is_floor = ui.state.view.gravity_click == GravityClick::floor;
  ui.emit(is_floor ? "gravity.floor" : "gravity.wall",
          pixel < 0 ? std::string("nothing")
                    : fmt::format("{},{}", pixel % frame->grid.width, pixel / frame->grid.width));
}

void point(const Ui& ui, const DrawingSurface& surface) {
  LabelPointing& pointing = ui.memory.label_pointing;
  if (!ImGui::IsItemHovered()) {
    if (pointing.now && pointing.where == surface.where) ui.emit("label.hover", "none");
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
  ui.emit("label.hover", gesture_text(gesture));
}

}  // namespace

bool left_button_moves(const State& state) { return state.view.label.tool == LabelTool::wand; }

bool wheel_sizes(const Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  const LabelView& view = ui.state.view.label;
  const bool wand = view.tool == LabelTool::wand && !view.wand.seeds.empty();
  if (io.KeyCtrl || io.MouseWheel == 0 || (!wand && view.tool != LabelTool::brush)) return false;
  const double factor = std::pow(kNotch, io.MouseWheel);
  if (wand)
    ui.emit("label.wand.tolerance", fmt::format("{:.6g}", view.wand_options.tolerance_m * factor));
  else
    ui.emit("label.brush", fmt::format("{:.6g}", view.brush_px * factor));
  return true;
}

void use_label_tool(const Ui& ui, const DrawingSurface& surface) {
  // Released while another tool or mode was in hand: must not be finished when this one is back.
  if (!ImGui::IsMouseDown(0) && !ImGui::IsMouseReleased(0)) ui.memory.label_drag.on = false;
  if (ui.state.view.gravity_click != GravityClick::none) {
    click_gravity(ui);
    return point(ui, surface);
  }
  draws(ui.state.view.label.tool) ? drag_tool(ui, surface) : click_tool(ui, surface);
  point(ui, surface);
}

}  // namespace planescope::desktop
