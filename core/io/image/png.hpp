#pragma once

// PNG: read, written, and animated.

#include <cstdint>
#include <filesystem>
#include <ostream>
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

// ---- Animated PNG: any browser shows the animation, and every other viewer its first frame ----

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

// ---- Internal to core/io: chunks, and how pixels are packed (PNG, third edition, W3C 2025) ----

using PngBytes = std::vector<unsigned char>;

enum class PngColor : unsigned char { grey = 0, rgb = 2, rgba = 6 };

/// By what a row's bytes are predicted; only what they differ by is packed.
enum PngFilter : unsigned char { kNone, kSub, kUp, kAverage, kPaeth, kFilters };

std::uint32_t number_32(const unsigned char* at);  // big-endian, as these
void append_32(PngBytes& bytes, std::uint32_t value);
void append_16(PngBytes& bytes, int value);

/// What every PNG begins with: signature and IHDR.
PngBytes png_start(int width, int height, int bits, PngColor color);
void append_chunk(PngBytes& out, std::string_view type, std::span<const unsigned char> content);

/// A zlib stream; `level`: 1, quick, to 12, small. The same bytes give the same stream.
PngBytes deflated(std::span<const unsigned char> bytes, int level);

/// Unpacks a file that is whole and nothing but pixels: grey or RGB of 8 or 16 bits, not
/// interlaced, no chunk beside IHDR, IDAT and IEND. False for any other, and where anything is
/// wrong with it: libpng then reads it, or says what is wrong. Several times as quick as libpng,
/// which goes row by row and inflates with zlib. pixels: [height x row], as in the
/// file: 16 bits with the high byte first.
bool unpack_plain_png(std::span<const unsigned char> file,
                      const PngInfo& info,
                      std::span<unsigned char> pixels);

}  // namespace planescope::io
