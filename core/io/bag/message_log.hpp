#pragma once

// Messages by topic: what all containers of ROS recordings hold.

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/io/mapped_file.hpp"

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

/// A message's bytes, kept alive by `held` where they do not lie in a mapped file.
struct Message {
  std::shared_ptr<const std::vector<std::byte>> held;
  Bytes bytes;
  Wire wire = Wire::ros1;
};

inline constexpr std::size_t kWholeMessage = std::numeric_limits<std::size_t>::max();

/// Messages by topic, as every container of ROS recordings holds them. Reading is const and
/// thread-safe.
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
  bool has(const std::string& topic) const { return topics_.contains(topic); }

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
  virtual void expect_whole() const {}

  /// What `read` returns or throws, but for what came of a file that was cut meanwhile.
  template <typename Read>
  auto guarded(const Read& read) const {
    return guarded_by(*this, read);
  }

 protected:
  void sort_messages();

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

}  // namespace planescope::io
