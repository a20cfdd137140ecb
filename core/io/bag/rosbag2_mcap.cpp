// ROS 2 recordings in MCAP: https://mcap.dev/spec. Opening reads the summary and the index behind
// each chunk, never the messages; files without a summary are walked.

#include <algorithm>
#include <optional>
#include <set>

#include "core/io/bag/compression.hpp"
#include "core/io/bag/ros_messages.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace rosbag2 {
namespace {

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

enum class Op : std::uint8_t {
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  data_end = 0x0f,
};

constexpr std::size_t kMessageHeader = 2 + 4 + 8 + 8;  // channel, sequence, two times

struct Record {
  Op op{};
  Bytes content;
};

/// Reads one whole record. Throws OutOfBytes when it is not all there.
Record read_record(ByteReader& reader) {
  const auto op = static_cast<Op>(reader.read<std::uint8_t>());
  return {op, reader.take(reader.read<std::uint64_t>())};
}

void add_schema(Bytes content, McapIndex& index) {
  ByteReader in(content);
  const auto id = in.read<std::uint16_t>();
  index.schemas.try_emplace(id, ros::ros_type(std::string(in.read_text())));
}

void add_channel(Bytes content, McapIndex& index) {
  ByteReader in(content);
  const auto id = in.read<std::uint16_t>();
  const auto schema = index.schemas.find(in.read<std::uint16_t>());
  const std::string topic(in.read_text());
  index.channels.try_emplace(
      id, McapIndex::Channel{topic, schema == index.schemas.end() ? "" : schema->second,
                             std::string(in.read_text())});
}

struct ReadChunk {
  Chunk chunk;
  std::uint64_t missing_bytes = 0;  // that it declares and the file does not hold
};

/// `content` may end early.
ReadChunk read_chunk(Bytes content) {
  ByteReader in(content);
  in.take(16);  // times of the first and the last message
  ReadChunk read;
  read.chunk.raw_bytes = in.read<std::uint64_t>();
  read.chunk.crc = in.read<std::uint32_t>();  // checked where it is unpacked
  read.chunk.compression = parse_compression(in.read_text());
  const auto stored_bytes = in.read<std::uint64_t>();
  const std::size_t there = std::min<std::uint64_t>(stored_bytes, in.left());
  read.chunk.stored = in.take(there);
  read.missing_bytes = stored_bytes - there;
  read.chunk.cut = read.missing_bytes > 0;
  return read;
}

// --- By the summary ---

/// Where a chunk is, and the index records behind it.
struct ChunkPlace {
  std::uint64_t start = 0, length = 0, index_bytes = 0;
};

ChunkPlace read_chunk_index(Bytes content) {
  ByteReader in(content);
  in.take(16);
  ChunkPlace place{in.read<std::uint64_t>(), in.read<std::uint64_t>(), 0};
  in.take(in.read<std::uint32_t>());  // where the index of each channel is
  place.index_bytes = in.read<std::uint64_t>();
  return place;
}

/// Adds what the index records behind a chunk say; returns how many messages. Throws OutOfBytes
/// when they do not add up.
std::uint64_t add_chunk(Bytes file, const ChunkPlace& place, McapIndex& index) {
  ByteReader at(file);
  at.take(place.start);
  ByteReader whole(at.take(place.length));
  const Record record = read_record(whole);
  if (record.op != Op::chunk || !whole.done()) throw OutOfBytes{};
  const auto number = static_cast<std::uint32_t>(index.chunks.size());
  index.chunks.push_back(read_chunk(record.content).chunk);
  if (index.chunks.back().cut) throw OutOfBytes{};
  ByteReader entries(at.take(place.index_bytes));
  std::uint64_t count = 0;
  while (!entries.done()) {
    const Record of_channel = read_record(entries);
    if (of_channel.op != Op::message_index) throw OutOfBytes{};
    ByteReader list(of_channel.content);
    auto& messages = index.messages[list.read<std::uint16_t>()];
    ByteReader pairs(list.take_sized());
    for (; !pairs.done(); ++count) {
      const auto time_ns = pairs.read<std::uint64_t>();
      const auto offset = pairs.read<std::uint64_t>();
      if (offset >= index.chunks.back().raw_bytes) throw OutOfBytes{};
      messages.push_back({time_ns, 0, number, offset});
    }
  }
  return count;
}

/// Where the summary begins, 0 where there is none. Nothing where the file has no end.
std::optional<std::uint64_t> summary_start(Bytes file) {
  constexpr std::size_t kFooter = 1 + 8 + 8 + 8 + 4;
  if (file.size() < kFooter + 2 * kMcapMagic.size()) return std::nullopt;
  const Bytes magic = file.last(kMcapMagic.size());
  if (std::memcmp(magic.data(), kMcapMagic.data(), kMcapMagic.size()) != 0) return std::nullopt;
  ByteReader in(file.last(kFooter + kMcapMagic.size()));
  if (static_cast<Op>(in.read<std::uint8_t>()) != Op::footer) return std::nullopt;
  in.take(8);
  return in.read<std::uint64_t>();
}

void read_summary(Bytes file, std::uint64_t start, McapIndex& index) {
  ByteReader reader(file);
  reader.take(start);
  std::set<std::uint64_t> positions;
  std::uint64_t index_bytes = 0, found = 0;
  std::optional<std::uint64_t> declared;
  for (Record record; (record = read_record(reader)).op != Op::footer;) {
    if (record.op == Op::schema) add_schema(record.content, index);
    if (record.op == Op::channel) add_channel(record.content, index);
    if (record.op == Op::statistics) declared = ByteReader(record.content).read<std::uint64_t>();
    if (record.op != Op::chunk_index) continue;
    const ChunkPlace place = read_chunk_index(record.content);
    // Chunks that overlap could share their entries: there is room for each once.
    index_bytes += std::min<std::uint64_t>(place.index_bytes, file.size());
    if (!positions.insert(place.start).second || index_bytes > file.size()) throw OutOfBytes{};
    found += add_chunk(file, place, index);
  }
  // Messages outside chunks, and those of chunks without an index, are found by walking alone.
  if (declared.value_or(0) != found) throw OutOfBytes{};
  for (const auto& [channel, messages] : index.messages)
    if (!index.channels.contains(channel)) throw OutOfBytes{};
}

// --- By walking ---

struct Walk {
  McapIndex index;
  std::uint64_t messages = 0, missing_bytes = 0;
  bool ended = false;  // the record that ends the data was reached
};

void add_message(
    Walk& walk, Bytes file, const Record& record, std::uint32_t chunk, std::uint64_t offset) {
  if (record.content.size() < kMessageHeader) throw OutOfBytes{};
  ByteReader in(record.content);
  const auto channel = in.read<std::uint16_t>();
  in.take(4);  // its number in the channel
  walk.index.messages[channel].push_back({in.read<std::uint64_t>(), 0, chunk, offset});
  // Chunks may unpack to any number of them.
  if (++walk.messages > kMostMessages + file.size()) throw OutOfBytes{};
}

/// Schemas, channels and messages inside a chunk, as far as it can be unpacked.
void walk_chunk(Walk& walk, Bytes file, const ReadChunk& read) {
  const auto number = static_cast<std::uint32_t>(walk.index.chunks.size());
  walk.index.chunks.push_back(read.chunk);
  walk.missing_bytes += read.missing_bytes;
  Chunk& chunk = walk.index.chunks.back();
  Unpacked unpacked;
  ByteReader reader(content_that_is_there(chunk, unpacked));
  try {
    while (!reader.done()) {
      const std::uint64_t offset = reader.position();
      const Record record = read_record(reader);
      if (record.op == Op::schema) add_schema(record.content, walk.index);
      if (record.op == Op::channel) add_channel(record.content, walk.index);
      if (record.op == Op::message) add_message(walk, file, record, number, offset);
    }
  } catch (OutOfBytes) {
    chunk.cut = true;
  }
}

/// The chunk whose record starts here though its end is missing.
void walk_cut_chunk(Walk& walk, Bytes file, ByteReader reader) {
  try {
    if (static_cast<Op>(reader.read<std::uint8_t>()) != Op::chunk) return;
    reader.take(8);
    walk_chunk(walk, file, read_chunk(reader.take(reader.left())));
  } catch (OutOfBytes) {
    // Not even its head is there.
  }
}

Walk walk_records(Bytes file) {
  Walk walk;
  ByteReader reader(file);
  reader.take(kMcapMagic.size());
  while (!reader.done() && !walk.ended) {
    const ByteReader before = reader;
    try {
      const std::uint64_t offset = reader.position();
      const Record record = read_record(reader);
      switch (record.op) {
        case Op::schema:
          add_schema(record.content, walk.index);
          break;
        case Op::channel:
          add_channel(record.content, walk.index);
          break;
        case Op::message:
          add_message(walk, file, record, kNoChunk, offset);
          break;
        case Op::chunk:
          walk_chunk(walk, file, read_chunk(record.content));
          break;
        case Op::data_end:
        case Op::footer:
          walk.ended = true;
          break;
        default:
          break;
      }
    } catch (OutOfBytes) {
      walk_cut_chunk(walk, file, before);
      break;
    }
  }
  return walk;
}

std::string describe(const Walk& walk, bool has_end) {
  const auto cut = std::ranges::count_if(walk.index.chunks, &Chunk::cut);
  std::string text =
      has_end ? "the file is damaged" : "the file has no end: it is cut or was never closed";
  text += "; found " + std::to_string(walk.index.chunks.size()) + " chunks";
  if (cut > 0) text += ", " + std::to_string(cut) + " of them cut";
  if (walk.missing_bytes > 0) text += " (" + std::to_string(walk.missing_bytes) + " bytes short)";
  return text + "; " + std::to_string(walk.messages) + " messages recovered";
}

McapIndex index_of(const MappedFile& mapped, const std::filesystem::path& path) {
  const Bytes file = mapped.bytes();
  if (file.size() < kMcapMagic.size() ||
      std::memcmp(file.data(), kMcapMagic.data(), kMcapMagic.size()) != 0) {
    throw Error(path.string() + ": not an MCAP file (" + std::to_string(file.size()) +
                " bytes that do not start with \"\\x89MCAP0\")");
  }
  mapped.expect_hops();
  const auto start = summary_start(file);
  if (start && *start > 0) {
    try {
      McapIndex index;
      read_summary(file, *start, index);
      return index;
    } catch (OutOfBytes) {
      // Walked instead.
    }
  }
  Walk walk = walk_records(file);
  const bool whole = walk.ended && std::ranges::none_of(walk.index.chunks, &Chunk::cut);
  if (!whole || !start) walk.index.warnings.push_back(describe(walk, start.has_value()));
  return std::move(walk.index);
}

bool is_readable(const McapIndex::Channel& channel) {
  return channel.encoding == "cdr" || channel.encoding == "ros1";
}

class McapLog : public ChunkedLog {
 public:
  explicit McapLog(const std::filesystem::path& path) : ChunkedLog(path) {
    McapIndex index = index_of(file_, path);
    warnings_ = std::move(index.warnings);
    chunks_ = std::move(index.chunks);
    channels_ = std::move(index.channels);
    std::map<std::string, int> others;
    for (const auto& [id, channel] : channels_) {
      if (!is_readable(channel)) {
        ++others[channel.encoding];
        continue;
      }
      topics_.emplace(channel.topic, channel.type);
      auto& of_topic = messages_[channel.topic];
      const auto& more = index.messages[id];
      of_topic.insert(of_topic.end(), more.begin(), more.end());
    }
    sort_messages();
    ros::warn_of_encodings(others, warnings_);
  }

  std::string kind() const override { return "ROS 2 bag (MCAP)"; }
  Message read(const MessageRef& message, std::size_t at_most) const override {
    std::string where = "byte " + std::to_string(message.offset);
    if (message.chunk != kNoChunk) where += " of chunk " + std::to_string(message.chunk);
    Message result = around(message);
    try {
      ByteReader reader(result.bytes);
      reader.take(message.offset);
      const Record record = read_record(reader);
      if (record.op == Op::message && record.content.size() >= kMessageHeader) {
        const auto id = ByteReader(record.content).read<std::uint16_t>();
        const auto channel = channels_.find(id);
        result.bytes = record.content.subspan(kMessageHeader);
        if (!result.held)
          file_.prefetch(result.bytes.first(std::min(result.bytes.size(), at_most)));
        if (channel != channels_.end() && channel->second.encoding == "ros1") return result;
        return ros::cdr_message(result.held, result.bytes, at_most,
                                path_.string() + ": message at " + where);
      }
    } catch (OutOfBytes) {
      // The same to the user as a record of another kind.
    }
    throw Error(path_.string() + ": no message at " + where + ", where its index places one");
  }

 private:
  std::map<std::uint16_t, McapIndex::Channel> channels_;
};

}  // namespace
}  // namespace rosbag2

std::unique_ptr<MessageLog> open_mcap(const std::filesystem::path& path) {
  return std::make_unique<rosbag2::McapLog>(path);
}

}  // namespace planescope::io
