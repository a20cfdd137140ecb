#include "core/io/bag/chunks.hpp"

#include <libdeflate.h>

#include <algorithm>

#include "core/model/error.hpp"
#include "core/model/read_limit.hpp"

namespace planescope::io {
namespace {

constexpr std::size_t kCachedChunks = 8;
constexpr std::size_t kCachedBytes = 64 << 20;

}  // namespace

Bytes content_that_is_there(Chunk& chunk, Unpacked& unpacked) {
  if (chunk.compression == Compression::none) return chunk.stored;
  unpacked = unpack(chunk.compression, chunk.stored, chunk.raw_bytes);
  if (!unpacked.whole) chunk.cut = true;
  return unpacked.bytes;
}

std::size_t unpacking_cost(const Chunk& chunk) {
  constexpr std::size_t kBz2Cost = 20;  // times slower than LZ4, measured on depth images
  if (chunk.compression == Compression::none) return 0;
  return chunk.raw_bytes * (chunk.compression == Compression::bz2 ? kBz2Cost : 1);
}

std::shared_ptr<const std::vector<std::byte>> ChunkCache::unpacked(const MappedFile& file,
                                                                   std::uint32_t number,
                                                                   const Chunk& chunk) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(cache_, number, &Cached::number);
    if (found != cache_.end()) {
      std::rotate(found, found + 1, cache_.end());
      return cache_.back().bytes;
    }
  }
  const std::string name = file.path().string() + ": chunk " + std::to_string(number);
  if (!chunk.cut) expect_within_read_limit(static_cast<double>(chunk.raw_bytes), name);
  if (chunk.compression == Compression::unknown)
    throw Error(name + " is compressed in an unknown way, expected none, lz4, bz2 or zstd");
  file.prefetch(chunk.stored);
  // Unpacked outside the lock, so that threads unpack different chunks at the same time.
  Unpacked unpacked = unpack(chunk.compression, chunk.stored, chunk.raw_bytes);
  if (!unpacked.whole && !chunk.cut) {
    throw Error(name + " is damaged: " + std::to_string(unpacked.bytes.size()) + " of " +
                std::to_string(chunk.raw_bytes) + " bytes could be unpacked");
  }
  if (chunk.crc != 0 && !chunk.cut &&
      libdeflate_crc32(0, unpacked.bytes.data(), unpacked.bytes.size()) != chunk.crc)
    throw Error(name + " is damaged: its checksum is another one");
  const auto bytes = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  const std::lock_guard lock(mutex_);
  cache_.push_back({number, bytes});
  std::size_t total = 0;
  for (const Cached& cached : cache_) total += cached.bytes->size();
  while (cache_.size() > 1 && (cache_.size() > kCachedChunks || total > kCachedBytes)) {
    total -= cache_.front().bytes->size();
    cache_.erase(cache_.begin());
  }
  return bytes;
}

}  // namespace planescope::io
