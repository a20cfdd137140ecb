#pragma once

// Pieces of files: a few texts and numbers, then bytes up to the end. Bytes that are not there read
// as zeros, so that any bytes are a piece.

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {

class PieceWriter {
 public:
  /// At most 255 bytes of it.
  void text(const std::string& value) {
    const std::string part = value.substr(0, 255);
    bytes_.push_back(static_cast<unsigned char>(part.size()));
    bytes_.insert(bytes_.end(), part.begin(), part.end());
  }
  void number(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) bytes_.push_back(static_cast<unsigned char>(value >> (8 * i)));
  }
  void rest(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  ByteVector take() { return std::move(bytes_); }

 private:
  ByteVector bytes_;
};

class PieceReader {
 public:
  explicit PieceReader(Bytes bytes) : left_(bytes) {}

  unsigned char byte() {
    if (left_.empty()) return 0;
    const unsigned char first = left_[0];
    left_ = left_.subspan(1);
    return first;
  }
  std::string text() {
    const std::size_t size = byte();
    const Bytes part = left_.first(std::min(size, left_.size()));
    left_ = left_.subspan(part.size());
    return {part.begin(), part.end()};
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) value |= static_cast<std::uint64_t>(byte()) << (8 * i);
    return value;
  }
  ByteVector rest() { return {left_.begin(), left_.end()}; }

 private:
  Bytes left_;
};

/// CRC-32, as PNG, ZIP and the labels' journal have it.
inline std::uint32_t checksum(Bytes bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

// JSON as pieces: where a value stands (a JSON pointer), and the value.
std::vector<ByteVector> split_json(Bytes bytes);
ByteVector join_json(const std::vector<ByteVector>& pieces);

}  // namespace planescope::fuzz
