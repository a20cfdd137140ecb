#include <png.h>

#include <bit>
#include <cassert>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

/// See png.cpp: libpng's errors longjmp, so everything with a destructor lives outside the step.
struct Encoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  const unsigned char* pixels = nullptr;
  std::size_t row_bytes = 0;
  int width = 0, height = 0, bits = 0, color_type = 0;
  std::vector<unsigned char> out;
  bool out_of_memory = false;

  ~Encoder() { png_destroy_write_struct(&png, &info); }
};

void on_write_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void on_write_warning(png_structp, png_const_charp) {}
void on_flush(png_structp) {}

void on_write(png_structp png, png_bytep bytes, png_size_t count) {
  auto* encoder = static_cast<Encoder*>(png_get_io_ptr(png));
  try {
    encoder->out.insert(encoder->out.end(), bytes, bytes + count);
  } catch (const std::bad_alloc&) {
    encoder->out_of_memory = true;
  }
  if (encoder->out_of_memory) png_error(png, "out of memory");
}

bool write_all(Encoder& encoder) {
  if (setjmp(png_jmpbuf(encoder.png))) return false;
  png_set_write_fn(encoder.png, &encoder, on_write, on_flush);
  // Level 1 with one cheap filter: several times quicker than the defaults, little larger.
  png_set_compression_level(encoder.png, 1);
  png_set_filter(encoder.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_IHDR(encoder.png, encoder.info, static_cast<png_uint_32>(encoder.width),
               static_cast<png_uint_32>(encoder.height), encoder.bits, encoder.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(encoder.png, encoder.info);
  if (encoder.bits == 16 && std::endian::native == std::endian::little) png_set_swap(encoder.png);
  for (int y = 0; y < encoder.height; ++y) {
    png_write_row(encoder.png, encoder.pixels + y * encoder.row_bytes);
  }
  png_write_end(encoder.png, encoder.info);
  return true;
}

template <typename T>
std::vector<unsigned char> encode(const Image<T>& image) {
  assert(!image.empty());
  const int channels = image.channels;
  assert(channels == 1 || (sizeof(T) == 1 && (channels == 3 || channels == 4)));
  Encoder encoder;
  encoder.pixels = reinterpret_cast<const unsigned char*>(image.data.data());
  encoder.row_bytes = sizeof(T) * image.width * channels;
  encoder.width = image.width;
  encoder.height = image.height;
  encoder.bits = 8 * sizeof(T);
  encoder.color_type = channels == 1   ? PNG_COLOR_TYPE_GRAY
                       : channels == 3 ? PNG_COLOR_TYPE_RGB
                                       : PNG_COLOR_TYPE_RGB_ALPHA;
  encoder.png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_write_error, on_write_warning);
  if (encoder.png) encoder.info = png_create_info_struct(encoder.png);
  if (!encoder.info || !write_all(encoder)) {
    throw Error("an image of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                " pixels cannot be encoded as PNG");
  }
  return std::move(encoder.out);
}

}  // namespace

std::vector<unsigned char> encode_png(const Image8& image) { return encode(image); }
std::vector<unsigned char> encode_png(const Image16& image) { return encode(image); }

void write_png(const std::filesystem::path& path, const Image16& image) {
  write_file_bytes(path, encode(image));
}
void write_png(const std::filesystem::path& path, const Image8& image) {
  write_file_bytes(path, encode(image));
}

}  // namespace planescope::io
