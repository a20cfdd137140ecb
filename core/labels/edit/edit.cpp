// Edits of labels: made from drafts, applied to redo a gesture, reversed to undo it.

#include "core/labels/edit/edit.hpp"

#include <algorithm>
#include <cassert>

namespace planescope::labels {
namespace {

LabelNotes notes_of(const FrameLabels& labels) {
  return {labels.gravity, labels.annotator, labels.review_state, labels.review};
}

std::vector<LabelPlane> by_id(std::vector<LabelPlane> planes) {
  std::ranges::sort(planes, {}, &LabelPlane::id);
  return planes;
}

std::vector<LabelPlaneChange> changed_planes(const FrameLabels& before, const FrameLabels& after) {
  const auto old_planes = by_id(before.planes), new_planes = by_id(after.planes);
  std::vector<LabelPlaneChange> changes;
  auto a = old_planes.begin();
  auto b = new_planes.begin();
  while (a != old_planes.end() || b != new_planes.end()) {
    LabelPlaneChange change;
    const bool take_a = b == new_planes.end() || (a != old_planes.end() && a->id <= b->id);
    const bool take_b = a == old_planes.end() || (b != new_planes.end() && b->id <= a->id);
    change.id = take_a ? a->id : b->id;
    if (take_a) change.before = *a++;
    if (take_b) change.after = *b++;
    if (change.before != change.after) changes.push_back(std::move(change));
  }
  return changes;
}

/// Keeps the list sorted by id.
void set_plane(std::vector<LabelPlane>& planes, int id, const std::optional<LabelPlane>& plane) {
  const auto at = std::ranges::lower_bound(planes, id, {}, &LabelPlane::id);
  const bool is_listed = at != planes.end() && at->id == id;
  if (is_listed && plane)
    *at = *plane;
  else if (is_listed)
    planes.erase(at);
  else if (plane)
    planes.insert(at, *plane);
}

}  // namespace

std::size_t LabelEdit::changed_pixels() const {
  std::size_t count = 0;
  for (const LabelRun& run : runs) count += run.count;
  return count;
}

LabelDraft::LabelDraft(const FrameLabels& before, FrameLabels after)
    : labels(std::move(after)), before_(before) {
  assert(before.depth_sha256 == labels.depth_sha256);
  assert(before.plane.width == labels.plane.width && before.plane.height == labels.plane.height);
  assert(before.hv.width == labels.hv.width && before.hv.height == labels.hv.height);
  for (std::uint32_t i = 0; i < labels.plane.data.size(); ++i)
    if (before.plane.data[i] != labels.plane.data[i] || before.hv.data[i] != labels.hv.data[i])
      changed_.push_back(i);
}

void LabelDraft::set(std::uint32_t pixel, int plane, std::uint8_t hv) {
  std::uint16_t& plane_now = labels.plane.data[pixel];
  std::uint8_t& hv_now = labels.hv.data[pixel];
  if (plane_now == plane && hv_now == hv) return;
  for (const int id : {int{plane_now}, plane})
    if (plane_now != plane && id > 0 && id < kPlaneIgnore &&
        std::ranges::find(unfitted, id) == unfitted.end())
      unfitted.push_back(id);
  plane_now = static_cast<std::uint16_t>(plane);
  hv_now = hv;
  changed_.push_back(pixel);
}

LabelEdit LabelDraft::edit(int frame, std::string title) const {
  LabelEdit edit{frame, std::move(title), {}, changed_planes(before_, labels), {}};
  const LabelNotes old_notes = notes_of(before_), new_notes = notes_of(labels);
  if (old_notes != new_notes) edit.notes = NotesChange{old_notes, new_notes};
  std::vector<std::uint32_t> pixels = changed_;
  if (!std::ranges::is_sorted(pixels)) std::ranges::sort(pixels);
  pixels.erase(std::ranges::unique(pixels).begin(), pixels.end());
  for (const std::uint32_t i : pixels) {
    const LabelRun one{
        i, 1, before_.plane.data[i], labels.plane.data[i], before_.hv.data[i], labels.hv.data[i]};
    if (one.plane_before == one.plane_after && one.hv_before == one.hv_after) continue;
    LabelRun longer = edit.runs.empty() ? LabelRun{} : edit.runs.back();
    const bool follows = longer.first + longer.count == i;
    longer.first = i;
    longer.count = 1;
    if (follows && longer == one)
      ++edit.runs.back().count;
    else
      edit.runs.push_back(one);
  }
  return edit;
}

LabelEdit make_edit(int frame,
                    std::string title,
                    const FrameLabels& before,
                    const FrameLabels& after) {
  return LabelDraft(before, after).edit(frame, std::move(title));
}

LabelEdit reversed(LabelEdit edit) {
  for (LabelRun& run : edit.runs) {
    std::swap(run.plane_before, run.plane_after);
    std::swap(run.hv_before, run.hv_after);
  }
  for (LabelPlaneChange& change : edit.planes) std::swap(change.before, change.after);
  if (edit.notes) std::swap(edit.notes->before, edit.notes->after);
  return edit;
}

bool can_apply(const FrameLabels& labels, const LabelEdit& edit) {
  return std::ranges::all_of(edit.runs, [&](const LabelRun& run) {
    const std::size_t end = std::size_t{run.first} + run.count;
    if (end > labels.plane.data.size()) return false;
    for (std::size_t i = run.first; i < end; ++i)
      if (labels.plane.data[i] != run.plane_before || labels.hv.data[i] != run.hv_before)
        return false;
    return true;
  });
}

void apply_edit(FrameLabels& labels, const LabelEdit& edit) {
  assert(can_apply(labels, edit));
  for (const LabelRun& run : edit.runs) {
    std::fill_n(labels.plane.data.begin() + run.first, run.count, run.plane_after);
    std::fill_n(labels.hv.data.begin() + run.first, run.count, run.hv_after);
  }
  labels.planes = by_id(std::move(labels.planes));
  for (const LabelPlaneChange& change : edit.planes)
    set_plane(labels.planes, change.id, change.after);
  if (!edit.notes) return;
  const LabelNotes& notes = edit.notes->after;
  labels.gravity = notes.gravity;
  labels.annotator = notes.annotator;
  labels.review_state = notes.review_state;
  labels.review = notes.review;
}

}  // namespace planescope::labels
