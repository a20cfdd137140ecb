#pragma once

// The image view and the scene view, shared by the debugger and label mode: their layout on screen
// and mouse handling.

#include <functional>
#include <optional>
#include <string>

#include "app/desktop/ui.hpp"
#include "render/draw_list.hpp"

namespace planescope::desktop {

// ---- Layout of both views ----------------------------------------------------------------------

struct Rect {
  float x = 0, y = 0, w = 0, h = 0;
};

struct Arrangement {
  std::optional<Rect> scene = {}, image = {};
  std::optional<Rect> between = {};  // the splitter, if both are shown
  bool beside = false;               // side by side; otherwise the scene is above the image
};

/// `picture` is the aspect ratio of the image, or 0 without one, when the scene fills the room. The
/// views are placed side by side or one above the other, whichever makes them larger. The image
/// takes at most `share` of the room and no more than its picture fills. `bar` is the height of
/// each view's toolbar, `grip` the width of the splitter.
Arrangement arrange(
    const Rect& room, double picture, Views shown, double share, float bar, float grip);

/// Aspect ratio of the frame's image; 0 without one, 4:3 while unknown.
double picture_shape(const State& state);
/// Whether both views or only the image are shown.
bool shows_image(const State& state);

// ---- Image view --------------------------------------------------------------------------------

/// Position of the image on screen.
struct ImagePlacement {
  ImVec2 area_min, area_max;  // area to which the image is clipped
  ImVec2 origin;              // upper left corner of the image
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

/// Controls for the backdrop, for showing the whole image, and for the overlay's opacity, whose
/// tooltip is `of_opacity`.
void draw_image_tools(const Ui& ui, const char* of_opacity);

/// Draws an image of width x height pixels in the remaining room, as an item named "image" that
/// receives all three mouse buttons. nullopt if there is no room. `picture` is only called with GL.
std::optional<ImagePlacement> draw_image_room(const Ui& ui,
                                              int width,
                                              int height,
                                              const std::function<TextureId(Canvas&)>& picture,
                                              const std::function<TextureId(Canvas&)>& beside = {});
/// Zooms the last drawn item with the wheel, around the mouse.
void zoom_image(const Ui& ui, const ImagePlacement& placed);
/// Pans the last drawn item while a mouse button holds it.
void drag_image(const Ui& ui, const ImagePlacement& placed);

// ---- Scene view --------------------------------------------------------------------------------

struct ScenePlacement {
  ImVec2 min, max;
  int width = 0, height = 0;  // [px]
};

/// The same for the scene; the item is named "view3d".
std::optional<ScenePlacement> draw_scene_room(
    const Ui& ui,
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>& picture,
    const std::function<TextureId(Canvas&, const render::Camera&, int width, int height)>& beside =
        {});
/// Zooms the last drawn item with the wheel.
void zoom_scene(const Ui& ui);
/// Applies the mouse motion of this frame in a view of this height [px].
void orbit_scene(const Ui& ui, int height);
void pan_scene(const Ui& ui, int height);

// ---- A and B -----------------------------------------------------------------------------------

/// Whether the mouse is on the side of the main run rather than on that of the other run.
bool mouse_is_here(const Ui& ui, ImVec2 min, ImVec2 max);
/// Labels the runs in a view; draws nothing without A.
void draw_sides(const Ui& ui, const char* view, ImVec2 min, ImVec2 max);

// ---- Color scales -------------------------------------------------------------------------------

/// Draws a scale's bar with ticks in the upper right corner of a view.
void draw_scale_bar(const Ui& ui, const render::ColorScale& scale, ImVec2 min, ImVec2 max);
/// Draws the scale of the debugger's colors, or why there is none. Draws nothing for colors without
/// a scale.
void draw_color_scale(const Ui& ui, ImVec2 min, ImVec2 max);

// ---- Context menu ------------------------------------------------------------------------------

/// Returns the depth pixel without a measurement whose ray passes through a screen position [px
/// from the top left], assuming the depth of the nearest visible point. nullopt for clouds, and if
/// the pixel has a point.
std::optional<std::size_t> pixel_of_nothing(const debug::Subject& subject,
                                            const render::View& view,
                                            const Vec2d& at);
struct ContextEntry {
  std::string name;  // of its widget: "context.<name>"
  std::string title;
  std::string key = {};  // of the action, for entries with a single one
  std::vector<Command> commands;
};

/// One line that identifies the item.
std::string context_title(const State& state, const PointedAt& at);
std::vector<ContextEntry> context_entries(const State& state, const PointedAt& at);
/// Opens and draws the context menu of a right-clicked item in the last drawn view.
void draw_context_menu(const Ui& ui, const std::optional<PointedAt>& clicked);

// ---- Empty views -------------------------------------------------------------------------------

/// Explains why no frame is shown.
void draw_absence(const Ui& ui);
/// Explains why no labels are shown.
void draw_label_absence(const Ui& ui);

}  // namespace planescope::desktop
