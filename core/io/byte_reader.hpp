#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace planescope::io {

using Bytes = std::span<const std::byte>;

static_assert(std::endian::native == std::endian::little, "files are read as they lie in memory");

/// Thrown by ByteReader when a length points past the end. Internal to the readers: each catches
/// it and says what that means for its file.
struct OutOfBytes {};

/// Reads little-endian values from untrusted bytes: every length is checked.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes), size_(bytes.size()) {}

  Bytes take(std::uint64_t count) {
    if (count > rest_.size()) throw OutOfBytes{};
    const Bytes taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  template <typename T>
  T read() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  /// A 32-bit length and that many bytes: how ROS writes strings, arrays and records.
  Bytes take_sized() { return take(read<std::uint32_t>()); }
  std::string_view read_text() {
    const Bytes text = take_sized();
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }

  bool done() const { return rest_.empty(); }
  std::size_t left() const { return rest_.size(); }
  std::size_t position() const { return size_ - rest_.size(); }

 private:
  Bytes rest_;
  std::size_t size_;
};

}  // namespace planescope::io
