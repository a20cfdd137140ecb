// The menu of what was clicked with the right button.

#include "app/desktop/debugger/context.hpp"

#include "app/desktop/views.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {
namespace {

/// A run may have come in since the menu was opened.
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
        for (const Command& command : entry.commands) ui.emit(command.action, command.argument);
      ui.name("context." + entry.name);
    }
  } else {
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace planescope::desktop
