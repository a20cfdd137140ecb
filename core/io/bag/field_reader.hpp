#pragma once

#include <algorithm>

#include "core/io/bag/message_log.hpp"

namespace planescope::io::ros {

/// Reads the fields of a message in their order, whichever ROS wrote it. Throws OutOfBytes where
/// they end early.
/// CDR: https://www.omg.org/spec/DDSI-RTPS/2.5, 10. Plain CDR alone, which ROS 2 writes.
class FieldReader {
 public:
  explicit FieldReader(const Message& message)
      : in_(message.bytes), is_cdr_(message.wire == Wire::cdr) {
    if (!is_cdr_) return;
    const auto high = in_.read<std::uint8_t>();
    const auto low = in_.read<std::uint8_t>();
    if (high != 0 || low > 1) throw OutOfBytes{};
    swapped_ = low == 0;  // written on a big-endian machine
    in_.take(2);          // options, unused
    in_ = ByteReader(in_.take(in_.left()));
  }

  bool is_cdr() const { return is_cdr_; }
  std::size_t left() const { return in_.left(); }

  template <typename T>
  T read() {
    if (is_cdr_) in_.take((sizeof(T) - in_.position() % sizeof(T)) % sizeof(T));
    std::byte bytes[sizeof(T)];
    std::ranges::copy(in_.take(sizeof(T)), bytes);
    if (swapped_) std::reverse(bytes, bytes + sizeof(T));
    return std::bit_cast<T>(bytes);
  }
  /// An array of bytes.
  Bytes bytes() { return in_.take(read<std::uint32_t>()); }
  std::string_view text() {
    const Bytes all = bytes();
    const std::string_view view(reinterpret_cast<const char*>(all.data()), all.size());
    if (!is_cdr_) return view;
    return view.substr(0, view.find('\0'));  // CDR ends it with one
  }
  std::vector<double> doubles() {
    const auto count = read<std::uint32_t>();
    if (count > in_.left() / sizeof(double)) throw OutOfBytes{};
    std::vector<double> values(count);
    for (double& value : values) value = read<double>();
    return values;
  }
  /// The bytes that are left.
  Bytes rest() { return in_.take(in_.left()); }

 private:
  ByteReader in_;
  bool is_cdr_;
  bool swapped_ = false;
};

}  // namespace planescope::io::ros
