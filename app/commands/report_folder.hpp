#pragma once

// The folder in which a report is made: finished frames are kept until the report is complete, also
// by a run that is stopped or killed, so that another one can go on.

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "core/model/file_bytes.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::app {

/// Each frame is named by its folder below DIR, "01-a.bag/frames/000012". They are written below
/// DIR/.report-work; commit() moves them to their place, over what stood there.
class ReportFolder {
 public:
  /// Without `resume`, deletes what a stopped run left. Throws Error where DIR cannot be written
  /// to, or another run writes into it.
  ReportFolder(std::filesystem::path dir, bool resume);
  /// Keeps finished frames, of this run or of an earlier one, for a run that resumes.
  ~ReportFolder();
  ReportFolder(const ReportFolder&) = delete;
  ReportFolder& operator=(const ReportFolder&) = delete;

  /// The frame as an earlier run left it, if it had the same key and its files are there.
  std::optional<report::ReportFrame> find(const std::filesystem::path& frame,
                                          const std::string& key);
  bool has(const std::filesystem::path& frame) const;
  /// An empty folder for the frame's files, with `pictures` and `report` in it.
  std::filesystem::path start(const std::filesystem::path& frame);
  void finish(const std::filesystem::path& frame,
              const report::ReportFrame& record,
              bool ours,
              const std::string& key);
  /// A finished frame's files, copied from another report in `dir`.
  void take(const std::filesystem::path& frame, const std::filesystem::path& dir);
  /// A frame that was finished, found or taken.
  report::ReportFrame read(const std::filesystem::path& frame) const;

  /// `whole`: the report is complete; then removes the work folder, and frames of an earlier
  /// report that are not in `frames`.
  void commit(bool whole, const std::set<std::filesystem::path>& frames);
  void give_up();  // finished frames are not kept either

 private:
  std::filesystem::path place_of(const std::filesystem::path& frame) const;
  /// An unused place in the work folder for a part of a frame's folder.
  std::filesystem::path aside(const std::filesystem::path& part) const;
  void set_aside(const std::filesystem::path& part) const;
  void put_in_place(const std::filesystem::path& part) const;
  void remove_others(const std::set<std::filesystem::path>& frames);

  std::filesystem::path dir_, work_;
  std::vector<std::filesystem::path> made_dirs_;  // outermost first
  FolderLock lock_;
  bool over_ = false;  // nothing in work_ is wanted any more
  mutable std::mutex mutex_;
  std::set<std::filesystem::path> finished_;  // in work_
};

}  // namespace planescope::app
