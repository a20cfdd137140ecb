// Output folder of a report: stages frames, resumes from their records, swaps parts in place.

#include <algorithm>

#include "app/cli/output.hpp"
#include "app/commands/report.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/data/segment_files.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kParts[] = {"pictures", "report"};
// Folder in the work folder for parts on their way into or out of the report.
constexpr const char* kReplaced = "replaced";

bool has_records(const fs::path& dir) {
  std::error_code failed;
  for (fs::recursive_directory_iterator at(dir, failed), end; !failed && at != end;
       at.increment(failed))
    if (at->path().filename() == "frame.json") return true;
  return false;
}

/// Validates a record, which may come from elsewhere: it must belong to this frame, and its
/// pictures must be in the frame's folder.
void settle_record(const fs::path& frame, report::ReportFrame& record) {
  const auto fail = [&](const std::string& what) {
    throw Error((frame / "report" / "frame.json").string() + ": " + what);
  };
  if (report::frame_folder(record.index).filename() != frame.filename())
    fail("belongs to frame " + std::to_string(record.index));
  for (report::ReportPicture& picture : record.pictures) {
    if (picture.name.empty() ||
        !std::ranges::all_of(picture.name, [](char c) { return c >= 'a' && c <= 'z'; }))
      fail("picture name '" + picture.name + "' is invalid; expected lowercase letters");
    picture.file = (frame / "pictures" / (picture.name + ".png")).generic_string();
  }
}

/// Whether the folder is a recording's, such as "01-a.bag" (see report_frame_folder()), and not
/// another report.
bool is_of_a_recording(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
  return digits >= 2 && name.compare(digits, 1, "-") == 0 && entry.is_directory() &&
         !entry.is_symlink() && !fs::exists(entry.path() / "report.json");
}

/// Whether the folder is the remains of a frame whose removal was interrupted.
bool is_empty_folder(const fs::directory_entry& entry) {
  return entry.is_directory() && fs::is_empty(entry.path());
}

template <typename Body>
auto on_disk(const fs::path& dir, Body&& body) {
  try {
    return body();
  } catch (const fs::filesystem_error& error) {
    throw Error("output " + dir.string() + ": " + error.code().message());
  }
}

}  // namespace

ReportFolder::ReportFolder(const fs::path& dir, bool resume) : dir_(without_slash(dir)) {
  check_output_dir(dir_);
  work_ = dir_ / ".report-work";
  on_disk(dir_, [&] {
    for (fs::path d = fs::absolute(dir_); !fs::exists(d); d = d.parent_path())
      made_dirs_.push_back(d);
    std::ranges::reverse(made_dirs_);
    fs::create_directories(work_);
  });
  lock_ = FolderLock::acquire(work_, "planescope report");
  if (!lock_.is_held()) {
    made_dirs_.clear();
    throw Error("output " + dir_.string() +
                (lock_.is_held_by_other() ? ": another report is being written there: " : ": ") +
                lock_.why_not());
  }
  if (resume) return;
  on_disk(dir_, [&] {
    for (const auto& entry : fs::directory_iterator(work_))
      if (entry.path().filename() != "lock") fs::remove_all(entry.path());
  });
}

ReportFolder::~ReportFolder() {
  if (!lock_.is_held()) return;
  std::error_code ignored;
  if (over_ || !has_records(work_)) fs::remove_all(work_, ignored);
  lock_ = FolderLock();
  // Removes only empty folders.
  for (auto it = made_dirs_.rbegin(); it != made_dirs_.rend(); ++it) fs::remove(*it, ignored);
}

fs::path ReportFolder::place_of(const fs::path& frame) const {
  const bool in_work = fs::exists(work_ / frame / "report" / "frame.json");
  return (in_work ? work_ : dir_) / frame;
}

bool ReportFolder::has(const fs::path& frame) const {
  return fs::exists(place_of(frame) / "report" / "frame.json");
}

std::optional<report::ReportFrame> ReportFolder::find(const fs::path& frame,
                                                      const std::string& key) {
  const fs::path place = place_of(frame);
  std::optional<report::ReportFrame> found = report::find_frame_record(place / "report", key);
  if (!found) return found;
  settle_record(frame, *found);
  const fs::path root = place == work_ / frame ? work_ : dir_;
  for (const report::ReportPicture& picture : found->pictures)
    for (const std::string& file :
         {picture.file, report::copy_of(picture), report::thumbnail_of(picture)})
      if (std::error_code none; !fs::exists(root / file) || fs::file_size(root / file, none) == 0)
        return std::nullopt;
  if (root == work_) {
    const std::lock_guard lock(mutex_);
    finished_.insert(frame);
  }
  return found;
}

fs::path ReportFolder::start(const fs::path& frame) {
  on_disk(dir_, [&] {
    fs::remove_all(work_ / frame);
    for (const char* part : kParts) fs::create_directories(work_ / frame / part);
  });
  return work_ / frame;
}

void ReportFolder::finish(const fs::path& frame,
                          const report::ReportFrame& record,
                          bool ours,
                          const std::string& key) {
  report::write_frame_record(work_ / frame / "report", record, ours, key);
  if (std::error_code none; record.pictures.empty()) fs::remove(work_ / frame / "pictures", none);
  const std::lock_guard lock(mutex_);
  finished_.insert(frame);
}

void ReportFolder::take(const fs::path& frame, const fs::path& dir) {
  if (!fs::is_regular_file(dir / frame / "report" / "frame.json"))
    throw Error((dir / frame).string() + ": the frame's files are missing");
  start(frame);
  on_disk(dir_, [&] {
    for (const char* part : kParts) {
      fs::remove(work_ / frame / part);
      if (fs::exists(dir / frame / part))
        fs::copy(dir / frame / part, work_ / frame / part, fs::copy_options::recursive);
    }
  });
  const std::lock_guard lock(mutex_);
  finished_.insert(frame);
}

report::ReportFrame ReportFolder::read(const fs::path& frame) const {
  report::ReportFrame record = report::read_frame_record(place_of(frame) / "report");
  settle_record(frame, record);
  return record;
}

fs::path ReportFolder::aside(const fs::path& part) const {
  fs::path place = work_ / kReplaced / part;
  fs::remove_all(place);
  fs::create_directories(place.parent_path());
  return place;
}

void ReportFolder::set_aside(const fs::path& part) const {
  if (fs::exists(dir_ / part)) fs::rename(dir_ / part, aside(part));
}

void ReportFolder::put_in_place(const fs::path& part) const {
  if (!fs::exists(work_ / part) || fs::is_empty(work_ / part)) return set_aside(part);
  // Move it out of the frame's folder first, so that the old part is not mistaken for a new one.
  const fs::path place = aside(part);
  fs::rename(work_ / part, place);
  exchange_folder(place, dir_ / part);
}

void ReportFolder::remove_others(const std::set<fs::path>& frames) {
  std::vector<fs::path> places = {dir_};  // parents of "frames"
  for (const auto& entry : fs::directory_iterator(dir_))
    if (is_of_a_recording(entry)) places.push_back(entry.path());
  for (const fs::path& place : places) {
    if (!fs::is_directory(place / "frames")) continue;
    std::vector<fs::path> others;
    for (const auto& entry : fs::directory_iterator(place / "frames"))
      if ((fs::exists(entry.path() / "report" / "frame.json") || is_empty_folder(entry)) &&
          !frames.contains(entry.path().lexically_relative(dir_)))
        others.push_back(entry.path());
    for (const fs::path& frame : others) {
      for (const char* part : kParts) set_aside(frame.lexically_relative(dir_) / part);
      for (fs::path empty = frame; empty != dir_ && fs::is_empty(empty);
           empty = empty.parent_path())
        fs::remove(empty);
    }
  }
}

void ReportFolder::commit(bool whole, const std::set<fs::path>& frames) {
  on_disk(dir_, [&] {
    while (!finished_.empty()) {
      const fs::path frame = *finished_.begin();
      check_no_linked_folder(dir_, frame / kParts[0]);
      fs::create_directories(dir_ / frame);
      for (const char* part : kParts) put_in_place(frame / part);
      finished_.erase(finished_.begin());
    }
    if (whole) remove_others(frames);
  });
  std::error_code ignored;
  fs::remove_all(work_ / kReplaced, ignored);
  over_ = whole;
}

void ReportFolder::give_up() { over_ = true; }

}  // namespace planescope::app
