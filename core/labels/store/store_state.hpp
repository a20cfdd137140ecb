#pragma once

// What a LabelStore is made of: the journal and what was done (store_state.cpp), the label files
// beside it (store_files.cpp).

#include <map>
#include <span>

#include "core/labels/store/journal_records.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::labels {

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

struct LabelStore::State {
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

  State(std::filesystem::path folder, LabelStoreOptions given);

  void require_writable() const;
  void sync();
  using NextLabels = std::map<int, std::shared_ptr<const FrameLabels>>;  // by frame
  /// Into the journal, then onto the frames. Throws Error, nothing changed.
  void keep(const std::vector<Entry>& entries, const NextLabels& next);
  void commit(std::span<const LabelEdit> edits);
  void commit(const LabelEdit& edit) { commit(std::span(&edit, 1)); }
  void step(RecordKind direction);
  std::vector<HistoryEntry> latest(std::size_t most) const;

  // The journal.
  void attach();
  void create_folder();
  Entry entry(RecordKind kind, int frame) const;
  Entry saving(int frame, const LabelDigests& digests) const;
  /// What the frame was before its first edit, unless the journal has it.
  std::vector<Entry> base_entries(int frame) const;
  void append(const std::vector<Entry>& entries);
  /// Undoes or redoes the edit at that place. Throws Error where it is one of other labels.
  void put(FrameLabels& labels, const JournalPlace& place, RecordKind direction) const;
  FrameLabels replay(int frame) const;
  LabelMark mark(int frame) const;

  // The label files.
  OpenFrame& open(int frame, const FrameLabels* blank);
  OpenFrame first_labels(int frame, const FrameLabels& blank) const;
  LabelDigests digests_of_files(int frame) const;
  bool is_ours(int frame, const LabelDigests& digests) const;
  void compare_with_files(int frame);
  bool take_over(int frame, const LabelDigests& digests);
  void set_files_aside(int frame) const;
  void notice(std::string text);
  bool unsaved(int frame) const;
  void save(int frame);

  std::filesystem::path dir;
  LabelStoreOptions options;
  FolderLock lock;
  std::unique_ptr<Journal> journal;  // null while there is no folder
  LabelHistory history;
  std::map<int, OpenFrame> frames;
  std::string read_only;
  std::vector<std::string> notices;
};

}  // namespace planescope::labels
