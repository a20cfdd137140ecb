#include "core/io/bag/message_log.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "core/io/bag/compression.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {

const std::vector<MessageRef>& MessageLog::messages(const std::string& topic) const {
  static const std::vector<MessageRef> kNone;
  const auto found = messages_.find(topic);
  return found == messages_.end() ? kNone : found->second;
}

void MessageLog::sort_messages() {
  for (auto& [topic, messages] : messages_) std::sort(messages.begin(), messages.end());
}

namespace {

namespace fs = std::filesystem;

/// A recording that `ros2 bag` split into several files, in their order.
class SplitLog : public MessageLog {
 public:
  SplitLog(const fs::path& folder, const std::vector<fs::path>& files) : MessageLog(folder) {
    for (const fs::path& file : files) {
      logs_.push_back(open_message_log(file));
      const MessageLog& log = *logs_.back();
      topics_.insert(log.topics().begin(), log.topics().end());
      for (const std::string& warning : log.warnings())
        warnings_.push_back(file.filename().string() + ": " + warning);
      for (const auto& [topic, type] : log.topics())
        for (MessageRef message : log.messages(topic)) {
          message.file = static_cast<std::uint32_t>(logs_.size() - 1);
          messages_[topic].push_back(message);
        }
    }
    sort_messages();
  }

  std::string kind() const override { return logs_.front()->kind(); }
  Message read(const MessageRef& message, std::size_t at_most) const override {
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

constexpr std::uintmax_t kMostYamlBytes = 1 << 22;

std::vector<std::string> names_in(const fs::path& metadata) {
  if (fs::file_size(metadata) > kMostYamlBytes)
    throw Error(metadata.string() + ": is larger than a list of files, expected one of ros2 bag");
  const auto bytes = read_file_bytes(metadata);
  std::vector<std::string> names;
  try {
    const YAML::Node root = YAML::Load(std::string(bytes.begin(), bytes.end()));
    const YAML::Node list = root["rosbag2_bagfile_information"]["relative_file_paths"];
    for (const YAML::Node& name : list) names.push_back(name.as<std::string>());
  } catch (const YAML::Exception& error) {
    throw Error(metadata.string() + ": is no metadata of ros2 bag: " + error.what());
  }
  if (names.empty())
    throw Error(metadata.string() +
                ": lists no files, expected rosbag2_bagfile_information.relative_file_paths");
  return names;
}

/// The files that the metadata.yaml of a folder lists, in its order. Throws Error where it cannot
/// be read, names none, or one of them is not there.
std::vector<fs::path> files_of_metadata(const fs::path& folder) {
  const fs::path metadata = folder / "metadata.yaml";
  std::vector<fs::path> files;
  for (const std::string& name : names_in(metadata)) {
    fs::path file = folder / fs::path(name).filename();  // once with the folder before it
    if (file.extension() == ".zstd" && fs::exists(fs::path(file).replace_extension()))
      file.replace_extension();  // unpacked since
    if (!fs::is_regular_file(file))
      throw Error(metadata.string() + ": lists " + name + ", which is not there");
    files.push_back(file);
  }
  return files;
}

}  // namespace

std::unique_ptr<MessageLog> open_message_log(const fs::path& path) {
  if (fs::is_directory(path)) return std::make_unique<SplitLog>(path, files_of_metadata(path));
  const std::string magic = first_bytes_within(path, 8);
  const std::string kind = extension(name_within(path));
  if (magic == "SQLite f" || kind == ".db3") return open_sqlite_log(path);
  if (magic == kMcapMagic || kind == ".mcap") return open_mcap(path);
  return open_rosbag1(path);
}

}  // namespace planescope::io
