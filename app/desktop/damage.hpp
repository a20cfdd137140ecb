#pragma once

// Which parts of the window a frame changes, from what ImGui is about to draw, without GL.

#include <imgui.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace planescope::desktop {

/// Pixels from the top left of the window; the second corner is no longer of it.
struct Part {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  bool operator==(const Part&) const = default;
};

class Damage {
 public:
  /// Where `frame` may look otherwise than the frame before: parts that do not overlap. All of the
  /// window at first, and where its size has changed. `version` tells apart what a texture holds
  /// now from what it held before.
  std::vector<Part> next(const ImDrawData& frame,
                         const std::function<std::uint64_t(ImTextureID)>& version);
  /// The frame before is lost.
  void forget() { tiles_.clear(); }

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::uint64_t> tiles_;  // hashes of what is drawn into each, row by row
};

/// Into `cut`, which is empty: what `frame` draws within the parts, and nothing outside them. Where
/// the parts hold what stood there, the window is then as if all of `frame` were drawn.
void cut_to_parts(const ImDrawData& frame, std::span<const Part> parts, ImDrawList& cut);

}  // namespace planescope::desktop
