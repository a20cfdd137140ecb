#pragma once

// Labels of a recording, on disk and in memory. Every gesture is written to the journal before it
// is shown; label files are written from the journal's state, completely or not at all.
//
//   DIR/000123.*   labels for other tools (label_files.hpp), as of the last save
//   DIR/journal    every edit, undo and redo, append-only, each with its checksum
//   DIR/lock       locked while an instance may write
//
// After a crash the journal is replayed. A damaged end of the journal is cut off and kept beside
// it. Label files that others changed meanwhile are taken over as an edit.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/store/journal.hpp"

namespace planescope::labels {

struct LabelStoreOptions {
  std::string annotator;                 // of new edits; empty: the user's login name
  std::function<std::int64_t()> now_ms;  // since 1970, UTC; empty: the system's clock
};

/// Identifies a state of a frame's labels by the record offset of its latest done edit, since the
/// edits before that cannot differ. 0 is the base.
using LabelMark = std::uint64_t;

/// The order of edits, undos and redos over all frames, from the journal: which edits are done or
/// undone, and the state in the label files. Contains only positions in the journal, no labels.
class LabelHistory {
 public:
  struct Step {
    JournalPlace place;
    int frame = 0;
    LabelMark before = 0;  // of the frame
    std::int64_t time_ms = 0;
  };
  struct Save {
    LabelDigests digests;
    LabelMark mark = 0;
  };
  struct FrameTrack {
    JournalPlace base;
    LabelMark mark = 0;
    std::vector<Save> saves;     // begun
    LabelMark written_mark = 0;  // of the last completed save, or the base
  };

  /// Adds the record. Returns false, without changes, if it cannot follow the previous records.
  bool add(const JournalPlace& place, const RecordHead& head, const LabelDigests& digests = {});

  /// The last edits that form one step: those of the same time, each of a different frame.
  static std::span<const Step> latest(const std::vector<Step>& steps);

  const std::vector<Step>& done() const { return done_; }
  const std::vector<Step>& undone() const { return undone_; }  // the last one is the next to redo
  const std::map<int, FrameTrack>& frames() const { return frames_; }
  /// Null if the journal does not contain the frame.
  const FrameTrack* find(int frame) const;

 private:
  std::map<int, FrameTrack> frames_;
  std::vector<Step> done_, undone_;
};

/// Not thread-safe. Returned labels are immutable and stay valid.
class LabelStore {
 public:
  /// Creates the folder with the first edit, not before. If another instance holds it, or it cannot
  /// be written, the store is read-only and reports why. Throws Error if `dir` is not a folder or
  /// the journal is of a later version.
  explicit LabelStore(std::filesystem::path dir, LabelStoreOptions options = {});
  // The destructor saves nothing: unsaved edits are in the journal.
  LabelStore(const LabelStore&) = delete;
  LabelStore& operator=(const LabelStore&) = delete;

  const std::filesystem::path& dir() const { return dir_; }
  /// Empty if edits are possible; otherwise one line: "read-only: held by ann, process 4711 on lab3
  /// since 14:02".
  const std::string& read_only() const { return read_only_; }
  /// One line each: damage or changes by others, and how they were handled.
  const std::vector<std::string>& notices() const { return notices_; }
  const std::string& annotator() const { return options_.annotator; }
  void set_annotator(std::string name);

  /// The frame's current labels. `blank` (empty_labels()) defines size, hash, intrinsics and
  /// gravity; an unlabeled frame starts with it. Throws Error if files or journal contain labels of
  /// another depth image or size.
  std::shared_ptr<const FrameLabels> open(int frame, const FrameLabels& blank);
  /// Null if the frame is not open.
  std::shared_ptr<const FrameLabels> labels(int frame) const;
  /// Increases with every change of the frame's labels, whatever its cause.
  std::uint64_t version(int frame) const;

  /// Appends the edit to the journal, then applies it to the labels. An empty edit does nothing.
  /// Throws Error, without changes, if the store is read-only or the journal cannot be written
  /// (full disk). The frame must be open.
  void commit(const LabelEdit& edit) { commit(std::span(&edit, 1)); }
  /// Commits edits of several frames, all open, as one step: either all are kept or none, and undo
  /// reverts all of them.
  void commit(std::span<const LabelEdit> edits);

  // History over all frames. The frames of the step must be open: `undo_frames` returns them, the
  // most recently edited first.
  std::vector<int> undo_frames() const;
  std::vector<int> redo_frames() const;
  void undo() { step(RecordKind::undo); }
  void redo() { step(RecordKind::redo); }
  std::size_t undo_count() const { return history_.done().size(); }  // counts each edit of a step
  std::size_t redo_count() const { return history_.undone().size(); }
  /// Latest first, at most `most` of them.
  std::vector<HistoryEntry> history(std::size_t most) const;

  bool unsaved(int frame) const;
  bool any_unsaved() const;
  /// Writes the frame's three files: each beside its target, fsync, rename, fsync of the folder.
  /// Throws Error on failure; existing files stay, and the journal has the rest.
  void save(int frame);
  /// A frame that cannot be saved does not prevent saving the others; the first Error is thrown at
  /// the end.
  void save_all();
  /// Makes committed edits survive a power failure as well.
  void sync();

 private:
  struct OpenFrame {
    std::shared_ptr<const FrameLabels> labels;
    std::optional<LabelMark> in_files;  // state of the label files; nullopt: unknown or damaged
    LabelDigests base_files;            // files of the base, until the journal has it
    std::uint64_t version = 1;
  };
  struct Entry {
    RecordHead head;
    JournalBytes bytes;
    LabelDigests digests = {};  // of a save
  };
  using NextLabels = std::map<int, std::shared_ptr<const FrameLabels>>;  // by frame

  // The journal (store.cpp).
  void attach();
  void create_folder();
  void require_writable() const;
  Entry entry(RecordKind kind, int frame) const;
  Entry saving(int frame, const LabelDigests& digests) const;
  /// The frame before its first edit, unless the journal has it.
  std::vector<Entry> base_entries(int frame) const;
  void append(const std::vector<Entry>& entries);
  /// Appends to the journal, then updates the frames. Throws Error without changes.
  void keep(const std::vector<Entry>& entries, const NextLabels& next);
  void step(RecordKind direction);
  /// Undoes or redoes the edit at that position. Throws Error if it belongs to other labels.
  void put(FrameLabels& labels, const JournalPlace& place, RecordKind direction) const;
  FrameLabels replay(int frame) const;
  LabelMark mark(int frame) const;

  // The label files (store_files.cpp).
  OpenFrame& opened(int frame, const FrameLabels* blank);
  OpenFrame first_labels(int frame, const FrameLabels& blank) const;
  LabelDigests digests_of_files(int frame) const;
  bool is_ours(int frame, const LabelDigests& digests) const;
  void compare_with_files(int frame);
  bool take_over(int frame, const LabelDigests& digests);
  void set_files_aside(int frame) const;
  void notice(std::string text);

  std::filesystem::path dir_;
  LabelStoreOptions options_;
  FolderLock lock_;
  std::unique_ptr<Journal> journal_;  // null until the folder exists
  LabelHistory history_;
  std::map<int, OpenFrame> frames_;
  std::string read_only_;
  std::vector<std::string> notices_;
};

/// Time spent and gestures made, from a journal; gaps of more than a minute count as a minute.
struct WorkTime {
  int frame = 0;
  std::string annotator;
  double seconds = 0;
  std::size_t gestures = 0;
};
/// Empty if there is no journal. Sorted by frame, then annotator.
std::vector<WorkTime> work_times(const std::filesystem::path& dir);

}  // namespace planescope::labels
