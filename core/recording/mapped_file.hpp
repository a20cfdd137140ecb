#pragma once

#include <filesystem>

#include "core/recording/byte_reader.hpp"

namespace planescope {

/// A file mapped read-only into memory: only the pages that are looked at are ever read.
class MappedFile {
 public:
  /// Throws Error when the path is missing, no regular file or cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  Bytes bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

}  // namespace planescope
