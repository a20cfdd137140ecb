#pragma once

// Command output: notices, progress, and folders whose files appear only when complete.

#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/model/file_bytes.hpp"

namespace planescope::app {

/// A line on stderr, whatever the text holds, behind the name of the program that runs
/// (run_program() sets it).
void print_notice(const std::string& text);
void set_notice_name(const char* program);

template <typename... Values>
void notice(fmt::format_string<Values...> format, Values&&... values) {
  print_notice(fmt::format(format, std::forward<Values>(values)...));
}

/// "dir" of "dir/", so that it has a name.
std::filesystem::path without_slash(const std::filesystem::path& path);

/// Throws Error unless `dir` is a folder that can be written to, or could be made as one. Makes
/// nothing: called before the work starts, so that an unwritable output costs no time.
void check_output_dir(const std::filesystem::path& dir);

/// Makes it where it is missing. Throws Error.
void make_output_dir(const std::filesystem::path& dir);

/// Throws Error if a folder between `dir` and DIR/`relative` is a link, which would lead the files
/// elsewhere.
void check_no_linked_folder(const std::filesystem::path& dir,
                            const std::filesystem::path& relative);

/// Files and folders that appear in `dir` only when all are complete: they are written below a
/// hidden folder, and commit() moves them to their place, over what stood there. Without commit()
/// nothing of them remains, nor of the folders that were made for them.
class StagedOutput {
 public:
  explicit StagedOutput(const std::filesystem::path& dir);  // checks `dir`, makes nothing yet
  ~StagedOutput();
  StagedOutput(const StagedOutput&) = delete;
  StagedOutput& operator=(const StagedOutput&) = delete;

  /// An empty folder in which to write what will be DIR/`relative`. From any thread.
  std::filesystem::path add(const std::filesystem::path& relative);
  /// Where to write what will be the file DIR/`relative`; if nothing is written there, commit()
  /// removes an earlier one. From any thread.
  std::filesystem::path add_file(const std::filesystem::path& relative);
  void commit();

 private:
  std::filesystem::path staged(const std::filesystem::path& relative, bool is_folder);

  std::mutex mutex_;
  std::filesystem::path dir_;
  std::filesystem::path staging_;
  FolderLock lock_;                               // on it
  std::set<std::filesystem::path> added_;         // relative
  std::vector<std::filesystem::path> made_dirs_;  // parents made here, outermost first
};

/// Whether a run was killed before DIR/`name` took its place. What it moved to DIR may be replaced.
bool is_unfinished(const std::filesystem::path& dir, const std::filesystem::path& name);

/// A file or folder that ships with us: in $PLANESCOPE_ASSETS where that is set, otherwise in
/// ../share/planescope beside the executable, otherwise in the source tree. Throws Error,
/// "WHAT missing: there is no PLACE nor PLACE", if it is in none of them.
std::filesystem::path find_asset(const std::string& name, const std::string& what);

}  // namespace planescope::app
