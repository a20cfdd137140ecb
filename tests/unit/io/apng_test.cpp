#include "core/io/image/apng.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <sstream>
#include <string>
#include <vector>

#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "support/temp_dir.hpp"

namespace planescope::io {
namespace {

struct Chunk {
  std::string type, content;
  bool is_whole = false;  // its CRC is right
};

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::vector<Chunk> chunks_of(const std::string& file) {
  std::vector<Chunk> chunks;
  for (std::size_t at = 8; at + 12 <= file.size();) {
    const std::uint32_t size = number_at(file, at);
    Chunk chunk{file.substr(at + 4, 4), file.substr(at + 8, size)};
    const std::string checked = chunk.type + chunk.content;
    chunk.is_whole = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size()) ==
                     number_at(file, at + 8 + size);
    chunks.push_back(std::move(chunk));
    at += 12 + size;
  }
  return chunks;
}

Image8 picture(int shift) {
  Image8 image(7, 5, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<std::uint8_t>(31 * x + 57 * y * y + 90 * c + shift);
  return image;
}

std::string animation(int frames) {
  std::ostringstream out;
  ApngWriter writer(out, 7, 5, frames, 5);
  for (int i = 0; i < frames; ++i) writer.add(picture(i));
  writer.finish();
  return out.str();
}

/// The same pixels as a PNG of their own.
Image8 decoded(const std::string& header, const std::string& pixels) {
  std::string file = "\x89PNG\r\n\x1a\n";
  const auto add = [&](const std::string& checked) {
    const auto append = [&](std::uint32_t value) {
      for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(value >> shift);
    };
    append(static_cast<std::uint32_t>(checked.size() - 4));
    file += checked;
    append(static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size())));
  };
  add("IHDR" + header);
  add("IDAT" + pixels);
  add("IEND");
  const auto path = temp_dir() / "one_frame.png";
  write_file_text(path, file);
  return read_png_rgb(path);
}

TEST(Apng, ShowsItsFirstFrameInEveryViewer) {
  const auto path = temp_dir() / "animation.png";
  write_file_text(path, animation(3));
  EXPECT_EQ(read_png_rgb(path).data, picture(0).data);
}

TEST(Apng, HasItsChunksInOrderAndWhole) {
  const std::vector<Chunk> chunks = chunks_of(animation(3));
  std::string types;
  for (const Chunk& chunk : chunks) {
    EXPECT_TRUE(chunk.is_whole) << chunk.type;
    types += chunk.type + " ";
  }
  EXPECT_EQ(types, "IHDR acTL fcTL IDAT fcTL fdAT fcTL fdAT IEND ");
  EXPECT_EQ(number_at(chunks[1].content, 0), 3u);  // frames
  std::uint32_t sequence = 0;
  for (const Chunk& chunk : chunks) {
    if (chunk.type == "fcTL" || chunk.type == "fdAT") {
      EXPECT_EQ(number_at(chunk.content, 0), sequence++);
    }
  }
}

TEST(Apng, KeepsEveryFramesPixels) {
  const std::vector<Chunk> chunks = chunks_of(animation(3));
  EXPECT_EQ(decoded(chunks[0].content, chunks[5].content.substr(4)).data, picture(1).data);
  EXPECT_EQ(decoded(chunks[0].content, chunks[7].content.substr(4)).data, picture(2).data);
}

}  // namespace
}  // namespace planescope::io
