#include "core/io/image/webp.hpp"

#include <fmt/format.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <cassert>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/read_limit.hpp"

namespace planescope::io {

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
    throw Error(fmt::format("a picture of {}x{} pixels cannot be written as WebP (error {})",
                            image.width, image.height, static_cast<int>(picture.error_code)));
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
