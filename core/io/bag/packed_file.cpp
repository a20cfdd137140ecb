#include "core/io/bag/packed_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "core/io/bag/unpack.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

// Depth shrinks to a third at most, and what is all zeros is no recording: more is not written to
// disk.
constexpr std::uint64_t kMostGrowth = 1000, kAlwaysAllowed = std::uint64_t{1} << 28;

FileDescriptor make_nameless_file(const fs::path& of) {
  std::error_code failed;
  fs::path folder = fs::temp_directory_path(failed);
  if (failed) folder = "/tmp";
  std::string name = (folder / "planescope-XXXXXX").string();
  FileDescriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (!file.is_open())
    throw Error(fmt::format("{}: cannot be unpacked into {}: {}", of.string(), folder.string(),
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
      throw Error(fmt::format("{}: unpacks to more than {} bytes, expected a recording",
                              packed.path().string(), most));
    const auto bytes = std::span(piece).first(out.pos);
    if (const int error = write_fully(file, bytes, static_cast<off_t>(written)); error != 0)
      throw Error(fmt::format("{}: cannot be unpacked into the folder for temporary files: {}",
                              packed.path().string(), error_text(error)));
    written += out.pos;
  }
  if (written == 0)
    throw Error(packed.path().string() + ": is damaged, expected a file that zstd unpacks");
}

}  // namespace

fs::path name_within(const fs::path& path) {
  const std::string kind = extension(path);
  return kind == ".zstd" || kind == ".zst" ? path.stem() : path.filename();
}

std::string first_bytes_within(const fs::path& path, std::size_t count) {
  constexpr std::size_t kEnough = 1 << 18;  // to unpack a block of zstd from
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
  {
    const MappedFile packed(path);
    if (!is_zstd(packed.bytes())) return MappedFile(path);
    const FileDescriptor file = make_nameless_file(path);
    packed.guarded([&] {
      unpack_into(file, packed);
      return true;
    });
    return {path, file};
  }
}

}  // namespace planescope::io
