// Context menu of right-clicked items.

#include <fmt/format.h>

#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

using Kind = render::Picked::Kind;
using Commands = std::vector<Command>;

Pixel pixel_at(const State& state, std::int64_t source) {
  return pixel_of(source, state.run()->subject->frame.depth.width);
}
std::string pixel_text(const Pixel& at) { return fmt::format("{},{}", at.u, at.v); }

std::string key_of(const char* action) { return first_key(find_action(action)); }

/// Entries that select the item first and then run an action.
struct Menu {
  const State& state;
  Command select;
  std::vector<ContextEntry> entries = {};

  void add(const std::string& name, const std::string& title, Commands commands) {
    entries.push_back({name, title, "", std::move(commands)});
  }
  /// Adds an action on the selected item.
  void act(const std::string& name, const std::string& title, const char* action) {
    entries.push_back({name, title, key_of(action), {select, {action}}});
  }
  /// `click` is the result of a click on the item; nothing: it cannot be measured.
  void add_common(const Clicked& click, const std::string& copied) {
    Commands isolate = {select};
    if (!state.view.isolated) isolate.push_back({"isolate"});
    entries.push_back({"isolate", "Isolate", key_of("isolate"), std::move(isolate)});
    act("frame", "Frame it", "camera.selected");
    if (click.on != Clicked::On::nothing) {
      const bool plane = click.on == Clicked::On::plane;
      Commands measure;
      if (state.view.click != (plane ? Click::plane : Click::point))
        measure.push_back({plane ? "measure.planes" : "measure.points"});
      measure.push_back(command("measure.end", click));
      add("measure", state.view.measured.size() == 1 ? "Measure to here" : "Measure from here",
          std::move(measure));
      add("floor", "Set gravity: this is a floor", {command("gravity.floor", click)});
      add("wall", "Set gravity: this is a wall", {command("gravity.wall", click)});
    }
    act("bookmark", "Bookmark this view", "bookmark.add");
    add("copy", "Copy \"" + copied + "\"", {command("copy", copied)});
  }
};

std::vector<ContextEntry> point_entries(const State& state, const PointedAt& at) {
  const debug::Run& run = *state.run();
  const Clicked voxel{Clicked::On::voxel, {}, at.what.index};
  Menu menu{state, at.source >= 0 ? command("select.pixel", pixel_at(state, at.source))
                                  : command("select.voxel", at.what.index)};
  const std::int32_t plane = run.timeline.point_at(at.what.index, state.view.step).plane;
  const std::int32_t node = run.timeline.node_of_point(at.what.index, state.view.step);
  menu.add("select", "Select point", {menu.select});
  menu.act("why",
           plane < 0 ? "Why is it unassigned?" : "Why is it in " + debug::plane_name(run, plane),
           "point.life");
  const std::int32_t other = state.view.selected.voxel;
  if (run.is_ours() && run.segmentation.plane_of[at.what.index] > 0) {
    menu.add("own", "Should be a separate plane",
             {menu.select, command("fix.point", PointWish{debug::Wish::own_plane})});
    menu.add("none", "Should not be a plane",
             {menu.select, command("fix.point", PointWish{debug::Wish::no_plane})});
  }
  if (run.is_ours() && other >= 0 && other != at.what.index &&
      debug::step_of_meeting(run, other, at.what.index) > 0)
    menu.add("met", "Where was it merged with the selected point?", {command("join.show", voxel)});
  else if (run.is_ours() && other >= 0 && other != at.what.index)
    menu.add("joined", "Should be on the same plane as the selected point",
             {menu.select, command("fix.point", PointWish{debug::Wish::joined, other})});
  if (plane >= 0)
    menu.add("plane", "Select " + debug::plane_name(run, plane),
             {command("select.plane", PlaneRef{plane})});
  if (node >= 0)
    menu.add("node", fmt::format("Select node {}", node), {command("select.node", node)});
  menu.act("break", "Break on this point", "break.point");
  menu.add_common(at.source >= 0 ? Clicked{Clicked::On::pixel, pixel_at(state, at.source)} : voxel,
                  fmt::format("voxel {}", at.what.index));
  return menu.entries;
}

std::vector<ContextEntry> plane_entries(const State& state, std::int32_t plane) {
  const std::string name = debug::plane_name(*state.run(), plane);
  Menu menu{state, command("select.plane", PlaneRef{plane})};
  menu.add("select", "Select plane", {menu.select, command("tab.inspector", "inspector")});
  menu.add_common({Clicked::On::plane, {}, plane}, name);
  return menu.entries;
}

std::vector<ContextEntry> node_entries(const State& state, std::int32_t node) {
  Menu menu{state, command("select.node", node)};
  menu.add("select", "Select node", {menu.select, command("tab.inspector", "inspector")});
  menu.act("decision", "Go to its decision", "step.decision");
  menu.act("break", "Break on its decision", "break.node");
  menu.add_common({}, fmt::format("node {}", node));
  return menu.entries;
}

std::vector<ContextEntry> empty_entries(const State& state, std::int64_t source) {
  std::vector<ContextEntry> entries;
  const auto act = [&](const char* name, const char* action) {
    entries.push_back({name, find_action(action).title, key_of(action), {{action}}});
  };
  if (source >= 0) {
    const Pixel pixel = pixel_at(state, source);
    const std::string text = pixel_text(pixel);
    entries.push_back({"why", "Why is nothing here?", "", {command("why.pixel", pixel)}});
    entries.push_back({"copy", "Copy \"" + text + "\"", "", {command("copy", text)}});
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
    text = "nothing at pixel " + pixel_text(pixel_at(state, at.source));
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

namespace {

/// A new run may have arrived since the menu was opened.
bool is_there(const State& state, const PointedAt& at) {
  const debug::Run& run = *state.run();
  const auto below = [&](std::size_t size) {
    return static_cast<std::size_t>(at.what.index) < size;
  };
  switch (at.what.kind) {
    case render::Picked::Kind::voxel:
      return below(run.subject->voxel_count());
    case render::Picked::Kind::plane:
      return below(static_cast<std::size_t>(run.timeline.plane_count()));
    case render::Picked::Kind::node:
      return below(run.octree().nodes.size());
    default:
      return true;
  }
}

}  // namespace

void draw_context_menu(const Ui& ui, const std::optional<PointedAt>& clicked) {
  if (clicked) {
    ui.memory.context = *clicked;
    ImGui::OpenPopup("context");
  }
  if (!ImGui::BeginPopup("context")) return;
  const PointedAt& at = ui.memory.context;
  if (is_there(ui.state, at)) {
    ImGui::TextDisabled("%s", context_title(ui.state, at).c_str());
    ImGui::Separator();
    for (const ContextEntry& entry : context_entries(ui.state, at)) {
      if (ImGui::MenuItem(entry.title.c_str(), entry.key.c_str()))
        ui.commands.insert(ui.commands.end(), entry.commands.begin(), entry.commands.end());
      ui.name("context." + entry.name);
    }
  } else {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace planescope::desktop
