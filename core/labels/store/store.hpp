#pragma once

// Labels of a recording, on disk and in memory. Every gesture is in the journal before it is shown;
// label files are written from that, whole or not at all.
//
//   DIR/000123.*   the labels that other tools read (label_files.hpp), as of the last save
//   DIR/journal    every edit, undo and redo since the first, append-only, each with its checksum
//   DIR/lock       held while an instance may write
//
// After a crash the journal is replayed. A journal whose end is damaged is cut there; what was cut
// off is kept beside it. Label files that others changed meanwhile are taken over as an edit.

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

/// A state of a frame's labels is named by the record offset of its latest edit that is done: what
/// was done before that cannot differ. 0 is the base.
using LabelMark = std::uint64_t;

/// The order of edits, undos and redos over all frames, as the journal tells it: which edits are
/// done, which were undone, what is in the label files. Places in the journal only, no labels.
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
    LabelMark written_mark = 0;  // of the last that ended, or the base
  };

  /// Adds the record. False, with nothing changed, where it cannot follow the records before it.
  bool add(const JournalPlace& place, const RecordHead& head, const LabelDigests& digests = {});

  /// The last edits that are one step: those of one moment, each of another frame.
  static std::span<const Step> latest(const std::vector<Step>& steps);

  const std::vector<Step>& done() const { return done_; }
  const std::vector<Step>& undone() const { return undone_; }  // the next to redo is the last
  const std::map<int, FrameTrack>& frames() const { return frames_; }
  /// Null where the journal does not know the frame.
  const FrameTrack* find(int frame) const;

 private:
  std::map<int, FrameTrack> frames_;
  std::vector<Step> done_, undone_;
};

/// Not thread-safe. Labels handed out are immutable and stay valid.
class LabelStore {
 public:
  /// Creates the folder with the first edit, not before. Where another instance holds it, or it
  /// cannot be written, the store is read-only and says why. Throws Error where `dir` is no folder
  /// or the journal is of a later version.
  explicit LabelStore(std::filesystem::path dir, LabelStoreOptions options = {});
  // The destructor saves nothing: what is not saved is in the journal.
  LabelStore(const LabelStore&) = delete;
  LabelStore& operator=(const LabelStore&) = delete;

  const std::filesystem::path& dir() const { return dir_; }
  /// Empty where edits are possible; otherwise one line: "read-only: held by ann, process 4711 on
  /// lab3 since 14:02".
  const std::string& read_only() const { return read_only_; }
  /// One line each: what was found damaged or changed by others, and what became of it.
  const std::vector<std::string>& notices() const { return notices_; }
  const std::string& annotator() const { return options_.annotator; }
  void set_annotator(std::string name);

  /// The frame's labels as they are now. `blank` (empty_labels()) says size, hash, intrinsics and
  /// gravity; it is what an unlabelled frame has. Throws Error where files or journal hold labels
  /// of another depth image or size.
  std::shared_ptr<const FrameLabels> open(int frame, const FrameLabels& blank);
  /// Null where it was not opened.
  std::shared_ptr<const FrameLabels> labels(int frame) const;
  /// Grows with every change of the frame's labels, whatever made it.
  std::uint64_t version(int frame) const;

  /// Into the journal, then into the labels. An empty edit does nothing. Throws Error, nothing
  /// changed, where it is read-only or the journal cannot be written (full disk). The frame is
  /// open.
  void commit(const LabelEdit& edit) { commit(std::span(&edit, 1)); }
  /// Edits of several frames, each of which is open, as one step: all are kept or none, and undo
  /// takes all of them back.
  void commit(std::span<const LabelEdit> edits);

  // History over all frames. The frames of the step must be open: `undo_frames` says which they
  // are, the last that was edited first.
  std::vector<int> undo_frames() const;
  std::vector<int> redo_frames() const;
  void undo() { step(RecordKind::undo); }
  void redo() { step(RecordKind::redo); }
  std::size_t undo_count() const { return history_.done().size(); }  // edits, each by itself
  std::size_t redo_count() const { return history_.undone().size(); }
  /// The latest first, at most `most` of them.
  std::vector<HistoryEntry> history(std::size_t most) const;

  bool unsaved(int frame) const;
  bool any_unsaved() const;
  /// Writes the frame's three files: each beside its target, fsync, rename, fsync of the folder.
  /// Throws Error where that fails; what was there stays, the journal has the rest.
  void save(int frame);
  /// A frame that cannot be saved does not keep the others from being saved; the first Error is
  /// thrown at the end.
  void save_all();
  /// Makes what was committed survive a loss of power as well.
  void sync();

 private:
  struct OpenFrame {
    std::shared_ptr<const FrameLabels> labels;
    std::optional<LabelMark> in_files;  // what the label files hold; nullopt: not known or damaged
    LabelDigests base_files;            // what the base came from, until it is in the journal
    std::uint64_t version = 1;
  };
  struct Entry {
    RecordHead head;
    JournalBytes bytes;
    LabelDigests digests = {};  // of a saving
  };
  using NextLabels = std::map<int, std::shared_ptr<const FrameLabels>>;  // by frame

  // The journal (store.cpp).
  void attach();
  void create_folder();
  void require_writable() const;
  Entry entry(RecordKind kind, int frame) const;
  Entry saving(int frame, const LabelDigests& digests) const;
  /// What the frame was before its first edit, unless the journal has it.
  std::vector<Entry> base_entries(int frame) const;
  void append(const std::vector<Entry>& entries);
  /// Into the journal, then onto the frames. Throws Error, nothing changed.
  void keep(const std::vector<Entry>& entries, const NextLabels& next);
  void step(RecordKind direction);
  /// Undoes or redoes the edit at that place. Throws Error where it is one of other labels.
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
  std::unique_ptr<Journal> journal_;  // null while there is no folder
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
/// Empty where there is no journal. By frame, then annotator.
std::vector<WorkTime> work_times(const std::filesystem::path& dir);

}  // namespace planescope::labels
