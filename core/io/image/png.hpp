#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::io {

/// What a PNG holds, read from its header without decoding it.
struct PngInfo {
  int width = 0;
  int height = 0;
  int channels = 0;
  int bit_depth = 0;
};

/// All readers throw Error naming the file, what was found and what was expected: not a PNG, cut
/// short, wrong number of channels or bits. Sizes are checked before anything is allocated.
PngInfo png_info(const std::filesystem::path& path);
/// Whether the chunk that ends every PNG is missing; looks at the end of the file only.
bool png_is_cut(const std::filesystem::path& path);
Image16 read_png_16(const std::filesystem::path& path);   // exactly one channel of 16 bits
Image8 read_png_grey(const std::filesystem::path& path);  // exactly one channel of 8 bits
Image8 read_png_rgb(const std::filesystem::path& path);   // anything 8- or 16-bit, turned into RGB

/// Likewise of a PNG in memory; `name` is what messages call it.
PngInfo png_info(std::span<const unsigned char> bytes, const std::string& name);
Image16 decode_png_16(std::span<const unsigned char> bytes, const std::string& name);
Image8 decode_png_rgb(std::span<const unsigned char> bytes, const std::string& name);

/// Writers: 16-bit grey; or 8-bit with 1, 3 or 4 channels. The same image gives the same bytes.
void write_png(const std::filesystem::path& path, const Image16& image);
void write_png(const std::filesystem::path& path, const Image8& image);
std::vector<unsigned char> encode_png(const Image8& image);
std::vector<unsigned char> encode_png(const Image16& image);

// For writers of PNG's parts (apng.cpp): chunks, and how pixels are packed (PNG, third edition, W3C
// 2025).

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
