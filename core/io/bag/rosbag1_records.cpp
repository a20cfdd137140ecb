#include "core/io/bag/rosbag1_records.hpp"

namespace planescope::io::rosbag1 {

std::optional<Bytes> Fields::find(std::string_view name) const {
  ByteReader reader(header_);
  while (!reader.done()) {
    const std::string_view field = reader.read_text();
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw OutOfBytes{};
    if (field.substr(0, equals) == name) {
      const std::string_view value = field.substr(equals + 1);
      return Bytes(reinterpret_cast<const std::byte*>(value.data()), value.size());
    }
  }
  return std::nullopt;
}

std::string_view Fields::text(std::string_view name) const {
  const auto value = find(name);
  if (!value) throw OutOfBytes{};
  return {reinterpret_cast<const char*>(value->data()), value->size()};
}

}  // namespace planescope::io::rosbag1
