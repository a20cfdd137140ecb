#include "core/io/bag/rosbag1.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <memory>
#include <set>

#include "core/model/error.hpp"
#include "core/model/read_limit.hpp"

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

constexpr std::size_t kStepBytes = 1 << 20;
// LZ4 cannot pack tighter than 255:1, so what is declared beyond that need not be reserved.
constexpr std::size_t kMaxLz4Ratio = 255;

/// Continues an LZ4 block whose end is missing: copies literals and matches until the input runs
/// out, which liblz4 refuses to do. https://github.com/lz4/lz4/blob/dev/doc/lz4_Block_format.md
void unpack_cut_lz4_block(ByteReader in, std::size_t max_bytes, std::vector<std::byte>& out) {
  const auto length = [&](std::size_t nibble) {
    std::size_t total = nibble;
    for (std::uint8_t more = nibble == 15 ? 255 : 0; more == 255; total += more) {
      more = in.read<std::uint8_t>();
    }
    return total;
  };
  try {
    while (!in.done() && out.size() < max_bytes) {
      const auto token = in.read<std::uint8_t>();
      const std::size_t literals = length(token >> 4);
      const Bytes copied = in.take(std::min(literals, in.left()));
      out.insert(out.end(), copied.begin(), copied.end());
      const std::size_t offset = in.read<std::uint16_t>();
      if (offset == 0 || offset > out.size()) return;
      const std::size_t match = 4 + length(token & 15);
      for (std::size_t i = 0; i < match && out.size() < max_bytes; ++i) {
        out.push_back(out[out.size() - offset]);
      }
    }
  } catch (OutOfBytes) {
    // The cut: what came before it is what we wanted.
  }
}

/// The blocks of an LZ4 frame, the last one as far as it is there.
std::vector<std::byte> unpack_cut_lz4(Bytes stored, std::size_t max_bytes) {
  std::vector<std::byte> out;
  ByteReader in(stored);
  try {
    in.take(4);  // magic
    const auto flags = in.read<std::uint8_t>();
    in.take(1);                 // block size
    if (flags & 8) in.take(8);  // content size
    if (flags & 1) in.take(4);  // dictionary
    in.take(1);                 // header checksum
    while (out.size() < max_bytes) {
      const auto size = in.read<std::uint32_t>();
      if (size == 0) break;
      const Bytes block = in.take(std::min<std::size_t>(size & 0x7fffffffu, in.left()));
      if (size & 0x80000000u) {
        const Bytes kept = block.first(std::min(block.size(), max_bytes - out.size()));
        out.insert(out.end(), kept.begin(), kept.end());
      } else {
        unpack_cut_lz4_block(ByteReader(block), max_bytes, out);
      }
      if (flags & 16) in.take(4);  // block checksum
    }
  } catch (OutOfBytes) {
    // The cut.
  }
  return out;
}

Unpacked unpack_lz4(Bytes stored, std::uint32_t raw_bytes) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) return {};
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> guard(
      context, LZ4F_freeDecompressionContext);
  Unpacked result;
  auto& out = result.bytes;
  out.reserve(std::min<std::size_t>(raw_bytes, stored.size() * kMaxLz4Ratio));
  Bytes in = stored;
  std::size_t expected = 1;  // 0 once the frame has ended and its checksum was right
  while (!in.empty() && expected != 0) {
    const std::size_t before = out.size();
    std::size_t produced = std::min<std::size_t>(kStepBytes, raw_bytes - before);
    out.resize(before + produced);
    std::size_t consumed = in.size();
    expected =
        LZ4F_decompress(context, out.data() + before, &produced, in.data(), &consumed, nullptr);
    const bool failed = LZ4F_isError(expected);
    out.resize(before + (failed ? 0 : produced));
    if (failed || (produced == 0 && consumed == 0)) break;
    in = in.subspan(consumed);
  }
  result.whole = out.size() == raw_bytes && expected == 0;
  if (out.size() < raw_bytes) {
    auto more = unpack_cut_lz4(stored, raw_bytes);
    if (more.size() > out.size()) out = std::move(more);
  }
  return result;
}

Unpacked unpack_bz2(Bytes stored, std::uint32_t raw_bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return {};
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> guard(&stream,
                                                                         BZ2_bzDecompressEnd);
  Unpacked result;
  auto& out = result.bytes;
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(stored.data()));
  stream.avail_in = static_cast<unsigned>(stored.size());
  while (out.size() < raw_bytes) {
    const std::size_t before = out.size();
    const std::size_t room = std::min<std::size_t>(kStepBytes, raw_bytes - before);
    out.resize(before + room);
    stream.next_out = reinterpret_cast<char*>(out.data() + before);
    stream.avail_out = static_cast<unsigned>(room);
    const int status = BZ2_bzDecompress(&stream);
    out.resize(before + room - stream.avail_out);
    if (status != BZ_OK || out.size() == before) break;
  }
  result.whole = out.size() == raw_bytes;
  return result;
}

}  // namespace

Compression parse_compression(std::string_view name) {
  if (name == "none") return Compression::none;
  if (name == "lz4") return Compression::lz4;
  if (name == "bz2") return Compression::bz2;
  return Compression::unknown;
}

Unpacked unpack(Compression compression, Bytes stored, std::uint32_t raw_bytes) {
  raw_bytes = static_cast<std::uint32_t>(std::min<std::uint64_t>(raw_bytes, read_limit_bytes()));
  switch (compression) {
    case Compression::none:
      return {{stored.begin(), stored.end()}, stored.size() >= raw_bytes};
    case Compression::lz4:
      return unpack_lz4(stored, raw_bytes);
    case Compression::bz2:
      return unpack_bz2(stored, raw_bytes);
    case Compression::unknown:
      break;
  }
  return {};
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

namespace {

constexpr std::size_t kCachedChunks = 8;
constexpr std::size_t kCachedBytes = 64 << 20;

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
    : path_(path), file_(path), index_(index_of(file_, path)) {
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
  std::sort(all.begin(), all.end(), [](const MessageRef& a, const MessageRef& b) {
    return std::tie(a.time_ns, a.chunk, a.offset) < std::tie(b.time_ns, b.chunk, b.offset);
  });
  return all;
}

MessageBytes Bag::chunk_bytes(std::uint32_t number) const {
  const Chunk& chunk = index_.chunks.at(number);
  if (chunk.compression == Compression::none) return {nullptr, chunk.stored};
  {
    const std::lock_guard lock(cache_mutex_);
    const auto found = std::find_if(cache_.begin(), cache_.end(),
                                    [&](const Cached& c) { return c.chunk == number; });
    if (found != cache_.end()) {
      std::rotate(found, found + 1, cache_.end());
      return {cache_.back().bytes, *cache_.back().bytes};
    }
  }
  if (!chunk.cut)
    expect_within_read_limit(chunk.raw_bytes, path_.string() + ": chunk " + std::to_string(number));
  file_.prefetch(chunk.stored);
  // Unpacked outside the lock, so that threads unpack different chunks at the same time.
  Unpacked unpacked = unpack(chunk.compression, chunk.stored, chunk.raw_bytes);
  if (!unpacked.whole && !chunk.cut) {
    throw Error(path_.string() + ": chunk " + std::to_string(number) +
                " is damaged: " + std::to_string(unpacked.bytes.size()) + " of " +
                std::to_string(chunk.raw_bytes) + " bytes could be unpacked");
  }
  const auto bytes = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  const std::lock_guard lock(cache_mutex_);
  cache_.push_back({number, bytes});
  std::size_t total = 0;
  for (const Cached& cached : cache_) total += cached.bytes->size();
  while (cache_.size() > 1 && (cache_.size() > kCachedChunks || total > kCachedBytes)) {
    total -= cache_.front().bytes->size();
    cache_.erase(cache_.begin());
  }
  return {bytes, *bytes};
}

std::size_t Bag::unpacking_cost(const MessageRef& message) const {
  constexpr std::size_t kBz2Cost = 20;  // times slower than LZ4, measured on depth images
  const Chunk& chunk = index_.chunks.at(message.chunk);
  if (chunk.compression == Compression::none) return 0;
  return chunk.raw_bytes * (chunk.compression == Compression::bz2 ? kBz2Cost : 1);
}

MessageBytes Bag::read(const MessageRef& message) const {
  MessageBytes result = chunk_bytes(message.chunk);
  try {
    ByteReader reader(result.bytes);
    reader.take(message.offset);
    const Record record = read_record(reader);
    if (record.header.op() == Op::message) {
      if (!result.chunk) file_.prefetch(record.data);
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
