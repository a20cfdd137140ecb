#pragma once

#include <filesystem>

#include "core/io/byte_reader.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {

/// What `read`, which looks at a mapped file, returns or throws. Throws Error where the file was
/// cut by somebody else meanwhile: whatever came of zeros is not told.
template <typename File, typename Read>
auto guarded_by(const File& file, const Read& read) {
  try {
    auto result = read();
    file.expect_whole();
    return result;
  } catch (...) {
    file.expect_whole();
    throw;
  }
}

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
  /// What `read`, which looks at bytes(), returns or throws. Throws Error where bytes were missing:
  /// whatever came of zeros is not told.
  template <typename Read>
  auto guarded(const Read& read) const {
    return guarded_by(*this, read);
  }
  /// Throws Error where bytes were missing that were looked at, ever.
  void expect_whole() const;
  /// Stops the system from reading ahead around every byte that is accessed: for jumping through a
  /// large file without loading it.
  void expect_hops() const;
  /// Lets the system read this part of bytes() in one go; worth it after expect_hops().
  void prefetch(Bytes part) const;

 private:
  std::filesystem::path path_;
  Bytes bytes_;
  std::size_t slot_ = 0;  // in the table of all mappings
};

}  // namespace planescope::io
