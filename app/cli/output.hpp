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

/// Prints a line on stderr after the name of the running program (set by run_program()). Line
/// breaks and control characters in the text are replaced.
void print_notice(const std::string& text);
void set_notice_name(const char* program);

template <typename... Values>
void notice(fmt::format_string<Values...> format, Values&&... values) {
  print_notice(fmt::format(format, std::forward<Values>(values)...));
}

/// Returns "dir" for "dir/", so that the path has a filename.
std::filesystem::path without_slash(const std::filesystem::path& path);

/// Throws Error unless `dir` is a writable folder or can be created as one. Creates nothing; called
/// before the work starts, so that an unwritable output fails early.
void check_output_dir(const std::filesystem::path& dir);

/// Throws Error if the output is the recording or in its folder, where the next run might read its
/// files as frames. Links and `..` are resolved.
void check_outside(const std::filesystem::path& out, const std::filesystem::path& recording);

/// Creates the folder if it is missing. Throws Error.
void make_output_dir(const std::filesystem::path& dir);

/// Throws Error if a folder between `dir` and DIR/`relative` is a symbolic link, which would
/// redirect the files.
void check_no_linked_folder(const std::filesystem::path& dir,
                            const std::filesystem::path& relative);

/// Files and folders that appear in `dir` only when all are complete: they are written to a hidden
/// folder, and commit() moves them to their final paths, replacing existing ones. Without commit(),
/// everything is removed, including parent folders created for the output.
class StagedOutput {
 public:
  explicit StagedOutput(const std::filesystem::path& dir);  // checks `dir`, creates nothing yet
  ~StagedOutput();
  StagedOutput(const StagedOutput&) = delete;
  StagedOutput& operator=(const StagedOutput&) = delete;

  /// Returns an empty folder to write to, which becomes DIR/`relative`. Thread-safe.
  std::filesystem::path add(const std::filesystem::path& relative);
  /// Returns a path to write to, which becomes the file DIR/`relative`. If nothing is written
  /// there, commit() removes an existing file. Thread-safe.
  std::filesystem::path add_file(const std::filesystem::path& relative);
  void commit();

 private:
  std::filesystem::path staged(const std::filesystem::path& relative, bool is_folder);

  std::mutex mutex_;
  std::filesystem::path dir_;
  std::filesystem::path staging_;
  FolderLock lock_;                               // on staging_
  std::set<std::filesystem::path> added_;         // relative
  std::vector<std::filesystem::path> made_dirs_;  // parents created here, outermost first
};

/// Whether a run was killed before DIR/`name` was moved to its place. Files that it already moved
/// to DIR may be replaced.
bool is_unfinished(const std::filesystem::path& dir, const std::filesystem::path& name);

/// Finds a file or folder that ships with planescope: in $PLANESCOPE_ASSETS if set, otherwise in
/// ../share/planescope beside the executable, otherwise in the source tree. Throws Error if it is
/// missing; the message begins with WHAT and lists the searched paths.
std::filesystem::path find_asset(const std::string& name, const std::string& what);

}  // namespace planescope::app
