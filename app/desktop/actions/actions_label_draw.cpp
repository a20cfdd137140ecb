// Strokes, areas and cuts: each a gesture in text, on the image or in space.

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/camera.hpp"
#include "app/desktop/labeling/label_gesture.hpp"
#include "app/desktop/labeling/label_painting.hpp"
#include "app/desktop/labeling/label_sight.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

constexpr const char* kTakes = "VIEW [MODE] X,Y X,Y ...";

void preview(State& state, const std::string& text) {
  const LabelGesture gesture = gesture_argument("label.preview", text, 1);
  state.view.label.stroke = preview_of(state, selected_by(state, gesture), gesture.mode);
}

void draw(State& state, const std::string& tool, const LabelGesture& gesture) {
  state.view.label.stroke.reset();
  paint_pixels(state, tool, selected_by(state, gesture).pixels, paint_in_hand(state), gesture.mode);
}

void stroke(State& state, const std::string& text) {
  LabelGesture gesture = gesture_argument("label.stroke", text, 1);
  if (!gesture.radius_px) gesture.radius_px = static_cast<float>(state.view.label.brush_px);
  draw(state, "Brush", gesture);
}

void area(State& state, const std::string& text) {
  const LabelGesture gesture = gesture_argument("label.area", text, 3);
  if (gesture.radius_px) throw Error("action label.area: an area has no radius");
  switch (state.view.label.tool) {
    case LabelTool::rectangle:
      return draw(state, "Rectangle", gesture);
    case LabelTool::lasso:
      return draw(state, "Lasso", gesture);
    default:
      return draw(state, "Polygon", gesture);
  }
}

/// The line from the first place to the last one.
void cut(State& state, const std::string& text) {
  const LabelGesture gesture = gesture_argument("label.cut", text, 2);
  const int plane = state.view.label.plane;
  if (plane == 0) throw Error("there is no active plane to cut: choose one first");
  const labels::LabelGrid& grid = state.label_frame()->grid;
  const labels::Vec2f &from = gesture.path.front(), &to = gesture.path.back();
  const std::vector<float> sides =
      gesture.where == DrawnIn::image
          ? labels::sides_of_line(grid.width, grid.height, from, to)
          : sides_in_space(state, gesture.width, gesture.height, from, to);
  const FrameLabels& labels = *state.labels();
  const FrameLabels after = labels::split_by_side(labels, grid, plane, sides);
  const std::string name = name_of_paint({.plane = plane});
  if (after.planes.size() == labels.planes.size())
    return say(state, "all of " + name + " lies on one side of the line");
  commit_labels(state, "Cut " + name, after);
  say(state, "Cut " + name);
}

/// Another one where it is in another view than those before.
void add_corner(State& state, const std::string& text) {
  const LabelGesture gesture = gesture_argument("label.corner", text, 1);
  const labels::Vec2f size(static_cast<float>(gesture.width), static_cast<float>(gesture.height));
  const render::Camera camera = camera_of(state);
  std::optional<OpenPolygon>& open = state.view.label.polygon;
  const bool goes_on = open && open->where == gesture.where && open->view_size == size &&
                       (gesture.where == DrawnIn::image || same_camera(open->camera, camera));
  if (!goes_on)
    open = OpenPolygon{.where = gesture.where,
                       .mode = gesture.mode,
                       .corners = {},
                       .view_size = size,
                       .camera = camera};
  if (open->corners.empty() || open->corners.back() != gesture.path.front())
    open->corners.push_back(gesture.path.front());
}

void take_corner_back(State& state) {
  std::optional<OpenPolygon>& open = state.view.label.polygon;
  open->corners.pop_back();
  if (open->corners.empty()) open.reset();
}

}  // namespace

std::vector<Action> label_draw_actions() {
  return {
      {"label.preview",
       "Show what a gesture would change",
       "",
       "",
       "VIEW [MODE] [RADIUS] X,Y X,Y ...",
       preview,
       labels_at_hand,
       {}},
      {"label.stroke",
       "Draw a stroke",
       "",
       "",
       "VIEW [MODE] [RADIUS] X,Y X,Y ...",
       stroke,
       labels_at_hand,
       {}},
      {"label.area", "Draw an area", "", "", kTakes, area, labels_at_hand, {}},
      {"label.cut", "Cut the active plane", "", "", kTakes, cut, labels_at_hand, {}},
      {"label.corner",
       "Add a corner to the polygon",
       "",
       "",
       "VIEW [MODE] X,Y",
       add_corner,
       labels_at_hand,
       {}},
      {"label.corner.back",
       "Take the polygon's last corner back",
       "Tools",
       "Backspace",
       "",
       [](State& s, const std::string&) { take_corner_back(s); },
       [](const State& s) { return s.view.label.polygon.has_value(); },
       {}},
  };
}

}  // namespace planescope::desktop
