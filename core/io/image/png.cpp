// PNG: uses libpng to decode files that png_rows.cpp does not support, and libdeflate to write.

#include "core/io/image/png.hpp"

#include <fmt/format.h>
#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

constexpr std::uint32_t kMaxSide = 1 << 15;
constexpr std::size_t kSignatureBytes = 8;
constexpr std::size_t kHeaderBytes = 33;  // signature and IHDR chunk
// Deflate never compresses better than 1032:1, so a small file cannot request a large image.
constexpr std::uint64_t kMaxDeflateRatio = 1040;

/// libpng's state. Its errors longjmp: nothing with a destructor may be in a frame that a jump
/// leaves, so this struct owns everything and the steps below hold only trivial values.
struct Decoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  const unsigned char* next = nullptr;
  std::size_t left = 0;
  png_bytep* rows = nullptr;
  bool to_rgb = false;
  char message[160] = "";

  ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
};

void on_error(png_structp png, png_const_charp text) {
  auto* decoder = static_cast<Decoder*>(png_get_error_ptr(png));
  std::strncpy(decoder->message, text, sizeof(decoder->message) - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, png_size_t count) {
  auto* decoder = static_cast<Decoder*>(png_get_io_ptr(png));
  if (count > decoder->left) png_error(png, "the file ends early");
  std::memcpy(out, decoder->next, count);
  decoder->next += count;
  decoder->left -= count;
}

bool guarded(Decoder& decoder, void (*step)(Decoder&)) {
  if (setjmp(png_jmpbuf(decoder.png))) return false;
  step(decoder);
  return true;
}

void read_header(Decoder& decoder) {
  png_set_user_limits(decoder.png, kMaxSide, kMaxSide);
  png_set_chunk_malloc_max(decoder.png, 1 << 20);
  png_read_info(decoder.png, decoder.info);
}

void set_transforms(Decoder& decoder) {
  if (!decoder.to_rgb) {
    png_set_swap(decoder.png);
  } else {
    png_set_expand(decoder.png);
    png_set_scale_16(decoder.png);
    png_set_strip_alpha(decoder.png);
    png_set_gray_to_rgb(decoder.png);
  }
  png_set_interlace_handling(decoder.png);
  png_read_update_info(decoder.png, decoder.info);
}

void read_rows(Decoder& decoder) {
  png_read_image(decoder.png, decoder.rows);
  png_read_end(decoder.png, nullptr);
}

void require_signature(std::span<const unsigned char> bytes, const std::filesystem::path& path) {
  if (bytes.size() >= kSignatureBytes && png_sig_cmp(bytes.data(), 0, kSignatureBytes) == 0) return;
  throw Error(path.string() + ": not a PNG (" +
              (bytes.empty() ? "the file is empty" : "it does not start with the PNG signature") +
              ")");
}

int channels_of(int color_type) {
  switch (color_type) {
    case PNG_COLOR_TYPE_GRAY:
      return 1;
    case PNG_COLOR_TYPE_GRAY_ALPHA:
      return 2;
    case PNG_COLOR_TYPE_RGB_ALPHA:
      return 4;
    default:
      return 3;  // RGB, or a palette of it
  }
}

[[noreturn]] void fail(const std::filesystem::path& path, const Decoder& decoder) {
  throw Error(path.string() + ": not a readable PNG (" + decoder.message + ")");
}

/// Throws Error if the bytes do not start as a PNG or the header is damaged.
PngInfo open(Decoder& decoder,
             std::span<const unsigned char> bytes,
             const std::filesystem::path& path) {
  require_signature(bytes, path);
  decoder.next = bytes.data();
  decoder.left = bytes.size();
  decoder.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder, on_error, on_warning);
  if (decoder.png) decoder.info = png_create_info_struct(decoder.png);
  if (!decoder.info) throw Error(path.string() + ": libpng could not be initialized");
  png_set_read_fn(decoder.png, &decoder, on_read);
  if (!guarded(decoder, read_header)) fail(path, decoder);
  return {static_cast<int>(png_get_image_width(decoder.png, decoder.info)),
          static_cast<int>(png_get_image_height(decoder.png, decoder.info)),
          channels_of(png_get_color_type(decoder.png, decoder.info)),
          png_get_bit_depth(decoder.png, decoder.info)};
}

/// Converts between memory order and PNG order, which has the high byte of 16 bits first.
void swap_order(std::span<std::uint16_t> values) {
  for (std::uint16_t& value : values) value = static_cast<std::uint16_t>(value << 8 | value >> 8);
}
void swap_order(std::span<std::uint8_t>) {}

/// `decoder` has read the header of `file`.
template <typename T>
Image<T> decode(Decoder& decoder,
                const PngInfo& info,
                std::span<const unsigned char> file,
                int channels,
                const std::filesystem::path& path) {
  const std::uint64_t packed_bits = std::uint64_t(info.width) * info.height * info.bit_depth;
  if (packed_bits / 8 > file.size() * kMaxDeflateRatio)
    throw Error(fmt::format("{}: declares {}x{} pixels, more than its {} bytes can contain",
                            path.string(), info.width, info.height, file.size()));
  expect_within_read_limit(static_cast<double>(info.width) * info.height * channels * sizeof(T),
                           path.string() + ": its pixels");
  Image<T> image(info.width, info.height, channels);
  const std::size_t row_bytes = sizeof(T) * info.width * channels;
  auto* const pixels = reinterpret_cast<unsigned char*>(image.data.data());
  if (info.channels == channels && info.bit_depth == 8 * static_cast<int>(sizeof(T)) &&
      unpack_plain_png(file, info, {pixels, row_bytes * info.height})) {
    swap_order(image.data);
    return image;
  }
  if (!guarded(decoder, set_transforms)) fail(path, decoder);
  if (png_get_rowbytes(decoder.png, decoder.info) != row_bytes) {
    throw Error(path.string() + ": PNG with an unexpected pixel layout");
  }
  std::vector<png_bytep> rows(info.height);
  for (int y = 0; y < info.height; ++y) {
    rows[y] = pixels + y * row_bytes;
  }
  decoder.rows = rows.data();
  if (!guarded(decoder, read_rows)) fail(path, decoder);
  return image;
}

template <typename T>
Image<T> decode_grey(std::span<const unsigned char> bytes, const std::filesystem::path& path) {
  Decoder decoder;
  const PngInfo info = open(decoder, bytes, path);
  const int bits = 8 * sizeof(T);
  if (info.channels != 1 || info.bit_depth != bits)
    throw Error(fmt::format("{}: {}-bit PNG with {}; expected a {}-bit PNG with one channel",
                            path.string(), info.bit_depth, counted(info.channels, "channel"),
                            bits));
  return decode<T>(decoder, info, bytes, 1, path);
}

}  // namespace

PngInfo png_info(const std::filesystem::path& path) {
  std::array<unsigned char, kHeaderBytes> head{};
  std::ifstream file = open_to_read(path);
  file.read(reinterpret_cast<char*>(head.data()), head.size());
  if (std::memcmp(head.data(), "version ", 8) == 0) read_file_bytes(path);  // Git LFS pointer
  return png_info(std::span(head).first(static_cast<std::size_t>(file.gcount())), path.string());
}

PngInfo png_info(std::span<const unsigned char> head, const std::string& name) {
  require_signature(head, name);
  if (head.size() < kHeaderBytes || std::memcmp(&head[12], "IHDR", 4) != 0) {
    throw Error(name + ": not a readable PNG (its header is truncated or damaged)");
  }
  const std::uint32_t width = number_32(&head[16]), height = number_32(&head[20]);
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide)
    throw Error(fmt::format("{}: {}x{} PNG; expected 1 to {} pixels per side", name, width, height,
                            kMaxSide));
  return {static_cast<int>(width), static_cast<int>(height), channels_of(head[25]), head[24]};
}

bool png_is_cut(const std::filesystem::path& path) {
  constexpr std::streamoff kEndBytes = 12;  // length, "IEND", checksum
  std::array<char, kEndBytes> tail{};
  std::ifstream file = open_to_read(path);
  if (file.seekg(0, std::ios::end) && file.tellg() >= kEndBytes) {
    file.seekg(-kEndBytes, std::ios::end);
    file.read(tail.data(), kEndBytes);
    if (std::memcmp(&tail[4], "IEND", 4) == 0) return false;
  }
  // Some writers append data after the end: only decoding shows whether the file is complete.
  const auto bytes = read_file_bytes(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.rfind("IEND") == std::string_view::npos;
}

Image16 read_png_16(const std::filesystem::path& path) {
  return decode_grey<std::uint16_t>(read_file_bytes(path), path);
}
Image8 read_png_grey(const std::filesystem::path& path) {
  return decode_grey<std::uint8_t>(read_file_bytes(path), path);
}
Image16 decode_png_16(std::span<const unsigned char> bytes, const std::string& name) {
  return decode_grey<std::uint16_t>(bytes, name);
}

Image8 decode_png_rgb(std::span<const unsigned char> bytes, const std::string& name) {
  Decoder decoder;
  const PngInfo info = open(decoder, bytes, name);
  decoder.to_rgb = true;
  return decode<std::uint8_t>(decoder, info, bytes, 3, name);
}
Image8 read_png_rgb(const std::filesystem::path& path) {
  return decode_png_rgb(read_file_bytes(path), path.string());
}

std::uint32_t number_32(const unsigned char* at) {
  return std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 |
         at[3];
}

void append_32(PngBytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<unsigned char>(value >> shift));
}

void append_16(PngBytes& bytes, int value) {
  bytes.push_back(static_cast<unsigned char>(value >> 8));
  bytes.push_back(static_cast<unsigned char>(value));
}

PngBytes png_start(int width, int height, int bits, PngColor color) {
  PngBytes header;
  append_32(header, static_cast<std::uint32_t>(width));
  append_32(header, static_cast<std::uint32_t>(height));
  header.push_back(static_cast<unsigned char>(bits));
  header.push_back(static_cast<unsigned char>(color));
  header.insert(header.end(), {0, 0, 0});  // default methods, no interlacing
  PngBytes out = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(out, "IHDR", header);
  return out;
}

void append_chunk(PngBytes& out, std::string_view type, std::span<const unsigned char> content) {
  append_32(out, static_cast<std::uint32_t>(content.size()));
  const std::size_t checked = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), content.begin(), content.end());
  append_32(out, libdeflate_crc32(0, out.data() + checked, out.size() - checked));
}

PngBytes deflated(std::span<const unsigned char> bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  PngBytes out(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  out.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.data(),
                                      out.size()));
  return out;
}

namespace {

constexpr int kQuickLevel = 1;  // files are only slightly larger

template <typename T>
std::vector<unsigned char> encode(const Image<T>& image) {
  const int channels = image.channels;
  assert(!image.empty());
  assert(channels == 1 || (sizeof(T) == 1 && (channels == 3 || channels == 4)));
  const std::size_t pixel_bytes = sizeof(T) * static_cast<std::size_t>(channels);
  const std::size_t row_bytes = pixel_bytes * static_cast<std::size_t>(image.width);
  std::vector<unsigned char> rows((row_bytes + 1) * static_cast<std::size_t>(image.height));
  const std::size_t row_values = row_bytes / sizeof(T);
  const auto channels_before = static_cast<std::size_t>(channels);
  std::vector<T> plain(channels_before + row_values);  // a row, preceded by a black pixel
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    const std::span row_of(plain.data() + channels_before, row_values);
    std::ranges::copy(std::span(image.data).subspan(y * row_values, row_values), row_of.begin());
    swap_order(row_of);
    unsigned char* row = rows.data() + y * (row_bytes + 1);
    *row++ = kSub;  // fast, and improves compression
    const auto* const before = reinterpret_cast<const unsigned char*>(plain.data());
    const unsigned char* const at = before + pixel_bytes;
    for (std::size_t i = 0; i < row_bytes; ++i)
      row[i] = static_cast<unsigned char>(at[i] - before[i]);
  }
  const PngColor color = channels == 1   ? PngColor::grey
                         : channels == 3 ? PngColor::rgb
                                         : PngColor::rgba;
  std::vector<unsigned char> out =
      png_start(image.width, image.height, 8 * static_cast<int>(sizeof(T)), color);
  append_chunk(out, "IDAT", deflated(rows, kQuickLevel));
  append_chunk(out, "IEND", {});
  return out;
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
