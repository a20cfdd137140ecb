#include "app/desktop/labeling/label_look.hpp"

namespace planescope::desktop {
namespace {

template <typename T>
const T* item(const std::vector<T>& items, int index) {
  return index >= 0 && index < static_cast<int>(items.size())
             ? &items[static_cast<std::size_t>(index)]
             : nullptr;
}

/// What the tab that is open asks about.
std::span<const std::uint32_t> marked_pixels(const State& state) {
  const LabelView& view = state.view.label;
  const LabelResults& results = state.results.label;
  if (view.tab == "review" && results.review)
    if (const labels::Disagreement* about = item(results.review->items, view.review_item))
      return about->pixels;
  if (view.tab == "checks" && results.audit)
    if (const labels::Finding* about = item(results.audit->findings, view.finding))
      return about->pixels;
  return {};
}

}  // namespace

render::LabelLook label_look_of(const State& state) {
  const LabelView& view = state.view.label;
  render::LabelLook look;
  look.labels = state.labels();
  look.plane = view.plane;
  look.show_class = view.show_class;
  if (view.stroke) {
    look.preview = view.stroke->pixels;
    look.preview_takes = view.stroke->takes;
  } else if (view.wand.found) {
    look.preview = view.wand.found->pixels;
    look.preview_takes = view.paints == Paints::erase;
  }
  if (state.results.label.carry.done) look.doubt = state.results.label.carry.done->doubt;
  look.marked = marked_pixels(state);
  look.theme = state.view.theme;
  return look;
}

}  // namespace planescope::desktop
