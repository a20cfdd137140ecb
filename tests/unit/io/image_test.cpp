// Tests of PNG, JPEG, WebP and APNG images, intact and damaged.

#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "support/apng.hpp"
#include "support/jpeg_bytes.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

std::filesystem::path temp_file(const std::string& name) { return temp_dir() / name; }

template <typename T>
Image<T> noise_image(int width, int height, int channels, unsigned seed) {
  Image<T> image(width, height, channels);
  std::mt19937 random(seed);
  for (T& value : image.data) value = static_cast<T>(random());
  return image;
}

/// Changes the size in a PNG's header, including its checksum.
void forge_size(std::vector<unsigned char>& png, std::uint32_t width, std::uint32_t height) {
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) png[at + i] = static_cast<unsigned char>(value >> (24 - 8 * i));
  };
  put(16, width);
  put(20, height);
  put(29, test::crc_of(std::string(png.begin() + 12, png.begin() + 29)));
}

TEST(Png, SixteenBitDepthSurvivesARoundTrip) {
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

TEST(Png, EightBitImagesSurviveARoundTrip) {
  const auto grey = noise_image<std::uint8_t>(19, 5, 1, 2);
  const auto rgb = noise_image<std::uint8_t>(19, 5, 3, 3);
  write_png(temp_file("grey.png"), grey);
  write_png(temp_file("rgb.png"), rgb);
  EXPECT_EQ(read_png_grey(temp_file("grey.png")).data, grey.data);
  EXPECT_EQ(read_png_rgb(temp_file("rgb.png")).data, rgb.data);
}

TEST(Png, AnyKindOfColorIsConvertedToRgb) {
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

TEST(Png, WrongBitsOrChannelsAreReported) {
  const auto path = temp_file("eight.png");
  write_png(path, noise_image<std::uint8_t>(4, 4, 1, 7));
  const std::string eight = message_of([&] { read_png_16(path); });
  EXPECT_NE(eight.find("eight.png"), std::string::npos) << eight;
  EXPECT_NE(eight.find("8-bit"), std::string::npos) << eight;
  write_png(path, noise_image<std::uint8_t>(4, 4, 3, 8));
  const std::string three = message_of([&] { read_png_16(path); });
  EXPECT_NE(three.find("3 channels"), std::string::npos) << three;
}

TEST(Png, ATruncatedFileIsAnError) {
  const auto bytes = encode_png(noise_image<std::uint16_t>(40, 30, 1, 9));
  const auto path = temp_file("cut.png");
  for (std::size_t cut = 0; cut < bytes.size(); cut += cut < 64 ? 1 : 37) {
    std::filesystem::remove(path);
    write_file_bytes(path, std::span(bytes).first(cut));
    EXPECT_NE(message_of([&] { read_png_16(path); }), "") << "cut at byte " << cut;
  }
}

TEST(Png, ATinyFileThatClaimsAHugeImageIsRejectedBeforeAllocation) {
  auto bytes = encode_png(noise_image<std::uint16_t>(16, 12, 1, 12));
  forge_size(bytes, 30000, 30000);
  write_file_bytes(temp_file("huge.png"), bytes);
  const std::string message = message_of([&] { read_png_16(temp_file("huge.png")); });
  EXPECT_NE(message.find("30000x30000"), std::string::npos) << message;
}

TEST(Png, DamagedBytesNeverCrash) {
  const auto path = temp_file("damaged.png");
  expect_no_harm_by_damage(path, encode_png(noise_image<std::uint16_t>(16, 12, 1, 10)), 500, [&] {
    message_of([&] { read_png_16(path); });
    read_png_rgb(path);
  });
}

TEST(Png, MissingFilesAndUnwritablePathsAreReported) {
  const std::string missing = message_of([&] { read_png_16(temp_file("not_there.png")); });
  EXPECT_NE(missing.find("not_there.png"), std::string::npos);
  const auto unwritable = temp_file("no_such_folder") / "x.png";
  EXPECT_NE(message_of([&] { write_png(unwritable, Image16(2, 2)); }), "");
}

TEST(WebP, ImagesAreReadBackWithinTheExpectedLoss) {
  Image8 image(120, 80, 3, 230);
  for (int y = 20; y < 60; ++y)
    for (int x = 30; x < 90; ++x) image.at(x, y, 1) = 60;
  write_file_bytes(temp_file("a.webp"), encode_webp(image, 72));
  const Image8 read = read_webp_rgb(temp_file("a.webp"));
  ASSERT_EQ(read.width, 120);
  ASSERT_EQ(read.height, 80);
  EXPECT_NEAR(read.at(5, 5, 1), 230, 4);
  EXPECT_NEAR(read.at(60, 40, 1), 60, 4);
  EXPECT_NEAR(read.at(60, 40, 0), 230, 4);
  EXPECT_THROW(encode_webp(Image8(20'000, 1, 3), 72), Error);
}

TEST(WebP, DamageIsReported) {
  const auto file = temp_file("damaged.webp");
  const auto bytes = encode_webp(noise_image<std::uint8_t>(64, 48, 3, 1), 72);
  for (const std::size_t kept : {std::size_t{0}, std::size_t{11}, bytes.size() / 2}) {
    write_file_bytes(file, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(kept)});
    EXPECT_NE(message_of([&] { read_webp_rgb(file); }).find("damaged.webp: not a readable WebP"),
              std::string::npos)
        << kept;
  }
}

const std::filesystem::path kPath = temp_dir() / "image.jpg";

TEST(Jpeg, ColorIsReadAsRgb) {
  write_file_bytes(kPath, encode_jpeg(50, 20, true));
  const Image8 image = read_jpeg_rgb(kPath);
  ASSERT_EQ(image.width, 50);
  ASSERT_EQ(image.height, 20);
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.at(25, 10, 0), 200, 3);
  EXPECT_NEAR(image.at(25, 10, 1), 100, 3);
  EXPECT_NEAR(image.at(25, 10, 2), 30, 3);
}

TEST(Jpeg, GrayIsConvertedToRgb) {
  write_file_bytes(kPath, encode_jpeg(16, 16, false));
  const Image8 image = read_jpeg_rgb(kPath);
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.at(8, 8, 2), 200, 3);
}

TEST(Jpeg, AFileThatEndsEarlyIsAnError) {
  const auto bytes = encode_jpeg(200, 200, true);
  for (std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{30}, bytes.size() / 2}) {
    std::filesystem::remove(kPath);
    write_file_bytes(kPath, std::span(bytes).first(cut));
    EXPECT_THROW(read_jpeg_rgb(kPath), Error) << "cut at byte " << cut;
  }
}

TEST(Jpeg, DamagedBytesNeverCrash) {
  expect_no_harm_by_damage(kPath, encode_jpeg(40, 30, true), 300, [] { read_jpeg_rgb(kPath); });
}

Image8 picture(int shift) {
  Image8 image(7, 5, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<std::uint8_t>(31 * x + 57 * y * y + 90 * c + shift);
  return image;
}

std::filesystem::path animation(const std::vector<Image8>& frames,
                                ApngStores stores = ApngStores::whole) {
  const auto path = temp_dir() / "animation.png";
  write_file_stream(path, [&](std::ostream& out) {
    ApngWriter writer(out, 7, 5, static_cast<int>(frames.size()), 12, stores);
    for (const Image8& frame : frames) writer.add(frame);
    writer.finish();
  });
  return path;
}

TEST(Apng, ShowsItsFirstFrameInEveryViewer) {
  EXPECT_EQ(read_png_rgb(animation({picture(0), picture(1)})).data, picture(0).data);
}

TEST(Apng, KeepsThePixelsOfEveryFrame) {
  std::vector<Image8> frames = {picture(0), picture(0), picture(0), picture(9)};
  frames[1].at(2, 1, 1) ^= 0xff;
  frames[1].at(6, 4, 2) ^= 1;  // the last pixel
  frames[2] = frames[1];       // an identical frame
  for (const ApngStores stores : {ApngStores::whole, ApngStores::difference}) {
    const test::Apng apng = test::read_apng(animation(frames, stores));
    EXPECT_EQ(apng.frame_count, 4);
    EXPECT_EQ(apng.frames_per_second, 12);
    ASSERT_EQ(apng.frames.size(), frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
      EXPECT_EQ(apng.frames[i].data, frames[i].data) << i;
  }
}

TEST(Apng, OfDifferencesIsSmallIfLittleChanges) {
  const std::vector<Image8> frames(20, picture(0));
  const auto whole = std::filesystem::file_size(animation(frames));
  EXPECT_LT(std::filesystem::file_size(animation(frames, ApngStores::difference)), 4 * whole / 5);
}

}  // namespace
}  // namespace planescope::io
