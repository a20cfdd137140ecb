#pragma once

// Animated PNG: any browser shows the animation, and every other PNG viewer its first frame. For
// photographs.

#include <ostream>

#include "core/model/image.hpp"

namespace planescope::io {

/// Writes one RGB frame after the other, without loss; only one is in memory. The stream's owner
/// checks it for errors.
class ApngWriter {
 public:
  /// `frames`: how many add() will be called with, at least one.
  ApngWriter(std::ostream& out, int width, int height, int frames, int frames_per_second);
  void add(const Image8& image);
  void finish();

 private:
  std::ostream& out_;
  int width_, height_, frames_, frames_per_second_;
  int added_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace planescope::io
