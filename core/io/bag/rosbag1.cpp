// ROS 1 bags: http://wiki.ros.org/Bags/Format/2.0. Read by the index at their end, or by walking
// their chunks where that is missing, cut or damaged.

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/io/bag/compression.hpp"
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

/// The header of a record: `name=value` fields.
class Fields {
 public:
  explicit Fields(Bytes header) : header_(header) {}
  /// The value of a field, empty where there is none. Throws OutOfBytes on a damaged header.
  std::optional<Bytes> find(std::string_view name) const;
  /// Throws OutOfBytes when the field is missing or of another size.
  template <typename T>
  T get(std::string_view name) const {
    const auto value = find(name);
    if (!value || value->size() != sizeof(T)) throw OutOfBytes{};
    return ByteReader(*value).read<T>();
  }
  std::string_view text(std::string_view name) const;
  Op op() const { return static_cast<Op>(get<std::uint8_t>("op")); }

 private:
  Bytes header_;
};

struct Record {
  Fields header;
  Bytes data;
};

/// Reads one whole record. Throws OutOfBytes when it is not all there.
Record read_record(ByteReader& reader) {
  const Bytes header = reader.take_sized();
  return {Fields(header), reader.take_sized()};
}

/// ROS time as the bag writes it: seconds in the low, nanoseconds in the high half.
std::uint64_t nanoseconds(std::uint64_t time) {
  return (time & 0xffffffffu) * 1'000'000'000u + (time >> 32);
}

struct Connection {
  std::string topic;
  std::string type;  // such as "sensor_msgs/Image"
};

/// What a bag holds and where: found in its index, or by walking its chunks where that is lost.
struct Index {
  std::map<std::uint32_t, Connection> connections;
  std::map<std::uint32_t, std::vector<MessageRef>> messages;  // by connection, in file order
  std::vector<Chunk> chunks;
  std::vector<std::string> warnings;
};

std::optional<Bytes> Fields::find(std::string_view name) const {
  ByteReader reader(header_);
  while (!reader.done()) {
    const std::string_view field = reader.read_text();
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw OutOfBytes{};
    if (field.substr(0, equals) == name) {
      const std::string_view value = field.substr(equals + 1);
      return Bytes(reinterpret_cast<const std::byte*>(value.data()), value.size());
    }
  }
  return std::nullopt;
}

std::string_view Fields::text(std::string_view name) const {
  const auto value = find(name);
  if (!value) throw OutOfBytes{};
  return {reinterpret_cast<const char*>(value->data()), value->size()};
}

/// Adds what a CONNECTION record says. Throws OutOfBytes when it is damaged.
void add_connection(const Record& record, Index& index) {
  const Fields description(record.data);
  index.connections.try_emplace(
      record.header.get<std::uint32_t>("conn"),
      Connection{std::string(record.header.text("topic")), std::string(description.text("type"))});
}

/// The messages that an INDEX_DATA record places in a chunk. Throws OutOfBytes when it is damaged.
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

Record read_record_of(Op op, ByteReader& reader) {
  const Record record = read_record(reader);
  if (record.header.op() != op) throw OutOfBytes{};
  return record;
}

void append(std::vector<MessageRef>& to, const std::vector<MessageRef>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

void read_index_section(Bytes file, Index& index) {
  ByteReader start(file);
  start.take(kMagic.size());
  const Record bag_header = read_record_of(Op::bag_header, start);
  const auto index_position = bag_header.header.get<std::uint64_t>("index_pos");
  if (index_position == 0) throw OutOfBytes{};
  ByteReader reader(file);
  reader.take(index_position);
  const auto connections = bag_header.header.get<std::uint32_t>("conn_count");
  for (std::uint32_t i = 0; i < connections; ++i) {
    add_connection(read_record_of(Op::connection, reader), index);
  }
  const auto chunks = bag_header.header.get<std::uint32_t>("chunk_count");
  std::set<std::uint64_t> positions;
  std::uint64_t entry_bytes = 0;
  for (std::uint32_t i = 0; i < chunks; ++i) {
    const Record info = read_record_of(Op::chunk_info, reader);
    ByteReader at_chunk(file);
    const auto position = info.header.get<std::uint64_t>("chunk_pos");
    if (!positions.insert(position).second) throw OutOfBytes{};
    at_chunk.take(position);
    const Record chunk = read_record_of(Op::chunk, at_chunk);
    const auto raw_bytes = chunk.header.get<std::uint32_t>("size");
    index.chunks.push_back(
        {parse_compression(chunk.header.text("compression")), chunk.data, raw_bytes, false});
    const auto parts = info.header.get<std::uint32_t>("count");  // one per connection
    for (std::uint32_t part = 0; part < parts; ++part) {
      const Record entries = read_record_of(Op::index_data, at_chunk);
      // Chunks that overlap could share their entries: there is room for each once.
      entry_bytes += entries.data.size();
      if (entry_bytes > file.size()) throw OutOfBytes{};
      append(index.messages[entries.header.get<std::uint32_t>("conn")],
             index_entries(entries, i, raw_bytes));
    }
  }
}

/// Reads the index at the end of the bag; false when any of it is missing or does not add up.
bool read_index(Bytes file, Index& index) {
  try {
    read_index_section(file, index);
    return true;
  } catch (OutOfBytes) {
    index = {};
    return false;
  }
}

// ---- Without an index ---------------------------------------------------------------------------

/// The walk through a bag whose index is missing, cut or damaged.
struct Scan {
  Bytes file;
  Index index;
  std::uint64_t index_position = 0;  // where the bag header places the index, 0 = never written
  std::uint32_t declared_chunks = 0;
  std::uint64_t missing_bytes = 0;  // that a cut chunk declares but the file does not hold
  std::uint64_t damaged_bytes = 0;  // passed over, no record could be read there
  std::uint64_t messages = 0;
};

void add_messages(Scan& scan, std::uint32_t connection, const std::vector<MessageRef>& found) {
  auto& messages = scan.index.messages[connection];
  messages.insert(messages.end(), found.begin(), found.end());
  scan.messages += found.size();
  // Chunks may unpack to any number of them.
  if (scan.messages > kMostMessages + scan.file.size()) throw OutOfBytes{};
}

/// Walks the connections and messages inside a chunk, as far as it can be unpacked.
void walk_chunk(Scan& scan, std::uint32_t number) {
  Chunk& chunk = scan.index.chunks[number];
  Unpacked unpacked;
  ByteReader reader(content_that_is_there(chunk, unpacked));
  try {
    while (!reader.done()) {
      const auto offset = static_cast<std::uint32_t>(reader.position());
      const Record record = read_record(reader);
      if (record.header.op() == Op::connection) {
        add_connection(record, scan.index);
      } else if (record.header.op() == Op::message) {
        const std::uint64_t time = nanoseconds(record.header.get<std::uint64_t>("time"));
        add_messages(scan, record.header.get<std::uint32_t>("conn"), {{time, 0, number, offset}});
      }
    }
  } catch (OutOfBytes) {
    chunk.cut = true;
  }
}

/// Uses the INDEX_DATA records that follow a chunk, which spares unpacking it. They must be all
/// there (another record follows) and name only known connections, else nothing is taken.
/// Moves the reader behind them.
bool take_index_records(Scan& scan, std::uint32_t number, ByteReader& reader) {
  std::vector<std::pair<std::uint32_t, std::vector<MessageRef>>> found;
  try {
    while (true) {
      ByteReader next = reader;
      if (Fields(next.take_sized()).op() != Op::index_data) break;
      const Record record = read_record(reader);
      const auto connection = record.header.get<std::uint32_t>("conn");
      if (!scan.index.connections.contains(connection)) return false;
      found.emplace_back(connection,
                         index_entries(record, number, scan.index.chunks[number].raw_bytes));
    }
  } catch (OutOfBytes) {
    return false;
  }
  for (const auto& [connection, messages] : found) add_messages(scan, connection, messages);
  return !found.empty();
}

/// The chunk whose record starts here though its end is missing: the last one of a recording that
/// was interrupted (declares no size yet) or cut. The rest of the file is taken for its content.
bool take_cut_chunk(Scan& scan, ByteReader reader) {
  try {
    const Fields header(reader.take_sized());
    if (header.op() != Op::chunk) return false;
    const auto stored_bytes = reader.read<std::uint32_t>();
    const auto raw_bytes = header.get<std::uint32_t>("size");
    if (stored_bytes != 0 && stored_bytes <= reader.left()) return false;
    const std::size_t rest = std::min<std::size_t>(reader.left(), 0xffffffffu);
    if (stored_bytes != 0) scan.missing_bytes = stored_bytes - rest;
    scan.index.chunks.push_back({parse_compression(header.text("compression")), reader.take(rest),
                                 stored_bytes == 0 ? 0xffffffffu : raw_bytes, true});
  } catch (OutOfBytes) {
    return false;
  }
  walk_chunk(scan, static_cast<std::uint32_t>(scan.index.chunks.size() - 1));
  return true;
}

/// Handles the record at the reader and moves behind it. Throws OutOfBytes on damage.
void take_record(Scan& scan, ByteReader& reader) {
  const Record record = read_record(reader);
  switch (record.header.op()) {
    case Op::bag_header:
      scan.index_position = record.header.get<std::uint64_t>("index_pos");
      scan.declared_chunks = record.header.get<std::uint32_t>("chunk_count");
      break;
    case Op::connection:
      add_connection(record, scan.index);
      break;
    case Op::chunk: {
      const auto raw_bytes = record.header.get<std::uint32_t>("size");
      const auto compression = parse_compression(record.header.text("compression"));
      if (record.data.empty()) throw OutOfBytes{};
      const auto number = static_cast<std::uint32_t>(scan.index.chunks.size());
      scan.index.chunks.push_back({compression, record.data, raw_bytes, false});
      if (!take_index_records(scan, number, reader)) walk_chunk(scan, number);
      break;
    }
    case Op::index_data:  // of a chunk that was walked
    case Op::chunk_info:
    case Op::message:
      break;
    default:
      throw OutOfBytes{};
  }
}

/// Where the next chunk behind `from` may start: its header begins with two lengths and
/// `compression=`.
std::size_t find_chunk(Bytes file, std::size_t from) {
  constexpr std::string_view kField = "compression=";
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  const std::size_t found = text.find(kField, from + 1 + 8);
  return found == std::string_view::npos ? file.size() : found - 8;
}

std::string describe(const Scan& scan) {
  const auto number = [](std::uint64_t n) { return std::to_string(n); };
  const std::uint64_t size = scan.file.size();
  std::string text;
  if (scan.index_position == 0) {
    text = "the recording was never closed, it has no index";
  } else if (scan.index_position > size) {
    text = "the file is cut: it ends at byte " + number(size) + ", its index would start at byte " +
           number(scan.index_position) + ", so more than " + number(scan.index_position - size) +
           " bytes are missing";
  } else {
    text = "the index is cut or damaged";
  }
  const auto cut = std::count_if(scan.index.chunks.begin(), scan.index.chunks.end(),
                                 [](const Chunk& c) { return c.cut; });
  text += "; found " + number(scan.index.chunks.size());
  if (scan.declared_chunks > 0) text += " of " + number(scan.declared_chunks);
  text += " chunks";
  if (cut > 0) text += ", " + number(cut) + " of them cut";
  if (scan.missing_bytes > 0) text += " (" + number(scan.missing_bytes) + " bytes short)";
  if (scan.damaged_bytes > 0) text += "; " + number(scan.damaged_bytes) + " bytes are unreadable";
  return text + "; " + number(scan.messages) + " messages recovered";
}

/// Walks the records from the start, unpacking only chunks that tell nothing otherwise, and says
/// in `warnings` what is missing.
Index scan(Bytes file) {
  Scan scan;
  scan.file = file;
  std::size_t position = kMagic.size();
  while (position < file.size()) {
    ByteReader reader(file.subspan(position));
    try {
      take_record(scan, reader);
      position += reader.position();
    } catch (OutOfBytes) {
      if (take_cut_chunk(scan, ByteReader(file.subspan(position)))) break;
      const std::size_t next = find_chunk(file, position);
      scan.damaged_bytes += next - position;
      position = next;
    }
  }
  scan.index.warnings.push_back(describe(scan));
  return std::move(scan.index);
}

Index index_of(const MappedFile& mapped, const std::filesystem::path& path) {
  const Bytes file = mapped.bytes();
  if (file.size() < kMagic.size() || std::memcmp(file.data(), kMagic.data(), kMagic.size()) != 0) {
    throw Error(path.string() + ": not a ROS bag (" + std::to_string(file.size()) +
                " bytes that do not start with \"#ROSBAG V2.0\")");
  }
  mapped.expect_hops();
  Index index;
  if (read_index(file, index)) return index;
  return scan(file);
}

class Bag : public ChunkedLog {
 public:
  explicit Bag(const std::filesystem::path& path) : ChunkedLog(path) {
    Index index = index_of(file_, path);
    warnings_ = std::move(index.warnings);
    chunks_ = std::move(index.chunks);
    for (const auto& [id, connection] : index.connections) {
      topics_.emplace(connection.topic, connection.type);
      append(messages_[connection.topic], index.messages[id]);
    }
    sort_messages();
  }

  std::string kind() const override { return "bag"; }
  Message read(const MessageRef& message, std::size_t /*at_most*/) const override {
    Message result = around(message);
    try {
      ByteReader reader(result.bytes);
      reader.take(message.offset);
      const Record record = read_record(reader);
      if (record.header.op() == Op::message) {
        if (!result.held) file_.prefetch(record.data);
        result.bytes = record.data;
        return result;
      }
    } catch (OutOfBytes) {
      // The same to the user as a record of another kind.
    }
    throw Error(path_.string() + ": no message at byte " + std::to_string(message.offset) +
                " of chunk " + std::to_string(message.chunk) + ", where its index places one");
  }
};

}  // namespace
}  // namespace rosbag1

std::unique_ptr<MessageLog> open_rosbag1(const std::filesystem::path& path) {
  return std::make_unique<rosbag1::Bag>(path);
}

}  // namespace planescope::io
