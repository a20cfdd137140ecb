// Its chunks acTL, fcTL and fdAT make an animation of a PNG.

#include "core/io/image/apng.hpp"

#include <cassert>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "core/io/image/png_chunks.hpp"

namespace planescope::io {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr int kChannels = 3;
constexpr int kSmallLevel = 6;

void write(std::ostream& out, const Bytes& bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

void write_chunk(std::ostream& out, std::string_view type, const Bytes& content) {
  Bytes chunk;
  append_chunk(chunk, type, content);
  write(out, chunk);
}

/// A row as it differs from what the filter foretells. `above`: zeros where there is none.
template <typename Foretell>
void filter_by(const unsigned char* row,
               const unsigned char* above,
               std::span<unsigned char> filtered,
               const Foretell& foretell) {
  const auto set = [&](std::size_t i, int left, int corner) {
    filtered[i] = static_cast<unsigned char>(row[i] - foretell(left, above[i], corner));
  };
  for (std::size_t i = 0; i < kChannels; ++i) set(i, 0, 0);
  for (std::size_t i = kChannels; i < filtered.size(); ++i)
    set(i, row[i - kChannels], above[i - kChannels]);
}

void filter_row(int filter,
                const unsigned char* row,
                const unsigned char* above,
                std::span<unsigned char> filtered) {
  switch (filter) {
    case kNone:
      return filter_by(row, above, filtered, [](int, int, int) { return 0; });
    case kSub:
      return filter_by(row, above, filtered, [](int left, int, int) { return left; });
    case kUp:
      return filter_by(row, above, filtered, [](int, int up, int) { return up; });
    case kAverage:
      return filter_by(row, above, filtered, [](int left, int up, int) { return (left + up) / 2; });
    default:
      return filter_by(row, above, filtered, paeth);
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
  const Bytes nothing(stride, 0);
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

}  // namespace

ApngWriter::ApngWriter(std::ostream& out, int width, int height, int frames, int frames_per_second)
    : out_(out),
      width_(width),
      height_(height),
      frames_(frames),
      frames_per_second_(frames_per_second) {
  assert(width > 0 && height > 0 && frames > 0 && frames_per_second > 0);
  write(out_, png_start(width, height, 8, PngColor::rgb));
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
  const Bytes pixels = deflated(filtered_rows(image), kSmallLevel);
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
