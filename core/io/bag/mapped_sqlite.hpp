#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <memory>

#include "core/io/mapped_file.hpp"

namespace planescope::io {

/// A SQLite database read out of a mapped file, through a file system of SQLite's (VFS) that knows
/// this file alone: nothing is ever written, locked or made beside it, and a file that is cut opens
/// as far as its pages are whole.
class MappedSqlite {
 public:
  /// Throws Error when the file is no SQLite file.
  explicit MappedSqlite(const std::filesystem::path& path);

  const MappedFile& file() const { return file_; }
  sqlite3* database() const { return database_.get(); }
  /// Bytes that the header promises; 0 where the last writer did not keep that.
  std::uint64_t promised_bytes() const { return promised_bytes_; }
  bool is_cut() const { return promised_bytes_ > file_.bytes().size(); }
  std::size_t page_bytes() const { return page_bytes_; }

 private:
  struct Closer {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  struct Vfs;
  struct VfsDeleter {
    void operator()(Vfs* vfs) const;
  };

  MappedFile file_;
  std::size_t page_bytes_ = 0;
  std::uint64_t promised_bytes_ = 0;
  std::unique_ptr<Vfs, VfsDeleter> vfs_;
  std::unique_ptr<sqlite3, Closer> database_;
};

}  // namespace planescope::io
