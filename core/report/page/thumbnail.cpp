#include "core/report/page/thumbnail.hpp"

// jpeglib.h needs size_t and FILE declared before it.
#include <jpeglib.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

namespace planescope::report {
namespace {

/// Source pixels from `first` on that a target pixel covers, and how much of it each is.
struct Span {
  int first = 0;
  std::vector<double> shares;  // their sum is 1
};
std::vector<Span> spans(int source, int target) {
  std::vector<Span> result;
  const double scale = static_cast<double>(source) / target;
  for (int i = 0; i < target; ++i) {
    const double begin = i * scale, end = (i + 1) * scale;
    Span span;
    span.first = static_cast<int>(std::floor(begin));
    const int last = std::min(source, static_cast<int>(std::ceil(end - 1e-9)));
    for (int pixel = span.first; pixel < last; ++pixel)
      span.shares.push_back((std::min(end, pixel + 1.0) - std::max(begin, double(pixel))) / scale);
    result.push_back(span);
  }
  return result;
}

/// sums += share * row, shrunk to `columns`.
void add_row(const std::uint8_t* row,
             int channels,
             const std::vector<Span>& columns,
             double share,
             std::vector<double>& sums) {
  double* sum = sums.data();
  for (const Span& column : columns) {
    const std::uint8_t* pixel = row + column.first * channels;
    for (const double part : column.shares)
      for (int c = 0; c < channels; ++c) sum[c] += share * part * *pixel++;
    sum += channels;
  }
}

}  // namespace

Image8 shrink(const Image8& image, int max_width) {
  if (image.width <= max_width) return image;
  const int height =
      std::max(1, static_cast<int>(std::lround(double(image.height) * max_width / image.width)));
  Image8 small(max_width, height, image.channels);
  const std::vector<Span> columns = spans(image.width, max_width);
  const std::vector<Span> rows = spans(image.height, height);
  std::vector<double> sums(static_cast<std::size_t>(max_width) * image.channels);
  for (int y = 0; y < height; ++y) {
    std::ranges::fill(sums, 0);
    int row = rows[y].first;
    for (const double share : rows[y].shares)
      add_row(&image.at(0, row++), image.channels, columns, share, sums);
    std::ranges::transform(sums, &small.at(0, y), [](double sum) {
      return static_cast<std::uint8_t>(std::min(sum + 0.5, 255.0));
    });
  }
  return small;
}

std::vector<unsigned char> encode_jpeg(const Image8& image, int quality) {
  assert(image.channels == 3 && !image.empty());
  jpeg_compress_struct encoder;
  jpeg_error_mgr errors;
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&encoder, &buffer, &size);
  encoder.image_width = static_cast<JDIMENSION>(image.width);
  encoder.image_height = static_cast<JDIMENSION>(image.height);
  encoder.input_components = 3;
  encoder.in_color_space = JCS_RGB;
  jpeg_set_defaults(&encoder);
  jpeg_set_quality(&encoder, quality, TRUE);
  encoder.comp_info[0].h_samp_factor = encoder.comp_info[0].v_samp_factor = 1;
  encoder.optimize_coding = TRUE;
  jpeg_start_compress(&encoder, TRUE);
  const std::size_t stride = static_cast<std::size_t>(image.width) * 3;
  while (encoder.next_scanline < encoder.image_height) {
    auto* row = const_cast<JSAMPROW>(image.data.data() + encoder.next_scanline * stride);
    jpeg_write_scanlines(&encoder, &row, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  std::vector<unsigned char> bytes(buffer, buffer + size);
  std::free(buffer);
  return bytes;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < left ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= left ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace planescope::report
