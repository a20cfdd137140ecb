#pragma once

// Renders pictures without a window: OpenGL 3.3 through EGL, on a GPU or in software.

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // planescope itself has types of the same names
namespace v0 {
#else
inline namespace v0 {
#endif
enum class Picture : std::uint8_t {
  planes,     // in space: voxels in the colors of their planes, outlines, normals
  labels,     // in space: h and v
  cases,      // in space: octree nodes by the paper's cases I to IV
  leftovers,  // in space: points without a plane
  overlay,    // planes over the color image or shaded depth, at its size; clouds: in space
  depth,      // the depth image, at its size; clouds: height, in space
};
enum class Theme : std::uint8_t { light, dark };

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height * width * 3], row 0 at the top
};

/// Use it only on the thread that created it. Leaves its own OpenGL context current there.
class PLANESCOPE_API Renderer {
 public:
  /// Throws Error with the result of each attempt if OpenGL is unavailable.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  Image draw(const Result& result,
             Picture picture = Picture::planes,
             int width = 1280,
             int height = 960,
             Theme theme = Theme::light);
  /// The state at a step: nodes by case, the queue, and a highlight of the step's subject.
  Image draw(
      const Trace& trace, int step, int width = 1280, int height = 960, Theme theme = Theme::light);
  std::string description() const;  // "llvmpipe (LLVM 15.0.6, 256 bits), Mesa 22.3.6, EGL device"

 private:
  struct State;
  std::unique_ptr<State> state_;
};

PLANESCOPE_API void write_png(const std::string& path, const Image& image);

}  // namespace v0
}  // namespace planescope
