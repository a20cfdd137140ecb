#include "core/io/bag/split_log.hpp"

#include <algorithm>

namespace planescope::io {

SplitLog::SplitLog(const std::filesystem::path& folder,
                   const std::vector<std::filesystem::path>& files)
    : MessageLog(folder) {
  for (const std::filesystem::path& file : files) {
    logs_.push_back(open_message_log(file));
    const MessageLog& log = *logs_.back();
    topics_.insert(log.topics().begin(), log.topics().end());
    for (const std::string& warning : log.warnings())
      warnings_.push_back(file.filename().string() + ": " + warning);
  }
}

std::vector<MessageRef> SplitLog::messages(const std::string& topic) const {
  std::vector<MessageRef> all;
  for (std::uint32_t file = 0; file < logs_.size(); ++file) {
    for (MessageRef message : logs_[file]->messages(topic)) {
      message.file = file;
      all.push_back(message);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace planescope::io
