#pragma once

#include <optional>
#include <string_view>

#include "core/io/byte_reader.hpp"

namespace planescope::io::rosbag1 {

// ROS bag format 2.0: http://wiki.ros.org/Bags/Format/2.0
inline constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

enum class Op : std::uint8_t {
  message = 2,
  bag_header = 3,
  index_data = 4,
  chunk = 5,
  chunk_info = 6,
  connection = 7,
};

/// The header of a record: `name=value` fields.
class Fields {
 public:
  explicit Fields(Bytes header) : header_(header) {}
  /// The value of a field, empty where there is none. Throws OutOfBytes on a damaged header.
  std::optional<Bytes> find(std::string_view name) const;
  /// Throws OutOfBytes when the field is missing or of another size.
  template <typename T>
  T get(std::string_view name) const {
    const auto value = find(name);
    if (!value || value->size() != sizeof(T)) throw OutOfBytes{};
    return ByteReader(*value).read<T>();
  }
  std::string_view text(std::string_view name) const;
  Op op() const { return static_cast<Op>(get<std::uint8_t>("op")); }

 private:
  Bytes header_;
};

struct Record {
  Fields header;
  Bytes data;
};

/// Reads one whole record. Throws OutOfBytes when it is not all there.
inline Record read_record(ByteReader& reader) {
  const Bytes header = reader.take_sized();
  return {Fields(header), reader.take_sized()};
}

/// ROS time as the bag writes it: seconds in the low, nanoseconds in the high half.
inline std::uint64_t nanoseconds(std::uint64_t time) {
  return (time & 0xffffffffu) * 1'000'000'000u + (time >> 32);
}

}  // namespace planescope::io::rosbag1
