// The plane wand; accepting and leaving what is shown but is no label yet.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/actions/arguments.hpp"
#include "app/desktop/camera.hpp"
#include "app/desktop/labeling/label_gesture.hpp"
#include "app/desktop/labeling/label_painting.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

constexpr double kLeastTolerance_m = 0.001, kLargestTolerance_m = 0.1;

labels::WandOptions options_of(const LabelView& view) {
  labels::WandOptions options = view.wand_options;
  if (view.paints == Paints::erase) options.take_labelled = true;
  return options;
}

void grow(State& state) {
  LabelView& view = state.view.label;
  WandPreview& wand = view.wand;
  wand.why_not.clear();
  std::optional<labels::WandResult> found = labels::grow_plane(
      state.label_frame()->grid, state.labels().get(), wand.seeds, options_of(view), &wand.why_not);
  wand.found = found ? std::make_shared<labels::WandResult>(std::move(*found)) : nullptr;
  if (!wand.found) say(state, "no plane there: " + wand.why_not, true);
}

std::uint32_t seed_argument(State& state, const std::string& action, const std::string& text) {
  const std::int64_t pixel = pixel_argument(state, action, text);
  if (pixel < 0) throw Error("no point is seen there");
  return static_cast<std::uint32_t>(pixel);
}

void begin(State& state, const std::string& text) {
  const std::uint32_t seed = seed_argument(state, "label.wand", text);
  state.view.label.wand = {};
  state.view.label.wand.seeds = {seed};
  grow(state);
}

/// A fragment of what is shown; where nothing is, of the active plane.
void add(State& state, const std::string& text) {
  const std::uint32_t seed = seed_argument(state, "label.wand.add", text);
  WandPreview& wand = state.view.label.wand;
  if (!wand.found) {
    wand = {};
    wand.onto_active = true;
  }
  wand.seeds.push_back(seed);
  grow(state);
  if (wand.found && wand.found->fragment_pixels.back() == 0) {
    wand.seeds.pop_back();
    say(state, "nothing there is part of this plane");
  }
}

void set_tolerance(State& state, const std::string& text) {
  const double wanted = number_argument("label.wand.tolerance", text);
  LabelView& view = state.view.label;
  view.wand_options.tolerance_m = std::clamp(wanted, kLeastTolerance_m, kLargestTolerance_m);
  if (!view.wand.seeds.empty() && labels_at_hand(state)) grow(state);
}

/// The wand makes a plane at each click, unless one was chosen that has no pixels yet, or the first
/// click held Shift.
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
      options_of(state.view.label).take_labelled ? labels::PaintMode::over : labels::PaintMode::add;
  paint_pixels(state, "Wand", found->pixels, paint_of_wand(state), mode);
  state.view.label.wand = {};
}

void close_polygon(State& state) {
  const OpenPolygon open = *state.view.label.polygon;
  if (open.corners.size() < 3) throw Error("a polygon has three corners or more");
  if (open.where == DrawnIn::space && !same_camera(open.camera, camera_of(state)))
    throw Error("the view has moved since the polygon was begun");
  const LabelGesture gesture{.where = open.where,
                             .width = static_cast<int>(open.view_size.x()),
                             .height = static_cast<int>(open.view_size.y()),
                             .mode = open.mode,
                             .radius_px = {},
                             .path = open.corners};
  apply(state, {"label.area", gesture_text(gesture)});
  state.view.label.polygon.reset();
}

void accept(State& state) {
  LabelView& view = state.view.label;
  if (view.polygon) return close_polygon(state);
  if (view.wand.found) return accept_wand(state);
  if (view.tab == "review" && view.review_item >= 0) return apply(state, {"review.keep", ""});
  say(state, "there is nothing to accept");
}

/// Cancels what was begun last, one thing at a time.
void cancel(State& state) {
  LabelView& view = state.view.label;
  if (view.stroke || view.polygon || !view.wand.seeds.empty()) return let_go(view);
  CarryJob& carry = state.results.label.carry;
  if (carry.running) say(state, "nothing was carried");
  if (carry.running || carry.done) {
    carry = {};
    return;
  }
  view.review_item = view.finding = -1;
  view.paints = Paints::plane;
}

}  // namespace

std::vector<Action> label_wand_actions() {
  return {
      {"label.wand",
       "Grow a plane from a pixel",
       "",
       "",
       "U,V or space:WxH X,Y",
       begin,
       labels_at_hand,
       {}},
      {"label.wand.add",
       "Add a fragment to the plane that is shown",
       "",
       "",
       "U,V or space:WxH X,Y",
       add,
       labels_at_hand,
       {}},
      {"label.wand.tolerance", "Tolerance of the wand", "", "", "METRES", set_tolerance, {}, {}},
      {"label.accept",
       "Accept what is shown; in the review, keep",
       "Tools",
       "Enter",
       "",
       [](State& s, const std::string&) { accept(s); },
       labels_at_hand,
       {}},
      {"label.cancel",
       "Leave what is shown",
       "Tools",
       "Escape",
       "",
       [](State& s, const std::string&) {
         s.view.gravity_click = GravityClick::none;
         cancel(s);
       },
       {},
       {}},
  };
}

}  // namespace planescope::desktop
