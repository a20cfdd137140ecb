#pragma once

// What recordings are compressed by: single messages, chunks of them, or whole files.

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/bag/message_log.hpp"

namespace planescope::io {

enum class Compression : std::uint8_t { none, lz4, bz2, zstd, unknown };
/// As bags ("none") and MCAP ("") name it.
Compression parse_compression(std::string_view name);

/// What could be unpacked, in order from the start; `whole` says whether that is all of it.
struct Unpacked {
  std::vector<std::byte> bytes;
  bool whole = false;
};

/// Unpacks a chunk that declares `raw_bytes` of content. Memory grows with what really comes out,
/// never with what is declared. A chunk that is cut or damaged gives what lies before the damage:
/// for LZ4 to the byte, for BZ2 to its blocks of 900 kB, for zstd to its blocks of 128 kB.
Unpacked unpack(Compression compression, Bytes stored, std::uint64_t raw_bytes);

/// Whether bytes start as a zstd frame does. No message does: the second byte of CDR is 0 or 1.
bool is_zstd(Bytes bytes);
/// The first `at_most` bytes that zstd frames hold, `whole` where these are all there.
Unpacked unpack_zstd(Bytes stored, std::uint64_t at_most);

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

inline constexpr std::uint32_t kNoChunk = 0xffffffff;  // of messages that lie in none

/// A container of chunks, opened by memory map.
class ChunkedLog : public MessageLog {
 public:
  explicit ChunkedLog(const std::filesystem::path& path);

  std::size_t unpacking_cost(const MessageRef& message) const override;
  void expect_whole() const override { file_.expect_whole(); }

 protected:
  /// The content of the message's chunk, or the file where it lies in none. Throws Error naming the
  /// file when the chunk is damaged.
  Message around(const MessageRef& message) const;

  MappedFile file_;
  std::vector<Chunk> chunks_;

 private:
  std::shared_ptr<const std::vector<std::byte>> unpacked(std::uint32_t number) const;

  struct Cached {
    std::uint32_t number = 0;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  /// The chunks that were unpacked last: neighboring frames and color share them. Last used at the
  /// back.
  mutable std::vector<Cached> cache_;
  mutable std::mutex mutex_;
};

// Bags that were compressed as a whole, as `ros2 bag record --compression-mode file` does.

/// Of a packed file "rec_0.db3.zstd" the name "rec_0.db3", of others their own.
std::filesystem::path name_within(const std::filesystem::path& path);

/// The first `count` bytes of what the file holds, fewer where it is shorter.
std::string first_bytes_within(const std::filesystem::path& path, std::size_t count);

/// Maps a file, or what it holds where it is zstd: that is unpacked into a file without a name, in
/// the folder for temporary files, which is gone with the mapping. Of a packed file that is cut or
/// damaged what comes before. Throws Error where nothing does, where there is no room, and where it
/// grows as no recording does.
MappedFile map_content(const std::filesystem::path& path);

}  // namespace planescope::io
