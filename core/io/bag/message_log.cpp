// Code shared by all containers of ROS recordings, and recordings split into several files.

#include "core/io/bag/message_log.hpp"

#include <fmt/format.h>
#include <libdeflate.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::io {

namespace fs = std::filesystem;

const std::vector<MessageRef>& MessageLog::messages(const std::string& topic) const {
  static const std::vector<MessageRef> kNone;
  const auto found = messages_.find(topic);
  return found == messages_.end() ? kNone : found->second;
}

void MessageLog::sort_messages() {
  for (auto& [topic, messages] : messages_) std::ranges::sort(messages, std::less<>());
}

void MessageLog::warn_of_encodings(const std::map<std::string, int>& topics) {
  for (const auto& [encoding, count] : topics)
    warnings_.push_back(fmt::format("skipped {}: serialized as \"{}\"; expected cdr",
                                    counted(static_cast<std::size_t>(count), "topic"), encoding));
}

void expect_start(const MappedFile& file,
                  std::size_t least_bytes,
                  std::string_view start,
                  const char* what,
                  const char* shown) {
  const Bytes bytes = file.bytes();
  if (bytes.size() < least_bytes || std::memcmp(bytes.data(), start.data(), start.size()) != 0)
    throw Error(fmt::format("{}: not {} ({} bytes); expected {} at the start", file.path().string(),
                            what, bytes.size(), shown));
  file.expect_hops();
}

std::string ros_type(std::string type) {
  const std::size_t middle = type.find("/msg/");
  if (middle != std::string::npos) type.erase(middle, 4);
  return type;
}

Message cdr_message(HeldBytes held, Bytes bytes, std::size_t at_most, const std::string& what) {
  if (!is_zstd(bytes)) return {std::move(held), bytes, Wire::cdr};
  const std::uint64_t limit = std::min<std::uint64_t>(at_most, read_limit_bytes());
  Unpacked unpacked = unpack_zstd(bytes, limit);
  if (!unpacked.whole && at_most == kWholeMessage)
    throw Error(fmt::format("{} is damaged: only {} bytes of its zstd frame could be decompressed",
                            what, unpacked.bytes.size()));
  held = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  return {held, *held, Wire::cdr};
}

// ---- Containers of chunks ----

namespace {

/// A walk may find this many messages, plus one for each byte of the file.
constexpr std::uint64_t kMostMessages = 1 << 20;
constexpr std::size_t kCachedChunks = 8, kCachedBytes = 64 << 20;

}  // namespace

Bytes ChunkIndex::content_of(Chunk& chunk, Unpacked& unpacked) {
  if (chunk.compression == Compression::none) return chunk.stored;
  unpacked = unpack(chunk.compression, chunk.stored, chunk.raw_bytes);
  if (!unpacked.whole) chunk.cut = true;
  return unpacked.bytes;
}

void ChunkIndex::add_found(std::uint32_t channel, std::span<const MessageRef> found, Bytes file) {
  std::ranges::copy(found, std::back_inserter(messages[channel]));
  found_messages += found.size();
  if (found_messages > kMostMessages + file.size()) throw OutOfBytes{};
}

void ChunkIndex::warn_of_loss(const std::string& what,
                              std::uint64_t declared_chunks,
                              std::uint64_t damaged_bytes) {
  const auto cut = std::ranges::count_if(chunks, &Chunk::cut);
  std::string text = fmt::format("{}; found {}", what, chunks.size());
  if (declared_chunks > 0) text += fmt::format(" of {}", declared_chunks);
  text += " chunks";
  if (cut > 0) text += fmt::format(", {} of them truncated", cut);
  if (missing_bytes > 0) text += fmt::format(" ({} bytes short)", missing_bytes);
  if (damaged_bytes > 0) text += fmt::format("; {} bytes are unreadable", damaged_bytes);
  warnings.push_back(text + fmt::format("; {} messages recovered", found_messages));
}

void ChunkedLog::take(ChunkIndex index) {
  warnings_ = std::move(index.warnings);
  chunks_ = std::move(index.chunks);
  std::map<std::string, int> others;
  for (const auto& [id, channel] : index.channels) {
    if (channel.encoding != "cdr" && channel.encoding != "ros1") {
      ++others[channel.encoding];
      continue;
    }
    topics_.emplace(channel.topic, channel.type);
    std::ranges::copy(index.messages[id], std::back_inserter(messages_[channel.topic]));
  }
  channels_ = std::move(index.channels);
  sort_messages();
  warn_of_encodings(others);
}

Message ChunkedLog::read(const MessageRef& message, std::size_t at_most) const {
  std::string where = fmt::format("byte {}", message.offset);
  if (message.chunk != kNoChunk) where += fmt::format(" in chunk {}", message.chunk);
  HeldBytes held;
  Bytes around = file_.bytes();
  if (message.chunk != kNoChunk) {
    const Chunk& chunk = chunks_.at(message.chunk);
    around = chunk.stored;
    if (chunk.compression != Compression::none)
      around = *(held = unpacked(message.chunk));
    else if (at_most == kWholeMessage)
      check_stored(message.chunk);
  }
  try {
    ByteReader reader(around);
    reader.take(message.offset);
    if (const std::optional<Message> found = message_at(reader)) {
      const Bytes bytes = found->bytes;
      if (!held) file_.prefetch(bytes.first(std::min(bytes.size(), at_most)));
      if (found->wire == Wire::ros1) return {held, bytes};
      return cdr_message(held, bytes, at_most, path_.string() + ": message at " + where);
    }
  } catch (OutOfBytes) {
    // Reported like a record of another kind.
  }
  throw Error(path_.string() + ": no message at " + where + ", where the index expects one");
}

std::size_t ChunkedLog::unpacking_cost(const MessageRef& message) const {
  constexpr std::size_t kBz2Cost = 20;  // times slower than LZ4, measured on depth images
  if (message.chunk == kNoChunk) return 0;
  const Chunk& chunk = chunks_.at(message.chunk);
  if (chunk.compression == Compression::none) return 0;
  return chunk.raw_bytes * (chunk.compression == Compression::bz2 ? kBz2Cost : 1);
}

void ChunkedLog::check(std::uint32_t number, Bytes content) const {
  const Chunk& chunk = chunks_.at(number);
  if (chunk.crc == 0 || chunk.cut) return;
  const std::uint32_t crc = libdeflate_crc32(0, content.data(), content.size());
  if (crc == chunk.crc) return;
  file_.expect_whole();
  throw Error(fmt::format("{}: chunk {} is damaged: its CRC-32 is {:08x}; expected {:08x}",
                          path_.string(), number, crc, chunk.crc));
}

void ChunkedLog::check_stored(std::uint32_t number) const {
  {
    const std::lock_guard lock(mutex_);
    if (checked_.contains(number)) return;
  }
  check(number, chunks_.at(number).stored);
  const std::lock_guard lock(mutex_);
  checked_.insert(number);
}

HeldBytes ChunkedLog::unpacked(std::uint32_t number) const {
  const Chunk& chunk = chunks_.at(number);
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(cache_, number, [](const auto& one) { return one.first; });
    if (found != cache_.end()) {
      std::rotate(found, found + 1, cache_.end());
      return cache_.back().second;
    }
  }
  const std::string name = fmt::format("{}: chunk {}", path_.string(), number);
  if (!chunk.cut) expect_within_read_limit(static_cast<double>(chunk.raw_bytes), name);
  if (chunk.compression == Compression::unknown)
    throw Error(name + " uses an unknown compression method; expected none, lz4, bz2, or zstd");
  file_.prefetch(chunk.stored);
  // Unpacked outside the lock, so that threads unpack different chunks at the same time.
  Unpacked unpacked = unpack(chunk.compression, chunk.stored, chunk.raw_bytes);
  if (!unpacked.whole && !chunk.cut)
    throw Error(fmt::format("{} is damaged: {} of {} bytes could be decompressed", name,
                            unpacked.bytes.size(), chunk.raw_bytes));
  check(number, unpacked.bytes);
  const auto bytes = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  const std::lock_guard lock(mutex_);
  cache_.emplace_back(number, bytes);
  std::size_t total = 0;
  for (const auto& [cached, held] : cache_) total += held->size();
  while (cache_.size() > 1 && (cache_.size() > kCachedChunks || total > kCachedBytes)) {
    total -= cache_.front().second->size();
    cache_.erase(cache_.begin());
  }
  return bytes;
}

// ---- Recordings that `ros2 bag` split into several files ----

namespace {

class SplitLog : public MessageLog {
 public:
  /// `files`: in recording order.
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
    throw Error(fmt::format("{}: file too large for ROS 2 bag metadata; expected at most {} bytes",
                            metadata.string(), kMostYamlBytes));
  const auto bytes = read_file_bytes(metadata);
  std::vector<std::string> names;
  try {
    const YAML::Node root = YAML::Load(std::string(bytes.begin(), bytes.end()));
    const YAML::Node list = root["rosbag2_bagfile_information"]["relative_file_paths"];
    for (const YAML::Node& name : list) names.push_back(name.as<std::string>());
  } catch (const YAML::Exception& error) {
    throw Error(metadata.string() + ": not ROS 2 bag metadata: " + error.what());
  }
  if (names.empty())
    throw Error(metadata.string() +
                ": lists no files; expected rosbag2_bagfile_information.relative_file_paths");
  return names;
}

/// The files that the metadata.yaml of a folder lists, in its order. Throws Error if the file
/// cannot be read, lists nothing, or lists a missing file.
std::vector<fs::path> files_of_metadata(const fs::path& folder) {
  const fs::path metadata = folder / "metadata.yaml";
  std::vector<fs::path> files;
  for (const std::string& name : names_in(metadata)) {
    // Early versions of ros2 bag wrote the folder's name first.
    const fs::path inside = fs::path(name).lexically_normal();
    if (inside.empty() || inside.is_absolute() || *inside.begin() == "..")
      throw Error(fmt::format(
          "{}: relative_file_paths contains '{}'; expected relative paths inside the bag's folder",
          metadata.string(), name));
    fs::path file = folder / inside.filename();
    if (file.extension() == ".zstd" && fs::exists(fs::path(file).replace_extension()))
      file.replace_extension();  // has been unpacked since
    if (!fs::is_regular_file(file))
      throw Error(metadata.string() + ": lists " + name + ", which does not exist");
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
