#pragma once

#include <cstdint>

#include "core/model/image.hpp"
#include "render/gl.hpp"

namespace planescope::render {

/// An image as a GL texture, row 0 at the top (texture coordinate v = 0). Shown larger than it is,
/// its pixels stay square. Needs the context that was current when it was made.
class ImageTexture {
 public:
  ImageTexture() = default;  // id() 0
  explicit ImageTexture(const Image8& image) { upload(image); }

  /// Replaces what it shows; quicker where the size stays. RGB or RGBA, not empty.
  void upload(const Image8& image);

  std::uint32_t id() const { return texture_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GlTexture texture_;
  int width_ = 0, height_ = 0, channels_ = 0;
};

}  // namespace planescope::render
