#pragma once

// A place in a report, as people and links write it.

#include <filesystem>
#include <string>

namespace planescope::report {

/// FILE, FILE#f12, FILE#f12/p3, FILE#r2/f12/was3. FILE alone: its first frame.
struct ReportTarget {
  std::filesystem::path file;
  int recording = 1;         // of the report, from 1
  int frame = -1;            // its number in the recording; -1: the first that the report has
  int plane = 0;             // 0: none
  bool of_baseline = false;  // was: the plane is one of the baseline's
};

/// Throws Error that names the file, what was found after its name and what was expected.
ReportTarget parse_report_target(const std::string& text);

}  // namespace planescope::report
