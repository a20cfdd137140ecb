#pragma once

#include <memory>
#include <vector>

#include "core/io/bag/message_log.hpp"

namespace planescope::io {

/// A recording that `ros2 bag` split into several files, in their order.
class SplitLog : public MessageLog {
 public:
  /// Of the folder that they lie in; at least one. Throws Error where one cannot be opened.
  SplitLog(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files);

  std::string kind() const override { return logs_.front()->kind(); }
  std::vector<MessageRef> messages(const std::string& topic) const override;
  Message read(const MessageRef& message, std::size_t at_most = kWholeMessage) const override {
    return logs_.at(message.file)->read(message, at_most);
  }
  std::size_t unpacking_cost(const MessageRef& message) const override {
    return logs_.at(message.file)->unpacking_cost(message);
  }
  void expect_whole() const override {
    for (const auto& log : logs_) log->expect_whole();
  }

 private:
  std::vector<std::unique_ptr<MessageLog>> logs_;
};

}  // namespace planescope::io
