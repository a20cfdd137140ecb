#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/byte_reader.hpp"
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

enum class Compression : std::uint8_t { none, lz4, bz2, unknown };
Compression parse_compression(std::string_view name);

/// What could be unpacked, in order from the start; `whole` says whether that is all of it.
struct Unpacked {
  std::vector<std::byte> bytes;
  bool whole = false;
};

/// Unpacks a chunk that declares `raw_bytes` of content. Memory grows with what really comes out,
/// never with what is declared. A chunk that is cut or damaged gives what lies before the damage:
/// for LZ4 to the byte, for BZ2 to its blocks of 900 kB.
Unpacked unpack(Compression compression, Bytes stored, std::uint32_t raw_bytes);

struct Connection {
  std::string topic;
  std::string type;  // such as "sensor_msgs/Image"
};

/// Where a message lies.
struct MessageRef {
  std::uint64_t time_ns = 0;  // when it was recorded
  std::uint32_t chunk = 0;
  std::uint32_t offset = 0;  // in the unpacked chunk
};

/// A message's bytes, kept alive by `chunk` where they had to be unpacked.
struct MessageBytes {
  std::shared_ptr<const std::vector<std::byte>> chunk;
  Bytes bytes;
};

struct Chunk {
  Compression compression = Compression::none;
  Bytes stored;
  std::uint32_t raw_bytes = 0;
  bool cut = false;  // its end is missing or damaged
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
                                      std::uint32_t raw_bytes);

/// Reads the index at the end of the bag; false when any of it is missing or does not add up.
bool read_index(Bytes file, Index& index);
/// Walks the records from the start, unpacking only chunks that tell nothing otherwise, and says
/// in `warnings` what is missing.
Index scan(Bytes file);

/// A ROS 1 bag, opened by memory map. Reading is const and thread-safe.
class Bag {
 public:
  /// Throws Error when the file is no bag.
  explicit Bag(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const MappedFile& file() const { return file_; }
  const std::vector<std::string>& warnings() const { return index_.warnings; }
  /// Topics in alphabetical order with their type.
  const std::map<std::string, std::string>& topics() const { return topics_; }
  bool has(const std::string& topic) const { return topics_.contains(topic); }
  /// All messages of a topic by recording time, equal times in file order.
  std::vector<MessageRef> messages(const std::string& topic) const;
  /// Throws Error naming the file when the message is damaged.
  MessageBytes read(const MessageRef& message) const;
  /// What unpacking its chunk costs, in bytes of LZ4; 0 where that is not compressed.
  std::size_t unpacking_cost(const MessageRef& message) const;

 private:
  MessageBytes chunk_bytes(std::uint32_t chunk) const;

  std::filesystem::path path_;
  MappedFile file_;
  Index index_;
  std::map<std::string, std::string> topics_;

  // Unpacked chunks that were used last: neighbouring frames and colour share them.
  struct Cached {
    std::uint32_t chunk = 0;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  mutable std::mutex cache_mutex_;
  mutable std::vector<Cached> cache_;  // last used at the back
};

}  // namespace planescope::io::rosbag1
