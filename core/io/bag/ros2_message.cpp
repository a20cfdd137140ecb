#include "core/io/bag/ros2_message.hpp"

#include <algorithm>

#include "core/io/bag/unpack.hpp"
#include "core/model/error.hpp"
#include "core/model/read_limit.hpp"

namespace planescope::io::rosbag2 {

Message cdr_message(std::shared_ptr<const std::vector<std::byte>> held,
                    Bytes bytes,
                    std::size_t at_most,
                    const std::string& what) {
  if (!is_zstd(bytes)) return {std::move(held), bytes, Wire::cdr};
  const std::uint64_t limit = std::min<std::uint64_t>(at_most, read_limit_bytes());
  Unpacked unpacked = unpack_zstd(bytes, limit);
  if (!unpacked.whole && at_most == kWholeMessage) {
    throw Error(what + " is damaged: " + std::to_string(unpacked.bytes.size()) +
                " bytes could be unpacked of its zstd frame");
  }
  held = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  return {held, *held, Wire::cdr};
}

void warn_of_encodings(const std::map<std::string, int>& topics,
                       std::vector<std::string>& warnings) {
  for (const auto& [encoding, count] : topics)
    warnings.push_back(std::to_string(count) + " topics are serialized as \"" + encoding +
                       "\", expected cdr; they are left out");
}

std::string ros_type(std::string type) {
  const std::size_t middle = type.find("/msg/");
  if (middle != std::string::npos) type.erase(middle, 4);
  return type;
}

}  // namespace planescope::io::rosbag2
