#pragma once

// Sums of whole numbers over the square window about each pixel, a row of the picture at a time:
// the columns' sums move down with the window, and along the row they are added up once.

#include <algorithm>
#include <vector>

#include "core/planes/segment/depth_kernels.hpp"

namespace planescope::planes {

/// Whole numbers, so that the order in which they are added does not matter. Every sum over a
/// window, and over a window's rows, must fit into Int.
template <typename Int>
class WindowSums {
 public:
  /// Of a picture of this size, whose pixels are set next; windows of 2 half + 1 pixels.
  void start(int width, int height, int half) {
    width_ = width, height_ = height, half_ = half;
    stride_ = (width + kPixelGroup - 1) / kPixelGroup * kPixelGroup;
    values_.resize(static_cast<std::size_t>(stride_) * height);
    columns_.assign(stride_, 0);
    up_to_.resize(width + 1);
    begin_ = end_ = 0;
  }
  /// With room up to a multiple of kPixelGroup.
  Int* row(int y) { return values_.data() + static_cast<std::size_t>(y) * stride_; }

  /// Moves the windows to this row, which is not above that of the last call.
  void move_to(int y) {
    // Rows that the windows only passed through are not looked at.
    const int begin = std::max(0, y - half_), end = std::min(height_, y + half_ + 1);
    for (int above = begin_; above < std::min(begin, end_); ++above) {
      const Int* values = row(above);
      for (int x = 0; x < stride_; x += kLanes)
        store(&columns_[x], load(&columns_[x]) - load(values + x));
    }
    for (int below = std::max(begin, end_); below < end; ++below) {
      const Int* values = row(below);
      for (int x = 0; x < stride_; x += kLanes)
        store(&columns_[x], load(&columns_[x]) + load(values + x));
    }
    begin_ = begin, end_ = end;
    Int sum = 0;
    const Int* columns = columns_.data();
    Int* up_to = up_to_.data();
    *up_to++ = 0;
    for (int x = 0; x < width_; ++x) *up_to++ = sum += *columns++;
  }
  /// Of the window about a pixel of the row, as far as it is in the picture.
  Int at(int x) const {
    return up_to_[std::min(width_, x + half_ + 1)] - up_to_[std::max(0, x - half_)];
  }

 private:
  static constexpr int kLanes = 16 / sizeof(Int);  // in a register that every processor has
  typedef Int Group __attribute__((vector_size(16)));
  static Group load(const Int* from) {
    Group group;
    __builtin_memcpy(&group, from, sizeof group);
    return group;
  }
  static void store(Int* to, const Group& group) { __builtin_memcpy(to, &group, sizeof group); }

  int width_ = 0, height_ = 0, half_ = 0, stride_ = 0;
  int begin_ = 0, end_ = 0;  // rows in the windows
  std::vector<Int> values_, columns_, up_to_;
};

}  // namespace planescope::planes
