#pragma once

// What readers and writers of PNG files share: their parts, and how pixels are packed (PNG, third
// edition, W3C 2025).

#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

namespace planescope::io {

enum class PngColor : unsigned char { grey = 0, rgb = 2, rgba = 6 };

/// By what a row's bytes are foretold; only what they differ by is packed.
enum PngFilter : unsigned char { kNone, kSub, kUp, kAverage, kPaeth, kFilters };
/// That of the three neighbours which is nearest to left + up - corner.
inline int paeth(int left, int up, int corner) {
  const int guess = left + up - corner;
  const int by_left = std::abs(guess - left), by_up = std::abs(guess - up);
  const int by_corner = std::abs(guess - corner);
  if (by_left <= by_up && by_left <= by_corner) return left;
  return by_up <= by_corner ? up : corner;
}

void append_32(std::vector<unsigned char>& bytes, std::uint32_t value);  // big-endian
void append_16(std::vector<unsigned char>& bytes, int value);

/// What every PNG begins with: signature and IHDR.
std::vector<unsigned char> png_start(int width, int height, int bits, PngColor color);
void append_chunk(std::vector<unsigned char>& out,
                  std::string_view type,
                  std::span<const unsigned char> content);

/// A zlib stream; `level`: 1, quick, to 12, small. The same bytes give the same stream.
std::vector<unsigned char> deflated(std::span<const unsigned char> bytes, int level);

}  // namespace planescope::io
