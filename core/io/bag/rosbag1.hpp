#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/bag/chunks.hpp"
#include "core/io/bag/message_log.hpp"
#include "core/io/mapped_file.hpp"

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

struct Connection {
  std::string topic;
  std::string type;  // such as "sensor_msgs/Image"
};

/// What a bag holds and where: found in its index, or by walking its chunks where that is lost.
struct Index {
  std::map<std::uint32_t, Connection> connections;
  std::map<std::uint32_t, std::vector<MessageRef>> messages;  // by connection, in file order
  std::vector<Chunk> chunks;
  std::vector<std::string> warnings;
};

/// Adds what a CONNECTION record says. Throws OutOfBytes when it is damaged.
void add_connection(const Record& record, Index& index);
/// The messages that an INDEX_DATA record places in a chunk. Throws OutOfBytes when it is damaged.
std::vector<MessageRef> index_entries(const Record& record,
                                      std::uint32_t chunk,
                                      std::uint64_t raw_bytes);

/// Reads the index at the end of the bag; false when any of it is missing or does not add up.
bool read_index(Bytes file, Index& index);
/// Walks the records from the start, unpacking only chunks that tell nothing otherwise, and says
/// in `warnings` what is missing.
Index scan(Bytes file);

/// A ROS 1 bag, opened by memory map.
class Bag : public MessageLog {
 public:
  /// Throws Error when the file is no bag.
  explicit Bag(const std::filesystem::path& path);

  std::string kind() const override { return "bag"; }
  std::vector<MessageRef> messages(const std::string& topic) const override;
  Message read(const MessageRef& message, std::size_t at_most = kWholeMessage) const override;
  std::size_t unpacking_cost(const MessageRef& message) const override;
  void expect_whole() const override { file_.expect_whole(); }

 private:
  Message chunk_bytes(std::uint32_t chunk) const;

  MappedFile file_;
  Index index_;
  mutable ChunkCache cache_;
};

}  // namespace planescope::io::rosbag1
