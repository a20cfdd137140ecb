#pragma once

// Values as bytes and back, the same on every machine: whole numbers in groups of seven bits, the
// lowest first; floating point as its eight bytes, the lowest first; text after its length.

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/model/error.hpp"

namespace planescope::labels {

class RecordWriter {
 public:
  void number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<unsigned char>(value | 0x80));
    bytes_.push_back(static_cast<unsigned char>(value));
  }
  void real(double value) {
    auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i, bits >>= 8) bytes_.push_back(static_cast<unsigned char>(bits));
  }
  void text(const std::string& value) {
    number(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }

  std::vector<unsigned char> take() { return std::move(bytes_); }

 private:
  std::vector<unsigned char> bytes_;
};

/// Throws Error where the bytes do not hold what is asked for.
class RecordReader {
 public:
  explicit RecordReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  std::uint64_t number(std::uint64_t most = UINT64_MAX) {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint64_t byte = next();
      if (shift > 63) fail();
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) break;
    }
    if (value > most) fail();
    return value;
  }
  int integer() { return static_cast<int>(number(INT32_MAX)); }
  double real() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits |= static_cast<std::uint64_t>(next()) << (8 * i);
    return std::bit_cast<double>(bits);
  }
  std::string text() {
    const auto size = static_cast<std::size_t>(number(bytes_.size()));
    std::string value(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
    bytes_ = bytes_.subspan(size);
    return value;
  }
  /// How many things of at least a byte each follow.
  std::size_t count() { return static_cast<std::size_t>(number(bytes_.size())); }

 private:
  unsigned char next() {
    if (bytes_.empty()) fail();
    const unsigned char byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }
  [[noreturn]] static void fail() {
    throw Error("a record of labels does not hold what its kind needs");
  }

  std::span<const unsigned char> bytes_;
};

}  // namespace planescope::labels
