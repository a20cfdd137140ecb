#pragma once

// planescope labels check|export|import|convert|compare|stats

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"

namespace planescope::app {

struct LabelsArgs {
  InputArgs input;  // recordings or folders of labels, --frames, --labels, --gravity, --voxel
  std::filesystem::path recording;  // --recording; empty: the one that the labels are named after
  std::string format;
  std::filesystem::path from, out;
  bool strict = false;  // hints count as findings
  bool json = false;
};

/// One line per finding. Returns 0 where all is well or only hints were found, 1 with findings (or
/// hints, if `strict`), 2 where files are damaged.
int run_labels_check(const LabelsArgs& args, const std::stop_token& stop);
/// Where people have worked: planes, area and time by frame.
int run_labels_stats(const LabelsArgs& args, const std::stop_token& stop);
/// How far two sets of labels of the same frames agree.
int run_labels_compare(const LabelsArgs& args, const std::stop_token& stop);
int run_labels_export(const LabelsArgs& args, const std::stop_token& stop);
/// All files are read before any label is changed; what was there can be brought back by undo.
int run_labels_import(const LabelsArgs& args, const std::stop_token& stop);
int run_labels_convert(const LabelsArgs& args);

}  // namespace planescope::app
