#pragma once

// Memory-mapped files, and a reader that takes one value after another from their bytes.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

#include "core/model/file_bytes.hpp"

namespace planescope::io {

using Bytes = std::span<const std::byte>;

static_assert(std::endian::native == std::endian::little, "files are read in memory byte order");

/// Thrown by ByteReader if a length points past the end. Internal to the readers, which catch it
/// and report the consequence for their file.
struct OutOfBytes {};

/// Reads little-endian values from untrusted bytes: every length is checked.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes), size_(bytes.size()) {}

  Bytes take(std::uint64_t count) {
    if (count > rest_.size()) throw OutOfBytes{};
    const Bytes taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  template <typename T>
  T read() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  /// A 32-bit length and that many bytes: how ROS writes strings, arrays and records.
  Bytes take_sized() { return take(read<std::uint32_t>()); }
  std::string_view read_text() {
    const Bytes text = take_sized();
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }

  bool done() const { return rest_.empty(); }
  std::size_t left() const { return rest_.size(); }
  std::size_t position() const { return size_ - rest_.size(); }

 private:
  Bytes rest_;
  std::size_t size_;
};

/// A file mapped read-only into memory: only the accessed pages are ever read. If another process
/// truncates the file meanwhile, the missing bytes read as zeros and guarded() throws. (The system
/// raises SIGBUS in this case: the first mapping installs a handler, which forwards all signals
/// outside mappings.)
class MappedFile {
 public:
  /// Throws Error if the path is missing, not a regular file, or unreadable.
  explicit MappedFile(const std::filesystem::path& path);
  /// Maps `file` in place of this one. `path` is the name in errors.
  MappedFile(const std::filesystem::path& path, const FileDescriptor& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  Bytes bytes() const { return bytes_; }
  /// Throws Error if any accessed byte was ever missing.
  void expect_whole() const;
  /// Stops the system from reading ahead around every accessed byte, to jump through a large file
  /// without loading it.
  void expect_hops() const;
  /// Lets the system read this part of bytes() at once; useful after expect_hops().
  void prefetch(Bytes part) const;
  /// Changes a byte of the first page in memory, never in the file.
  void overwrite(std::size_t at, std::byte value);

 private:
  std::filesystem::path path_;
  Bytes bytes_;
  std::size_t slot_ = 0;  // in the table of all mappings
};

/// Returns or throws what `read`, which accesses a mapped file, does. If another process truncated
/// the file meanwhile, throws Error instead, since any other result would be based on zeros.
template <typename File, typename Read>
auto guarded(const File& file, const Read& read) {
  try {
    auto result = read();
    file.expect_whole();
    return result;
  } catch (...) {
    file.expect_whole();
    throw;
  }
}

}  // namespace planescope::io
