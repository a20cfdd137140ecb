#include <algorithm>

#include "core/io/bag/rosbag1.hpp"

namespace planescope::io::rosbag1 {
namespace {

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

}  // namespace

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

}  // namespace planescope::io::rosbag1
