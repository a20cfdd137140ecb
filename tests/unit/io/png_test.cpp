#include "core/io/image/png.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

std::filesystem::path temp_file(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / name;
}

template <typename T>
Image<T> noise_image(int width, int height, int channels, unsigned seed) {
  Image<T> image(width, height, channels);
  std::mt19937 random(seed);
  for (T& value : image.data) value = static_cast<T>(random());
  return image;
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Rewrites the size in a PNG's header, checksum included.
void forge_size(std::vector<unsigned char>& png, std::uint32_t width, std::uint32_t height) {
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) png[at + i] = static_cast<unsigned char>(value >> (24 - 8 * i));
  };
  put(16, width);
  put(20, height);
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = 12; i < 29; ++i) {
    crc ^= png[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0);
  }
  put(29, ~crc);
}

TEST(Png, SixteenBitDepthComesBackAsWritten) {
  const auto image = noise_image<std::uint16_t>(37, 23, 1, 1);
  const auto path = temp_file("depth16.png");
  write_png(path, image);
  EXPECT_EQ(read_png_16(path).data, image.data);
  const PngInfo info = png_info(path);
  EXPECT_EQ(info.width, 37);
  EXPECT_EQ(info.height, 23);
  EXPECT_EQ(info.channels, 1);
  EXPECT_EQ(info.bit_depth, 16);
}

TEST(Png, EightBitImagesComeBackAsWritten) {
  const auto grey = noise_image<std::uint8_t>(19, 5, 1, 2);
  const auto rgb = noise_image<std::uint8_t>(19, 5, 3, 3);
  write_png(temp_file("grey.png"), grey);
  write_png(temp_file("rgb.png"), rgb);
  EXPECT_EQ(read_png_grey(temp_file("grey.png")).data, grey.data);
  EXPECT_EQ(read_png_rgb(temp_file("rgb.png")).data, rgb.data);
}

TEST(Png, AnyKindOfColourBecomesRgb) {
  const auto rgba = noise_image<std::uint8_t>(7, 4, 4, 4);
  write_png(temp_file("rgba.png"), rgba);
  const Image8 rgb = read_png_rgb(temp_file("rgba.png"));
  ASSERT_EQ(rgb.channels, 3);
  EXPECT_EQ(rgb.at(6, 3, 1), rgba.at(6, 3, 1));

  const auto grey16 = noise_image<std::uint16_t>(7, 4, 1, 5);
  write_png(temp_file("grey16.png"), grey16);
  const Image8 from_grey = read_png_rgb(temp_file("grey16.png"));
  EXPECT_NEAR(from_grey.at(2, 2, 2), grey16.at(2, 2) / 257.0, 0.51);
}

TEST(Png, TheSameImageGivesTheSameBytes) {
  const auto image = noise_image<std::uint8_t>(64, 48, 3, 6);
  EXPECT_EQ(encode_png(image), encode_png(image));
}

TEST(Png, WrongBitsOrChannelsAreNamed) {
  const auto path = temp_file("eight.png");
  write_png(path, noise_image<std::uint8_t>(4, 4, 1, 7));
  const std::string eight = error_of([&] { read_png_16(path); });
  EXPECT_NE(eight.find("eight.png"), std::string::npos) << eight;
  EXPECT_NE(eight.find("8 bits"), std::string::npos) << eight;
  write_png(path, noise_image<std::uint8_t>(4, 4, 3, 8));
  const std::string three = error_of([&] { read_png_16(path); });
  EXPECT_NE(three.find("3 channel(s)"), std::string::npos) << three;
}

TEST(Png, AFileCutAnywhereIsAnError) {
  const auto bytes = encode_png(noise_image<std::uint16_t>(40, 30, 1, 9));
  const auto path = temp_file("cut.png");
  for (std::size_t cut = 0; cut < bytes.size(); cut += cut < 64 ? 1 : 37) {
    std::filesystem::remove(path);
    write_file_bytes(path, std::span(bytes).first(cut));
    EXPECT_NE(error_of([&] { read_png_16(path); }), "") << "cut at byte " << cut;
  }
}

TEST(Png, ATinyFileThatPromisesAHugeImageIsRefusedBeforeAllocation) {
  auto bytes = encode_png(noise_image<std::uint16_t>(16, 12, 1, 12));
  forge_size(bytes, 30000, 30000);
  write_file_bytes(temp_file("huge.png"), bytes);
  const std::string message = error_of([&] { read_png_16(temp_file("huge.png")); });
  EXPECT_NE(message.find("30000x30000"), std::string::npos) << message;
}

TEST(Png, DamagedBytesNeverCrash) {
  const auto good = encode_png(noise_image<std::uint16_t>(16, 12, 1, 10));
  const auto path = temp_file("damaged.png");
  std::mt19937 random(11);
  for (int trial = 0; trial < 500; ++trial) {
    auto bytes = good;
    for (int flips = 0; flips < 4; ++flips) {
      bytes[random() % bytes.size()] = static_cast<unsigned char>(random());
    }
    std::filesystem::remove(path);
    write_file_bytes(path, bytes);
    error_of([&] { read_png_16(path); });
    error_of([&] { read_png_rgb(path); });
  }
}

TEST(Png, MissingFilesAndUnwritablePathsAreNamed) {
  const std::string missing = error_of([&] { read_png_16(temp_file("not_there.png")); });
  EXPECT_NE(missing.find("not_there.png"), std::string::npos);
  const auto unwritable = temp_file("no_such_folder") / "x.png";
  EXPECT_NE(error_of([&] { write_png(unwritable, Image16(2, 2)); }), "");
}

}  // namespace
}  // namespace planescope::io
