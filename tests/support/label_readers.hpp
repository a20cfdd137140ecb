#pragma once

// Readers of label files, written from the published definitions of the formats. They share no code
// with the writers.

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace planescope::test {

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// np.fromfile(path, dtype)
template <typename T>
std::vector<T> numbers_in_file(const std::filesystem::path& path) {
  const std::string bytes = file_text(path);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// laserscan.py of semantic-kitti-api: label & 0xFFFF, label >> 16; points in rows of four.
struct SemanticKitti {
  std::vector<std::uint32_t> semantic, instance;
  std::vector<float> points;  // x y z remission
};
inline SemanticKitti read_semantic_kitti(const std::filesystem::path& bin,
                                         const std::filesystem::path& label) {
  SemanticKitti scan;
  scan.points = numbers_in_file<float>(bin);
  for (const std::uint32_t value : numbers_in_file<std::uint32_t>(label)) {
    scan.semantic.push_back(value & 0xFFFF);
    scan.instance.push_back(value >> 16);
  }
  return scan;
}

/// np.load() of a one-dimensional little-endian int32 array, version 1.0; empty for anything else.
inline std::vector<std::int32_t> load_npy_int32(const std::filesystem::path& path) {
  const std::string bytes = file_text(path);
  if (bytes.substr(0, 8) != std::string("\x93NUMPY\x01\x00", 8)) return {};
  const std::size_t length =
      static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  const std::string header = bytes.substr(10, length);
  const std::size_t data = 10 + length, count = (bytes.size() - data) / 4;
  const std::string expected =
      "{'descr': '<i4', 'fortran_order': False, 'shape': (" + std::to_string(count) + ",), }";
  if (header.substr(0, expected.size()) != expected || header.back() != '\n' || data % 64 != 0)
    return {};
  std::vector<std::int32_t> values(count);
  std::memcpy(values.data(), bytes.data() + data, 4 * count);
  return values;
}

/// maskApi: alternating counts of zeros and ones in column-major order. Returns row-major order.
inline std::vector<int> decode_rle(const std::vector<std::uint64_t>& counts, int w, int h) {
  std::vector<int> columns;
  int value = 0;
  for (const std::uint64_t count : counts) {
    columns.insert(columns.end(), count, value);
    value = 1 - value;
  }
  std::vector<int> rows(columns.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) rows.at(y * w + x) = columns.at(x * h + y);
  return rows;
}

}  // namespace planescope::test
