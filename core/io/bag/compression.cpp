// Decompresses LZ4, bzip2 and zstd data, including truncated blocks.

#include <bzlib.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "core/io/bag/message_log.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

constexpr std::size_t kStepBytes = 1 << 20;
// LZ4 cannot compress better than 255:1, so declared sizes beyond that are not reserved.
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
    // The block is cut here: keep the output so far.
  }
}

/// The blocks of an LZ4 frame. The last one may be incomplete.
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
    // The frame is cut here.
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
  std::size_t expected = 1;  // 0 after the end of a frame with a correct checksum
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
  std::size_t expected = 1;  // 0 after the end of a frame with a correct checksum
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

namespace {

namespace fs = std::filesystem;

// Compression shrinks depth to a third at best, and only worthless data such as all zeros shrinks a
// thousandfold: refuse to write more than this to disk.
constexpr std::uint64_t kMostGrowth = 1000, kAlwaysAllowed = std::uint64_t{1} << 28;

FileDescriptor make_nameless_file(const fs::path& of) {
  std::error_code failed;
  fs::path folder = fs::temp_directory_path(failed);
  if (failed) folder = "/tmp";
  std::string name = (folder / "planescope-XXXXXX").string();
  FileDescriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (!file.is_open())
    throw Error(fmt::format("{}: cannot be decompressed into {}: {}", of.string(), folder.string(),
                            error_text(errno)));
  ::unlink(name.c_str());
  return file;
}

void unpack_into(const FileDescriptor& file, const MappedFile& packed) {
  const Bytes stored = packed.bytes();
  const std::uint64_t most = std::max<std::uint64_t>(kAlwaysAllowed, stored.size() * kMostGrowth);
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  std::vector<unsigned char> piece(ZSTD_DStreamOutSize());
  ZSTD_inBuffer in{stored.data(), stored.size(), 0};
  std::uint64_t written = 0;
  for (bool more = true; more;) {
    ZSTD_outBuffer out{piece.data(), piece.size(), 0};
    const std::size_t was = in.pos;
    const std::size_t result = ZSTD_decompressStream(context.get(), &out, &in);
    more = ZSTD_isError(result) == 0 && (out.pos > 0 || in.pos > was);
    if (written + out.pos > most)
      throw Error(fmt::format(
          "{}: the decompressed data is too large for a recording; expected at most {} bytes",
          packed.path().string(), most));
    const auto bytes = std::span(piece).first(out.pos);
    if (const int error = write_fully(file, bytes, static_cast<off_t>(written)); error != 0)
      throw Error(fmt::format("{}: cannot be decompressed into the temporary folder: {}",
                              packed.path().string(), error_text(error)));
    written += out.pos;
  }
  if (written == 0)
    throw Error(packed.path().string() + ": damaged; expected a zstd-compressed file");
}

}  // namespace

fs::path name_within(const fs::path& path) {
  const std::string kind = extension(path);
  return kind == ".zstd" || kind == ".zst" ? path.stem() : path.filename();
}

std::string first_bytes_within(const fs::path& path, std::size_t count) {
  constexpr std::size_t kEnough = 1 << 18;  // enough to unpack a zstd block
  const FileDescriptor file = open_file(path, O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) throw Error(path.string() + ": cannot be read: " + error_text(errno));
  std::vector<unsigned char> bytes(kEnough);
  bytes.resize(read_fully(file, bytes, 0));
  const Bytes stored = std::as_bytes(std::span<const unsigned char>(bytes));
  const auto text = [count](Bytes of) {
    const Bytes first = of.first(std::min(count, of.size()));
    return std::string(reinterpret_cast<const char*>(first.data()), first.size());
  };
  return is_zstd(stored) ? text(unpack_zstd(stored, count).bytes) : text(stored);
}

MappedFile map_content(const fs::path& path) {
  const MappedFile packed(path);
  if (!is_zstd(packed.bytes())) return MappedFile(path);
  const FileDescriptor file = make_nameless_file(path);
  guarded(packed, [&] {
    unpack_into(file, packed);
    return true;
  });
  return {path, file};
}

}  // namespace planescope::io
