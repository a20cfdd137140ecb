// Its chunks acTL, fcTL and fdAT make an animation of a PNG.

#include "core/io/image/apng.hpp"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "core/io/image/png.hpp"

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

struct Part {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// What differs; one pixel where nothing does, as no frame may be empty.
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
  Bytes control;
  append_32(control, static_cast<std::uint32_t>(frames));
  append_32(control, 0);  // again and again
  write_chunk(out_, "acTL", control);
}

void ApngWriter::add(const Image8& image) {
  assert(image.width == width_ && image.height == height_ && image.channels == kChannels);
  assert(added_ < frames_);
  const bool parts = stores_ == ApngStores::difference && added_ > 0;
  const Part part = parts ? difference(before_, image) : Part{0, 0, width_, height_};
  Bytes control;
  append_32(control, sequence_++);
  for (const int value : {part.x1 - part.x0, part.y1 - part.y0, part.x0, part.y0})
    append_32(control, static_cast<std::uint32_t>(value));
  append_16(control, 1);  // shown for 1 / frames_per_second s
  append_16(control, frames_per_second_);
  append_16(control, 0);  // left as it is, and drawn over
  write_chunk(out_, "fcTL", control);
  const Bytes pixels =
      deflated(parts ? filtered_rows(cut(image, part)) : filtered_rows(image), kSmallLevel);
  if (stores_ == ApngStores::difference) before_ = image;
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
