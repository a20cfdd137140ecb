// PNG, third edition (W3C 2025): chunks (5.3), and the filters of rows (9).

#include "core/io/image/png_plain.hpp"

#include <libdeflate.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include "core/io/image/png.hpp"

namespace planescope::io {
namespace {

using ByteSpan = std::span<const unsigned char>;

constexpr std::size_t kChunksFrom = 8;  // behind the signature
constexpr std::size_t kAroundContent = 12;
constexpr std::size_t kHeaderContent = 13;

std::uint32_t number_32(const unsigned char* at) {
  return std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 |
         at[3];
}

struct PlainChunk {
  std::string_view type;
  ByteSpan content;
};

/// The chunk that `rest` begins with, which it loses. Without a type where it is cut or damaged.
PlainChunk take_chunk(ByteSpan& rest) {
  if (rest.size() < kAroundContent) return {};
  const std::size_t size = number_32(rest.data());
  if (size > rest.size() - kAroundContent) return {};
  const ByteSpan checked = rest.subspan(4, 4 + size);
  if (libdeflate_crc32(0, checked.data(), checked.size()) != number_32(rest.data() + 8 + size))
    return {};
  rest = rest.subspan(kAroundContent + size);
  return {{reinterpret_cast<const char*>(checked.data()), 4}, checked.subspan(4)};
}

/// Grey or RGB, and not interlaced.
bool is_plain(ByteSpan header) {
  constexpr std::size_t kColor = 9, kInterlace = 12;
  return header.size() == kHeaderContent && (header[kColor] == 0 || header[kColor] == 2) &&
         header[kInterlace] == 0;
}

/// What all IDAT hold together; empty where the file is not plain.
std::vector<unsigned char> packed_pixels(ByteSpan file) {
  if (file.size() < kChunksFrom) return {};
  ByteSpan rest = file.subspan(kChunksFrom);
  const PlainChunk header = take_chunk(rest);
  if (header.type != "IHDR" || !is_plain(header.content)) return {};
  std::vector<unsigned char> packed;
  packed.reserve(rest.size());
  PlainChunk chunk = take_chunk(rest);
  for (; chunk.type == "IDAT"; chunk = take_chunk(rest))
    packed.insert(packed.end(), chunk.content.begin(), chunk.content.end());
  if (chunk.type != "IEND") return {};
  return packed;
}

/// A zlib stream of exactly this many bytes. False for windows of less than 32 KiB as well:
/// libdeflate does not look whether the stream keeps to them.
bool inflate_exactly(ByteSpan packed, unsigned char* out, std::size_t size) {
  constexpr unsigned char kWindow32K = 0x78;
  if (packed.empty() || packed[0] != kWindow32K) return false;
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  std::size_t used = 0;
  return decompressor &&
         libdeflate_zlib_decompress_ex(decompressor.get(), packed.data(), packed.size(), out, size,
                                       &used, nullptr) == LIBDEFLATE_SUCCESS &&
         used == packed.size();
}

/// Adds to each byte what `predict` makes of those to the left, above, and above on the left.
template <typename Predict>
void unfilter(const unsigned char* __restrict in,
              const unsigned char* __restrict above,
              std::size_t pixel,
              std::size_t size,
              unsigned char* __restrict out,
              const Predict& predict) {
  for (std::size_t i = 0; i < pixel; ++i)
    out[i] = static_cast<unsigned char>(in[i] + predict(0, above[i], 0));
  for (std::size_t i = pixel; i < size; ++i)
    out[i] =
        static_cast<unsigned char>(in[i] + predict(out[i - pixel], above[i], above[i - pixel]));
}

/// The running sums of two bytes a pixel, four pixels at a time: in the lanes of a product with a 1
/// in each of them. Of the high bytes apart from the low ones, so that none spills over. Returns
/// how many bytes are done.
std::size_t add_up_pairs(const unsigned char* in, std::size_t size, unsigned char* out) {
  constexpr std::uint64_t kOnes = 0x0001000100010001, kLow = 0x00ff00ff00ff00ff;
  std::uint64_t before_high = 0, before_low = 0;  // of the file: the high byte comes first
  std::size_t i = 0;
  for (; i + 8 <= size; i += 8) {
    std::uint64_t pixels;
    std::memcpy(&pixels, in + i, 8);
    const std::uint64_t high = (pixels & kLow) * kOnes, low = (pixels >> 8 & kLow) * kOnes;
    const std::uint64_t sums =
        ((high + before_high * kOnes) & kLow) | ((low + before_low * kOnes) & kLow) << 8;
    std::memcpy(out + i, &sums, 8);
    before_high = (before_high + (high >> 48)) & 0xff;
    before_low = (before_low + (low >> 48)) & 0xff;
  }
  return i;
}

void unfilter_sub(const unsigned char* in,
                  std::size_t pixel,
                  std::size_t size,
                  unsigned char* out) {
  std::size_t i = 0;
  if constexpr (std::endian::native == std::endian::little)
    if (pixel == 2) i = add_up_pairs(in, size, out);
  for (; i < pixel; ++i) out[i] = in[i];
  for (; i < size; ++i) out[i] = static_cast<unsigned char>(in[i] + out[i - pixel]);
}

/// `in`: a row behind the byte that names its filter. False where there is no such filter.
bool unfilter_row(int filter,
                  const unsigned char* in,
                  const unsigned char* above,
                  std::size_t pixel,
                  std::size_t size,
                  unsigned char* out) {
  switch (filter) {
    case kNone:
      std::memcpy(out, in, size);
      return true;
    case kSub:
      unfilter_sub(in, pixel, size, out);
      return true;
    case kUp:
      unfilter(in, above, pixel, size, out, [](int, int up, int) { return up; });
      return true;
    case kAverage:
      unfilter(in, above, pixel, size, out, [](int left, int up, int) { return (left + up) / 2; });
      return true;
    case kPaeth:
      unfilter(in, above, pixel, size, out, paeth);
      return true;
    default:
      return false;
  }
}

}  // namespace

bool unpack_plain_png(ByteSpan file, const PngInfo& info, std::span<unsigned char> pixels) {
  const std::size_t pixel = static_cast<std::size_t>(info.channels) * info.bit_depth / 8;
  const std::size_t row = pixel * info.width, rows = info.height;
  if (info.bit_depth < 8 || row * rows != pixels.size()) return false;
  const std::vector<unsigned char> packed = packed_pixels(file);
  const std::size_t size = (row + 1) * rows;
  const auto filtered = std::make_unique_for_overwrite<unsigned char[]>(size);
  if (!inflate_exactly(packed, filtered.get(), size)) return false;
  const std::vector<unsigned char> nothing(row);
  const unsigned char* above = nothing.data();
  for (std::size_t y = 0; y < rows; ++y) {
    const unsigned char* in = filtered.get() + y * (row + 1);
    unsigned char* out = pixels.data() + y * row;
    if (!unfilter_row(in[0], in + 1, above, pixel, row, out)) return false;
    above = out;
  }
  return true;
}

}  // namespace planescope::io
