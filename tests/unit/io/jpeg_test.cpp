#include "core/io/image/jpeg.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <random>
// jpeglib.h needs stdio's FILE and must come after it.
#include <jpeglib.h>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

std::vector<unsigned char> encode_jpeg(int width, int height, bool color) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = color ? 3 : 1;
  jpeg.in_color_space = color ? JCS_RGB : JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 95, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<unsigned char> row(static_cast<std::size_t>(width) * jpeg.input_components);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < jpeg.input_components; ++c) {
        row[x * jpeg.input_components + c] = c == 0 ? 200 : c == 1 ? 100 : 30;
      }
    }
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::vector<unsigned char> out(buffer, buffer + size);
  std::free(buffer);
  return out;
}

const std::filesystem::path kPath = std::filesystem::path(testing::TempDir()) / "image.jpg";

TEST(Jpeg, ColourIsReadAsRgb) {
  write_file_bytes(kPath, encode_jpeg(50, 20, true));
  const Image8 image = read_jpeg_rgb(kPath);
  ASSERT_EQ(image.width, 50);
  ASSERT_EQ(image.height, 20);
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.at(25, 10, 0), 200, 3);
  EXPECT_NEAR(image.at(25, 10, 1), 100, 3);
  EXPECT_NEAR(image.at(25, 10, 2), 30, 3);
}

TEST(Jpeg, GreyBecomesRgb) {
  write_file_bytes(kPath, encode_jpeg(16, 16, false));
  const Image8 image = read_jpeg_rgb(kPath);
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.at(8, 8, 2), 200, 3);
}

TEST(Jpeg, AFileCutShortIsAnError) {
  const auto bytes = encode_jpeg(200, 200, true);
  for (std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{30}, bytes.size() / 2}) {
    std::filesystem::remove(kPath);
    write_file_bytes(kPath, std::span(bytes).first(cut));
    EXPECT_THROW(read_jpeg_rgb(kPath), Error) << "cut at byte " << cut;
  }
}

TEST(Jpeg, DamagedBytesNeverCrash) {
  const auto good = encode_jpeg(40, 30, true);
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    auto bytes = good;
    bytes[random() % bytes.size()] = static_cast<unsigned char>(random());
    std::filesystem::remove(kPath);
    write_file_bytes(kPath, bytes);
    try {
      read_jpeg_rgb(kPath);
    } catch (const Error&) {
      // Damage may well be noticed; it only must not crash.
    }
  }
}

}  // namespace
}  // namespace planescope::io
