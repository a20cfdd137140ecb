#include "core/labels/store/store.hpp"

#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <exception>
#include <map>
#include <set>

#include "core/labels/store/store_state.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

std::string login_name() {
  const passwd* user = ::getpwuid(::getuid());
  return user && user->pw_name ? user->pw_name : "unknown";
}

std::int64_t system_time_ms() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

LabelStoreOptions completed(LabelStoreOptions options) {
  if (options.annotator.empty()) options.annotator = login_name();
  if (!options.now_ms) options.now_ms = system_time_ms;
  return options;
}

constexpr double kLongestGapS = 60;  // a longer pause was spent on something else

bool is_gesture(RecordKind kind) {
  return kind == RecordKind::edit || kind == RecordKind::undo || kind == RecordKind::redo;
}

}  // namespace

LabelStore::LabelStore(std::filesystem::path dir, LabelStoreOptions options)
    : state_(std::make_unique<State>(std::move(dir), completed(std::move(options)))) {}

LabelStore::~LabelStore() = default;

const std::filesystem::path& LabelStore::dir() const { return state_->dir; }
const std::string& LabelStore::read_only() const { return state_->read_only; }
const std::vector<std::string>& LabelStore::notices() const { return state_->notices; }
const std::string& LabelStore::annotator() const { return state_->options.annotator; }

void LabelStore::set_annotator(std::string name) {
  state_->options.annotator = name.empty() ? login_name() : std::move(name);
}

std::shared_ptr<const FrameLabels> LabelStore::open(int frame, const FrameLabels& blank) {
  return state_->open(frame, &blank).labels;
}

std::shared_ptr<const FrameLabels> LabelStore::labels(int frame) const {
  const auto at = state_->frames.find(frame);
  return at == state_->frames.end() ? nullptr : at->second.labels;
}

std::uint64_t LabelStore::version(int frame) const {
  const auto at = state_->frames.find(frame);
  return at == state_->frames.end() ? 0 : at->second.version;
}

void LabelStore::commit(const LabelEdit& edit) { state_->commit(edit); }
void LabelStore::commit(std::span<const LabelEdit> edits) { state_->commit(edits); }

std::optional<int> LabelStore::undo_frame() const {
  if (undo_count() == 0) return std::nullopt;
  return state_->history.done().back().frame;
}

std::optional<int> LabelStore::redo_frame() const {
  if (redo_count() == 0) return std::nullopt;
  return state_->history.undone().back().frame;
}

namespace {

std::vector<int> frames_of(std::span<const LabelHistory::Step> steps) {
  std::vector<int> frames;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) frames.push_back(step->frame);
  return frames;
}

}  // namespace

std::vector<int> LabelStore::undo_frames() const {
  return frames_of(LabelHistory::latest(state_->history.done()));
}
std::vector<int> LabelStore::redo_frames() const {
  return frames_of(LabelHistory::latest(state_->history.undone()));
}

void LabelStore::undo() { state_->step(RecordKind::undo); }
void LabelStore::redo() { state_->step(RecordKind::redo); }
std::size_t LabelStore::undo_count() const { return state_->history.done().size(); }
std::size_t LabelStore::redo_count() const { return state_->history.undone().size(); }

std::vector<HistoryEntry> LabelStore::history(std::size_t most) const {
  return state_->latest(most);
}

bool LabelStore::unsaved(int frame) const { return state_->unsaved(frame); }

bool LabelStore::any_unsaved() const {
  for (const auto& [frame, track] : state_->history.frames()) {
    if (unsaved(frame)) return true;
  }
  for (const auto& [frame, open] : state_->frames) {
    if (unsaved(frame)) return true;
  }
  return false;
}

void LabelStore::save(int frame) { state_->save(frame); }

void LabelStore::save_all() {
  std::set<int> wanted;
  for (const auto& [frame, open] : state_->frames) wanted.insert(frame);
  for (const auto& [frame, track] : state_->history.frames()) wanted.insert(frame);
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

void LabelStore::sync() { state_->sync(); }

std::vector<WorkTime> work_times(const std::filesystem::path& dir) {
  std::map<std::pair<int, std::string>, WorkTime> times;
  std::map<std::string, std::int64_t> latest_ms;  // gesture of an annotator
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
