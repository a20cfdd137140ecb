#pragma once

// An append-only file of records, each with a checksum: it keeps a label folder's history.
// journal_records.hpp says what the records hold.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/model/file_bytes.hpp"

namespace planescope::labels {

/// A record in the file.
struct JournalPlace {
  std::uint64_t offset = 0;  // where it starts; never 0
  std::uint32_t bytes = 0;   // of what it holds
};

using JournalBytes = std::vector<unsigned char>;

class Journal {
 public:
  enum class Access : std::uint8_t { read, write };
  using Visitor = std::function<bool(const JournalPlace&, std::span<const unsigned char>)>;

  /// Calls `visit` for one record after the other, up to the end, the first that is damaged or the
  /// first that is refused with false: what follows is `damaged`. A missing file has no records; it
  /// is made by the first append(). Throws Error where the file cannot be read or is of a later
  /// version.
  Journal(std::filesystem::path path, Access access, const Visitor& visit);
  ~Journal();

  const std::filesystem::path& path() const { return path_; }
  /// Bytes behind the last good record.
  std::uint64_t damaged() const { return size_ - end_; }
  /// Moves them into a file beside it, and returns its path.
  std::filesystem::path set_damaged_aside();

  /// All of these or none. Survives a crash of this process at once, a loss of power a moment later
  /// or after sync().
  /// Throws Error where it cannot be written; the journal is then as it was.
  std::vector<JournalPlace> append(std::span<const JournalBytes> records);
  void sync();
  /// Throws Error where the record is not as it was written.
  JournalBytes read(const JournalPlace& place) const;

 private:
  class BackgroundSync;

  void scan(const Visitor& visit);

  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t end_ = 0;   // behind the last good record
  std::uint64_t size_ = 0;  // of the file
  bool unsynced_ = false;
  bool created_ = false;                        // and its name not yet made durable
  std::unique_ptr<BackgroundSync> background_;  // from the first append() on
};

}  // namespace planescope::labels
