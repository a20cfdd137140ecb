#pragma once

// What one gesture changed: applied forwards to redo, backwards to undo, written to the journal.
// Tools write into a draft (operations.hpp), which keeps their edit.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::labels {

/// Consecutive pixels that had one label and get one label.
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

/// The rest of FrameLabels that edits change.
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
  std::string title;                     // "Brush P3", as the undo list names it
  std::vector<LabelRun> runs;            // ascending, disjoint
  std::vector<LabelPlaneChange> planes;  // by id
  std::optional<NotesChange> notes;

  bool empty() const { return runs.empty() && planes.empty() && !notes; }
  std::size_t changed_pixels() const;
};

/// Labels while a gesture changes them. Pixels are changed by set(), which remembers them: the edit
/// consists of those, no image is compared. Planes and notes may be changed in place.
class LabelDraft {
 public:
  /// `before` must outlive the draft.
  explicit LabelDraft(const FrameLabels& before) : labels(before), before_(before) {}
  /// Of labels that no tool made: their images are compared. Both of the same frame (asserted).
  LabelDraft(const FrameLabels& before, FrameLabels after);
  void set(std::uint32_t pixel, int plane, std::uint8_t hv);
  LabelEdit edit(int frame, std::string title) const;

  FrameLabels labels;
  std::vector<int> unfitted;  // planes that gained or lost pixels; fit_planes() clears it

 private:
  const FrameLabels& before_;
  std::vector<std::uint32_t> changed_;  // in the order of their changes
};

/// For labels that no tool made: from a file, or carried from another frame.
LabelEdit make_edit(int frame,
                    std::string title,
                    const FrameLabels& before,
                    const FrameLabels& after);
/// Undoes it when applied.
LabelEdit reversed(LabelEdit edit);
/// The labels are those before the edit (asserted).
void apply_edit(FrameLabels& labels, const LabelEdit& edit);
/// Whether they are, for edits that come from a file.
bool can_apply(const FrameLabels& labels, const LabelEdit& edit);

}  // namespace planescope::labels
