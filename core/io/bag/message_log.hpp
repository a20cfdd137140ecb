#pragma once

// Messages by topic, common to all containers of ROS recordings, and decompression of single
// messages, of chunks, and of whole files. Internal to core/io.

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/io/byte_reader.hpp"

namespace planescope::io {

/// Layout of the fields of a message: ROS 1 writes them without gaps; ROS 2 aligns them (CDR) after
/// a header of four bytes that contains the byte order.
enum class Wire : std::uint8_t { ros1, cdr };

/// Location of a message.
struct MessageRef {
  std::uint64_t time_ns = 0;  // recording time
  std::uint32_t file = 0;     // index, in recordings of several files
  std::uint32_t chunk = 0;
  std::uint64_t offset = 0;  // in the unpacked chunk, or another number that identifies the message

  auto place() const { return std::tie(file, chunk, offset); }
  bool operator<(const MessageRef& other) const {
    return std::tie(time_ns, file, chunk, offset) <
           std::tie(other.time_ns, other.file, other.chunk, other.offset);
  }
};

using HeldBytes = std::shared_ptr<const std::vector<std::byte>>;

/// A message's bytes. `held` keeps them alive unless they are part of a mapped file.
struct Message {
  HeldBytes held;
  Bytes bytes;
  Wire wire = Wire::ros1;
};

inline constexpr std::size_t kWholeMessage = std::numeric_limits<std::size_t>::max();

/// A recording's messages. Reading is const and thread-safe.
class MessageLog {
 public:
  explicit MessageLog(std::filesystem::path path) : path_(std::move(path)) {}
  virtual ~MessageLog() = default;
  MessageLog(const MessageLog&) = delete;
  MessageLog& operator=(const MessageLog&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Data loss, one line each with counts.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Topics in alphabetical order with their type, such as "sensor_msgs/Image" in either ROS.
  const std::map<std::string, std::string>& topics() const { return topics_; }

  /// Name of the container for messages, such as "bag".
  virtual std::string kind() const = 0;
  /// All messages of a topic by recording time, equal times in file order.
  const std::vector<MessageRef>& messages(const std::string& topic) const;
  /// The message, or at least its first `at_most` bytes. Throws Error naming a damaged file.
  virtual Message read(const MessageRef& message, std::size_t at_most = kWholeMessage) const = 0;
  /// Cost of unpacking the message's chunk, in bytes of LZ4; 0 if it is not compressed.
  virtual std::size_t unpacking_cost(const MessageRef&) const { return 0; }
  /// Throws Error if another process has truncated the file since it was opened.
  virtual void expect_whole() const = 0;

 protected:
  void sort_messages();
  /// Warns about topics that are skipped because of their serialization.
  void warn_of_encodings(const std::map<std::string, int>& topics);

  std::filesystem::path path_;
  std::vector<std::string> warnings_;
  std::map<std::string, std::string> topics_;
  std::map<std::string, std::vector<MessageRef>> messages_;  // by topic, sorted
};

/// Opens a file or folder as the container that its content shows. Throws Error if there is none.
std::unique_ptr<MessageLog> open_message_log(const std::filesystem::path& path);

// One per container; errors as above. `path` may be compressed as a whole.
std::unique_ptr<MessageLog> open_rosbag1(const std::filesystem::path& path);
std::unique_ptr<MessageLog> open_sqlite_log(const std::filesystem::path& path);
std::unique_ptr<MessageLog> open_mcap(const std::filesystem::path& path);

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";  // https://mcap.dev/spec

/// Throws Error unless the file has at least this length and this start. `what`: "a ROS bag";
/// `shown`: the start in readable form.
void expect_start(const MappedFile& file,
                  std::size_t least_bytes,
                  std::string_view start,
                  const char* what,
                  const char* shown);

/// The message in the bytes of a ROS 2 container. They may be a zstd frame: `ros2 bag` records this
/// in metadata.yaml, the RealSense SDK nowhere. Throws Error that begins with `what` if the frame
/// is damaged.
Message cdr_message(HeldBytes held, Bytes bytes, std::size_t at_most, const std::string& what);

/// Converts a type to its ROS 1 name: "sensor_msgs/msg/Image" to "sensor_msgs/Image".
std::string ros_type(std::string type);

// ---- Compression ----

enum class Compression : std::uint8_t { none, lz4, bz2, zstd, unknown };
/// From the names in bags ("none" for no compression) and in MCAP ("").
Compression parse_compression(std::string_view name);

/// Unpacked bytes from the start; `whole` if they are complete.
struct Unpacked {
  std::vector<std::byte> bytes;
  bool whole = false;
};

/// Unpacks a chunk that declares `raw_bytes` of content. Memory grows with the actual output, never
/// with the declared size. A truncated or damaged chunk yields the content before the damage: to
/// the byte for LZ4, in blocks of 900 kB for BZ2, in blocks of 128 kB for zstd.
Unpacked unpack(Compression compression, Bytes stored, std::uint64_t raw_bytes);

/// Whether the bytes start like a zstd frame. Messages never do: the second byte of CDR is 0 or 1.
bool is_zstd(Bytes bytes);
/// The first `at_most` bytes of the content of zstd frames; `whole` if they are complete.
Unpacked unpack_zstd(Bytes stored, std::uint64_t at_most);

// Bags compressed as a whole, by `ros2 bag record --compression-mode file`.

/// The name of the content: "rec_0.db3" for "rec_0.db3.zstd", otherwise the name itself.
std::filesystem::path name_within(const std::filesystem::path& path);

/// The first `count` bytes of the file's unpacked content; fewer if it is shorter.
std::string first_bytes_within(const std::filesystem::path& path, std::size_t count);

/// Maps a file, or its content if it is compressed by zstd. The content is unpacked into an unnamed
/// file in the folder for temporary files, which disappears with the mapping. A truncated or
/// damaged file yields the content before the damage. Throws Error if there is no content, if the
/// disk is full, or if the content is too large for a recording.
MappedFile map_content(const std::filesystem::path& path);

// ---- Containers of chunks: ROS 1 bags and MCAP ----

/// A run of messages, compressed together.
struct Chunk {
  Compression compression = Compression::none;
  Bytes stored;
  std::uint64_t raw_bytes = 0;
  bool cut = false;       // its end is missing or damaged
  std::uint32_t crc = 0;  // CRC-32 of the content; 0: unknown
};

inline constexpr std::uint32_t kNoChunk = 0xffffffff;  // of messages outside chunks

/// Content of a file of chunks: read from its index, or found by walking its records if the index
/// is missing, truncated or damaged.
struct ChunkIndex {
  /// `encoding`: "cdr", or "ros1" for the layout of ROS 1.
  struct Channel {
    std::string topic, type, encoding;
  };
  std::map<std::uint32_t, Channel> channels;
  std::map<std::uint32_t, std::vector<MessageRef>> messages;  // by channel, in file order
  std::vector<Chunk> chunks;
  std::vector<std::string> warnings;
  // Set by a walk:
  std::uint64_t found_messages = 0;
  std::uint64_t missing_bytes = 0;  // declared by a cut chunk, but not in the file

  /// Adds messages found by a walk. Throws OutOfBytes if there are more than a file can hold:
  /// chunks may unpack to any number of them.
  void add_found(std::uint32_t channel, std::span<const MessageRef> found, Bytes file);

  /// Calls take(reader, number, offset) at each record in a chunk, as far as it can be unpacked;
  /// `take` moves the reader and throws OutOfBytes on damage.
  template <typename Take>
  void walk_chunk(std::size_t number, const Take& take) {
    Unpacked unpacked;
    ByteReader reader(content_of(chunks[number], unpacked));
    try {
      while (!reader.done()) take(reader, static_cast<std::uint32_t>(number), reader.position());
    } catch (OutOfBytes) {
      chunks[number].cut = true;
    }
  }
  /// Adds the warning "WHAT; found N chunks, ...". `declared_chunks`: 0 if unknown.
  void warn_of_loss(const std::string& what,
                    std::uint64_t declared_chunks = 0,
                    std::uint64_t damaged_bytes = 0);

 private:
  /// The content as far as it can be unpacked; `unpacked` owns it if it was compressed. Sets `cut`
  /// if it is incomplete.
  static Bytes content_of(Chunk& chunk, Unpacked& unpacked);
};

/// A file of chunks, memory-mapped.
class ChunkedLog : public MessageLog {
 public:
  explicit ChunkedLog(const std::filesystem::path& path)
      : MessageLog(path), file_(map_content(path)) {}

  Message read(const MessageRef& message, std::size_t at_most) const override;
  std::size_t unpacking_cost(const MessageRef& message) const override;
  void expect_whole() const override { file_.expect_whole(); }

 protected:
  /// The message in the record at the reader; nullopt if the record is no message. Throws
  /// OutOfBytes on damage.
  virtual std::optional<Message> message_at(ByteReader& reader) const = 0;
  /// Takes over an index, except channels of unsupported encodings.
  void take(ChunkIndex index);

  MappedFile file_;
  std::map<std::uint32_t, ChunkIndex::Channel> channels_;

 private:
  /// Throws Error unless the content of a chunk has its CRC.
  void check(std::uint32_t number, Bytes content) const;
  void check_stored(std::uint32_t number) const;  // once, of a chunk that is not compressed
  HeldBytes unpacked(std::uint32_t number) const;

  std::vector<Chunk> chunks_;
  mutable std::set<std::uint32_t> checked_;
  /// The most recently unpacked chunks, which neighboring frames and color share. Most recently
  /// used last.
  mutable std::vector<std::pair<std::uint32_t, HeldBytes>> cache_;
  mutable std::mutex mutex_;
};

}  // namespace planescope::io
