// PNG row filters (third edition, W3C 2025, Sec. 9): undone for files with nothing but pixels, and
// chosen for animations, whose chunks acTL, fcTL and fdAT are also written here.

#include <libdeflate.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include "core/io/image/png.hpp"

namespace planescope::io {
namespace {

using ByteSpan = std::span<const unsigned char>;

/// The neighbor that is nearest to left + up - corner.
int paeth(int left, int up, int corner) {
  const int guess = left + up - corner;
  const int by_left = std::abs(guess - left), by_up = std::abs(guess - up);
  const int by_corner = std::abs(guess - corner);
  if (by_left <= by_up && by_left <= by_corner) return left;
  return by_up <= by_corner ? up : corner;
}

/// Calls use(predict). `predict` computes a byte from those to the left, above, and above left.
/// Returns false if there is no such filter.
template <typename Use>
bool with_filter(int filter, const Use& use) {
  if (filter == kNone) use([](int, int, int) { return 0; });
  if (filter == kSub) use([](int left, int, int) { return left; });
  if (filter == kUp) use([](int, int up, int) { return up; });
  if (filter == kAverage) use([](int left, int up, int) { return (left + up) / 2; });
  if (filter == kPaeth) use([](int left, int up, int corner) { return paeth(left, up, corner); });
  return filter >= 0 && filter < kFilters;
}

// ---- Reading ----

constexpr std::size_t kChunksFrom = 8;  // after the signature
constexpr std::size_t kAroundContent = 12;
constexpr std::size_t kHeaderContent = 13;

struct PlainChunk {
  std::string_view type;
  ByteSpan content;
};

/// Removes the first chunk from `rest`. Returns a chunk without a type if it is cut or damaged.
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

/// Gray or RGB, and not interlaced.
bool is_plain(ByteSpan header) {
  constexpr std::size_t kColor = 9, kInterlace = 12;
  return header.size() == kHeaderContent && (header[kColor] == 0 || header[kColor] == 2) &&
         header[kInterlace] == 0;
}

/// The joined content of all IDAT chunks; empty if the file is not plain.
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

/// Inflates a zlib stream of exactly `size` bytes. Returns false also for windows of less than 32
/// KiB, because libdeflate does not check that the stream respects them.
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

/// Adds the prediction to each byte.
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

/// Prefix sums of two-byte pixels, four pixels at a time: multiplication by a 1 in each lane adds
/// up the lanes. High and low bytes are summed separately, so that none overflows into another.
/// Returns the number of finished bytes.
std::size_t add_up_pairs(const unsigned char* in, std::size_t size, unsigned char* out) {
  constexpr std::uint64_t kOnes = 0x0001000100010001, kLow = 0x00ff00ff00ff00ff;
  std::uint64_t before_high = 0, before_low = 0;  // in the file: the high byte comes first
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
  if (pixel == 2) i = add_up_pairs(in, size, out);
  for (; i < pixel; ++i) out[i] = in[i];
  for (; i < size; ++i) out[i] = static_cast<unsigned char>(in[i] + out[i - pixel]);
}

/// `in`: a row after its filter byte. Returns false if there is no such filter.
bool unfilter_row(int filter,
                  const unsigned char* in,
                  const unsigned char* above,
                  std::size_t pixel,
                  std::size_t size,
                  unsigned char* out) {
  if (filter == kNone) return std::memcpy(out, in, size) != nullptr;
  if (filter != kSub)
    return with_filter(
        filter, [&](const auto& predict) { unfilter(in, above, pixel, size, out, predict); });
  unfilter_sub(in, pixel, size, out);
  return true;
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

// ---- Animation ----

namespace {

constexpr int kChannels = 3;
constexpr int kSmallLevel = 6;

void write(std::ostream& out, const PngBytes& bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

void write_chunk(std::ostream& out, std::string_view type, const PngBytes& content) {
  PngBytes chunk;
  append_chunk(chunk, type, content);
  write(out, chunk);
}

/// Stores the differences of a row from the prediction. `above`: zeros for the first row.
void filter_row(int filter,
                const unsigned char* row,
                const unsigned char* above,
                std::span<unsigned char> filtered) {
  with_filter(filter, [&](const auto& predict) {
    for (std::size_t i = 0; i < filtered.size(); ++i) {
      const std::size_t left = i - kChannels;
      const int predicted =
          i < kChannels ? predict(0, above[i], 0) : predict(row[left], above[i], above[left]);
      filtered[i] = static_cast<unsigned char>(row[i] - predicted);
    }
  });
}

/// Sum of a filtered row's bytes as distances from 0: small values usually compress well.
long cost_of(std::span<const unsigned char> filtered) {
  long cost = 0;
  for (const unsigned char byte : filtered) cost += std::min<int>(byte, 256 - byte);
  return cost;
}

PngBytes filtered_rows(const Image8& image) {
  const std::size_t stride = static_cast<std::size_t>(image.width) * kChannels;
  PngBytes result;
  PngBytes candidate(stride), best(stride);
  const PngBytes nothing(stride, 0);
  for (int y = 0; y < image.height; ++y) {
    const unsigned char* row = image.data.data() + y * stride;
    const unsigned char* above = y > 0 ? row - stride : nothing.data();
    int best_filter = -1;
    long least = 0;
    for (int filter = 0; filter < kFilters; ++filter) {
      filter_row(filter, row, above, candidate);
      const long cost = cost_of(candidate);
      if (best_filter >= 0 && cost >= least) continue;
      best_filter = filter;
      least = cost;
      best.swap(candidate);
    }
    result.push_back(static_cast<unsigned char>(best_filter));
    result.insert(result.end(), best.begin(), best.end());
  }
  return result;
}

struct Part {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// The rectangle that differs; one pixel if nothing does, since no frame may be empty.
Part difference(const Image8& a, const Image8& b) {
  Part part{b.width, b.height, 0, 0};
  const int stride = kChannels * b.width;
  for (int y = 0; y < b.height; ++y) {
    const std::uint8_t *row_a = &a.at(0, y), *row_b = &b.at(0, y);
    if (std::equal(row_b, row_b + stride, row_a)) continue;
    part.y0 = std::min(part.y0, y);
    part.y1 = y + 1;
    int left = 0, right = stride - 1;
    while (row_a[left] == row_b[left]) ++left;
    while (row_a[right] == row_b[right]) --right;
    part.x0 = std::min(part.x0, left / kChannels);
    part.x1 = std::max(part.x1, right / kChannels + 1);
  }
  return part.y1 == 0 ? Part{0, 0, 1, 1} : part;
}

Image8 cut(const Image8& whole, const Part& part) {
  Image8 image(part.x1 - part.x0, part.y1 - part.y0, kChannels);
  for (int y = 0; y < image.height; ++y)
    std::copy_n(&whole.at(part.x0, part.y0 + y), kChannels * image.width, &image.at(0, y));
  return image;
}

}  // namespace

ApngWriter::ApngWriter(
    std::ostream& out, int width, int height, int frames, int frames_per_second, ApngStores stores)
    : out_(out),
      width_(width),
      height_(height),
      frames_(frames),
      frames_per_second_(frames_per_second),
      stores_(stores) {
  assert(width > 0 && height > 0 && frames > 0 && frames_per_second > 0);
  write(out_, png_start(width, height, 8, PngColor::rgb));
  PngBytes control;
  append_32(control, static_cast<std::uint32_t>(frames));
  append_32(control, 0);  // loop forever
  write_chunk(out_, "acTL", control);
}

void ApngWriter::add(const Image8& image) {
  assert(image.width == width_ && image.height == height_ && image.channels == kChannels);
  assert(added_ < frames_);
  const bool parts = stores_ == ApngStores::difference && added_ > 0;
  const Part part = parts ? difference(before_, image) : Part{0, 0, width_, height_};
  PngBytes control;
  append_32(control, sequence_++);
  for (const int value : {part.x1 - part.x0, part.y1 - part.y0, part.x0, part.y0})
    append_32(control, static_cast<std::uint32_t>(value));
  append_16(control, 1);  // shown for 1 / frames_per_second s
  append_16(control, frames_per_second_);
  append_16(control, 0);  // dispose and blend: draw over the previous frame
  write_chunk(out_, "fcTL", control);
  const PngBytes pixels =
      deflated(parts ? filtered_rows(cut(image, part)) : filtered_rows(image), kSmallLevel);
  if (stores_ == ApngStores::difference) before_ = image;
  if (added_++ == 0) return write_chunk(out_, "IDAT", pixels);
  PngBytes content;
  append_32(content, sequence_++);
  content.insert(content.end(), pixels.begin(), pixels.end());
  write_chunk(out_, "fdAT", content);
}

void ApngWriter::finish() {
  assert(added_ == frames_);
  write_chunk(out_, "IEND", {});
}

}  // namespace planescope::io
