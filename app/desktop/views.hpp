#pragma once

// What the views of the debugger and of the label mode share: the camera's image and the scene in
// space, as they lie on screen and follow the mouse.

#include <functional>
#include <optional>
#include <string>

#include "app/desktop/ui.hpp"
#include "render/draw_list.hpp"

namespace planescope::desktop {

// ---- How they share their room -----------------------------------------------------------------

struct Rect {
  float x = 0, y = 0, w = 0, h = 0;
};

struct Arrangement {
  std::optional<Rect> scene = {}, image = {};
  std::optional<Rect> between = {};  // the splitter, where there are both
  bool beside = false;               // or the scene above the image
};

/// `picture`: width of the image by its height, 0 where there is none: then the scene has it all.
/// Both stand side by side or one above the other, whichever shows them larger; the image has at
/// most `share` of the room and no more than its picture fills. `bar`: height of the tools above
/// each; `grip`: width of the splitter.
Arrangement arrange(
    const Rect& room, double picture, Views shown, double share, float bar, float grip);

/// Width of the frame's image by its height; 0 where it has none, 4:3 while nobody knows.
double picture_shape(const State& state);
/// Both views, or the image alone.
bool shows_image(const State& state);

// ---- The camera's image ------------------------------------------------------------------------

/// Where the image lies on screen.
struct ImagePlacement {
  ImVec2 area_min, area_max;  // of the room that it is cut off at
  ImVec2 origin;              // of the image's upper left corner
  float scale = 1;            // screen pixels per image pixel
  int width = 0, height = 0;  // [image pixels]

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

/// What is behind the image, all of it, how strongly it is covered (`of_opacity` says by what).
void draw_image_tools(const Ui& ui, const char* of_opacity);

/// An image of width x height pixels in the room that is left: an item that takes all three mouse
/// buttons, named "image". Nothing where there is no room. `picture` is not asked without GL.
std::optional<ImagePlacement> draw_image_room(const Ui& ui,
                                              int width,
                                              int height,
                                              const std::function<TextureId(Canvas&)>& picture,
                                              const std::function<TextureId(Canvas&)>& beside = {});
/// By the wheel, about the mouse. Of the item drawn last, like the next.
void zoom_image(const Ui& ui, const ImagePlacement& placed);
/// With the mouse, while a button holds the item.
void drag_image(const Ui& ui, const ImagePlacement& placed);

// ---- The scene in space ------------------------------------------------------------------------

struct ScenePlacement {
  ImVec2 min, max;
  int width = 0, height = 0;  // [px]
};

/// The same for the scene: the item is named "view3d".
std::optional<ScenePlacement> draw_scene_room(
    const Ui& ui,
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>& picture,
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>& beside =
        {});
/// By the wheel. Of the item drawn last.
void zoom_scene(const Ui& ui);
/// As far as the mouse has moved in this frame, in a view of that height [px].
void orbit_scene(const Ui& ui, int height);
void pan_scene(const Ui& ui, int height);

// ---- A and B -----------------------------------------------------------------------------------

/// Whether the mouse is on the side of the run that is looked at, not on the other one's.
bool mouse_is_here(const Ui& ui, ImVec2 min, ImVec2 max);
/// Says over a view which run it shows; nothing where there is no A to tell apart.
void draw_sides(const Ui& ui, const char* view, ImVec2 min, ImVec2 max);

// ---- What colours mean --------------------------------------------------------------------------

/// A scale's bar with its ticks, in the upper right corner of a view.
void draw_scale_bar(const Ui& ui, const render::ColorScale& scale, ImVec2 min, ImVec2 max);
/// That of the debugger's colours, or why they tell nothing; nothing where they are along no scale.
void draw_color_scale(const Ui& ui, ImVec2 min, ImVec2 max);

// ---- What is clicked ---------------------------------------------------------------------------

/// The depth pixel that looks to where nothing is seen at a place on screen [px from the top left]:
/// at the depth of what is seen nearest to it. Nothing for clouds, and where it has a point.
std::optional<std::size_t> pixel_of_nothing(const debug::Subject& subject,
                                            const render::View& view,
                                            const Vec2d& at);
struct ContextEntry {
  std::string name;  // of its widget: "context.<name>"
  std::string title;
  std::string key = {};  // of the action, where it is one alone
  std::vector<Command> commands;
};

/// What it is, in a line.
std::string context_title(const State& state, const PointedAt& at);
std::vector<ContextEntry> context_entries(const State& state, const PointedAt& at);
/// Opens the menu of what was clicked with the right button, over the item drawn last, and draws
/// it.
void draw_context_menu(const Ui& ui, const std::optional<PointedAt>& clicked);

// ---- Where there is nothing to show ------------------------------------------------------------

/// Why no frame is shown.
void draw_absence(const Ui& ui);
/// Why no labels are.
void draw_label_absence(const Ui& ui);

}  // namespace planescope::desktop
