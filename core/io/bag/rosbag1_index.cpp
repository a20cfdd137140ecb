#include "core/io/bag/rosbag1.hpp"

namespace planescope::io::rosbag1 {
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
  for (std::uint32_t i = 0; i < chunks; ++i) {
    const Record info = read_record_of(Op::chunk_info, reader);
    ByteReader at_chunk(file);
    at_chunk.take(info.header.get<std::uint64_t>("chunk_pos"));
    const Record chunk = read_record_of(Op::chunk, at_chunk);
    const auto raw_bytes = chunk.header.get<std::uint32_t>("size");
    index.chunks.push_back(
        {parse_compression(chunk.header.text("compression")), chunk.data, raw_bytes, false});
    const auto parts = info.header.get<std::uint32_t>("count");  // one per connection
    for (std::uint32_t part = 0; part < parts; ++part) {
      const Record entries = read_record_of(Op::index_data, at_chunk);
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
                                      std::uint32_t raw_bytes) {
  if (record.header.get<std::uint32_t>("ver") != 1) throw OutOfBytes{};
  std::vector<MessageRef> messages;
  ByteReader entries(record.data);
  while (!entries.done()) {
    const std::uint64_t time = nanoseconds(entries.read<std::uint64_t>());
    const auto offset = entries.read<std::uint32_t>();
    if (offset >= raw_bytes) throw OutOfBytes{};
    messages.push_back({time, chunk, offset});
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

}  // namespace planescope::io::rosbag1
