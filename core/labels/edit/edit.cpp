// Edits of labels: made from a draft or two label states, applied to redo and reverted to undo.

#include "core/labels/edit/edit.hpp"

#include <algorithm>
#include <cassert>

namespace planescope::labels {
namespace {

LabelNotes notes_of(const FrameLabels& labels) {
  return {labels.gravity, labels.annotator, labels.review_state, labels.review};
}

void set_notes(FrameLabels& labels, const LabelNotes& notes) {
  labels.gravity = notes.gravity;
  labels.annotator = notes.annotator;
  labels.review_state = notes.review_state;
  labels.review = notes.review;
}

/// Pixels come in ascending order.
void add_if_changed(std::vector<LabelRun>& runs,
                    std::uint32_t pixel,
                    const FrameLabels& before,
                    const FrameLabels& after) {
  LabelRun run = {pixel,
                  1,
                  before.plane.data[pixel],
                  after.plane.data[pixel],
                  before.hv.data[pixel],
                  after.hv.data[pixel]};
  if (run.plane_before == run.plane_after && run.hv_before == run.hv_after) return;
  if (!runs.empty() && runs.back().first + runs.back().count == pixel) {
    LabelRun longer = run;
    longer.first = runs.back().first;
    longer.count = runs.back().count;
    if (longer == runs.back()) {
      ++runs.back().count;
      return;
    }
  }
  runs.push_back(run);
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

LabelEdit edit_of(int frame,
                  std::string title,
                  std::vector<LabelRun> runs,
                  const FrameLabels& before,
                  const FrameLabels& after) {
  LabelEdit edit{frame, std::move(title), std::move(runs), changed_planes(before, after), {}};
  const LabelNotes old_notes = notes_of(before), new_notes = notes_of(after);
  if (old_notes != new_notes) edit.notes = NotesChange{old_notes, new_notes};
  return edit;
}

void set_plane(FrameLabels& labels, int id, const std::optional<LabelPlane>& plane) {
  auto& planes = labels.planes;
  const auto at = std::ranges::lower_bound(planes, id, {}, &LabelPlane::id);
  const bool is_listed = at != planes.end() && at->id == id;
  if (is_listed && plane) {
    *at = *plane;
  } else if (is_listed) {
    planes.erase(at);
  } else if (plane) {
    planes.insert(at, *plane);
  }
}

enum class Direction : std::uint8_t { forwards, backwards };

bool can_put(const FrameLabels& labels, const LabelEdit& edit, Direction direction) {
  const bool forwards = direction == Direction::forwards;
  const auto fits = [&](const LabelRun& run) {
    const std::size_t end = std::size_t{run.first} + run.count;
    if (end > labels.plane.data.size()) return false;
    for (std::size_t i = run.first; i < end; ++i) {
      if (labels.plane.data[i] != (forwards ? run.plane_before : run.plane_after)) return false;
      if (labels.hv.data[i] != (forwards ? run.hv_before : run.hv_after)) return false;
    }
    return true;
  };
  return std::ranges::all_of(edit.runs, fits);
}

void put(FrameLabels& labels, const LabelEdit& edit, Direction direction) {
  assert(can_put(labels, edit, direction));
  const bool forwards = direction == Direction::forwards;
  labels.planes = by_id(std::move(labels.planes));
  for (const LabelRun& run : edit.runs) {
    const auto plane = labels.plane.data.begin() + run.first;
    const auto hv = labels.hv.data.begin() + run.first;
    std::fill_n(plane, run.count, forwards ? run.plane_after : run.plane_before);
    std::fill_n(hv, run.count, forwards ? run.hv_after : run.hv_before);
  }
  for (const LabelPlaneChange& change : edit.planes)
    set_plane(labels, change.id, forwards ? change.after : change.before);
  if (edit.notes) set_notes(labels, forwards ? edit.notes->after : edit.notes->before);
}

}  // namespace

std::size_t LabelEdit::changed_pixels() const {
  std::size_t count = 0;
  for (const LabelRun& run : runs) count += run.count;
  return count;
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
  std::vector<std::uint32_t> pixels = changed_;
  if (!std::ranges::is_sorted(pixels)) std::ranges::sort(pixels);
  pixels.erase(std::ranges::unique(pixels).begin(), pixels.end());
  std::vector<LabelRun> runs;
  for (const std::uint32_t pixel : pixels) add_if_changed(runs, pixel, before_, labels);
  return edit_of(frame, std::move(title), std::move(runs), before_, labels);
}

LabelEdit make_edit(int frame,
                    std::string title,
                    const FrameLabels& before,
                    const FrameLabels& after) {
  assert(before.depth_sha256 == after.depth_sha256);
  assert(before.plane.width == after.plane.width && before.plane.height == after.plane.height);
  assert(before.hv.width == after.hv.width && before.hv.height == after.hv.height);
  std::vector<LabelRun> runs;
  const auto pixels = static_cast<std::uint32_t>(before.plane.data.size());
  for (std::uint32_t i = 0; i < pixels; ++i) add_if_changed(runs, i, before, after);
  return edit_of(frame, std::move(title), std::move(runs), before, after);
}

bool can_apply(const FrameLabels& labels, const LabelEdit& edit) {
  return can_put(labels, edit, Direction::forwards);
}

bool can_revert(const FrameLabels& labels, const LabelEdit& edit) {
  return can_put(labels, edit, Direction::backwards);
}

void apply_edit(FrameLabels& labels, const LabelEdit& edit) {
  put(labels, edit, Direction::forwards);
}

void revert_edit(FrameLabels& labels, const LabelEdit& edit) {
  put(labels, edit, Direction::backwards);
}

}  // namespace planescope::labels
