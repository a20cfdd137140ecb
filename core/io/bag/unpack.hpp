#pragma once

#include <string_view>
#include <vector>

#include "core/io/byte_reader.hpp"

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

}  // namespace planescope::io
