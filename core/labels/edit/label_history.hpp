#pragma once

// The order of edits, undos and redos over all frames, as the journal tells it: which edits are
// done, which were undone, what is in the label files. Places in the journal only, no labels.

#include <map>
#include <vector>

#include "core/labels/store/journal_records.hpp"

namespace planescope::labels {

/// A state of a frame's labels is named by the record offset of its latest edit that is done: what
/// was done before that cannot differ. 0 is the base.
using LabelMark = std::uint64_t;

class LabelHistory {
 public:
  struct Step {
    JournalPlace place;
    int frame = 0;
    LabelMark before = 0;  // of the frame
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

  const std::vector<Step>& done() const { return done_; }
  const std::vector<Step>& undone() const { return undone_; }  // the next to redo is the last
  const std::map<int, FrameTrack>& frames() const { return frames_; }
  /// Null where the journal does not know the frame.
  const FrameTrack* find(int frame) const;

 private:
  std::map<int, FrameTrack> frames_;
  std::vector<Step> done_, undone_;
};

}  // namespace planescope::labels
