#pragma once

#include "app/desktop/state/state.hpp"
#include "render/label_scene.hpp"

namespace planescope::desktop {

/// What both views of the label mode draw. Its spans are the state's.
render::LabelLook label_look_of(const State& state);

}  // namespace planescope::desktop
