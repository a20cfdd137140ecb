#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "core/io/bag/chunks.hpp"
#include "core/io/bag/message_log.hpp"
#include "core/io/mapped_file.hpp"

namespace planescope::io::rosbag2 {

// https://mcap.dev/spec
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

/// What an MCAP file holds and where: found in its summary, or by walking its records where there
/// is none or it does not add up.
struct McapIndex {
  /// Messages are CDR, or as ROS 1 lays them out where a bag of ROS 1 was converted.
  struct Channel {
    std::string topic, type, encoding;
  };
  std::map<std::uint16_t, std::string> schemas;  // types of messages
  std::map<std::uint16_t, Channel> channels;
  std::map<std::uint16_t, std::vector<MessageRef>> messages;  // by channel, in file order
  std::vector<Chunk> chunks;
  std::vector<std::string> warnings;
};

/// A ROS 2 recording in MCAP, opened by memory map. Opening reads the summary and the index behind
/// each chunk, never the messages.
class McapLog : public MessageLog {
 public:
  /// Throws Error when the file is none.
  explicit McapLog(const std::filesystem::path& path);

  std::string kind() const override { return "ROS 2 bag (MCAP)"; }
  std::vector<MessageRef> messages(const std::string& topic) const override;
  Message read(const MessageRef& message, std::size_t at_most = kWholeMessage) const override;
  std::size_t unpacking_cost(const MessageRef& message) const override;
  void expect_whole() const override { file_.expect_whole(); }

 private:
  MappedFile file_;
  McapIndex index_;
  mutable ChunkCache cache_;
};

}  // namespace planescope::io::rosbag2
