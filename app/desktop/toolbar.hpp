#pragma once

// Small controls above the views.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

/// A button that performs an action, lit while the action is switched on; its tooltip tells the
/// action's title and key. Named "button.<action>".
void action_button(const Ui& ui, const char* action, const char* label);

/// What is behind the image, all of it, how strongly it is covered (`of_opacity` says by what).
void draw_image_tools(const Ui& ui, const char* of_opacity);

/// A few words in the middle of the room that is left.
void draw_notice(const Ui& ui, const std::string& text, ImU32 color);
/// Where a frame would be shown: why it is not.
void draw_absence(const Ui& ui);
/// The same in the label mode.
void draw_label_absence(const Ui& ui);

/// "voxel 812, node 41 (IV), P3": what is known of a voxel at the cursor.
std::string describe_voxel(const State& state, std::int32_t voxel);
std::string describe_node(const State& state, std::int32_t node);

}  // namespace planescope::desktop
