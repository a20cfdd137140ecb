#pragma once

// Pictures without a window: OpenGL 3.3 through EGL, on a GPU or in software.

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // which has types of the same names, in planescope itself
namespace v0 {
#else
inline namespace v0 {
#endif
enum class Picture : std::uint8_t {
  planes,     // in space: voxels in the colours of their planes, outlines, normals
  labels,     // in space: h and v
  cases,      // in space: octree nodes by the paper's cases I to IV
  leftovers,  // in space: what is in no plane
  overlay,    // planes over the colour image or shaded depth, in its own size; clouds: in space
  depth,      // the depth image, in its own size; clouds: height, in space
};
enum class Theme : std::uint8_t { light, dark };

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height * width * 3], row 0 at the top
};

/// Belongs to the thread that made it, and leaves its own OpenGL context current there.
class PLANESCOPE_API Renderer {
 public:
  /// Throws Error with what each attempt said where there is no OpenGL.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  Image draw(const Result& result,
             Picture picture = Picture::planes,
             int width = 1280,
             int height = 960,
             Theme theme = Theme::light);
  /// The state at a step: nodes by case, the queue, what the step is about.
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
