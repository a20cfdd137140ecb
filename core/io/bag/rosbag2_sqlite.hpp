#pragma once

#include <mutex>
#include <vector>

#include "core/io/bag/mapped_sqlite.hpp"
#include "core/io/bag/message_log.hpp"

namespace planescope::io::rosbag2 {

/// A ROS 2 recording in SQLite: a table `topics` and a table `messages` of blobs. Opening reads the
/// numbers and times of the messages, never the blobs.
class SqliteLog : public MessageLog {
 public:
  /// Throws Error when the file is no such recording.
  explicit SqliteLog(const std::filesystem::path& path);

  std::string kind() const override { return "ROS 2 bag (SQLite)"; }
  std::vector<MessageRef> messages(const std::string& topic) const override;
  Message read(const MessageRef& message, std::size_t at_most = kWholeMessage) const override;
  void expect_whole() const override { file_.file().expect_whole(); }

 private:
  void read_topics();
  void read_index();
  void drop_cut_messages();
  void warn_of_loss();
  bool can_be_read(std::int64_t id, std::size_t& bytes) const;

  MappedSqlite file_;
  mutable std::mutex mutex_;  // a connection serves one thread at a time
  std::map<std::int64_t, std::string> topic_of_;
  std::map<std::string, std::vector<MessageRef>> messages_;
  std::uint64_t count_ = 0;
  std::string damage_;  // what could not be indexed, for people
};

}  // namespace planescope::io::rosbag2
