#pragma once

// Reads an animated PNG chunk by chunk, independently of the writer.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/image/png.hpp"

namespace planescope::test {

struct PngChunk {
  std::string type, content;
};

inline std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

inline std::uint32_t number_at(const std::string& bytes, std::size_t at, int count = 4) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes.at(at + static_cast<std::size_t>(i)));
  return value;
}

/// Throws if a checksum or a length is wrong.
inline std::vector<PngChunk> chunks_of(const std::string& file) {
  if (file.substr(0, 8) != "\x89PNG\r\n\x1a\n") throw std::runtime_error("no signature");
  std::vector<PngChunk> chunks;
  for (std::size_t at = 8; at < file.size();) {
    const std::uint32_t size = number_at(file, at);
    const std::string checked = file.substr(at + 4, 4 + size);
    if (crc_of(checked) != number_at(file, at + 8 + size)) throw std::runtime_error("a checksum");
    chunks.push_back({checked.substr(0, 4), checked.substr(4)});
    at += 12 + size;
  }
  return chunks;
}

struct Apng {
  int frame_count = 0, frames_per_second = 0;
  std::vector<Image8> frames;  // complete frames, as displayed by a viewer
};

inline std::string chunk_bytes(const std::string& type, const std::string& content) {
  const auto big_endian = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  return big_endian(static_cast<std::uint32_t>(content.size())) + type + content +
         big_endian(crc_of(type + content));
}

/// Throws if chunks are missing, out of order, or outside the picture.
inline Apng read_apng(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<PngChunk> chunks =
      chunks_of(std::string(std::istreambuf_iterator<char>(in), {}));
  const auto expect = [](bool holds, const char* what) {
    if (!holds) throw std::runtime_error(what);
  };
  expect(chunks.size() > 3 && chunks[0].type == "IHDR" && chunks[1].type == "acTL", "a start");
  expect(chunks.back().type == "IEND", "an end");
  Apng apng;
  apng.frame_count = static_cast<int>(number_at(chunks[1].content, 0));
  std::uint32_t sequence = 0;
  const std::filesystem::path single = path.string() + ".single.png";
  for (std::size_t i = 2; i + 1 < chunks.size(); i += 2) {
    const std::string &control = chunks[i].content, data = chunks[i + 1].content;
    expect(chunks[i].type == "fcTL" && control.size() == 26, "a control chunk");
    expect(number_at(control, 0) == sequence++, "the sequence");
    expect(chunks[i + 1].type == (i == 2 ? "IDAT" : "fdAT"), "the data");
    if (i > 2) expect(number_at(data, 0) == sequence++, "the sequence");
    apng.frames_per_second =
        static_cast<int>(number_at(control, 22, 2) / number_at(control, 20, 2));
    std::string header = chunks[0].content;
    header.replace(0, 8, control, 4, 8);
    std::ofstream(single, std::ios::binary)
        << "\x89PNG\r\n\x1a\n"
        << chunk_bytes("IHDR", header) << chunk_bytes("IDAT", i == 2 ? data : data.substr(4))
        << chunk_bytes("IEND", "");
    const Image8 part = io::read_png_rgb(single);
    const auto x0 = static_cast<int>(number_at(control, 12));
    const auto y0 = static_cast<int>(number_at(control, 16));
    Image8 whole = apng.frames.empty() ? part : apng.frames.back();
    expect(x0 + part.width <= whole.width && y0 + part.height <= whole.height, "a part inside");
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < 3 * part.width; ++x) (&whole.at(x0, y0 + y))[x] = (&part.at(0, y))[x];
    apng.frames.push_back(std::move(whole));
  }
  std::filesystem::remove(single);
  return apng;
}

}  // namespace planescope::test
