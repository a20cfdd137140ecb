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
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/edit/edit.hpp"

namespace planescope::labels {

struct LabelStoreOptions {
  std::string annotator;                 // of new edits; empty: the user's login name
  std::function<std::int64_t()> now_ms;  // since 1970, UTC; empty: the system's clock
};

/// One line of the history.
struct HistoryEntry {
  int frame = 0;
  std::string title, annotator;
  std::int64_t time_ms = 0;
  std::size_t pixels = 0;
};

/// Not thread-safe. Labels handed out are immutable and stay valid.
class LabelStore {
 public:
  /// Creates the folder with the first edit, not before. Where another instance holds it, or it
  /// cannot be written, the store is read-only and says why. Throws Error where `dir` is no folder
  /// or the journal is of a later version.
  explicit LabelStore(std::filesystem::path dir, LabelStoreOptions options = {});
  ~LabelStore();  // saves nothing: what is not saved is in the journal
  LabelStore(const LabelStore&) = delete;
  LabelStore& operator=(const LabelStore&) = delete;

  const std::filesystem::path& dir() const;
  /// Empty where edits are possible; otherwise one line: "read-only: held by ann, process 4711 on
  /// lab3 since 14:02".
  const std::string& read_only() const;
  /// One line each: what was found damaged or changed by others, and what became of it.
  const std::vector<std::string>& notices() const;
  const std::string& annotator() const;
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
  void commit(const LabelEdit& edit);
  /// Edits of several frames, each of which is open, as one step: all are kept or none, and undo
  /// takes all of them back.
  void commit(std::span<const LabelEdit> edits);

  // History over all frames. The frames of the step must be open: `undo_frames` says which they
  // are, the last that was edited first. `undo_frame`: that one.
  std::optional<int> undo_frame() const;
  std::optional<int> redo_frame() const;
  std::vector<int> undo_frames() const;
  std::vector<int> redo_frames() const;
  void undo();
  void redo();
  std::size_t undo_count() const;  // edits, those of one step each by itself
  std::size_t redo_count() const;
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
  struct State;
  std::unique_ptr<State> state_;
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
