#pragma once

// An append-only file of records with checksums, which stores a label folder's history, and the
// records' content (journal_records.cpp).

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::labels {

/// Position of a record in the file.
struct JournalPlace {
  std::uint64_t offset = 0;  // start of the record; never 0
  std::uint32_t bytes = 0;   // of its content
};

using JournalBytes = std::vector<unsigned char>;

class Journal {
 public:
  enum class Access : std::uint8_t { read, write };
  using Visitor = std::function<bool(const JournalPlace&, std::span<const unsigned char>)>;

  /// Calls `visit` for one record after another, up to the end, the first damaged record, or the
  /// first one for which it returns false: the rest is `damaged`. A missing file has no records;
  /// the first append() creates it. Throws Error if the file cannot be read or is of a later
  /// version.
  Journal(std::filesystem::path path, Access access, const Visitor& visit);
  ~Journal();

  const std::filesystem::path& path() const { return path_; }
  /// Bytes after the last good record.
  std::uint64_t damaged() const { return size_ - end_; }
  /// Moves the damaged bytes to a file beside the journal, and returns its path.
  std::filesystem::path set_damaged_aside();

  /// Appends all of these or none. Survives a crash of this process at once, and a power failure a
  /// moment later or after sync(). Throws Error if the file cannot be written; the journal is then
  /// unchanged.
  std::vector<JournalPlace> append(std::span<const JournalBytes> records);
  void sync();
  /// Throws Error if the record has changed since it was written.
  JournalBytes read(const JournalPlace& place) const;

 private:
  class BackgroundSync;

  void scan(const Visitor& visit);

  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t end_ = 0;   // after the last good record
  std::uint64_t size_ = 0;  // of the file
  bool unsynced_ = false;
  bool created_ = false;                        // but its name is not durable yet
  std::unique_ptr<BackgroundSync> background_;  // from the first append() on
};

enum class RecordKind : std::uint8_t {
  base = 1,  // the frame's labels before the first edit
  edit,
  undo,     // of the latest edit that is done, in any frame
  redo,     // of the latest undone edit
  saving,   // label files are about to be written with the current labels
  written,  // and were written
};

/// Start of every record.
struct RecordHead {
  RecordKind kind = RecordKind::base;
  int frame = 0;
  std::int64_t time_ms = 0;  // since 1970, UTC
  std::string annotator;
};

/// SHA-256 of each of a frame's label files; empty if the file is missing.
using LabelDigests = std::array<std::string, kLabelFiles>;

JournalBytes base_record(const RecordHead& head, const FrameLabels& labels);
JournalBytes edit_record(const RecordHead& head, const LabelEdit& edit);
JournalBytes saving_record(const RecordHead& head, const LabelDigests& digests);
JournalBytes plain_record(const RecordHead& head);  // of any other kind

/// One line of the history.
struct HistoryEntry {
  int frame = 0;
  std::string title, annotator;
  std::int64_t time_ms = 0;
  std::size_t pixels = 0;
};

// All throw Error if the bytes are not such a record, for example of a later version.
RecordHead read_head(std::span<const unsigned char> record);
FrameLabels read_base(std::span<const unsigned char> record);
HistoryEntry read_history_entry(std::span<const unsigned char> record);
/// `pixels`: in the frame; throws if a run exceeds them.
LabelEdit read_edit(std::span<const unsigned char> record, std::size_t pixels);
LabelDigests read_saving(std::span<const unsigned char> record);

}  // namespace planescope::labels
