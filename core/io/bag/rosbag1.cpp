#include "core/io/bag/rosbag1.hpp"

#include <algorithm>

#include "core/io/bag/rosbag1_records.hpp"
#include "core/model/error.hpp"

namespace planescope::io::rosbag1 {
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
