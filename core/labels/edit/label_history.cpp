#include "core/labels/edit/label_history.hpp"

namespace planescope::labels {

bool LabelHistory::add(const JournalPlace& place,
                       const RecordHead& head,
                       const LabelDigests& digests) {
  const auto known = frames_.find(head.frame);
  if (head.kind == RecordKind::base) {
    if (known != frames_.end()) return false;
    frames_[head.frame].base = place;
    return true;
  }
  if (known == frames_.end()) return false;
  FrameTrack& frame = known->second;
  switch (head.kind) {
    case RecordKind::base:
      break;
    case RecordKind::edit:
      done_.push_back({place, head.frame, frame.mark});
      undone_.clear();
      frame.mark = place.offset;
      break;
    case RecordKind::undo:
      if (done_.empty() || done_.back().frame != head.frame) return false;
      frame.mark = done_.back().before;
      undone_.push_back(done_.back());
      done_.pop_back();
      break;
    case RecordKind::redo:
      if (undone_.empty() || undone_.back().frame != head.frame) return false;
      frame.mark = undone_.back().place.offset;
      done_.push_back(undone_.back());
      undone_.pop_back();
      break;
    case RecordKind::saving:
      frame.saves.push_back({digests, frame.mark});
      break;
    case RecordKind::written:
      if (frame.saves.empty()) return false;
      frame.written_mark = frame.saves.back().mark;
      break;
  }
  return true;
}

const LabelHistory::FrameTrack* LabelHistory::find(int frame) const {
  const auto at = frames_.find(frame);
  return at == frames_.end() ? nullptr : &at->second;
}

}  // namespace planescope::labels
