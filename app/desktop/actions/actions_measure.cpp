// Measuring between points and planes that are clicked.

#include <fmt/format.h>

#include "app/desktop/actions/actions.hpp"
#include "core/debug/explain/measure.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

/// The point that was clicked, or the plane that it is on.
debug::MeasureEnd end_at(const State& state, const std::string& text) {
  const debug::Run& run = *state.run();
  const Clicked clicked = click_argument(state, "measure.end", text);
  const std::int32_t step = state.view.step;
  if (clicked.on == Clicked::On::plane) return debug::measured_plane(run, clicked.index, step);
  const bool is_pixel = clicked.on == Clicked::On::pixel;
  const debug::MeasureEnd point =
      is_pixel ? debug::measured_point(*run.subject, static_cast<std::size_t>(clicked.index))
               : debug::measured_voxel(*run.subject, static_cast<std::uint32_t>(clicked.index));
  if (state.view.click != Click::plane) return point;
  const std::uint32_t voxel =
      is_pixel ? run.subject->voxel_of_source(static_cast<std::size_t>(clicked.index))
               : static_cast<std::uint32_t>(clicked.index);
  if (voxel == planes::kNoVoxel) throw Error("no plane there, it is out of range");
  const std::int32_t plane = run.timeline.point_at(static_cast<std::int32_t>(voxel), step).plane;
  return debug::measured_plane(run, plane, step, &point);
}

/// A click that hits nothing changes nothing and says so. A third end begins anew.
void add_end(State& state, const std::string& text) {
  std::vector<debug::MeasureEnd>& ends = state.view.measured;
  try {
    debug::MeasureEnd end = end_at(state, text);
    if (ends.size() == 1 && end.normal && end.name == ends[0].name && end.normal == ends[0].normal)
      throw Error(end.name + " was clicked before");
    if (ends.size() >= 2) ends.clear();
    ends.push_back(std::move(end));
  } catch (const Error& error) {
    return say(state, fmt::format("nothing to measure: {}", error.what()), true);
  }
  if (ends.size() < 2)
    return say_hint(state, "click the other end",
                    [](const State& s) { return s.view.measured.size() != 1; });
  say(state, debug::measure(*state.run()->subject, ends[0], ends[1]).text);
}

Action click_switch(const char* name, const char* title, const char* key, Click what) {
  return {name,
          title,
          "Measure",
          key,
          "",
          [what](State& s, const std::string&) {
            s.view.click = s.view.click == what ? Click::selects : what;
            s.view.marking = false;
          },
          has_run,
          [what](const State& s) { return s.view.click == what; }};
}

}  // namespace

std::vector<Action> measure_actions() {
  return {click_switch("measure.points", "Measure between points", "U", Click::point),
          click_switch("measure.planes", "Measure between planes", "Shift+U", Click::plane),
          {"measure.end", "Measure from or to here", "", "", kClickTakes, add_end, has_run, {}}};
}

}  // namespace planescope::desktop
