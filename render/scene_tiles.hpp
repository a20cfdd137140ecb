#pragma once

#include "render/overlay.hpp"
#include "render/tiles.hpp"

namespace planescope::render {

/// What a list draws where, seen from one place, so that only what changed of it is drawn again.
/// Pictures from another place or in another theme are not compared.
Tiles scene_tiles(const DrawList& list,
                  const Overlay& overlay,
                  const View& view,
                  float shade_radius_px);

}  // namespace planescope::render
