// Window contents: panel layout, keyboard shortcuts, and the update of each frame.

#include "app/desktop/shell.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <new>
#include <span>
#include <utility>

#include "app/desktop/imgui.hpp"
#include "app/desktop/panels.hpp"
#include "app/desktop/ui.hpp"
#include "app/desktop/views.hpp"
#include "render/paint.hpp"

namespace planescope::desktop {
namespace {

constexpr float kTextPx = 15;

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoBringToFrontOnFocus;

constexpr ImGuiWindowFlags kStill =
    ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse;

/// Draws a panel in its area.
template <typename Draw>
void panel(const Ui& ui, const char* name, const Rect& rect, ImGuiWindowFlags flags, Draw draw) {
  ImGui::SetNextWindowPos(ImVec2(rect.x, rect.y));
  ImGui::SetNextWindowSize(ImVec2(std::max(1.0f, rect.w), std::max(1.0f, rect.h)));
  const bool has_keyboard = ui.state.view.keyboard == name;
  std::string& had_keyboard = ui.memory.texts["keyboard"];
  if (has_keyboard && had_keyboard != name) ImGui::SetNextWindowFocus();
  if (has_keyboard) had_keyboard = name;
  if (ImGui::Begin(name, nullptr, kFixed | flags)) draw();
  if (has_keyboard)
    ImGui::GetForegroundDrawList()->AddRect(ImVec2(rect.x, rect.y),
                                            ImVec2(rect.x + rect.w, rect.y + rect.h),
                                            ui.colors.accent, 0, 0, ui.px(1.5f));
  ImGui::End();
  ui.name(std::string("panel.") + name, ImVec2(rect.x, rect.y),
          ImVec2(rect.x + rect.w, rect.y + rect.h));
}

void tabs(const Ui& ui,
          const char* bar,
          const std::string& chosen,
          const std::string& action,
          std::span<const Tab> all) {
  if (!ImGui::BeginTabBar(bar, ImGuiTabBarFlags_FittingPolicyScroll)) return;
  // The state selects the tab; ImGui's own selection follows it.
  std::string& shown = ui.memory.texts[bar];
  for (const Tab& tab : all) {
    const bool wanted = chosen == tab.name;
    const ImGuiTabItemFlags flags =
        wanted && shown != chosen ? ImGuiTabItemFlags_SetSelected : ImGuiTabItemFlags_None;
    const bool open = ImGui::BeginTabItem(tab.title, nullptr, flags);
    ui.name(std::string("tab.") + tab.name);
    if (ImGui::IsItemClicked() && !wanted) ui.act(action, tab.name);
    if (!open) continue;
    if (wanted) shown = chosen;
    ImGui::BeginChild(tab.name, ImVec2(0, 0), false, ImGuiWindowFlags_NavFlattened);
    tab.draw(ui);
    ImGui::EndChild();
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

/// A splitter between panels that changes a fraction of the layout.
void splitter(const Ui& ui,
              const std::string& name,
              const Rect& rect,
              bool vertical,
              float extent,
              float sign) {
  ImGui::SetNextWindowPos(ImVec2(rect.x, rect.y));
  ImGui::SetNextWindowSize(ImVec2(rect.w, rect.h));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::Begin(("##splitter." + name).c_str(), nullptr, kFixed | ImGuiWindowFlags_NoScrollbar);
  ImGui::InvisibleButton("grip", ImVec2(rect.w, rect.h));
  ui.name("splitter." + name);
  const bool hot = ImGui::IsItemActive() || ImGui::IsItemHovered();
  if (hot) ImGui::SetMouseCursor(vertical ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
  if (ImGui::IsItemActive()) {
    const ImVec2 delta = ImGui::GetIO().MouseDelta;
    const float moved = vertical ? delta.x : delta.y;
    double Layout::*share = std::ranges::find(kLayoutParts, name, &LayoutPart::name)->share;
    if (moved != 0)
      ui.act("layout.set", LayoutShare{share, ui.state.view.layout.*share + sign * moved / extent});
  }
  ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(rect.x, rect.y),
                                            ImVec2(rect.x + rect.w, rect.y + rect.h),
                                            hot ? ui.colors.accent : ui.colors.grid);
  ImGui::End();
  ImGui::PopStyleVar(3);
}

void draw_timing(const Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::SetNextWindowPos(ImVec2(io.DisplaySize.x - ui.px(8), ui.px(34)), 0, ImVec2(1, 0));
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::Begin("##timing", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
  ImGui::Text("frame %.1f ms, median %.1f ms, 99th percentile %.1f ms", ui.timing.last_ms,
              ui.timing.median_ms, ui.timing.p99_ms);
  ImGui::End();
}

/// Areas of the panels common to all modes, and the space between them.
struct Places {
  float top = 0, body = 0, status = 0;  // top of the body; height of the body and the status bar
  float left = 0, right = 0;            // widths of the side columns
  float x1 = 0, x2 = 0, middle = 0;     // space between them: from x1, `middle` wide
  float grip = 0;                       // width of splitters
};

/// Limits a fraction so that no panel disappears.
float share(double s, double low, double high) {
  return static_cast<float>(std::clamp(s, low, high));
}

Places places_of(const Ui& ui, float w, float h) {
  const Layout& layout = ui.state.view.layout;
  Places at;
  at.top = ImGui::GetFrameHeight();
  at.status = ImGui::GetFrameHeight() + ui.px(2);
  at.grip = std::round(ui.px(4));
  at.body = h - at.top - at.status;
  at.left = std::round(w * share(layout.left, 0.06, 0.25));
  at.right = std::round(w * share(layout.right, 0.15, 0.45));
  at.middle = w - at.left - at.right - 2 * at.grip;
  at.x1 = at.left + at.grip;
  at.x2 = at.x1 + at.middle;
  return at;
}

void draw_debugger(const Ui& ui, const Places& at) {
  const ViewState& view = ui.state.view;
  const Layout& layout = view.layout;
  const float timeline = std::round(ui.px(108)), grip = at.grip, x1 = at.x1, middle = at.middle;
  const std::vector<Assumption> assumptions = assumptions_of(ui.state);
  const float line = assumptions.empty() ? 0 : std::round(ImGui::GetFrameHeight() + ui.px(14));
  const float bottom = std::round(at.body * share(layout.bottom, 0.1, 0.6));
  const float top = at.body - bottom - timeline - grip - line;
  const bool has_tree = !ui.state.run() || !ui.state.run()->octree().nodes.empty();
  const float octree = has_tree ? std::round(middle * share(layout.octree, 0.15, 0.85)) : -grip;
  const float tools = std::round(at.body * share(layout.tools, 0.15, 0.8));
  const float y0 = at.top + line, y1 = y0 + top, y2 = at.top + at.body - bottom,
              y3 = at.top + at.body - tools;
  const float x3 = at.x2 + grip;

  const float bar = ImGui::GetFrameHeight() + ui.px(16);
  if (!assumptions.empty())
    panel(ui, "assumptions", {x1, at.top, middle, line}, kStill,
          [&] { draw_assumptions(ui, assumptions); });
  const Arrangement views = arrange({x1, y0, middle, top}, picture_shape(ui.state), view.views,
                                    share(layout.image, 0.0, 0.8), bar, grip);
  if (views.scene) panel(ui, "view3d", *views.scene, kStill, [&] { draw_view3d(ui); });
  if (views.image) panel(ui, "image", *views.image, kStill, [&] { draw_image(ui); });
  panel(ui, "timeline", {x1, y1, middle, timeline}, kStill, [&] { draw_timeline(ui); });
  if (has_tree) panel(ui, "octree", {x1, y2, octree, bottom}, kStill, [&] { draw_octree(ui); });
  panel(ui, "events", {x1 + octree + grip, y2, middle - octree - grip, bottom}, kStill,
        [&] { tabs(ui, "##list_tabs", view.list_tab, "tab.list", kListTabs); });
  panel(ui, "inspector", {x3, at.top, at.right, at.body - tools - grip}, kStill,
        [&] { tabs(ui, "##inspector_tabs", view.inspector_tab, "tab.inspector", kInspectorTabs); });
  panel(ui, "tools", {x3, y3, at.right, tools}, kStill,
        [&] { tabs(ui, "##tool_tabs", view.tool_tab, "tab.tool", kToolTabs); });
  if (views.between)
    splitter(ui, "image", *views.between, views.beside, views.beside ? middle : top, -1);
  splitter(ui, "bottom", {x1, y2 - grip, middle, grip}, false, at.body, -1);
  if (has_tree) splitter(ui, "octree", {x1 + octree, y2, grip, bottom}, true, middle, 1);
  splitter(ui, "tools", {x3, y3 - grip, at.right, grip}, false, at.body, -1);
}

void draw_label_mode(const Ui& ui, const Places& at) {
  const Layout& layout = ui.state.view.layout;
  const float bar = std::round(ImGui::GetFrameHeight() + ui.px(14)), grip = at.grip;
  const float y = at.top + bar, height = at.body - bar;
  const bool has_image = picture_shape(ui.state) > 0;
  // Both views are as large as possible for 4:3 pictures. Clouds have no image.
  const bool beside = at.middle > 2 * height;
  const float extent = beside ? at.middle : height;
  const float image = has_image ? std::round(extent * share(layout.image, 0.0, 0.8)) : 0;
  const float space = has_image ? extent - image - grip : extent;
  const Rect first = beside ? Rect{at.x1, y, space, height} : Rect{at.x1, y, at.middle, space};
  const Rect second = beside ? Rect{at.x1 + space + grip, y, image, height}
                             : Rect{at.x1, y + space + grip, at.middle, image};
  const Rect between =
      beside ? Rect{at.x1 + space, y, grip, height} : Rect{at.x1, y + space, at.middle, grip};

  panel(ui, "label_tools", {at.x1, at.top, at.middle, bar}, kStill, [&] { draw_label_tools(ui); });
  panel(ui, "view3d", first, kStill, [&] { draw_label_space(ui); });
  if (has_image) panel(ui, "image", second, kStill, [&] { draw_label_image(ui); });
  panel(ui, "labels", {at.x2 + grip, at.top, at.right, at.body}, kStill,
        [&] { tabs(ui, "##label_tabs", ui.state.view.label.tab, "tab.label", kLabelTabs); });
  if (has_image) splitter(ui, "image", between, beside, extent, -1);
}

/// Closes the open menu or list, if any. ImGui does not, because Escape is an action's key.
bool close_menu() {
  constexpr ImGuiPopupFlags kAny = ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel;
  if (!ImGui::IsPopupOpen("", kAny)) return false;
  ImGui::ClosePopupToLevel(0, true);
  return true;
}

/// Keys that navigate within a panel that has keyboard focus.
bool moves_among_widgets(const std::string& key) {
  constexpr std::array kKeys = {"Left",  "Right", "Up",  "Down",   "Space",
                                "Enter", "Home",  "End", "PageUp", "PageDown"};
  return std::ranges::find(kKeys, key) != kKeys.end();
}

/// On failure, the journal still has everything, and no window is left to report the error.
void save_quietly(const OpenRecording& open) {
  try {
    if (open.labels && open.labels->read_only().empty()) open.labels->save_all();
  } catch (const std::exception&) {
  }
}

}  // namespace

Shell::Shell(State state, std::unique_ptr<Canvas> canvas, std::function<void()> wake)
    : state_(std::move(state)), jobs_(wake), steps_(std::move(wake)), canvas_(std::move(canvas)) {
  // ImGui does not check its allocator's result, so the allocator must throw when out of memory.
  ImGui::SetAllocatorFunctions([](std::size_t size, void*) { return ::operator new(size); },
                               [](void* memory, void*) { ::operator delete(memory); });
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.ConfigInputTextCursorBlink = false;  // an idle window draws nothing
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  // A huge window has more than 65,536 vertices, which the OpenGL renderer supports.
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  expect_keys(io);
}

Shell::~Shell() {
  for (const OpenRecording& open : state_.document.recordings) save_quietly(open);
  ImGui::SetCurrentContext(context_);
  canvas_.reset();
  ImGui::DestroyContext(context_);
}

void Shell::rebuild_fonts(float scale) {
  // Latin, Greek, punctuation, sub- and superscripts, arrows, math, shapes.
  static const ImWchar ranges[] = {0x20,   0x17f,  0x370,  0x3ff,  0x2010, 0x205e, 0x2070,
                                   0x209c, 0x2190, 0x21ff, 0x2200, 0x22ff, 0x25a0, 0x25ff,
                                   0x2600, 0x26ff, 0x2713, 0x2718, 0};
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  const std::string_view file = render::font_file();
  const auto add = [&](float px, float embolden) {
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;
    config.OversampleH = 2;
    config.RasterizerMultiply = embolden;
    return atlas.AddFontFromMemoryTTF(const_cast<char*>(file.data()), static_cast<int>(file.size()),
                                      std::round(px * scale), &config, ranges);
  };
  add(kTextPx, 1);
  small_ = add(kTextPx * 0.85f, 1);
  bold_ = add(kTextPx * 1.1f, 1.35f);
  build_fonts(atlas);
  fonts_changed_ = true;
}

std::string Shell::take_picture_path() {
  // One frame later, because this frame still shows the prompt for the path.
  return std::exchange(picture_due_, std::exchange(state_.view.picture_to, {}));
}

bool Shell::take_fonts_changed() { return std::exchange(fonts_changed_, false); }

void Shell::perform(const Command& command, bool strict) {
  frames_to_draw_ = std::max(frames_to_draw_, 2);
  try {
    const bool asks = !strict && command.argument.empty() && !command.value.has_value() &&
                      needs_argument(find_action(command.action));
    apply(state_, asks ? Command{"palette.ask", command.action} : command);
    ViewState& view = state_.view;
    if (view.show_palette && !asks && view.palette_asks == command.action)
      view.show_palette = false;
  } catch (const std::exception& error) {  // an Error or a filesystem error
    if (strict) throw;
    say(state_, error.what(), true);
  }
}

bool Shell::expire_message() {
  constexpr std::chrono::seconds kShown{12};
  const ViewState& view = state_.view;
  if (view.message.empty() || view.message_is_error || view.hint_done) return false;
  const auto now = std::chrono::steady_clock::now();
  if (view.message != message_) {
    message_ = view.message;
    message_since_ = now;
  }
  if (now - message_since_ < kShown) return true;
  say(state_, "");
  message_.clear();
  frames_to_draw_ = std::max(frames_to_draw_, 1);
  return false;
}

bool Shell::needs_frame() const {
  return frames_to_draw_ > 0 || !input_.empty() || state_.view.playing.direction != 0 ||
         state_.view.playing_frames || (steps_.active(state_) && steps_.has_room());
}

void Shell::frame(int width, int height, float screen_scale, double seconds) {
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  const float scale = screen_scale * static_cast<float>(state_.view.zoom);
  if (scale != scale_) rebuild_fonts(scale_ = scale);
  set_style(state_.view.theme, scale);
  if (canvas_) canvas_->screen_scale = scale;
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = static_cast<float>(std::max(seconds, 1e-4));
  if (!input_.empty()) frames_to_draw_ = 3;

  const bool typing = io.WantTextInput;
  input_.feed(io, [&](const std::string& key) {
    // While text is being typed, only Ctrl combinations and function keys are shortcuts.
    const bool ours = key.starts_with("Ctrl+") || (key[0] == 'F' && key.size() > 1) ||
                      key.find("+F") != std::string::npos;
    const bool edits = key == "Ctrl+A" || key == "Ctrl+C" || key == "Ctrl+V" || key == "Ctrl+X" ||
                       key == "Ctrl+Z" || key == "Ctrl+Y";
    if (typing && (!ours || edits)) return;
    if (key == "Escape" && close_menu()) return;
    if (state_.view.show_palette && key == "Escape") return perform({"palette"});
    if (state_.view.show_keys && key == "Escape") return perform({"keys"});
    if (state_.view.saving && key == "Escape") return perform({"steps.cancel"});
    if (!state_.view.keyboard.empty() && key == "Escape") return perform({"keyboard.panel"});
    if (!state_.view.keyboard.empty() && moves_among_widgets(key)) return;
    const Action* action = action_of_key(key, state_.view.mode);
    if (!action) return;
    // If Tab is bound to an action, do not let it start typing in the next slider too.
    if (key.ends_with("Tab")) input_.let_go(io, Key::tab);
    if (action->can_run(state_)) perform({action->name, action->key_is_argument ? key : ""});
  });

  if (state_.view.keyboard.empty()) memory_.texts["keyboard"].clear();
  set_navigation(io, !state_.view.keyboard.empty());
  if (jobs_.collect(state_)) frames_to_draw_ = std::max(frames_to_draw_, 2);
  drop_done_hint(state_);
  Playing& playing = state_.view.playing;
  if (playing.direction != 0 && state_.run()) {
    playing.due += seconds * playing.steps_per_s;
    const int steps = static_cast<int>(playing.due);
    playing.due -= steps;
    if (steps > 0) step_by(state_, playing.direction * steps);
    const std::int32_t end = playing.direction > 0 ? state_.run()->steps() : 0;
    if (state_.view.step == end) playing.direction = 0;
    frames_to_draw_ = std::max(frames_to_draw_, 2);
  }

  if (state_.view.playing_frames) {
    play_frames(state_, seconds);
    frames_to_draw_ = std::max(frames_to_draw_, 2);
  }

  steps_.note_frame(state_);
  const ImVec2 mouse = io.MousePos;
  const bool hides_mouse = state_.view.saving && state_.view.saving->hidden;
  if (hides_mouse) io.MousePos = ImVec2(-FLT_MAX, -FLT_MAX);  // no hover details in saved pictures
  ImGui::NewFrame();
  if (!state_.view.to_clipboard.empty())
    ImGui::SetClipboardText(std::exchange(state_.view.to_clipboard, {}).c_str());
  draw(width, height);
  ImGui::Render();
  io.MousePos = mouse;
  jobs_.pursue(state_);
  --frames_to_draw_;
}

void Shell::draw(int width, int height) {
  widgets_.clear();
  std::vector<Command> commands;
  Ui ui{.state = state_,
        .commands = commands,
        .widgets = widgets_,
        .memory = memory_,
        .canvas = canvas_.get(),
        .colors = ui_colors(state_.view.theme),
        .scale = scale_,
        .small = small_,
        .bold = bold_,
        .timing = timing};
  // Below this size, text is unreadable: clip the contents instead of squeezing them.
  const float w = std::max(static_cast<float>(width), ui.px(640));
  const float h = std::max(static_cast<float>(height), ui.px(400));
  if (ImGui::BeginMainMenuBar()) {
    draw_menu(ui);
    ImGui::EndMainMenuBar();
  }
  const Places places = places_of(ui, w, h);
  panel(ui, "frames", {0, places.top, places.left, places.body}, 0, [&] { draw_frames(ui); });
  state_.view.mode == Mode::labels ? draw_label_mode(ui, places) : draw_debugger(ui, places);
  panel(ui, "status", {0, h - places.status, w, places.status}, kStill, [&] { draw_status(ui); });
  const Rect left{places.left, places.top, places.grip, places.body};
  const Rect right{places.x2, places.top, places.grip, places.body};
  splitter(ui, "left", left, true, w, 1);
  splitter(ui, "right", right, true, w, -1);

  if (state_.view.show_palette) draw_palette(ui);
  if (state_.view.show_keys) draw_keys(ui);
  if (state_.view.show_timing) draw_timing(ui);
  state_.view.focus.clear();
  for (const Command& command : commands) perform(command);
  note_scene_shape();
}

/// The aspect ratio for placing cameras. The current frame's view was still drawn with the old one.
void Shell::note_scene_shape() {
  const auto scene = widgets_.find("view3d");
  if (scene == widgets_.end()) return;
  const auto& [min, max] = scene->second;
  state_.view.scene_aspect = static_cast<double>(max.x - min.x) / (max.y - min.y);
}

}  // namespace planescope::desktop
