// Actions for strokes, areas, cuts and the plane wand, in the image or in 3D. Previews are accepted
// or canceled.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/review.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/look.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

void preview(State& state, const LabelGesture& gesture) {
  const labels::SpaceSelection taken = selected_by(state, gesture);
  labels::LabelDraft draft(*state.labels());
  labels::paint(draft, state.label_frame()->grid, taken.pixels, paint_in_hand(state), gesture.mode);
  LabelView& view = state.view.label;
  view.stroke = std::make_shared<labels::LabelEdit>(draft.edit(state.document.frame, "Preview"));
  view.hover_hidden = taken.hidden;
}

void draw(State& state, const std::string& tool, const LabelGesture& gesture) {
  state.view.label.stroke.reset();
  paint_pixels(state, tool, selected_by(state, gesture).pixels, paint_in_hand(state), gesture.mode);
}

void stroke(State& state, LabelGesture gesture) {
  if (!gesture.radius_px) gesture.radius_px = static_cast<float>(state.view.label.brush_px);
  draw(state, "Brush", gesture);
}

void area(State& state, const LabelGesture& gesture) {
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

/// Cuts along the line from the first to the last position.
void cut(State& state, const LabelGesture& gesture) {
  const int plane = state.view.label.plane;
  if (plane == 0) throw Error("no plane is active; select one to cut");
  const labels::LabelGrid& grid = state.label_frame()->grid;
  if (gesture.where == DrawnIn::image) expect_image(state);
  const labels::Vec2f &from = gesture.path.front(), &to = gesture.path.back();
  const std::vector<float> sides =
      gesture.where == DrawnIn::image
          ? labels::sides_of_line(grid.width, grid.height, from, to)
          : sides_in_space(state, gesture.width, gesture.height, from, to);
  const std::string name = name_of_paint({.plane = plane});
  labels::LabelDraft draft(*state.labels());
  labels::split_by_side(draft, plane, sides);
  commit_and_say(state, "Cut " + name, draft, "all of " + name + " is on one side of the line");
}

/// Starts another polygon if the corner is in a different view from the previous ones.
void add_corner(State& state, const LabelGesture& gesture) {
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

labels::WandOptions options_of(const LabelView& view) {
  labels::WandOptions options = view.wand_options;
  if (view.paints == Paints::erase) options.take_labeled = true;
  if (view.bound) options.within = view.bound->within;
  return options;
}

void grow(State& state) {
  LabelView& view = state.view.label;
  WandPreview& wand = view.wand;
  wand.why_not.clear();
  std::optional<labels::WandResult> found = labels::grow_plane(
      state.label_frame()->grid, state.labels().get(), wand.seeds, options_of(view), &wand.why_not);
  wand.found = found ? std::make_shared<labels::WandResult>(std::move(*found)) : nullptr;
  if (wand.found) return;
  say_nothing_done(state, "no plane here: " + wand.why_not);
  state.view.message_is_error = true;
}

std::uint32_t seed_at(State& state, const char* action, const LabelGesture& where) {
  const std::int64_t pixel = pixel_of_gesture(state, action, where);
  if (pixel < 0) throw Error("no visible point here");
  return static_cast<std::uint32_t>(pixel);
}

void begin(State& state, const LabelGesture& where) {
  const std::uint32_t seed = seed_at(state, "label.wand", where);
  state.view.label.wand = {};
  state.view.label.wand.seeds = {seed};
  grow(state);
}

/// Adds a fragment to the previewed plane, or to the active one without a preview.
void add(State& state, const LabelGesture& where) {
  const std::uint32_t seed = seed_at(state, "label.wand.add", where);
  WandPreview& wand = state.view.label.wand;
  if (!wand.found) {
    wand = {};
    wand.onto_active = true;
  }
  wand.seeds.push_back(seed);
  grow(state);
  if (wand.found && wand.found->fragment_pixels.back() == 0) {
    wand.seeds.pop_back();
    say_nothing_done(state, "nothing here belongs to this plane");
  }
}

/// Limits the wand to a lasso and regrows an existing preview.
void bound_wand(State& state, const std::optional<LabelGesture>& lasso) {
  LabelView& view = state.view.label;
  view.bound = nullptr;
  if (lasso) {
    const LabelGesture& gesture = *lasso;
    auto bound = std::make_shared<WandBound>();
    bound->drawn = {
        .where = gesture.where,
        .corners = gesture.path,
        .view_size = {static_cast<float>(gesture.width), static_cast<float>(gesture.height)},
        .camera = camera_of(state)};
    bound->within.resize(state.label_frame()->grid.pixels(), 0);
    const labels::PixelSet pixels = selected_by(state, gesture).pixels;
    if (pixels.empty()) throw Error("no visible point inside the lasso");
    for (const std::uint32_t pixel : pixels) bound->within[pixel] = 1;
    view.bound = std::move(bound);
  }
  if (!view.wand.seeds.empty()) return grow(state);
  if (!view.bound) return say(state, "the wand is unrestricted");
  say_hint(state, "the wand stays inside the lasso until Esc",
           [](const State& s) { return !s.view.label.bound; });
}

/// Each click of the wand creates a plane, unless an empty plane is active or the first click held
/// Shift.
labels::Paint paint_of_wand(const State& state) {
  const LabelView& view = state.view.label;
  labels::Paint paint = paint_in_hand(state);
  paint.origin = LabelOrigin::wand;
  const bool joins = view.wand.onto_active;
  if (view.paints == Paints::plane && !joins && labels::find_plane(*state.labels(), paint.plane))
    paint.plane = labels::free_plane_id(*state.labels());
  return paint;
}

void accept_wand(State& state) {
  const std::shared_ptr<const labels::WandResult> found = state.view.label.wand.found;
  const labels::PaintMode mode =
      options_of(state.view.label).take_labeled ? labels::PaintMode::over : labels::PaintMode::add;
  paint_pixels(state, "Wand", found->pixels, paint_of_wand(state), mode);
  state.view.label.wand = {};
  state.view.label.bound = nullptr;
}

void close_polygon(State& state) {
  const OpenPolygon open = *state.view.label.polygon;
  if (open.corners.size() < 3) throw Error("a polygon needs at least three corners");
  if (open.where == DrawnIn::space && !same_camera(open.camera, camera_of(state)))
    throw Error("the view has moved since the polygon was started");
  const LabelGesture gesture{.where = open.where,
                             .width = static_cast<int>(open.view_size.x()),
                             .height = static_cast<int>(open.view_size.y()),
                             .mode = open.mode,
                             .radius_px = {},
                             .path = open.corners};
  area(state, gesture);
  state.view.label.polygon.reset();
}

void accept_finish(State& state) {
  const std::shared_ptr<const labels::LabelEdit> edit = state.view.label.finish;
  commit_labels(state, *edit);
  say(state, edit->title);
}

void accept(State& state) {
  LabelView& view = state.view.label;
  if (view.polygon) return close_polygon(state);
  if (view.wand.found) return accept_wand(state);
  if (view.finish) return accept_finish(state);
  if (view.tab == "review" && view.review_item >= 0) return decide(state, ReviewDecision::keep);
  say_nothing_done(state, "nothing to accept");
}

/// Cancels the latest unfinished gesture, one at a time.
void cancel(State& state) {
  LabelView& view = state.view.label;
  const bool begun =
      view.stroke || view.polygon || !view.wand.seeds.empty() || view.bound || view.finish;
  if (begun) return let_go(view);
  CarryJob& carry = state.results.label.carry;
  if (SpreadWork& spread = state.results.label.spread; spread.running) {
    spread = {};
    return say(state, "proposal canceled");
  }
  if (carry.running) say(state, "carrying canceled");
  if (carry.running || carry.done) {
    carry = {};
    return;
  }
  view.review_item = view.finding = -1;
  view.paints = Paints::plane;
}

}  // namespace

void set_wand_tolerance(State& state, double wanted_m) {
  constexpr double kLeast_m = 0.001, kLargest_m = 0.1;
  LabelView& view = state.view.label;
  view.wand_options.tolerance_m = std::clamp(wanted_m, kLeast_m, kLargest_m);
  if (!view.wand.seeds.empty() && labels_at_hand(state)) grow(state);
}

void add_label_draw_actions(std::vector<Action>& all) {
  const ActionGroup draws{all, KeyMode::labels, "Tools", labels_at_hand};
  const char* const of_brush = "VIEW [MODE] [RADIUS] X,Y X,Y ...";
  const char* const shape = "VIEW [MODE] X,Y X,Y ...";
  const char* const place = "U,V or space:WxH X,Y";
  draws.add("label.preview", "Preview a gesture").run(gesture(of_brush, 1), preview);
  draws.add("label.stroke", "Draw a stroke").run(gesture(of_brush, 1), stroke);
  draws.add("label.area", "Draw an area").run(gesture(shape, 3), area);
  draws.add("label.cut", "Cut the active plane").run(gesture(shape, 2), cut);
  draws.add("label.corner", "Add a corner to the polygon")
      .run(gesture("VIEW [MODE] X,Y", 1), add_corner);
  draws.add("label.corner.back", "Remove the polygon's last corner")
      .key("Backspace")
      .when([](const State& s) { return s.view.label.polygon.has_value(); })
      .run(take_corner_back);
  draws.add("label.wand", "Grow a plane from a pixel").run(place_in_view(place), begin);
  draws.add("label.wand.add", "Add a part to the previewed plane").run(place_in_view(place), add);
  draws.add("label.wand.within", "Restrict the wand to a lasso")
      .run(or_none(gesture("VIEW X,Y X,Y ... or none", 3)), bound_wand);
  draws.add("label.wand.tolerance", "Tolerance of the wand")
      .when(nullptr)
      .run(number("METERS"), set_wand_tolerance);
  draws.add("label.accept", "Accept the preview; in the review, keep").key("Enter").run(accept);
  draws.add("label.cancel", "Cancel the preview").key("Escape").when(nullptr).run([](State& s) {
    s.view.click = Click::selects;
    cancel(s);
  });
}

}  // namespace planescope::desktop
