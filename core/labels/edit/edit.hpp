#pragma once

// The changes of one gesture: applied forward to redo, backward to undo, written to the journal.
// Tools write into a draft (operations.hpp), which records their edit.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::labels {

/// Consecutive pixels that had the same label and get the same label.
struct LabelRun {
  std::uint32_t first = 0, count = 0;
  std::uint16_t plane_before = 0, plane_after = 0;
  std::uint8_t hv_before = 0, hv_after = 0;

  bool operator==(const LabelRun&) const = default;
};

struct LabelPlaneChange {
  int id = 0;
  std::optional<LabelPlane> before, after;

  bool operator==(const LabelPlaneChange&) const = default;
};

/// The other members of FrameLabels that edits change.
struct LabelNotes {
  Gravity gravity;
  std::string annotator;
  std::string review_state;
  std::vector<ReviewNote> review;

  bool operator==(const LabelNotes&) const = default;
};
struct NotesChange {
  LabelNotes before, after;
};

struct LabelEdit {
  int frame = 0;
  std::string title;                     // for the undo list: "Brush P3"
  std::vector<LabelRun> runs;            // ascending, disjoint
  std::vector<LabelPlaneChange> planes;  // by id
  std::optional<NotesChange> notes;

  bool empty() const { return runs.empty() && planes.empty() && !notes; }
  std::size_t changed_pixels() const;
};

/// Labels while a gesture changes them. Change pixels through set(), which records them, so that
/// edit() need not compare images. Planes and notes may be changed in place.
class LabelDraft {
 public:
  /// `before` must outlive the draft.
  explicit LabelDraft(const FrameLabels& before) : labels(before), before_(before) {}
  /// For labels not made by a tool: compares the images. Both must be of one frame (asserted).
  LabelDraft(const FrameLabels& before, FrameLabels after);
  void set(std::uint32_t pixel, int plane, std::uint8_t hv);
  LabelEdit edit(int frame, std::string title) const;

  FrameLabels labels;
  std::vector<int> unfitted;  // planes that gained or lost pixels; fit_planes() clears it

 private:
  const FrameLabels& before_;
  std::vector<std::uint32_t> changed_;  // in order of change
};

/// For labels not made by a tool: from a file, or carried from another frame.
LabelEdit make_edit(int frame,
                    std::string title,
                    const FrameLabels& before,
                    const FrameLabels& after);
/// Returns an edit that undoes this one.
LabelEdit reversed(LabelEdit edit);
/// The labels must be those before the edit (asserted).
void apply_edit(FrameLabels& labels, const LabelEdit& edit);
/// Checks this, for edits read from a file.
bool can_apply(const FrameLabels& labels, const LabelEdit& edit);

}  // namespace planescope::labels
