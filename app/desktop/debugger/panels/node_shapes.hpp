#pragma once

// What a node looks like in the octree view. As in Gist's search trees, shape and colour both tell
// what became of it: round ones were divided, a square is a dead end, a diamond is a find.

#include "app/desktop/ui.hpp"

namespace planescope::desktop {

struct NodeShape {
  debug::NodeState state = debug::NodeState::queued;
  planes::Case decided = planes::Case::none;  // where settled
  bool at_max_depth = false;                  // hatched: its points went to the leftovers
  bool impure_fit = false;                    // R4: a dot, conquered label by label
};
void draw_node_shape(const Ui& ui, ImVec2 centre, float radius, const NodeShape& shape);

/// What the shapes mean, in one line.
void draw_shape_key(const Ui& ui);

}  // namespace planescope::desktop
