#pragma once

#include <cstdint>
#include <vector>

namespace planescope {

/// A row-major image, `channels` interleaved values per pixel, row 0 at the top.
template <typename T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<T> data;  // height * width * channels

  Image() = default;
  Image(int w, int h, int c = 1, T fill = T{})
      : width(w), height(h), channels(c), data(static_cast<std::size_t>(w) * h * c, fill) {}

  bool empty() const { return data.empty(); }
  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
  T& at(int x, int y, int c = 0) {
    return data[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
  const T& at(int x, int y, int c = 0) const {
    return data[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
};

using Image8 = Image<std::uint8_t>;    // 1 grey, 3 RGB or 4 RGBA channels
using Image16 = Image<std::uint16_t>;  // 1 channel: depth counts, plane ids

}  // namespace planescope
