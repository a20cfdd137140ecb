// JPEG through libjpeg, WebP through libwebp. jpeglib.h needs stdio's FILE, which fmt/format.h
// includes before it.

#include "core/io/image/photo.hpp"

#include <fmt/format.h>
#include <jerror.h>
#include <jpeglib.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <cassert>
#include <csetjmp>
#include <cstdio>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

/// libjpeg's state. Its errors longjmp, so the steps below hold only trivial values.
struct JpegDecoder {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jmp_buf jump{};
  const unsigned char* bytes = nullptr;
  std::size_t size = 0;
  unsigned char* pixels = nullptr;
  char message[JMSG_LENGTH_MAX] = "";

  ~JpegDecoder() { jpeg_destroy_decompress(&jpeg); }
};

void on_error(j_common_ptr jpeg) {
  auto* decoder = static_cast<JpegDecoder*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, decoder->message);
  longjmp(decoder->jump, 1);
}

// libjpeg only warns about a truncated file and fills the rest with gray; treat that as an error.
// Stray bytes between markers, which some cameras write, are harmless.
void on_message(j_common_ptr jpeg, int level) {
  if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA) on_error(jpeg);
}

bool read_jpeg_header(JpegDecoder& decoder) {
  if (setjmp(decoder.jump)) return false;
  jpeg_create_decompress(&decoder.jpeg);
  decoder.jpeg.client_data = &decoder;
  jpeg_mem_src(&decoder.jpeg, decoder.bytes, decoder.size);
  jpeg_read_header(&decoder.jpeg, TRUE);
  decoder.jpeg.out_color_space = JCS_RGB;
  return true;
}

bool read_jpeg_rows(JpegDecoder& decoder) {
  if (setjmp(decoder.jump)) return false;
  jpeg_start_decompress(&decoder.jpeg);
  const std::size_t row_bytes = std::size_t{3} * decoder.jpeg.output_width;
  while (decoder.jpeg.output_scanline < decoder.jpeg.output_height) {
    JSAMPROW row = decoder.pixels + row_bytes * decoder.jpeg.output_scanline;
    jpeg_read_scanlines(&decoder.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&decoder.jpeg);
  return true;
}

}  // namespace

Image8 decode_jpeg_rgb(std::span<const unsigned char> bytes, const std::string& name) {
  JpegDecoder decoder;
  decoder.bytes = bytes.data();
  decoder.size = bytes.size();
  decoder.jpeg.err = jpeg_std_error(&decoder.errors);
  decoder.jpeg.client_data = &decoder;
  decoder.errors.error_exit = on_error;
  decoder.errors.emit_message = on_message;
  const auto fail = [&] { throw Error(name + ": not a readable JPEG (" + decoder.message + ")"); };
  if (bytes.empty() || !read_jpeg_header(decoder)) fail();
  // A JPEG block of 64 pixels takes at least a few bits: an image far larger than its file allows
  // is damaged, and is rejected before it is allocated.
  const std::uint64_t pixels = std::uint64_t(decoder.jpeg.image_width) * decoder.jpeg.image_height;
  if (pixels > bytes.size() * std::uint64_t{4096})
    throw Error(fmt::format("{}: declares {}x{} pixels, more than its {} bytes can contain", name,
                            decoder.jpeg.image_width, decoder.jpeg.image_height, bytes.size()));
  expect_within_read_limit(3.0 * static_cast<double>(pixels), name + ": its pixels");
  Image8 image(static_cast<int>(decoder.jpeg.image_width),
               static_cast<int>(decoder.jpeg.image_height), 3);
  decoder.pixels = image.data.data();
  if (!read_jpeg_rows(decoder)) fail();
  return image;
}

Image8 read_jpeg_rgb(const std::filesystem::path& path) {
  return decode_jpeg_rgb(read_file_bytes(path), path.string());
}

std::vector<unsigned char> encode_webp(const Image8& image, float quality) {
  assert(image.channels == 3 && !image.empty());
  constexpr int kQuick = 2;  // of 0 to 6: 4, the default, takes twice the time for 3 % fewer bytes
  struct Encoder {
    WebPConfig config{};
    WebPPicture picture{};
    WebPMemoryWriter writer{};
    Encoder() { WebPMemoryWriterInit(&writer); }
    ~Encoder() {
      WebPPictureFree(&picture);
      WebPMemoryWriterClear(&writer);
    }
  } encoder;
  WebPPicture& picture = encoder.picture;
  bool fine = WebPConfigInit(&encoder.config) && WebPPictureInit(&picture);
  encoder.config.quality = quality;
  encoder.config.method = kQuick;
  picture.width = image.width;
  picture.height = image.height;
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &encoder.writer;
  fine = fine && WebPPictureImportRGB(&picture, image.data.data(), 3 * image.width) &&
         WebPEncode(&encoder.config, &picture);
  if (!fine && picture.error_code == VP8_ENC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!fine)
    throw Error(fmt::format("a {}x{} picture cannot be written as WebP (error {})", image.width,
                            image.height, static_cast<int>(picture.error_code)));
  return {encoder.writer.mem, encoder.writer.mem + encoder.writer.size};
}

Image8 read_webp_rgb(const std::filesystem::path& path) {
  const auto bytes = read_file_bytes(path);
  int width = 0, height = 0;
  if (!WebPGetInfo(bytes.data(), bytes.size(), &width, &height))
    throw Error(path.string() + ": not a readable WebP");
  expect_within_read_limit(3.0 * width * height, path.string() + ": its pixels");
  Image8 image(width, height, 3);
  if (!WebPDecodeRGBInto(bytes.data(), bytes.size(), image.data.data(), image.data.size(),
                         3 * width))
    throw Error(path.string() + ": not a readable WebP");
  return image;
}

}  // namespace planescope::io
