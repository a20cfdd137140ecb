#pragma once

#include "render/gl.hpp"

namespace planescope::render {

/// Framebuffers of one picture, kept while its size stays the same.
struct SceneTarget {
  explicit SceneTarget(int samples_per_pixel) : samples(samples_per_pixel) {}

  int samples = 4;  // 0: no antialiasing
  int width = 0, height = 0;
  GlRenderbuffer color, depth, box_depth;
  GlFramebuffer scene;     // color + depth
  GlFramebuffer boxes;     // color + box_depth: boxes hide boxes, but nothing else
  GlTexture flat_color;    // the finished picture, opaque when sampled
  GlTexture flat_depth;    // of the points, for shading
  GlFramebuffer resolved;  // flat_color + flat_depth

  void resize(int new_width, int new_height);
};

struct IdTarget {
  int width = 0, height = 0;
  GlRenderbuffer ids, depth;
  GlFramebuffer framebuffer;

  void resize(int new_width, int new_height);
};

}  // namespace planescope::render
