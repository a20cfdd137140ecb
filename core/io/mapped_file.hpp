#pragma once

#include <filesystem>

#include "core/io/byte_reader.hpp"

namespace planescope::io {

/// A file mapped read-only into memory: only the pages that are looked at are ever read.
class MappedFile {
 public:
  /// Throws Error when the path is missing, no regular file or cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  Bytes bytes() const { return bytes_; }
  /// Stops the system from reading ahead around every byte that is accessed: for jumping through a
  /// large file without loading it.
  void expect_hops() const;
  /// Lets the system read this part of bytes() in one go; worth it after expect_hops().
  void prefetch(Bytes part) const;

 private:
  Bytes bytes_;
};

}  // namespace planescope::io
