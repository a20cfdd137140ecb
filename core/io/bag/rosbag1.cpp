// ROS 1 bags: http://wiki.ros.org/Bags/Format/2.0. Read from the index at the end, or by walking
// the chunks if the index is missing, truncated or damaged.

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/io/bag/message_log.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace rosbag1 {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

enum class Op : std::uint8_t {
  message = 2,
  bag_header = 3,
  index_data = 4,
  chunk = 5,
  chunk_info = 6,
  connection = 7,
};

/// The header of a record: `name=value` fields. Throws OutOfBytes if it is damaged, a field is
/// missing, or a number has the wrong size.
class Fields {
 public:
  explicit Fields(Bytes header) : header_(header) {}

  std::string_view text(std::string_view name) const {
    for (ByteReader reader(header_); !reader.done();) {
      const std::string_view field = reader.read_text();
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw OutOfBytes{};
      if (field.substr(0, equals) == name) return field.substr(equals + 1);
    }
    throw OutOfBytes{};
  }
  template <typename T>
  T get(std::string_view name) const {
    const std::string_view value = text(name);
    if (value.size() != sizeof(T)) throw OutOfBytes{};
    return ByteReader(std::as_bytes(std::span(value))).read<T>();
  }
  Op op() const { return static_cast<Op>(get<std::uint8_t>("op")); }

 private:
  Bytes header_;
};

struct Record {
  Fields header;
  Bytes data;
};

/// Reads one whole record. Throws OutOfBytes if it is incomplete.
Record read_record(ByteReader& reader) {
  const Bytes header = reader.take_sized();
  return {Fields(header), reader.take_sized()};
}

Record read_record_of(Op op, ByteReader& reader) {
  const Record record = read_record(reader);
  if (record.header.op() != op) throw OutOfBytes{};
  return record;
}

/// Converts a ROS time as bags store it: seconds in the low half, nanoseconds in the high half.
std::uint64_t nanoseconds(std::uint64_t time) {
  return (time & 0xffffffffu) * 1'000'000'000u + (time >> 32);
}

void add_connection(const Record& record, ChunkIndex& index) {
  const Fields description(record.data);
  index.channels.try_emplace(record.header.get<std::uint32_t>("conn"),
                             ChunkIndex::Channel{std::string(record.header.text("topic")),
                                                 std::string(description.text("type")), "ros1"});
}

Chunk chunk_of(const Record& record) {
  const auto raw_bytes = record.header.get<std::uint32_t>("size");
  return {parse_compression(record.header.text("compression")), record.data, raw_bytes};
}

/// The messages of a chunk that an INDEX_DATA record lists. Throws OutOfBytes if it is damaged.
std::vector<MessageRef> index_entries(const Record& record,
                                      std::uint32_t chunk,
                                      std::uint64_t raw_bytes) {
  if (record.header.get<std::uint32_t>("ver") != 1) throw OutOfBytes{};
  std::vector<MessageRef> messages;
  ByteReader entries(record.data);
  while (!entries.done()) {
    const std::uint64_t time = nanoseconds(entries.read<std::uint64_t>());
    const auto offset = entries.read<std::uint32_t>();
    if (offset >= raw_bytes) throw OutOfBytes{};
    messages.push_back({time, 0, chunk, offset});
  }
  return messages;
}

/// Throws OutOfBytes if any of the index at the end of the bag is missing or inconsistent.
ChunkIndex read_index(Bytes file) {
  ChunkIndex index;
  ByteReader start(file);
  start.take(kMagic.size());
  const Record bag_header = read_record_of(Op::bag_header, start);
  const auto index_position = bag_header.header.get<std::uint64_t>("index_pos");
  if (index_position == 0) throw OutOfBytes{};
  ByteReader reader(file);
  reader.take(index_position);
  const auto connections = bag_header.header.get<std::uint32_t>("conn_count");
  for (std::uint32_t i = 0; i < connections; ++i)
    add_connection(read_record_of(Op::connection, reader), index);
  const auto chunks = bag_header.header.get<std::uint32_t>("chunk_count");
  std::set<std::uint64_t> positions;
  std::uint64_t entry_bytes = 0;
  for (std::uint32_t i = 0; i < chunks; ++i) {
    const Record info = read_record_of(Op::chunk_info, reader);
    ByteReader at_chunk(file);
    const auto position = info.header.get<std::uint64_t>("chunk_pos");
    if (!positions.insert(position).second) throw OutOfBytes{};
    at_chunk.take(position);
    index.chunks.push_back(chunk_of(read_record_of(Op::chunk, at_chunk)));
    const auto parts = info.header.get<std::uint32_t>("count");  // one per connection
    for (std::uint32_t part = 0; part < parts; ++part) {
      const Record entries = read_record_of(Op::index_data, at_chunk);
      // Overlapping chunks could share their entries: allow only as many bytes as the file has.
      entry_bytes += entries.data.size();
      if (entry_bytes > file.size()) throw OutOfBytes{};
      std::ranges::copy(
          index_entries(entries, i, index.chunks.back().raw_bytes),
          std::back_inserter(index.messages[entries.header.get<std::uint32_t>("conn")]));
    }
  }
  return index;
}

// ---- Without an index ---------------------------------------------------------------------------

/// Walks a bag whose index is missing, truncated or damaged. Unpacks only chunks without usable
/// index records.
class Scan {
 public:
  explicit Scan(Bytes file) : file_(file) {}

  /// Reports missing data in `warnings`.
  ChunkIndex index() {
    std::uint64_t damaged_bytes = 0;  // skipped because they contain no readable record
    std::size_t position = kMagic.size();
    while (position < file_.size()) {
      ByteReader reader(file_.subspan(position));
      try {
        take_record(reader);
        position += reader.position();
      } catch (OutOfBytes) {
        if (take_cut_chunk(ByteReader(file_.subspan(position)))) break;
        const std::size_t next = find_chunk(position);
        damaged_bytes += next - position;
        position = next;
      }
    }
    index_.warn_of_loss(what_is_missing(), declared_chunks_, damaged_bytes);
    return std::move(index_);
  }

 private:
  /// Processes the record at the reader and moves past it. Throws OutOfBytes on damage.
  void take_record(ByteReader& reader) {
    const Record record = read_record(reader);
    switch (record.header.op()) {
      case Op::bag_header:
        index_position_ = record.header.get<std::uint64_t>("index_pos");
        declared_chunks_ = record.header.get<std::uint32_t>("chunk_count");
        break;
      case Op::connection:
        add_connection(record, index_);
        break;
      case Op::chunk:
        if (record.data.empty()) throw OutOfBytes{};
        index_.chunks.push_back(chunk_of(record));
        if (!take_index_records(reader)) walk_chunk();
        break;
      case Op::index_data:  // of a walked chunk
      case Op::chunk_info:
      case Op::message:
        break;
      default:
        throw OutOfBytes{};
    }
  }

  /// Walks the connections and messages inside the last chunk.
  void walk_chunk() {
    index_.walk_chunk(
        index_.chunks.size() - 1, [&](ByteReader& reader, std::uint32_t chunk, std::size_t offset) {
          const Record record = read_record(reader);
          if (record.header.op() == Op::connection) add_connection(record, index_);
          if (record.header.op() != Op::message) return;
          const std::uint64_t time = nanoseconds(record.header.get<std::uint64_t>("time"));
          const MessageRef message{time, 0, chunk, offset};
          index_.add_found(record.header.get<std::uint32_t>("conn"), {&message, 1}, file_);
        });
  }

  /// Uses the INDEX_DATA records after the last chunk, which avoids unpacking it. They are used
  /// only if all of them are present (another record follows) and name only known connections.
  /// Moves the reader past them.
  bool take_index_records(ByteReader& reader) {
    const auto number = static_cast<std::uint32_t>(index_.chunks.size() - 1);
    std::vector<std::pair<std::uint32_t, std::vector<MessageRef>>> found;
    try {
      while (true) {
        ByteReader next = reader;
        if (Fields(next.take_sized()).op() != Op::index_data) break;
        const Record record = read_record(reader);
        const auto connection = record.header.get<std::uint32_t>("conn");
        if (!index_.channels.contains(connection)) return false;
        found.emplace_back(connection,
                           index_entries(record, number, index_.chunks.back().raw_bytes));
      }
    } catch (OutOfBytes) {
      return false;
    }
    for (const auto& [connection, messages] : found) index_.add_found(connection, messages, file_);
    return !found.empty();
  }

  /// Adds a chunk record at this position whose end is missing: the last one of a recording that
  /// was interrupted (no size declared yet) or truncated. Its content is the rest of the file.
  bool take_cut_chunk(ByteReader reader) {
    try {
      const Fields header(reader.take_sized());
      if (header.op() != Op::chunk) return false;
      const auto stored_bytes = reader.read<std::uint32_t>();
      const auto raw_bytes = header.get<std::uint32_t>("size");
      if (stored_bytes != 0 && stored_bytes <= reader.left()) return false;
      const std::size_t rest = std::min<std::size_t>(reader.left(), 0xffffffffu);
      if (stored_bytes != 0) index_.missing_bytes = stored_bytes - rest;
      index_.chunks.push_back({parse_compression(header.text("compression")), reader.take(rest),
                               stored_bytes == 0 ? 0xffffffffu : raw_bytes, true});
    } catch (OutOfBytes) {
      return false;
    }
    walk_chunk();
    return true;
  }

  /// Possible start of the next chunk after `from`: its header begins with two lengths and
  /// `compression=`.
  std::size_t find_chunk(std::size_t from) const {
    const std::string_view text(reinterpret_cast<const char*>(file_.data()), file_.size());
    const std::size_t found = text.find("compression=", from + 1 + 8);
    return found == std::string_view::npos ? file_.size() : found - 8;
  }

  std::string what_is_missing() const {
    const std::uint64_t size = file_.size(), at = index_position_;
    if (at == 0) return "the recording was never closed and has no index";
    if (at <= size) return "the index is truncated or damaged";
    return fmt::format(
        "the file is truncated: it ends at byte {}, but its index starts at byte {}, so "
        "more than {} bytes are missing",
        size, at, at - size);
  }

  Bytes file_;
  ChunkIndex index_;
  std::uint64_t index_position_ = 0;  // index position in the bag header; 0: never written
  std::uint32_t declared_chunks_ = 0;
};

class Bag : public ChunkedLog {
 public:
  explicit Bag(const std::filesystem::path& path) : ChunkedLog(path) {
    expect_start(file_, kMagic.size(), kMagic, "a ROS bag", "\"#ROSBAG V2.0\"");
    ChunkIndex index;
    try {
      index = read_index(file_.bytes());
    } catch (OutOfBytes) {
      index = Scan(file_.bytes()).index();
    }
    take(std::move(index));
  }

  std::string kind() const override { return "bag"; }

 protected:
  std::optional<Message> message_at(ByteReader& reader) const override {
    const Record record = read_record(reader);
    if (record.header.op() != Op::message) return std::nullopt;
    return Message{nullptr, record.data};
  }
};

}  // namespace
}  // namespace rosbag1

std::unique_ptr<MessageLog> open_rosbag1(const std::filesystem::path& path) {
  return std::make_unique<rosbag1::Bag>(path);
}

}  // namespace planescope::io
