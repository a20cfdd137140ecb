// The store's journal and history; store_files.cpp has the label files.

#include "core/labels/store/store.hpp"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <exception>
#include <ranges>
#include <set>

#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNotKept = "; the edit is not saved";

constexpr double kLongestGapS = 60;  // longer pauses count only this much

bool is_gesture(RecordKind kind) {
  return kind == RecordKind::edit || kind == RecordKind::undo || kind == RecordKind::redo;
}

/// Why nothing can be created in a folder that may not exist yet; empty if it is possible.
std::string why_not_writable(const fs::path& folder) {
  std::error_code error;
  fs::path nearest = fs::absolute(folder, error);
  while (!fs::exists(nearest, error) && nearest.has_relative_path())
    nearest = nearest.parent_path();
  if (::access(nearest.c_str(), W_OK) == 0) return "";
  return nearest.string() + " cannot be written (" + error_text(errno) + ")";
}

std::string login_name() {
  const passwd* user = ::getpwuid(::getuid());
  return user && user->pw_name ? user->pw_name : "unknown";
}

std::int64_t system_time_ms() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

std::vector<int> frames_of_step(const std::vector<LabelHistory::Step>& steps) {
  std::vector<int> frames;
  for (const LabelHistory::Step& step : LabelHistory::latest(steps) | std::views::reverse)
    frames.push_back(step.frame);
  return frames;
}

}  // namespace

LabelStore::LabelStore(fs::path dir, LabelStoreOptions options)
    : dir_(std::move(dir)), options_(std::move(options)) {
  if (options_.annotator.empty()) options_.annotator = login_name();
  if (!options_.now_ms) options_.now_ms = system_time_ms;
  std::error_code error;
  const auto status = fs::status(dir_, error);
  if (fs::exists(status) && !fs::is_directory(status))
    throw Error(dir_.string() + ": is a file; expected a label folder");
  if (fs::exists(status)) {
    attach();
  } else if (const std::string why = why_not_writable(dir_); !why.empty()) {
    read_only_ = "read-only: " + why;
  }
}

void LabelStore::attach() {
  const fs::path path = dir_ / "journal";
  lock_ = FolderLock::acquire(dir_, options_.annotator);
  if (!lock_.is_held()) {
    read_only_ = "read-only: " + lock_.why_not();
  } else if (::access(path.c_str(), W_OK) != 0 && errno != ENOENT) {
    read_only_ = "read-only: " + path.string() + " cannot be written (" + error_text(errno) + ")";
  }
  const auto access = read_only_.empty() ? Journal::Access::write : Journal::Access::read;
  journal_ = std::make_unique<Journal>(path, access, [&](const JournalPlace& place, auto record) {
    const RecordHead head = read_head(record);
    LabelDigests digests;
    if (head.kind == RecordKind::saving) digests = read_saving(record);
    return history_.add(place, head, digests);
  });
  // A record that another instance is writing is not damaged.
  if (journal_->damaged() == 0 || lock_.is_held_by_other()) return;
  const std::string found = path.string() + ": its last " + std::to_string(journal_->damaged()) +
                            " bytes are damaged; everything before them is ";
  try {
    if (!read_only_.empty()) throw Error(read_only_);
    const fs::path aside = journal_->set_damaged_aside();
    notices_.push_back(found + "kept, and the damaged bytes are in " + aside.filename().string());
  } catch (const Error& error) {
    if (read_only_.empty()) read_only_ = std::string("read-only: ") + error.what();
    notices_.push_back(found + "shown");
  }
}

void LabelStore::create_folder() {
  std::error_code error;
  fs::create_directories(dir_, error);
  if (error) throw Error(dir_.string() + ": folder cannot be created (" + error.message() + ")");
  attach();
  if (!lock_.is_held() && !lock_.is_held_by_other()) {  // possibly a full disk: may be temporary
    journal_.reset();
    throw Error(std::exchange(read_only_, ""));
  }
  if (read_only_.empty() && !history_.frames().empty())
    read_only_ = "read-only: another instance has changed the labels; open the recording again";
  require_writable();
  sync_folder(dir_.parent_path());
}

void LabelStore::require_writable() const {
  if (!read_only_.empty()) throw Error(dir_.string() + ": " + read_only_);
}

void LabelStore::sync() {
  if (journal_ && lock_.is_held()) journal_->sync();
}

LabelMark LabelStore::mark(int frame) const {
  const auto* track = history_.find(frame);
  return track ? track->mark : 0;
}

LabelStore::Entry LabelStore::entry(RecordKind kind, int frame) const {
  const RecordHead head = {kind, frame, options_.now_ms(), options_.annotator};
  return {head, plain_record(head)};
}

LabelStore::Entry LabelStore::saving(int frame, const LabelDigests& digests) const {
  const RecordHead head = entry(RecordKind::saving, frame).head;
  return {head, saving_record(head, digests), digests};
}

std::vector<LabelStore::Entry> LabelStore::base_entries(int frame) const {
  if (history_.find(frame)) return {};
  const OpenFrame& open = frames_.at(frame);
  const RecordHead head = entry(RecordKind::base, frame).head;
  std::vector<Entry> entries = {{head, base_record(head, *open.labels)}};
  if (open.base_files != LabelDigests{}) {
    entries.push_back(saving(frame, open.base_files));
    entries.push_back(entry(RecordKind::written, frame));
  }
  return entries;
}

void LabelStore::append(const std::vector<Entry>& entries) {
  require_writable();
  if (!journal_) create_folder();
  std::vector<JournalBytes> records;
  records.reserve(entries.size());
  for (const Entry& each : entries) records.push_back(each.bytes);
  const auto places = journal_->append(records);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    [[maybe_unused]] const bool follows =
        history_.add(places[i], entries[i].head, entries[i].digests);
    assert(follows);
  }
}

void LabelStore::keep(const std::vector<Entry>& entries, const NextLabels& next) {
  try {
    append(entries);
  } catch (const Error& error) {
    throw Error(error.what() + std::string(kNotKept));
  }
  for (const auto& [frame, labels] : next) {
    frames_.at(frame).labels = labels;
    ++frames_.at(frame).version;
  }
}

void LabelStore::commit(std::span<const LabelEdit> edits) {
  NextLabels next;
  std::vector<Entry> entries;
  // A distinct time, because edits of the same time are one step.
  std::int64_t now_ms = options_.now_ms();
  if (!history_.done().empty() && history_.done().back().time_ms == now_ms) ++now_ms;
  for (const LabelEdit& edit : edits) {
    if (edit.empty()) continue;
    assert(frames_.contains(edit.frame) && !next.contains(edit.frame));
    auto labels = std::make_shared<FrameLabels>(*frames_.at(edit.frame).labels);
    apply_edit(*labels, edit);
    next[edit.frame] = std::move(labels);
    for (Entry& base : base_entries(edit.frame)) entries.push_back(std::move(base));
  }
  if (next.empty()) return;
  // Consecutive, as undo expects them.
  for (const LabelEdit& edit : edits) {
    if (edit.empty()) continue;
    RecordHead head = entry(RecordKind::edit, edit.frame).head;
    head.time_ms = now_ms;
    entries.push_back({head, edit_record(head, edit)});
  }
  keep(entries, next);
}

void LabelStore::step(RecordKind direction) {
  require_writable();
  const bool undoes = direction == RecordKind::undo;
  const auto latest = LabelHistory::latest(undoes ? history_.done() : history_.undone());
  NextLabels next;
  std::vector<Entry> entries;
  for (auto each = latest.rbegin(); each != latest.rend(); ++each) {
    assert(frames_.contains(each->frame));
    auto labels = std::make_shared<FrameLabels>(*frames_.at(each->frame).labels);
    put(*labels, each->place, direction);
    next[each->frame] = std::move(labels);
    entries.push_back(entry(direction, each->frame));
  }
  if (entries.empty()) return;
  keep(entries, next);
}

void LabelStore::put(FrameLabels& labels, const JournalPlace& place, RecordKind direction) const {
  LabelEdit edit = read_edit(journal_->read(place), labels.plane.data.size());
  if (direction == RecordKind::undo) edit = reversed(std::move(edit));
  if (!can_apply(labels, edit))
    throw Error(journal_->path().string() + ": the edit at byte " + std::to_string(place.offset) +
                " does not match the records before it");
  apply_edit(labels, edit);
}

FrameLabels LabelStore::replay(int frame) const {
  FrameLabels labels = read_base(journal_->read(history_.find(frame)->base));
  for (const LabelHistory::Step& each : history_.done()) {
    if (each.frame != frame) continue;
    put(labels, each.place, RecordKind::redo);
  }
  return labels;
}

std::vector<HistoryEntry> LabelStore::history(std::size_t most) const {
  std::vector<HistoryEntry> entries;
  const auto& done = history_.done();
  for (auto at = done.rbegin(); at != done.rend() && entries.size() < most; ++at)
    entries.push_back(read_history_entry(journal_->read(at->place)));
  return entries;
}

void LabelStore::set_annotator(std::string name) {
  options_.annotator = name.empty() ? login_name() : std::move(name);
}

std::shared_ptr<const FrameLabels> LabelStore::open(int frame, const FrameLabels& blank) {
  return opened(frame, &blank).labels;
}

std::shared_ptr<const FrameLabels> LabelStore::labels(int frame) const {
  const auto at = frames_.find(frame);
  return at == frames_.end() ? nullptr : at->second.labels;
}

std::uint64_t LabelStore::version(int frame) const {
  const auto at = frames_.find(frame);
  return at == frames_.end() ? 0 : at->second.version;
}

std::vector<int> LabelStore::undo_frames() const { return frames_of_step(history_.done()); }
std::vector<int> LabelStore::redo_frames() const { return frames_of_step(history_.undone()); }

bool LabelStore::any_unsaved() const {
  const auto is_unsaved = [&](int frame) { return unsaved(frame); };
  return std::ranges::any_of(history_.frames() | std::views::keys, is_unsaved) ||
         std::ranges::any_of(frames_ | std::views::keys, is_unsaved);
}

void LabelStore::save_all() {
  std::set<int> wanted;
  for (const int frame : frames_ | std::views::keys) wanted.insert(frame);
  for (const int frame : history_.frames() | std::views::keys) wanted.insert(frame);
  std::exception_ptr first;
  for (const int frame : wanted) {
    try {
      if (unsaved(frame)) save(frame);
    } catch (const Error&) {
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
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

std::vector<WorkTime> work_times(const std::filesystem::path& dir) {
  std::map<std::pair<int, std::string>, WorkTime> times;
  std::map<std::string, std::int64_t> latest_ms;  // time of each annotator's latest gesture
  const Journal journal(
      dir / "journal", Journal::Access::read, [&](const JournalPlace&, auto record) {
        const RecordHead head = read_head(record);
        if (!is_gesture(head.kind)) return true;
        WorkTime& time = times[{head.frame, head.annotator}];
        time.frame = head.frame;
        time.annotator = head.annotator;
        ++time.gestures;
        if (const auto before = latest_ms.find(head.annotator); before != latest_ms.end()) {
          const double gap_s = static_cast<double>(head.time_ms - before->second) / 1000;
          time.seconds += std::clamp(gap_s, 0.0, kLongestGapS);
        }
        latest_ms[head.annotator] = head.time_ms;
        return true;
      });
  std::vector<WorkTime> sorted;
  sorted.reserve(times.size());
  for (const auto& [key, time] : times) sorted.push_back(time);
  return sorted;
}

}  // namespace planescope::labels
