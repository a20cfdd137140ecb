#pragma once

// Bytes of files: mapped into memory, and read one value after the other.

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

static_assert(std::endian::native == std::endian::little, "files are read as they lie in memory");

/// Thrown by ByteReader when a length points past the end. Internal to the readers: each catches
/// it and says what that means for its file.
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

/// A file mapped read-only into memory: only the pages that are looked at are ever read. Where the
/// file is cut by somebody else meanwhile, what is missing reads as zeros, and guarded() says so.
/// (The system raises SIGBUS then: the first mapping installs a handler, which passes on whatever
/// concerns no mapping.)
class MappedFile {
 public:
  /// Throws Error when the path is missing, no regular file or cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  /// Maps another file that stands for this one: `path` is what it is called.
  MappedFile(const std::filesystem::path& path, const FileDescriptor& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  Bytes bytes() const { return bytes_; }
  /// Throws Error where bytes were missing that were looked at, ever.
  void expect_whole() const;
  /// Stops the system from reading ahead around every byte that is accessed: for jumping through a
  /// large file without loading it.
  void expect_hops() const;
  /// Lets the system read this part of bytes() in one go; worth it after expect_hops().
  void prefetch(Bytes part) const;
  /// Changes a byte of the first page in memory, never in the file.
  void overwrite(std::size_t at, std::byte value);

 private:
  std::filesystem::path path_;
  Bytes bytes_;
  std::size_t slot_ = 0;  // in the table of all mappings
};

/// What `read`, which looks at a mapped file, returns or throws. Throws Error where the file was
/// cut by somebody else meanwhile: whatever came of zeros is not told.
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
