#pragma once

// PNG: reading, writing and animation.

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::io {

/// Properties of a PNG, read from its header without decoding it.
struct PngInfo {
  int width = 0;
  int height = 0;
  int channels = 0;
  int bit_depth = 0;
};

/// All readers throw Error that names the file, what was found and what was expected: not a PNG,
/// truncated, wrong number of channels or bits. Sizes are checked before anything is allocated.
PngInfo png_info(const std::filesystem::path& path);
/// Whether the chunk that ends every PNG is missing. Normally reads only the end of the file.
bool png_is_cut(const std::filesystem::path& path);
Image16 read_png_16(const std::filesystem::path& path);   // exactly one channel of 16 bits
Image8 read_png_grey(const std::filesystem::path& path);  // exactly one channel of 8 bits
Image8 read_png_rgb(const std::filesystem::path& path);   // any 8- or 16-bit PNG, converted to RGB

/// The same for a PNG in memory; `name` identifies it in messages.
PngInfo png_info(std::span<const unsigned char> bytes, const std::string& name);
Image16 decode_png_16(std::span<const unsigned char> bytes, const std::string& name);
Image8 decode_png_rgb(std::span<const unsigned char> bytes, const std::string& name);

/// Write 16-bit gray, or 8-bit with 1, 3 or 4 channels. The same image gives the same bytes.
void write_png(const std::filesystem::path& path, const Image16& image);
void write_png(const std::filesystem::path& path, const Image8& image);
std::vector<unsigned char> encode_png(const Image8& image);
std::vector<unsigned char> encode_png(const Image16& image);

// ---- Animated PNG: every browser plays it; other viewers show the first frame ----

/// How to store a frame: whole, or only the rectangle that differs from the previous frame.
enum class ApngStores : std::uint8_t { whole, difference };

/// Writes RGB frames one after another, losslessly. Keeps one frame in memory, or two for
/// differences. The stream's owner checks it for errors.
class ApngWriter {
 public:
  /// `frames`: the number of add() calls that will follow, at least one.
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

// ---- Internal to core/io: chunks and compression of pixels (PNG, third edition, W3C 2025) ----

using PngBytes = std::vector<unsigned char>;

enum class PngColor : unsigned char { grey = 0, rgb = 2, rgba = 6 };

/// How to predict the bytes of a row; only the differences are compressed.
enum PngFilter : unsigned char { kNone, kSub, kUp, kAverage, kPaeth, kFilters };

std::uint32_t number_32(const unsigned char* at);  // big-endian, as below
void append_32(PngBytes& bytes, std::uint32_t value);
void append_16(PngBytes& bytes, int value);

/// Start of every PNG: signature and IHDR.
PngBytes png_start(int width, int height, int bits, PngColor color);
void append_chunk(PngBytes& out, std::string_view type, std::span<const unsigned char> content);

/// Compresses to a zlib stream. `level`: 1 (fast) to 12 (small). Deterministic.
PngBytes deflated(std::span<const unsigned char> bytes, int level);

/// Decodes the pixels of a complete file with nothing else in it: gray or RGB of 8 or 16 bits, not
/// interlaced, no chunks beside IHDR, IDAT and IEND. Returns false for any other file and on any
/// error, so that libpng can read it or report the error. Several times as fast as libpng, which
/// goes row by row and inflates with zlib. pixels: [height x row], as in the file: 16 bits with the
/// high byte first.
bool unpack_plain_png(std::span<const unsigned char> file,
                      const PngInfo& info,
                      std::span<unsigned char> pixels);

}  // namespace planescope::io
