#include "app/desktop/debugger/context.hpp"

#include <fmt/format.h>

#include "app/desktop/debugger/plane_text.hpp"
#include "app/desktop/look.hpp"

namespace planescope::desktop {
namespace {

using Kind = render::Picked::Kind;
using Commands = std::vector<Command>;

std::string pixel_text(const State& state, std::int64_t source) {
  const int width = state.run()->subject->frame.depth.width;
  return fmt::format("{},{}", source % width, source / width);
}

std::string key_of(const char* action) { return first_key(find_action(action)); }

/// A thing that is selected first, and then what is done with it.
struct Menu {
  const State& state;
  Command select;
  std::vector<ContextEntry> entries = {};

  void add(const std::string& name, const std::string& title, Commands commands) {
    entries.push_back({name, title, "", std::move(commands)});
  }
  /// An action on what is selected.
  void act(const std::string& name, const std::string& title, const char* action) {
    entries.push_back({name, title, key_of(action), {select, {action, ""}}});
  }
  void add_common(const std::string& click, const std::string& copied) {
    Commands isolate = {select};
    if (!state.view.isolated) isolate.push_back({"isolate", ""});
    entries.push_back({"isolate", "Isolate", key_of("isolate"), std::move(isolate)});
    act("frame", "Frame it", "camera.selected");
    if (!click.empty()) {
      const bool plane = click.starts_with("plane");
      Commands measure;
      if (state.view.click != (plane ? Click::plane : Click::point))
        measure.push_back({plane ? "measure.planes" : "measure.points", ""});
      measure.push_back({"measure.end", click});
      add("measure", state.view.measured.size() == 1 ? "Measure to here" : "Measure from here",
          std::move(measure));
      add("floor", "Set gravity: this is a floor", {{"gravity.floor", click}});
      add("wall", "Set gravity: this is a wall", {{"gravity.wall", click}});
    }
    act("bookmark", "Bookmark this view", "bookmark.add");
    add("copy", "Copy \"" + copied + "\"", {{"copy", copied}});
  }
};

std::vector<ContextEntry> point_entries(const State& state, const PointedAt& at) {
  const debug::Run& run = *state.run();
  const std::string voxel = std::to_string(at.what.index);
  Menu menu{state, at.source >= 0 ? Command{"select.pixel", pixel_text(state, at.source)}
                                  : Command{"select.voxel", voxel}};
  const std::int32_t plane = run.timeline.point_at(at.what.index, state.view.step).plane;
  const std::int32_t node = run.timeline.node_of_point(at.what.index, state.view.step);
  menu.add("select", "Select point", {menu.select});
  menu.act("why",
           plane < 0 ? "Why is it unassigned?" : "Why is it in " + debug::plane_name(run, plane),
           "point.life");
  const std::int32_t other = state.view.selected.voxel;
  if (run.is_ours() && run.segmentation.plane_of[at.what.index] > 0) {
    menu.add("own", "Should be a separate plane", {menu.select, {"fix.point", "own"}});
    menu.add("none", "Should not be a plane", {menu.select, {"fix.point", "none"}});
  }
  if (run.is_ours() && other >= 0 && other != at.what.index &&
      debug::step_of_meeting(run, other, at.what.index) > 0)
    menu.add("met", "Where was it merged with the selected point?", {{"join.show", voxel}});
  else if (run.is_ours() && other >= 0 && other != at.what.index)
    menu.add("joined", "Should be one plane with the selected point",
             {menu.select, {"fix.point", fmt::format("with {}", other)}});
  if (plane >= 0)
    menu.add("plane", "Select " + debug::plane_name(run, plane),
             {{"select.plane", debug::plane_name(run, plane)}});
  if (node >= 0)
    menu.add("node", fmt::format("Select node {}", node), {{"select.node", std::to_string(node)}});
  menu.act("break", "Break on this point", "break.point");
  menu.add_common(at.source >= 0 ? pixel_text(state, at.source) : "voxel " + voxel,
                  "voxel " + voxel);
  return menu.entries;
}

std::vector<ContextEntry> plane_entries(const State& state, std::int32_t plane) {
  const std::string name = debug::plane_name(*state.run(), plane);
  Menu menu{state, {"select.plane", name}};
  menu.add("select", "Select plane", {menu.select, {"tab.inspector", "inspector"}});
  menu.add_common("plane " + name, name);
  return menu.entries;
}

std::vector<ContextEntry> node_entries(const State& state, std::int32_t node) {
  Menu menu{state, {"select.node", std::to_string(node)}};
  menu.add("select", "Select node", {menu.select, {"tab.inspector", "inspector"}});
  menu.act("decision", "Go to its decision", "step.decision");
  menu.act("break", "Break on its decision", "break.node");
  menu.add_common("", fmt::format("node {}", node));
  return menu.entries;
}

std::vector<ContextEntry> empty_entries(const State& state, std::int64_t source) {
  std::vector<ContextEntry> entries;
  const auto act = [&](const char* name, const char* action) {
    entries.push_back({name, find_action(action).title, key_of(action), {{action, ""}}});
  };
  if (source >= 0) {
    const std::string pixel = pixel_text(state, source);
    entries.push_back({"why", "Why is nothing here?", "", {{"why.pixel", pixel}}});
    entries.push_back({"copy", "Copy \"" + pixel + "\"", "", {{"copy", pixel}}});
  }
  act("home", "camera.home");
  if (!state.view.cameras.before.empty()) act("undo", "camera.undo");
  act("isolate", "isolate");
  return entries;
}

}  // namespace

std::string context_title(const State& state, const PointedAt& at) {
  std::string text = "nothing";
  if (at.what.kind == Kind::voxel) text = describe_voxel(state, at.what.index);
  if (at.what.kind == Kind::plane) text = describe_plane(state, at.what.index);
  if (at.what.kind == Kind::node) text = describe_node(state, at.what.index);
  if (at.what.kind == Kind::nothing && at.source >= 0)
    text = "nothing at pixel " + pixel_text(state, at.source);
  return text.substr(0, text.find('\n'));
}

std::vector<ContextEntry> context_entries(const State& state, const PointedAt& at) {
  switch (at.what.kind) {
    case Kind::voxel:
      return point_entries(state, at);
    case Kind::plane:
      return plane_entries(state, at.what.index);
    case Kind::node:
      return node_entries(state, at.what.index);
    default:
      return empty_entries(state, at.source);
  }
}

}  // namespace planescope::desktop
