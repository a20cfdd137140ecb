// ROS 2 recordings in MCAP: https://mcap.dev/spec. Opening reads the summary and the index after
// each chunk, never the messages; files without a summary are walked.

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <set>

#include "core/io/bag/message_log.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace rosbag2 {
namespace {

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

struct McapIndex : ChunkIndex {
  std::map<std::uint16_t, std::string> schemas;  // message types
};

struct Record {
  Op op{};
  Bytes content;
};

/// Reads one whole record. Throws OutOfBytes if it is incomplete.
Record read_record(ByteReader& reader) {
  const auto op = static_cast<Op>(reader.read<std::uint8_t>());
  return {op, reader.take(reader.read<std::uint64_t>())};
}

/// Adds a schema or a channel; ignores other records.
void add_names(const Record& record, McapIndex& index) {
  if (record.op != Op::schema && record.op != Op::channel) return;
  ByteReader in(record.content);
  const auto id = in.read<std::uint16_t>();
  if (record.op == Op::schema) {
    index.schemas.try_emplace(id, ros_type(std::string(in.read_text())));
    return;
  }
  const auto schema = index.schemas.find(in.read<std::uint16_t>());
  const std::string topic(in.read_text());
  index.channels.try_emplace(
      id, ChunkIndex::Channel{topic, schema == index.schemas.end() ? "" : schema->second,
                              std::string(in.read_text())});
}

/// Adds a chunk whose record may end early. Returns the number of declared bytes that are missing.
std::uint64_t add_chunk(Bytes content, McapIndex& index) {
  ByteReader in(content);
  in.take(16);  // times of the first and the last message
  Chunk chunk;
  chunk.raw_bytes = in.read<std::uint64_t>();
  chunk.crc = in.read<std::uint32_t>();  // checked when it is unpacked
  chunk.compression = parse_compression(in.read_text());
  const auto stored_bytes = in.read<std::uint64_t>();
  const std::size_t there = std::min<std::uint64_t>(stored_bytes, in.left());
  chunk.stored = in.take(there);
  chunk.cut = there < stored_bytes;
  index.chunks.push_back(chunk);
  return stored_bytes - there;
}

// ---- By the summary ----

/// Location of a chunk and of the index records after it.
struct ChunkPlace {
  std::uint64_t start = 0, length = 0, index_bytes = 0;
};

ChunkPlace read_chunk_index(Bytes content) {
  ByteReader in(content);
  in.take(16);
  ChunkPlace place{in.read<std::uint64_t>(), in.read<std::uint64_t>(), 0};
  in.take(in.read<std::uint32_t>());  // offset of each channel's index
  place.index_bytes = in.read<std::uint64_t>();
  return place;
}

/// Adds the entries of the index records after a chunk and returns the number of messages. Throws
/// OutOfBytes if the records are inconsistent.
std::uint64_t add_indexed_chunk(Bytes file, const ChunkPlace& place, McapIndex& index) {
  ByteReader at(file);
  at.take(place.start);
  ByteReader whole(at.take(place.length));
  const Record record = read_record(whole);
  if (record.op != Op::chunk || !whole.done()) throw OutOfBytes{};
  const auto number = static_cast<std::uint32_t>(index.chunks.size());
  if (add_chunk(record.content, index) > 0) throw OutOfBytes{};
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

/// Start of the summary, 0 if there is none. nullopt if the file has no footer.
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

McapIndex read_summary(Bytes file, std::uint64_t start) {
  McapIndex index;
  ByteReader reader(file);
  reader.take(start);
  std::set<std::uint64_t> positions;
  std::uint64_t index_bytes = 0, found = 0;
  std::optional<std::uint64_t> declared;  // messages
  for (Record record; (record = read_record(reader)).op != Op::footer;) {
    add_names(record, index);
    if (record.op == Op::statistics) declared = ByteReader(record.content).read<std::uint64_t>();
    if (record.op != Op::chunk_index) continue;
    const ChunkPlace place = read_chunk_index(record.content);
    // Overlapping chunks could share their entries: allow only as many bytes as the file has.
    index_bytes += std::min<std::uint64_t>(place.index_bytes, file.size());
    if (!positions.insert(place.start).second || index_bytes > file.size()) throw OutOfBytes{};
    found += add_indexed_chunk(file, place, index);
  }
  // Only walking finds messages outside chunks and in chunks without an index. Without statistics,
  // it is unknown whether there are any.
  if (declared != found) throw OutOfBytes{};
  for (const auto& [channel, messages] : index.messages)
    if (!index.channels.contains(channel)) throw OutOfBytes{};
  return index;
}

// ---- By walking ----

/// Adds a schema, channel or message at `offset` of a chunk or the file.
void take_record(
    McapIndex& index, Bytes file, const Record& record, std::uint32_t chunk, std::uint64_t offset) {
  add_names(record, index);
  if (record.op != Op::message) return;
  if (record.content.size() < kMessageHeader) throw OutOfBytes{};
  ByteReader in(record.content);
  const auto channel = in.read<std::uint16_t>();
  in.take(4);  // sequence number
  const MessageRef message{in.read<std::uint64_t>(), 0, chunk, offset};
  index.add_found(channel, {&message, 1}, file);
}

void walk_chunk(McapIndex& index, Bytes file, Bytes content) {
  index.missing_bytes += add_chunk(content, index);
  index.walk_chunk(index.chunks.size() - 1,
                   [&](ByteReader& reader, std::uint32_t chunk, std::size_t offset) {
                     take_record(index, file, read_record(reader), chunk, offset);
                   });
}

/// Warns unless the data before its end record has the CRC in that record. Writers start counting
/// at the start of the file, after the magic, or after the header.
void check_data(Bytes data, const Record& end, McapIndex& index) {
  const auto crc = ByteReader(end.content).read<std::uint32_t>();
  ByteReader header(data);
  header.take(kMcapMagic.size());
  read_record(header);
  for (const std::size_t start : {std::size_t{0}, kMcapMagic.size(), header.position()}) {
    const Bytes part = data.subspan(start);
    if (crc == 0 || libdeflate_crc32(0, part.data(), part.size()) == crc) return;
  }
  index.warnings.push_back(fmt::format(
      "the file is damaged: its data does not match its CRC-32, {:08x}; {} messages outside "
      "chunks may be wrong",
      crc, index.found_messages));
}

/// `has_end`: whether the file has a footer.
McapIndex walk_records(Bytes file, bool has_end) {
  McapIndex index;
  ByteReader reader(file);
  reader.take(kMcapMagic.size());
  bool ended = false;  // the end of the data was reached
  while (!reader.done() && !ended) {
    ByteReader at = reader;
    try {
      const std::uint64_t offset = reader.position();
      const Record record = read_record(reader);
      ended = record.op == Op::data_end || record.op == Op::footer;
      if (record.op == Op::data_end && index.chunks.empty())  // chunks have their own
        check_data(file.first(offset), record, index);
      if (record.op == Op::chunk)
        walk_chunk(index, file, record.content);
      else
        take_record(index, file, record, kNoChunk, offset);
    } catch (OutOfBytes) {
      try {  // the chunk may end early, or even within its header
        if (static_cast<Op>(at.read<std::uint8_t>()) == Op::chunk) {
          at.take(8);
          walk_chunk(index, file, at.take(at.left()));
        }
      } catch (OutOfBytes) {
      }
      break;
    }
  }
  const bool whole = ended && std::ranges::none_of(index.chunks, &Chunk::cut);
  if (!whole || !has_end)
    index.warn_of_loss(has_end ? "the file is damaged"
                               : "the file has no footer: it is truncated or was never closed");
  return index;
}

McapIndex index_of(Bytes file) {
  const auto start = summary_start(file);
  if (start && *start > 0) try {
      return read_summary(file, *start);
    } catch (OutOfBytes) {
      // Walk the file instead.
    }
  return walk_records(file, start.has_value());
}

class McapLog : public ChunkedLog {
 public:
  explicit McapLog(const std::filesystem::path& path) : ChunkedLog(path) {
    expect_start(file_, kMcapMagic.size(), kMcapMagic, "an MCAP file", "\"\\x89MCAP0\"");
    take(index_of(file_.bytes()));
  }

  std::string kind() const override { return "ROS 2 bag (MCAP)"; }

 protected:
  std::optional<Message> message_at(ByteReader& reader) const override {
    const Record record = read_record(reader);
    if (record.op != Op::message || record.content.size() < kMessageHeader) return std::nullopt;
    const auto channel = channels_.find(ByteReader(record.content).read<std::uint16_t>());
    const bool is_ros1 = channel != channels_.end() && channel->second.encoding == "ros1";
    return Message{nullptr, record.content.subspan(kMessageHeader),
                   is_ros1 ? Wire::ros1 : Wire::cdr};
  }
};

}  // namespace
}  // namespace rosbag2

std::unique_ptr<MessageLog> open_mcap(const std::filesystem::path& path) {
  return std::make_unique<rosbag2::McapLog>(path);
}

}  // namespace planescope::io
