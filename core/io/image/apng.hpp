#pragma once

// Animated PNG: any browser shows the animation, and every other PNG viewer its first frame. For
// photographs, and for pictures of a window.

#include <cstdint>
#include <ostream>

#include "core/model/types.hpp"

namespace planescope::io {

/// How a frame is stored: as a whole, or as the rectangle in which it differs from the one before.
enum class ApngStores : std::uint8_t { whole, difference };

/// Writes one RGB frame after the other, without loss; only one is in memory, two of differences.
/// The stream's owner checks it for errors.
class ApngWriter {
 public:
  /// `frames`: how many add() will be called with, at least one.
  ApngWriter(std::ostream& out,
             int width,
             int height,
             int frames,
             int frames_per_second,
             ApngStores stores = ApngStores::whole);
  void add(const Image8& image);
  void finish();

 private:
  std::ostream& out_;
  int width_, height_, frames_, frames_per_second_;
  ApngStores stores_;
  int added_ = 0;
  Image8 before_;
  std::uint32_t sequence_ = 0;
};

}  // namespace planescope::io
