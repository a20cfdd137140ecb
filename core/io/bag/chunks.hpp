#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "core/io/bag/unpack.hpp"
#include "core/io/mapped_file.hpp"

namespace planescope::io {

/// A run of messages, packed as one.
struct Chunk {
  Compression compression = Compression::none;
  Bytes stored;
  std::uint64_t raw_bytes = 0;
  bool cut = false;       // its end is missing or damaged
  std::uint32_t crc = 0;  // CRC-32 of the content; 0: not known
};

/// A walk through a file without an index finds at most so many messages, and one more for each
/// byte of the file: chunks may unpack to any number of them.
inline constexpr std::uint64_t kMostMessages = 1 << 20;

/// The content of a chunk as far as it can be unpacked, which is held by `unpacked` where it was
/// packed; where that is not all, the chunk is `cut`.
Bytes content_that_is_there(Chunk& chunk, Unpacked& unpacked);

/// What unpacking a chunk costs, in bytes of LZ4.
std::size_t unpacking_cost(const Chunk& chunk);

/// Keeps the unpacked chunks that were used last: neighbouring frames and colour share them.
/// Thread-safe.
class ChunkCache {
 public:
  /// The content of a chunk that is compressed. Throws Error naming the file when it is damaged.
  std::shared_ptr<const std::vector<std::byte>> unpacked(const MappedFile& file,
                                                         std::uint32_t number,
                                                         const Chunk& chunk);

 private:
  struct Cached {
    std::uint32_t number = 0;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  std::mutex mutex_;
  std::vector<Cached> cache_;  // last used at the back
};

}  // namespace planescope::io
