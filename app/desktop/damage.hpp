#pragma once

// Which parts of the window a frame changes, from what ImGui is about to draw, without GL.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "app/desktop/imgui.hpp"
#include "render/tiles.hpp"

namespace planescope::desktop {

using render::Part;

class Damage {
 public:
  /// Where `frame` may look otherwise than the frame before: parts that do not overlap. All of the
  /// window at first, and where its size has changed. `version` tells apart what a texture holds
  /// now from what it held before.
  std::vector<Part> next(const ImDrawData& frame,
                         const std::function<std::uint64_t(ImTextureID)>& version);
  /// The frame before is lost.
  void forget() { tiles_ = {}; }

 private:
  render::Tiles tiles_;
};

/// Into `cut`, which is empty: what `frame` draws within the parts, and nothing outside them. Where
/// the parts hold what stood there, the window is then as if all of `frame` were drawn.
void cut_to_parts(const ImDrawData& frame, std::span<const Part> parts, ImDrawList& cut);

}  // namespace planescope::desktop
