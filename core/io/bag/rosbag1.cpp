#include "core/io/bag/rosbag1.hpp"

#include <algorithm>
#include <set>

#include "core/io/bag/packed_file.hpp"
#include "core/model/error.hpp"

namespace planescope::io::rosbag1 {

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

namespace {

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

}  // namespace

void add_connection(const Record& record, Index& index) {
  const Fields description(record.data);
  index.connections.try_emplace(
      record.header.get<std::uint32_t>("conn"),
      Connection{std::string(record.header.text("topic")), std::string(description.text("type"))});
}

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

bool read_index(Bytes file, Index& index) {
  try {
    read_index_section(file, index);
    return true;
  } catch (OutOfBytes) {
    index = {};
    return false;
  }
}

namespace {

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

}  // namespace

Bag::Bag(const std::filesystem::path& path)
    : MessageLog(path), file_(map_content(path)), index_(index_of(file_, path)) {
  warnings_ = index_.warnings;
  for (const auto& [id, connection] : index_.connections) {
    topics_.emplace(connection.topic, connection.type);
  }
}

std::vector<MessageRef> Bag::messages(const std::string& topic) const {
  std::vector<MessageRef> all;
  for (const auto& [id, connection] : index_.connections) {
    if (connection.topic != topic) continue;
    const auto of_connection = index_.messages.find(id);
    if (of_connection == index_.messages.end()) continue;
    all.insert(all.end(), of_connection->second.begin(), of_connection->second.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

Message Bag::chunk_bytes(std::uint32_t number) const {
  const Chunk& chunk = index_.chunks.at(number);
  if (chunk.compression == Compression::none) return {nullptr, chunk.stored, Wire::ros1};
  const auto bytes = cache_.unpacked(file_, number, chunk);
  return {bytes, *bytes, Wire::ros1};
}

std::size_t Bag::unpacking_cost(const MessageRef& message) const {
  return io::unpacking_cost(index_.chunks.at(message.chunk));
}

Message Bag::read(const MessageRef& message, std::size_t) const {
  Message result = chunk_bytes(message.chunk);
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

}  // namespace planescope::io::rosbag1
