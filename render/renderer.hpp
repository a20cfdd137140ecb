#pragma once

// A GL context, what draws draw lists into it, and which parts of a picture change.

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

/// A current GL 3.3 core context. EGL needs no display server (device platform, then surfaceless,
/// then default); GLFW needs one and also owns a window. Throws Error with what each attempt said.
class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual void make_current() = 0;
  /// "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6, EGL device"
  virtual std::string description() const = 0;
  virtual GLFWwindow* window() { return nullptr; }  // of a GLFW context
};
std::unique_ptr<GlContext> make_egl_context();
/// A resizable window, drawn in step with the screen. Size for a screen of ordinary density: it
/// grows with the monitor's scale.
std::unique_ptr<GlContext> make_glfw_context(int width,
                                             int height,
                                             const std::string& title,
                                             bool visible = true);

// ---- Which parts of a picture change ----
// From hashes of what is drawn into its tiles: a step of the window changes few of them. Scenes
// drawn as a whole: a step takes 1.24 times as long (llvmpipe, two cores, 1440 x 900,
// `planescope-lab bench desktop`).

/// Pixels from the top left; the second corner is outside.
struct Part {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  std::int64_t pixels() const { return empty() ? 0 : std::int64_t{x1 - x0} * (y1 - y0); }
  bool operator==(const Part&) const = default;
};

/// A coordinate in pixels, limited far beyond any picture; 0 of NaN.
int whole_px(double place);
Part common(const Part& a, const Part& b);
/// The smallest that holds both.
Part around(const Part& a, const Part& b);
/// At most that many parts that hold all of them; they may overlap.
std::vector<Part> at_most(std::vector<Part> parts, std::size_t count);
/// Parts that hold all of them, with more than that many pixels between any two.
std::vector<Part> apart(std::vector<Part> parts, int reach_px);

class Tiles {
 public:
  Tiles() = default;
  Tiles(int width, int height);

  /// Something of that hash is drawn next, and touches no pixel outside.
  void add(const Part& touched, std::uint64_t hash);
  /// Where the picture may differ from the one before: parts that do not overlap. All of it where
  /// that was of another size.
  std::vector<Part> changes_since(const Tiles& before) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::uint64_t> hashes_;  // row by row
};

/// Of values without padding, in words of 32 bits.
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

/// What a list draws where, seen from one place. Pictures from another place or in another theme
/// are not compared.
Tiles scene_tiles(const DrawList& list,
                  const Overlay& overlay,
                  const View& view,
                  float shade_radius_px);

// ---- The renderer ----

/// `quick` takes half the time on a CPU and leaves points and fills without antialiasing: for a
/// view that moves.
enum class Effort : std::uint8_t { fine, quick };

/// Draws a DrawList with GL 3.3 core into a framebuffer of its own. Needs a current context, and
/// the same one until it is destroyed.
class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// RGB picture, row 0 at the top, antialiased: points, drawn on the CPU (splats.hpp), with 4
  /// samples, all else by soft edges. Same input, same renderer: same pixels. Quicker where only
  /// colors of points differ from the picture before.
  /// `bare`: becomes the picture without title and legend.
  Image8 render(const DrawList& list,
                const Camera& camera,
                int width,
                int height,
                Theme theme,
                Image8* bare = nullptr);

  /// The same left on the GPU, drawn there alone with 4 samples, for a window: a GL texture of
  /// exactly width x height, opaque, row 0 at the bottom (draw it upside down). The renderer's own,
  /// valid until it draws again.
  std::uint32_t draw(const DrawList& list,
                     const Camera& camera,
                     int width,
                     int height,
                     Theme theme,
                     Effort effort = Effort::fine,
                     double screen_scale = 1);

  /// Where draw() has drawn last: nothing is drawn where the picture is the same as before.
  std::span<const Part> changes() const;

  /// Id under each pixel (0 none), for picking: no antialiasing, visible surface only.
  Image<std::uint32_t> render_ids(const DrawList& list,
                                  const Camera& camera,
                                  int width,
                                  int height);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bound framebuffer's lower left part as an RGB picture, row 0 at the top.
Image8 read_picture(int width, int height);

}  // namespace planescope::render
