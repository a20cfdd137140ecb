// PNG, third edition (W3C 2025), with its chunks acTL, fcTL and fdAT.

#include "core/io/image/apng.hpp"

#include <zlib.h>

#include <array>
#include <cassert>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "core/model/error.hpp"

namespace planescope::io {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr int kChannels = 3;
constexpr int kLevel = 6;
constexpr int kFilters = 5;  // none, sub, up, average, Paeth

void append_32(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<unsigned char>(value >> shift));
}
void append_16(Bytes& bytes, int value) {
  bytes.push_back(static_cast<unsigned char>(value >> 8));
  bytes.push_back(static_cast<unsigned char>(value));
}

void write(std::ostream& out, const Bytes& bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

void write_chunk(std::ostream& out, std::string_view type, const Bytes& content) {
  Bytes chunk;
  append_32(chunk, static_cast<std::uint32_t>(content.size()));
  chunk.insert(chunk.end(), type.begin(), type.end());
  chunk.insert(chunk.end(), content.begin(), content.end());
  append_32(chunk, static_cast<std::uint32_t>(crc32_z(0, chunk.data() + 4, chunk.size() - 4)));
  write(out, chunk);
}

int paeth(int left, int up, int corner) {
  const int guess = left + up - corner;
  const int by_left = std::abs(guess - left), by_up = std::abs(guess - up);
  const int by_corner = std::abs(guess - corner);
  if (by_left <= by_up && by_left <= by_corner) return left;
  return by_up <= by_corner ? up : corner;
}

/// A row as it differs from what the filter foretells.
void filter_row(int filter,
                std::span<const unsigned char> row,
                std::span<const unsigned char> above,  // empty: there is none
                std::span<unsigned char> filtered) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int left = i >= kChannels ? row[i - kChannels] : 0;
    const int up = above.empty() ? 0 : above[i];
    const int corner = i >= kChannels && !above.empty() ? above[i - kChannels] : 0;
    const std::array<int, kFilters> foretold = {0, left, up, (left + up) / 2,
                                                paeth(left, up, corner)};
    filtered[i] = static_cast<unsigned char>(row[i] - foretold[static_cast<std::size_t>(filter)]);
  }
}

/// Sum of a filtered row's bytes as distances from 0: what usually is small compresses well.
long cost_of(std::span<const unsigned char> filtered) {
  long cost = 0;
  for (const unsigned char byte : filtered) cost += std::min<int>(byte, 256 - byte);
  return cost;
}

Bytes filtered_rows(const Image8& image) {
  const std::size_t stride = static_cast<std::size_t>(image.width) * kChannels;
  Bytes result;
  Bytes candidate(stride), best(stride);
  for (int y = 0; y < image.height; ++y) {
    const std::span row(image.data.data() + y * stride, stride);
    const std::span above = y > 0 ? std::span(row.data() - stride, stride) : row.first(0);
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

Bytes compressed(const Bytes& bytes) {
  uLongf size = compressBound(bytes.size());
  Bytes result(size);
  if (compress2(result.data(), &size, bytes.data(), bytes.size(), kLevel) != Z_OK)
    throw Error("an animation's frame cannot be compressed: out of memory");
  result.resize(size);
  return result;
}

}  // namespace

ApngWriter::ApngWriter(std::ostream& out, int width, int height, int frames, int frames_per_second)
    : out_(out),
      width_(width),
      height_(height),
      frames_(frames),
      frames_per_second_(frames_per_second) {
  assert(width > 0 && height > 0 && frames > 0 && frames_per_second > 0);
  write(out_, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'});
  Bytes header;
  append_32(header, static_cast<std::uint32_t>(width));
  append_32(header, static_cast<std::uint32_t>(height));
  for (const int value : {8, 2, 0, 0, 0})  // bits, RGB, the only compression and filters, no Adam7
    header.push_back(static_cast<unsigned char>(value));
  write_chunk(out_, "IHDR", header);
  Bytes control;
  append_32(control, static_cast<std::uint32_t>(frames));
  append_32(control, 0);  // again and again
  write_chunk(out_, "acTL", control);
}

void ApngWriter::add(const Image8& image) {
  assert(image.width == width_ && image.height == height_ && image.channels == kChannels);
  assert(added_ < frames_);
  Bytes control;
  append_32(control, sequence_++);
  append_32(control, static_cast<std::uint32_t>(width_));
  append_32(control, static_cast<std::uint32_t>(height_));
  append_32(control, 0);  // place in the canvas
  append_32(control, 0);
  append_16(control, 1);  // shown for 1 / frames_per_second s
  append_16(control, frames_per_second_);
  append_16(control, 0);  // left as it is, and drawn over
  write_chunk(out_, "fcTL", control);
  const Bytes pixels = compressed(filtered_rows(image));
  if (added_++ == 0) return write_chunk(out_, "IDAT", pixels);
  Bytes content;
  append_32(content, sequence_++);
  content.insert(content.end(), pixels.begin(), pixels.end());
  write_chunk(out_, "fdAT", content);
}

void ApngWriter::finish() {
  assert(added_ == frames_);
  write_chunk(out_, "IEND", {});
}

}  // namespace planescope::io
