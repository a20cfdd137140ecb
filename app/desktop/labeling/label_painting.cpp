#include "app/desktop/labeling/label_painting.hpp"

#include <fmt/format.h>

#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

bool is_plane(const labels::Paint& paint) { return paint.plane > 0 && paint.plane != kPlaneIgnore; }

bool takes_off(const labels::Paint& paint, labels::PaintMode mode) {
  return mode == labels::PaintMode::subtract || (paint.plane == 0 && paint.label == Label::unknown);
}

}  // namespace

std::string name_of_paint(const labels::Paint& paint) {
  if (paint.plane == kPlaneIgnore) return "ignore";
  if (paint.plane > 0) return fmt::format("P{}", paint.plane);
  return to_string(paint.label, "nothing");
}

labels::Paint paint_in_hand(const State& state) {
  const LabelView& view = state.view.label;
  switch (view.paints) {
    case Paints::plane:
      return {.plane = view.plane > 0 ? view.plane : labels::free_plane_id(*state.labels())};
    case Paints::ignore:
      return {.plane = kPlaneIgnore};
    case Paints::erase:
      return {};
    case Paints::h_only:
      return {.label = Label::h};
    case Paints::v_only:
      return {.label = Label::v};
  }
  return {};
}

StrokePreview preview_of(const State& state, labels::SpaceSelection taken, labels::PaintMode mode) {
  const labels::Paint paint = paint_in_hand(state);
  return {.pixels = labels::changed_by_painting(*state.labels(), state.label_frame()->grid,
                                                taken.pixels, paint, mode),
          .hidden = taken.hidden,
          .takes = takes_off(paint, mode)};
}

void paint_pixels(State& state,
                  const std::string& tool,
                  std::span<const std::uint32_t> pixels,
                  const labels::Paint& paint,
                  labels::PaintMode mode) {
  const FrameLabels& labels = *state.labels();
  const labels::LabelGrid& grid = state.label_frame()->grid;
  const LabelPlane* plane = is_plane(paint) ? labels::find_plane(labels, paint.plane) : nullptr;
  if (plane && plane->locked) throw Error(fmt::format("P{} is locked", plane->id));
  if (is_plane(paint) && !plane && mode == labels::PaintMode::subtract)
    throw Error(fmt::format("P{} has no pixels yet that could be taken off", paint.plane));
  const std::size_t changed = labels::changed_by_painting(labels, grid, pixels, paint, mode).size();
  if (changed == 0) return say(state, "nothing to change there");
  const std::string title = fmt::format(
      "{} {}{}", tool, mode == labels::PaintMode::subtract ? "off " : "", name_of_paint(paint));
  commit_labels(state, title, labels::painted(labels, grid, pixels, paint, mode));
  if (is_plane(paint)) state.view.label.plane = paint.plane;
  say(state, fmt::format("{}: {} pixels", title, changed));
}

}  // namespace planescope::desktop
