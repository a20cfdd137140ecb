#pragma once

#include <string_view>
#include <vector>

#include "core/io/byte_reader.hpp"

namespace planescope::io::rosbag1 {

enum class Compression : std::uint8_t { none, lz4, bz2, unknown };
Compression parse_compression(std::string_view name);

/// What could be unpacked, in order from the start; `whole` says whether that is all of it.
struct Unpacked {
  std::vector<std::byte> bytes;
  bool whole = false;
};

/// Unpacks a chunk that declares `raw_bytes` of content. Memory grows with what really comes out,
/// never with what is declared. A chunk that is cut or damaged gives what lies before the damage:
/// for LZ4 to the byte, for BZ2 to its blocks of 900 kB.
Unpacked unpack(Compression compression, Bytes stored, std::uint32_t raw_bytes);

}  // namespace planescope::io::rosbag1
