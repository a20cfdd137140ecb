#include "app/desktop/look.hpp"

namespace planescope::desktop {

render::StepLook look_of(const State& state) {
  const ViewState& view = state.view;
  render::StepLook look;
  look.step = view.step;
  look.color_by = view.color_by;
  look.show_queue = view.show_queue;
  look.show_settled = view.show_settled;
  look.show_planes = view.show_planes;
  look.node = view.selected.node;
  look.plane = view.selected.plane;
  look.voxel = view.selected.voxel;
  look.marked = state.document.marked;
  look.theme = view.theme;
  if (const planes::TraceEvent* event = state.event()) {
    const bool on_point = event->point >= 0 && event->point == look.voxel;
    if (event->node == look.node || on_point) look.node = -1;
    if (event->plane == look.plane) look.plane = -1;
    if (on_point) look.voxel = -1;
  }
  return look;
}

}  // namespace planescope::desktop
