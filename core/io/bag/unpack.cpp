#include "core/io/bag/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "core/model/read_limit.hpp"

namespace planescope::io {
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

Unpacked unpack_lz4(Bytes stored, std::uint64_t raw_bytes) {
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

Unpacked unpack_bz2(Bytes stored, std::uint64_t raw_bytes) {
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

bool is_zstd(Bytes bytes) {
  return bytes.size() >= 4 && ByteReader(bytes).read<std::uint32_t>() == ZSTD_MAGICNUMBER;
}

Unpacked unpack_zstd(Bytes stored, std::uint64_t at_most) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     ZSTD_freeDCtx);
  if (!context) return {};
  Unpacked result;
  auto& out = result.bytes;
  ZSTD_inBuffer in{stored.data(), stored.size(), 0};
  std::size_t expected = 1;  // 0 once a frame has ended and its checksum was right
  while (out.size() < at_most && (in.pos < in.size || expected != 0)) {
    const std::size_t before = out.size();
    out.resize(before + std::min<std::uint64_t>(kStepBytes, at_most - before));
    ZSTD_outBuffer to{out.data() + before, out.size() - before, 0};
    const std::size_t was = in.pos;
    expected = ZSTD_decompressStream(context.get(), &to, &in);
    out.resize(before + (ZSTD_isError(expected) ? 0 : to.pos));
    if (ZSTD_isError(expected) || (to.pos == 0 && in.pos == was)) break;
  }
  result.whole = out.size() == at_most || (expected == 0 && in.pos == in.size);
  return result;
}

Compression parse_compression(std::string_view name) {
  if (name == "none" || name.empty()) return Compression::none;
  if (name == "lz4") return Compression::lz4;
  if (name == "bz2") return Compression::bz2;
  if (name == "zstd") return Compression::zstd;
  return Compression::unknown;
}

Unpacked unpack(Compression compression, Bytes stored, std::uint64_t raw_bytes) {
  raw_bytes = std::min(raw_bytes, read_limit_bytes());
  switch (compression) {
    case Compression::none:
      return {{stored.begin(), stored.end()}, stored.size() >= raw_bytes};
    case Compression::lz4:
      return unpack_lz4(stored, raw_bytes);
    case Compression::bz2:
      return unpack_bz2(stored, raw_bytes);
    case Compression::zstd: {
      Unpacked result = unpack_zstd(stored, raw_bytes);
      result.whole = result.whole && result.bytes.size() == raw_bytes;
      return result;
    }
    case Compression::unknown:
      break;
  }
  return {};
}

}  // namespace planescope::io
