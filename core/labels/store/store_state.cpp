#include "core/labels/store/store_state.hpp"

#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <set>

#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNotKept = ": the gesture is not kept";

/// Why nothing can be created in a folder that may not exist yet; empty where it can.
std::string why_not_writable(const fs::path& folder) {
  std::error_code error;
  fs::path nearest = fs::absolute(folder, error);
  while (!fs::exists(nearest, error) && nearest.has_relative_path()) {
    nearest = nearest.parent_path();
  }
  if (::access(nearest.c_str(), W_OK) == 0) return "";
  return nearest.string() + " cannot be written (" + error_text(errno) + ")";
}

}  // namespace

LabelStore::State::State(fs::path folder, LabelStoreOptions given)
    : dir(std::move(folder)), options(std::move(given)) {
  std::error_code error;
  const auto status = fs::status(dir, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw Error(dir.string() + ": a file, expected the folder of a recording's labels");
  }
  if (fs::exists(status)) {
    attach();
  } else if (const std::string why = why_not_writable(dir); !why.empty()) {
    read_only = "read-only: " + why;
  }
}

void LabelStore::State::attach() {
  const fs::path path = dir / "journal";
  lock = FolderLock::take(dir, options.annotator);
  if (!lock.is_held()) {
    read_only = "read-only: " + lock.why_not();
  } else if (::access(path.c_str(), W_OK) != 0 && errno != ENOENT) {
    read_only = "read-only: " + path.string() + " cannot be written (" + error_text(errno) + ")";
  }
  const auto access = read_only.empty() ? Journal::Access::write : Journal::Access::read;
  journal = std::make_unique<Journal>(path, access, [&](const JournalPlace& place, auto record) {
    const RecordHead head = read_head(record);
    LabelDigests digests;
    if (head.kind == RecordKind::saving) digests = read_saving(record);
    return history.add(place, head, digests);
  });
  // What another instance is about to write is not damaged.
  if (journal->damaged() == 0 || lock.is_held_by_other()) return;
  const std::string found =
      path.string() + ": its last " + std::to_string(journal->damaged()) + " bytes are damaged";
  try {
    if (!read_only.empty()) throw Error(read_only);
    const fs::path aside = journal->set_damaged_aside();
    notices.push_back(found + ": everything before them is kept, they are in " +
                      aside.filename().string());
  } catch (const Error& error) {
    if (read_only.empty()) read_only = std::string("read-only: ") + error.what();
    notices.push_back(found + ": everything before them is shown");
  }
}

void LabelStore::State::create_folder() {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw Error(dir.string() + ": cannot be made a folder (" + error.message() + ")");
  attach();
  if (!lock.is_held() && !lock.is_held_by_other()) {  // a full disk, perhaps: may pass
    journal.reset();
    throw Error(std::exchange(read_only, ""));
  }
  if (read_only.empty() && !history.frames().empty()) {
    read_only = "read-only: another instance made labels meanwhile; open the recording again";
  }
  require_writable();
  sync_folder(dir.parent_path());
}

void LabelStore::State::require_writable() const {
  if (!read_only.empty()) throw Error(dir.string() + ": " + read_only);
}

void LabelStore::State::sync() {
  if (journal && lock.is_held()) journal->sync();
}

LabelMark LabelStore::State::mark(int frame) const {
  const auto* track = history.find(frame);
  return track ? track->mark : 0;
}

LabelStore::State::Entry LabelStore::State::entry(RecordKind kind, int frame) const {
  const RecordHead head = {kind, frame, options.now_ms(), options.annotator};
  return {head, plain_record(head)};
}

LabelStore::State::Entry LabelStore::State::saving(int frame, const LabelDigests& digests) const {
  const RecordHead head = entry(RecordKind::saving, frame).head;
  return {head, saving_record(head, digests), digests};
}

std::vector<LabelStore::State::Entry> LabelStore::State::base_entries(int frame) const {
  if (history.find(frame)) return {};
  const OpenFrame& open = frames.at(frame);
  const RecordHead head = entry(RecordKind::base, frame).head;
  std::vector<Entry> entries = {{head, base_record(head, *open.labels)}};
  if (open.base_files != LabelDigests{}) {
    entries.push_back(saving(frame, open.base_files));
    entries.push_back(entry(RecordKind::written, frame));
  }
  return entries;
}

void LabelStore::State::append(const std::vector<Entry>& entries) {
  require_writable();
  if (!journal) create_folder();
  std::vector<JournalBytes> records;
  records.reserve(entries.size());
  for (const Entry& each : entries) records.push_back(each.bytes);
  const auto places = journal->append(records);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    [[maybe_unused]] const bool follows =
        history.add(places[i], entries[i].head, entries[i].digests);
    assert(follows);
  }
}

void LabelStore::State::keep(const std::vector<Entry>& entries, const NextLabels& next) {
  try {
    append(entries);
  } catch (const Error& error) {
    throw Error(error.what() + std::string(kNotKept));
  }
  for (const auto& [frame, labels] : next) {
    frames.at(frame).labels = labels;
    ++frames.at(frame).version;
  }
}

void LabelStore::State::commit(std::span<const LabelEdit> edits) {
  NextLabels next;
  std::vector<Entry> entries;
  // A moment of its own: edits of one moment are one step.
  std::int64_t now_ms = options.now_ms();
  if (!history.done().empty() && history.done().back().time_ms == now_ms) ++now_ms;
  for (const LabelEdit& edit : edits) {
    if (edit.empty()) continue;
    assert(frames.contains(edit.frame) && !next.contains(edit.frame));
    auto labels = std::make_shared<FrameLabels>(*frames.at(edit.frame).labels);
    apply_edit(*labels, edit);
    next[edit.frame] = std::move(labels);
    for (Entry& base : base_entries(edit.frame)) entries.push_back(std::move(base));
  }
  if (next.empty()) return;
  // Side by side, as undo finds them.
  for (const LabelEdit& edit : edits) {
    if (edit.empty()) continue;
    RecordHead head = entry(RecordKind::edit, edit.frame).head;
    head.time_ms = now_ms;
    entries.push_back({head, edit_record(head, edit)});
  }
  keep(entries, next);
}

void LabelStore::State::step(RecordKind direction) {
  require_writable();
  const bool undoes = direction == RecordKind::undo;
  const auto latest = LabelHistory::latest(undoes ? history.done() : history.undone());
  NextLabels next;
  std::vector<Entry> entries;
  for (auto each = latest.rbegin(); each != latest.rend(); ++each) {
    assert(frames.contains(each->frame));
    auto labels = std::make_shared<FrameLabels>(*frames.at(each->frame).labels);
    put(*labels, each->place, direction);
    next[each->frame] = std::move(labels);
    entries.push_back(entry(direction, each->frame));
  }
  if (entries.empty()) return;
  keep(entries, next);
}

void LabelStore::State::put(FrameLabels& labels,
                            const JournalPlace& place,
                            RecordKind direction) const {
  const LabelEdit edit = read_edit(journal->read(place), labels.plane.data.size());
  const bool undoes = direction == RecordKind::undo;
  if (!(undoes ? can_revert(labels, edit) : can_apply(labels, edit))) {
    throw Error(journal->path().string() + ": the edit at byte " + std::to_string(place.offset) +
                " is not one of the labels that the records before it give");
  }
  undoes ? revert_edit(labels, edit) : apply_edit(labels, edit);
}

FrameLabels LabelStore::State::replay(int frame) const {
  FrameLabels labels = read_base(journal->read(history.find(frame)->base));
  for (const LabelHistory::Step& each : history.done()) {
    if (each.frame != frame) continue;
    put(labels, each.place, RecordKind::redo);
  }
  return labels;
}

std::vector<HistoryEntry> LabelStore::State::latest(std::size_t most) const {
  std::vector<HistoryEntry> entries;
  const auto& done = history.done();
  for (auto at = done.rbegin(); at != done.rend() && entries.size() < most; ++at) {
    const JournalBytes record = journal->read(at->place);
    const RecordHead head = read_head(record);
    const EditSummary summary = read_edit_summary(record);
    entries.push_back({head.frame, summary.title, head.annotator, head.time_ms, summary.pixels});
  }
  return entries;
}

std::span<const LabelHistory::Step> LabelHistory::latest(const std::vector<Step>& steps) {
  std::size_t first = steps.size();
  std::set<int> frames;
  while (first > 0 && steps[first - 1].time_ms == steps.back().time_ms &&
         frames.insert(steps[first - 1].frame).second)
    --first;
  return std::span(steps).subspan(first);
}

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
      done_.push_back({place, head.frame, frame.mark, head.time_ms});
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
