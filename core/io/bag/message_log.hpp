#pragma once

// Messages by topic, as all containers of ROS recordings hold them, and what those containers are
// compressed by: single messages, chunks of them, or whole files. Internal to core/io.

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

/// How the fields of a message are laid out: without gaps, as ROS 1 does, or aligned behind four
/// bytes that tell their order (CDR), as ROS 2 does.
enum class Wire : std::uint8_t { ros1, cdr };

/// Where a message lies.
struct MessageRef {
  std::uint64_t time_ns = 0;  // when it was recorded
  std::uint32_t file = 0;     // of a recording in several
  std::uint32_t chunk = 0;
  std::uint64_t offset = 0;  // in the unpacked chunk, or what else numbers messages there

  auto place() const { return std::tie(file, chunk, offset); }
  bool operator<(const MessageRef& other) const {
    return std::tie(time_ns, file, chunk, offset) <
           std::tie(other.time_ns, other.file, other.chunk, other.offset);
  }
};

using HeldBytes = std::shared_ptr<const std::vector<std::byte>>;

/// A message's bytes, kept alive by `held` where they do not lie in a mapped file.
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
  /// What was lost, one line each with counts.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Topics in alphabetical order with their type, such as "sensor_msgs/Image" in either ROS.
  const std::map<std::string, std::string>& topics() const { return topics_; }

  /// "bag" or what else it is, for people.
  virtual std::string kind() const = 0;
  /// All messages of a topic by recording time, equal times in file order.
  const std::vector<MessageRef>& messages(const std::string& topic) const;
  /// The message, or at least its first `at_most` bytes. Throws Error naming the file when it is
  /// damaged.
  virtual Message read(const MessageRef& message, std::size_t at_most = kWholeMessage) const = 0;
  /// What unpacking what it lies in costs, in bytes of LZ4; 0 where nothing is to be unpacked.
  virtual std::size_t unpacking_cost(const MessageRef&) const { return 0; }
  /// Throws Error where the file was cut by somebody else after it was opened.
  virtual void expect_whole() const = 0;

 protected:
  void sort_messages();
  /// Warns of topics that are left out, by how they are serialized.
  void warn_of_encodings(const std::map<std::string, int>& topics);

  std::filesystem::path path_;
  std::vector<std::string> warnings_;
  std::map<std::string, std::string> topics_;
  std::map<std::string, std::vector<MessageRef>> messages_;  // by topic, sorted
};

/// The container that a file or folder is, found out from its content. Throws Error when it is
/// none.
std::unique_ptr<MessageLog> open_message_log(const std::filesystem::path& path);

// One for each container; Errors as above. `path` may be compressed as a whole.
std::unique_ptr<MessageLog> open_rosbag1(const std::filesystem::path& path);
std::unique_ptr<MessageLog> open_sqlite_log(const std::filesystem::path& path);
std::unique_ptr<MessageLog> open_mcap(const std::filesystem::path& path);

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";  // https://mcap.dev/spec

/// Throws Error unless the file is that long and starts so; `what`: "a ROS bag", `shown`: the start
/// as people read it.
void expect_start(const MappedFile& file,
                  std::size_t least_bytes,
                  std::string_view start,
                  const char* what,
                  const char* shown);

/// The message that bytes of a ROS 2 container hold. They may be a zstd frame: `ros2 bag` says so
/// in metadata.yaml, the RealSense SDK nowhere. Throws Error that begins with `what` where that is
/// damaged.
Message cdr_message(HeldBytes held, Bytes bytes, std::size_t at_most, const std::string& what);

/// A type as ROS 1 calls it: "sensor_msgs/Image" for "sensor_msgs/msg/Image".
std::string ros_type(std::string type);

// ---- Compression ----

enum class Compression : std::uint8_t { none, lz4, bz2, zstd, unknown };
/// As bags ("none") and MCAP ("") name it.
Compression parse_compression(std::string_view name);

/// What could be unpacked, in order from the start; `whole` says whether that is all of it.
struct Unpacked {
  std::vector<std::byte> bytes;
  bool whole = false;
};

/// Unpacks a chunk that declares `raw_bytes` of content. Memory grows with what really comes out,
/// never with what is declared. A chunk that is cut or damaged gives what lies before the damage:
/// for LZ4 to the byte, for BZ2 to its blocks of 900 kB, for zstd to its blocks of 128 kB.
Unpacked unpack(Compression compression, Bytes stored, std::uint64_t raw_bytes);

/// Whether bytes start as a zstd frame does. No message does: the second byte of CDR is 0 or 1.
bool is_zstd(Bytes bytes);
/// The first `at_most` bytes that zstd frames hold, `whole` where these are all there.
Unpacked unpack_zstd(Bytes stored, std::uint64_t at_most);

// Bags that were compressed as a whole, as `ros2 bag record --compression-mode file` does.

/// Of a packed file "rec_0.db3.zstd" the name "rec_0.db3", of others their own.
std::filesystem::path name_within(const std::filesystem::path& path);

/// The first `count` bytes of what the file holds, fewer where it is shorter.
std::string first_bytes_within(const std::filesystem::path& path, std::size_t count);

/// Maps a file, or what it holds where it is zstd: that is unpacked into a file without a name, in
/// the folder for temporary files, which is gone with the mapping. Of a packed file that is cut or
/// damaged what comes before. Throws Error where nothing does, where there is no room, and where it
/// grows as no recording does.
MappedFile map_content(const std::filesystem::path& path);

// ---- Containers of chunks: bags of ROS 1, and MCAP ----

/// A run of messages, packed as one.
struct Chunk {
  Compression compression = Compression::none;
  Bytes stored;
  std::uint64_t raw_bytes = 0;
  bool cut = false;       // its end is missing or damaged
  std::uint32_t crc = 0;  // CRC-32 of the content; 0: not known
};

inline constexpr std::uint32_t kNoChunk = 0xffffffff;  // of messages that lie in none

/// What a file of chunks holds and where: read from its index, or found by walking its records
/// where that is missing, cut or damaged.
struct ChunkIndex {
  /// Messages are "cdr", or as ROS 1 lays them out: "ros1".
  struct Channel {
    std::string topic, type, encoding;
  };
  std::map<std::uint32_t, Channel> channels;
  std::map<std::uint32_t, std::vector<MessageRef>> messages;  // by channel, in file order
  std::vector<Chunk> chunks;
  std::vector<std::string> warnings;
  // Of a walk:
  std::uint64_t found_messages = 0;
  std::uint64_t missing_bytes = 0;  // that a cut chunk declares but the file does not hold

  /// Adds messages that a walk found. Throws OutOfBytes where they are more than files hold: chunks
  /// may unpack to any number of them.
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
  /// Adds the warning "WHAT; found N chunks, ...". `declared_chunks`: 0 where nothing says how
  /// many.
  void warn_of_loss(const std::string& what,
                    std::uint64_t declared_chunks = 0,
                    std::uint64_t damaged_bytes = 0);

 private:
  /// As far as it can be unpacked, held by `unpacked` where it was packed; where that is not all,
  /// the chunk is `cut`.
  static Bytes content_of(Chunk& chunk, Unpacked& unpacked);
};

/// A file of chunks, opened by memory map.
class ChunkedLog : public MessageLog {
 public:
  explicit ChunkedLog(const std::filesystem::path& path)
      : MessageLog(path), file_(map_content(path)) {}

  Message read(const MessageRef& message, std::size_t at_most) const override;
  std::size_t unpacking_cost(const MessageRef& message) const override;
  void expect_whole() const override { file_.expect_whole(); }

 protected:
  /// What the record at the reader holds; nullopt where it is no message. Throws OutOfBytes on
  /// damage.
  virtual std::optional<Message> message_at(ByteReader& reader) const = 0;
  /// Takes over what was found, but for channels that are serialized in other ways.
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
  /// The chunks that were unpacked last: neighboring frames and color share them. Last used at the
  /// back.
  mutable std::vector<std::pair<std::uint32_t, HeldBytes>> cache_;
  mutable std::mutex mutex_;
};

}  // namespace planescope::io
