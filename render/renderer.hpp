#pragma once

// GL contexts, the renderer of draw lists, and detection of changed picture parts.

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"
#include "render/draw_list.hpp"

struct GLFWwindow;

namespace planescope::render {

struct Overlay;

/// A current GL 3.3 core context. EGL works without a display server (device platform, then
/// surfaceless, then default); GLFW requires one and also owns a window. Throws Error with the
/// result of each attempt.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  /// "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6, EGL device"
  virtual std::string description() const = 0;
  virtual GLFWwindow* window() { return nullptr; }  // for GLFW contexts
};
std::unique_ptr<GlContext> make_egl_context();
/// A resizable window with vertical sync. The size is for a standard-density screen and is scaled
/// by the monitor's factor.
std::unique_ptr<GlContext> make_glfw_context(int width,
                                             int height,
                                             const std::string& title,
                                             bool visible = true);

// ---- Changed parts of a picture ----
// Compares hashes of everything drawn into each tile, because a step in the window changes few
// tiles. Redrawing whole scenes takes 1.24 times as long per step (llvmpipe, two cores, 1440 x 900,
// `planescope-lab bench desktop`).

/// Pixel rectangle from the top left; the second corner is exclusive.
struct Part {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::int64_t pixels() const { return empty() ? 0 : std::int64_t{x1 - x0} * (y1 - y0); }
  bool operator==(const Part&) const = default;
};

/// A pixel coordinate clamped far outside any picture; 0 for NaN.
int whole_px(double place);
Part common(const Part& a, const Part& b);
/// The smallest part that contains both.
Part around(const Part& a, const Part& b);
/// At most `count` parts that cover all of them; they may overlap.
std::vector<Part> at_most(std::vector<Part> parts, std::size_t count);
/// Parts that cover all of them, more than `reach_px` pixels apart from each other.
std::vector<Part> apart(std::vector<Part> parts, int reach_px);

class Tiles {
 public:
  Tiles() = default;
  Tiles(int width, int height);

  /// Adds an object with this hash that draws only inside `touched`. The order matters.
  void add(const Part& touched, std::uint64_t hash);
  /// Parts of the picture that may differ from the previous one, without overlap. The whole picture
  /// if the size changed.
  std::vector<Part> changes_since(const Tiles& before) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::uint64_t> hashes_;  // row by row
};

/// Hash of values without padding, in 32-bit words.
template <typename... Values>
std::uint64_t hashed(std::uint64_t hash, const Values&... values) {
  const auto add = [&](const auto& value) {
    static_assert(sizeof(value) % 4 == 0);
    std::array<std::uint32_t, sizeof(value) / 4> words;
    std::memcpy(words.data(), &value, sizeof(value));
    for (const std::uint32_t word : words) {
      hash = (hash ^ word) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 29;
    }
  };
  (add(values), ...);
  return hash;
}

/// Tiles of a draw list for one view. Pictures with different views or themes are not compared.
Tiles scene_tiles(const DrawList& list,
                  const Overlay& overlay,
                  const View& view,
                  float shade_radius_px);

// ---- The renderer ----

/// `quick` takes half the time on a CPU but draws points and fills without antialiasing; for
/// moving views.
enum class Effort : std::uint8_t { fine, quick };

/// Renders a DrawList with GL 3.3 core into its own framebuffer. Requires a current context, which
/// must remain the same until destruction.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Renders an antialiased RGB picture, row 0 at the top. Points are drawn on the CPU (splats.cpp)
  /// with 4 samples; everything else has soft edges. Same input, same renderer: same pixels. Faster
  /// if only the colors of points changed since the last picture. `bare`: receives the picture
  /// without title and legend.
  Image8 render(const DrawList& list,
                const Camera& camera,
                int width,
                int height,
                Theme theme,
                Image8* bare = nullptr);

  /// Renders on the GPU, with 4 samples, for display in a window. Returns a GL texture of exactly
  /// width x height, opaque, row 0 at the bottom (draw it upside down). It is owned by the renderer
  /// and valid until the next call.
  std::uint32_t draw(const DrawList& list,
                     const Camera& camera,
                     int width,
                     int height,
                     Theme theme,
                     Effort effort = Effort::fine,
                     double screen_scale = 1);

  /// Parts redrawn by the last draw(); empty if the picture was unchanged.
  std::span<const Part> changes() const;

  /// Id at each pixel (0 none), for picking: no antialiasing, visible surfaces only.
  Image<std::uint32_t> render_ids(const DrawList& list,
                                  const Camera& camera,
                                  int width,
                                  int height);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads the lower left part of the bound framebuffer as an RGB picture, row 0 at the top.
Image8 read_picture(int width, int height);

}  // namespace planescope::render
