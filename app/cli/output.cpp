// Notices and progress on stderr, staged output folders and the lookup of shipped assets.

#include "app/cli/output.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ranges>

#include "app/cli/progress.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;

const char* g_program = "planescope";

constexpr const char* kStaging = ".partial-";

/// Removes staging folders of killed runs, whose locks are free.
void remove_abandoned(const fs::path& dir) {
  std::vector<fs::path> stagings;
  for (const auto& entry : fs::directory_iterator(dir))
    if (entry.path().filename().string().starts_with(kStaging)) stagings.push_back(entry.path());
  for (const fs::path& staging : stagings)
    if (FolderLock::acquire(staging, "planescope").is_held()) fs::remove_all(staging);
}

/// Held by one process at a time. Ends with it.
FileDescriptor lock_folder(const fs::path& dir) {
  FileDescriptor folder = open_file(dir, O_RDONLY | O_DIRECTORY);
  ::flock(folder.get(), LOCK_EX);
  return folder;
}

}  // namespace

fs::path without_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

void set_notice_name(const char* program) { g_program = program; }

void print_notice(const std::string& text) {
  // Never throws: a message about a failure may be the last thing that is done.
  std::fputs(fmt::format("{}: {}\n", g_program, one_line(text)).c_str(), stderr);
}

void check_output_dir(const fs::path& dir) {
  if (dir.empty()) throw Error("output: the folder name is empty");
  std::error_code ignored;
  fs::path existing = fs::absolute(without_slash(dir));
  for (; !fs::exists(existing, ignored) && existing.has_relative_path();
       existing = existing.parent_path())
    if (ignored == std::errc::too_many_symbolic_link_levels)
      throw Error(fmt::format("output {}: {}: too many levels of symbolic links", dir.string(),
                              existing.string()));
    else if (fs::is_symlink(existing, ignored))
      throw Error(fmt::format("output {}: {} is a link to {}, which is missing; expected a folder",
                              dir.string(), existing.string(),
                              fs::read_symlink(existing, ignored).string()));
  if (!fs::is_directory(existing, ignored))
    throw Error("output " + dir.string() + ": " + existing.string() + " is not a folder");
  if (access(existing.c_str(), W_OK | X_OK) != 0)
    throw Error("output " + dir.string() + ": " + existing.string() + " cannot be written to");
}

namespace {

/// The path without links and `..`; a link to a missing file is followed as well.
fs::path real_path(fs::path path) {
  std::error_code failed;
  constexpr int kMostLinks = 40;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, failed) && !fs::exists(path, failed); ++i)
    path = path.parent_path() / fs::read_symlink(path, failed);
  return without_slash(fs::weakly_canonical(path, failed));
}

}  // namespace

void check_outside(const fs::path& out, const fs::path& recording) {
  if (out.empty() || recording == "-") return;
  const fs::path inside = real_path(out).lexically_relative(real_path(recording));
  if (inside.empty() || *inside.begin() == "..") return;
  const bool is_itself = inside == ".";
  fs::path beside = recording;  // a.mcap: a-out.mcap
  const std::string type = fs::is_directory(recording) ? "" : recording.extension().string();
  if (!type.empty()) beside.replace_extension();
  const std::string name = is_itself ? "out" + type : without_slash(out).filename().string();
  throw Error(fmt::format("{}: is {} {}; expected a path outside it, such as {}", out.string(),
                          is_itself ? "the recording" : "in the recording", recording.string(),
                          path_beside(beside, "-" + name).string()));
}

void make_output_dir(const fs::path& dir) {
  std::error_code failed;
  fs::create_directories(dir, failed);
  if (failed) throw Error("output " + dir.string() + ": " + failed.message());
}

void check_no_linked_folder(const fs::path& dir, const fs::path& relative) {
  fs::path folder = dir;
  for (const fs::path& part : relative) {
    if (folder != dir && fs::is_symlink(folder))
      throw Error(folder.string() + ": is a symbolic link; expected a folder");
    folder /= part;
  }
}

StagedOutput::StagedOutput(const fs::path& dir) : dir_(without_slash(dir)) {
  check_output_dir(dir);
}

StagedOutput::~StagedOutput() {
  std::error_code ignored;
  lock_ = FolderLock();
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
  // Removes only empty folders, so they stay after a commit or if they contain other files.
  for (auto it = made_dirs_.rbegin(); it != made_dirs_.rend(); ++it) fs::remove(*it, ignored);
}

fs::path StagedOutput::add(const fs::path& relative) { return staged(relative, true); }

fs::path StagedOutput::add_file(const fs::path& relative) { return staged(relative, false); }

fs::path StagedOutput::staged(const fs::path& relative, bool is_folder) {
  const std::lock_guard lock(mutex_);
  try {
    if (staging_.empty()) {
      std::vector<fs::path> missing;
      for (fs::path d = fs::absolute(dir_); !fs::exists(d); d = d.parent_path())
        missing.push_back(d);
      std::reverse(missing.begin(), missing.end());
      made_dirs_ = missing;
      fs::create_directories(dir_);
      const FileDescriptor alone = lock_folder(dir_);
      remove_abandoned(dir_);
      staging_ = dir_ / (kStaging + std::to_string(getpid()));
      fs::create_directory(staging_);
      lock_ = FolderLock::acquire(staging_, "planescope");
    }
    fs::create_directories(is_folder ? staging_ / relative : (staging_ / relative).parent_path());
  } catch (const fs::filesystem_error& error) {
    throw Error("output " + dir_.string() + ": " + error.code().message());
  }
  added_.insert(relative);
  return staging_ / relative;
}

namespace {

/// Throws Error if a staged file or folder cannot replace its target. Called before anything is
/// replaced.
void check_place(const fs::path& staged, const fs::path& dir, const fs::path& relative) {
  check_no_linked_folder(dir, relative);
  const fs::path target = dir / relative;
  const bool is_folder = fs::is_directory(staged);
  if (fs::exists(target) && fs::is_directory(target) != is_folder)
    throw Error(fmt::format("{}: is a {}; expected a {}", target.string(),
                            is_folder ? "file" : "folder", is_folder ? "folder" : "file"));
  fs::path parent = target.parent_path();
  while (!fs::exists(parent) && parent.has_relative_path()) parent = parent.parent_path();
  if (!fs::is_directory(parent)) throw Error(parent.string() + ": is a file; expected a folder");
  if (access(parent.c_str(), W_OK | X_OK) != 0)
    throw Error(parent.string() + ": cannot be written to");
}

}  // namespace

void StagedOutput::commit() {
  try {
    const FileDescriptor alone = lock_folder(dir_);  // files of two runs never mix
    for (const fs::path& relative : added_) check_place(staging_ / relative, dir_, relative);
    // In reverse, so that "a.mcap.labels" is moved before "a.mcap".
    for (const fs::path& relative : added_ | std::views::reverse) {
      const fs::path target = dir_ / relative;
      if (!fs::exists(staging_ / relative)) {
        fs::remove(target);
        if (relative.has_parent_path() && fs::is_empty(target.parent_path()))
          fs::remove(target.parent_path());
        continue;
      }
      fs::create_directories(target.parent_path());
      exchange_folder(staging_ / relative, target);
    }
  } catch (const fs::filesystem_error& error) {
    throw Error("output " + dir_.string() + ": " + error.code().message());
  }
  added_.clear();
}

bool is_unfinished(const fs::path& dir, const fs::path& name) {
  return fs::exists(dir) &&
         std::ranges::any_of(fs::directory_iterator(dir), [&](const fs::directory_entry& entry) {
           return entry.path().filename().string().starts_with(kStaging) &&
                  fs::exists(entry.path() / name);
         });
}

fs::path find_asset(const std::string& name, const std::string& what) {
  std::vector<fs::path> places;
  if (const char* assets = std::getenv("PLANESCOPE_ASSETS")) {
    places.push_back(fs::path(assets) / name);
  } else {
    std::error_code failed;
    const fs::path program = fs::read_symlink("/proc/self/exe", failed);
    if (!failed)
      places.push_back(program.parent_path().parent_path() / "share" / "planescope" / name);
    places.push_back(fs::path(PLANESCOPE_SOURCE_DIR) / "assets" / name);
  }
  std::string tried;
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::exists(place, ignored)) return place;
    tried += (tried.empty() ? "" : " and ") + place.string();
  }
  throw Error(what + " missing; looked for " + tried);
}

int DamagedFrames::report(std::size_t frames) const {
  if (lines.empty()) return 0;
  constexpr std::size_t kMostLines = 10;
  for (const std::string& line : lines | std::views::take(kMostLines)) notice("error: {}", line);
  notice("skipped {} of {} (damaged)", lines.size(), counted(frames, "frame"));
  return 2;
}

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(std::max(1, total)), visible_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void Progress::show(int done, const std::string& now) {
  if (!visible_) return;
  constexpr int kWidth = 28;
  const int filled = std::clamp(done * kWidth / total_, 0, kWidth);
  fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {}/{}  {}", what_, "", filled, "",
             kWidth - filled, done, total_, now);
  std::fflush(stderr);
}

void Progress::print(const std::string& line) {
  std::fputs(fmt::format("{}{}\n", visible_ ? "\r\033[K" : "", line).c_str(), stderr);
}

}  // namespace planescope::app
