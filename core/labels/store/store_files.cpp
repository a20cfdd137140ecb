// Reads and writes the label files beside a journal, and compares them with it.

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <ranges>

#include "core/labels/store/store.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

void require_same_depth(const FrameLabels& labels,
                        const FrameLabels& expected,
                        const std::string& where) {
  if (labels.is_cloud() && expected.is_cloud() && labels.plane.width != expected.plane.width)
    throw Error(fmt::format("{}: labels for a cloud with {} points, but the frame has {}", where,
                            labels.plane.width, expected.plane.width));
  if (labels.depth_sha256 != expected.depth_sha256)
    throw Error(fmt::format(
        "{}: labels for a {} with SHA-256 {:.12}, but this recording's frame has {:.12}", where,
        labels.is_cloud() ? "cloud" : "depth image", labels.depth_sha256, expected.depth_sha256));
  const Image16 &image = labels.plane, &frame = expected.plane;
  if (image.width != frame.width || image.height != frame.height)
    throw Error(fmt::format("{}: labels for {}x{} pixels, but the frame has {}x{}", where,
                            image.width, image.height, frame.width, frame.height));
}

std::string name_of(int frame) { return "frame " + std::to_string(frame); }

}  // namespace

LabelDigests LabelStore::digests_of_files(int frame) const {
  const auto paths = label_file_paths(dir_, frame);
  LabelDigests digests;
  for (std::size_t i = 0; i < kLabelFiles; ++i)
    if (is_there(paths[i])) digests[i] = sha256_hex_of_file(paths[i]);
  return digests;
}

/// Whether each of the files is one that we wrote or started from. They may be from different
/// saves, since a crash may have happened between replacing two of them.
bool LabelStore::is_ours(int frame, const LabelDigests& digests) const {
  const auto* track = history_.find(frame);
  const auto is_known = [&](std::size_t i) {
    if (digests[i].empty() || digests[i] == frames_.at(frame).base_files[i]) return true;
    return track && std::any_of(track->saves.begin(), track->saves.end(),
                                [&](const auto& save) { return save.digests[i] == digests[i]; });
  };
  return std::ranges::all_of(std::views::iota(std::size_t{0}, kLabelFiles), is_known);
}

LabelStore::OpenFrame LabelStore::first_labels(int frame, const FrameLabels& blank) const {
  OpenFrame open;
  open.in_files = 0;
  open.base_files = digests_of_files(frame);
  auto found = read_frame_labels(dir_, frame,
                                 {blank.depth_sha256, blank.is_cloud() ? blank.plane.pixels() : 0});
  if (found) require_same_depth(*found, blank, label_file_paths(dir_, frame).back().string());
  FrameLabels labels = blank;
  if (found) labels = std::move(*found);
  if (labels.depth_unit_m == 0) labels.depth_unit_m = blank.depth_unit_m;  // from an older file
  labels.origin = blank.origin;
  if (!found && labels.annotator.empty()) labels.annotator = options_.annotator;
  std::ranges::sort(labels.planes, {}, &LabelPlane::id);
  open.labels = std::make_shared<const FrameLabels>(std::move(labels));
  return open;
}

LabelStore::OpenFrame& LabelStore::opened(int frame, const FrameLabels* blank) {
  if (const auto at = frames_.find(frame); at != frames_.end()) {
    if (!blank) return at->second;
    require_same_depth(*at->second.labels, *blank, dir_.string());
    // Unedited: use the new blank, whose gravity may be better.
    if (!history_.find(frame) && at->second.base_files == LabelDigests{}) {
      const std::uint64_t version = at->second.version;
      at->second = first_labels(frame, *blank);
      at->second.version = version + 1;
    }
    return at->second;
  }
  if (!history_.find(frame)) {
    assert(blank);
    return frames_[frame] = first_labels(frame, *blank);
  }
  FrameLabels labels = replay(frame);
  if (blank) require_same_depth(labels, *blank, journal_->path().string());
  if (blank && labels.depth_unit_m == 0) labels.depth_unit_m = blank->depth_unit_m;
  if (blank) labels.origin = blank->origin;
  frames_[frame].labels = std::make_shared<const FrameLabels>(std::move(labels));
  try {
    compare_with_files(frame);
  } catch (const Error&) {
    frames_.erase(frame);
    throw;
  }
  return frames_.at(frame);
}

void LabelStore::compare_with_files(int frame) {
  OpenFrame& open = frames_.at(frame);
  const auto& saves = history_.find(frame)->saves;
  const LabelDigests digests = digests_of_files(frame);
  open.in_files.reset();
  if (!is_ours(frame, digests)) {
    take_over(frame, digests);
  } else if (digests == LabelDigests{}) {
    if (saves.empty()) open.in_files = 0;  // nothing was ever written, so no files are missing
  } else {
    const auto same = std::find_if(saves.rbegin(), saves.rend(),
                                   [&](const auto& save) { return save.digests == digests; });
    if (same != saves.rend()) open.in_files = same->mark;
  }
}

/// Records changes by others as an edit, so that both states are kept. Returns false if the files
/// cannot be read.
bool LabelStore::take_over(int frame, const LabelDigests& digests) {
  OpenFrame& open = frames_.at(frame);
  std::optional<FrameLabels> files;
  try {
    files = read_frame_labels(dir_, frame, "");
  } catch (const Error& error) {
    notice(std::string(error.what()) + ": the journal's labels for " + name_of(frame) +
           " are kept; saving renames the files to *.outside-N");
    return false;
  }
  require_same_depth(*files, *open.labels, label_file_paths(dir_, frame).back().string());
  const LabelEdit edit = make_edit(frame, "changed outside planescope", *open.labels, *files);
  if (!read_only_.empty()) {
    open.labels = std::make_shared<const FrameLabels>(std::move(*files));
    open.in_files = mark(frame);
    return true;
  }
  if (!edit.empty()) {
    commit(edit);
    notice(dir_.string() + ": the label files for " + name_of(frame) +
           " were changed outside planescope and have been reloaded; undo reverts this");
  }
  auto entries = base_entries(frame);
  entries.push_back(saving(frame, digests));
  entries.push_back(entry(RecordKind::written, frame));
  append(entries);
  open.in_files = mark(frame);
  return true;
}

void LabelStore::set_files_aside(int frame) const {
  for (const fs::path& path : label_file_paths(dir_, frame)) {
    if (!is_there(path)) continue;
    std::error_code error;
    fs::rename(path, unused_path(path.string() + ".outside-"), error);
    if (error) throw Error(path.string() + ": cannot be renamed (" + error.message() + ")");
  }
}

void LabelStore::notice(std::string text) {
  if (std::ranges::find(notices_, text) == notices_.end()) notices_.push_back(std::move(text));
}

bool LabelStore::unsaved(int frame) const {
  if (const auto at = frames_.find(frame); at != frames_.end())
    return at->second.in_files != mark(frame);
  const auto* track = history_.find(frame);
  return track && track->mark != track->written_mark;
}

void LabelStore::save(int frame) {
  require_writable();
  if (!frames_.contains(frame) && !history_.find(frame)) return;
  OpenFrame& open = opened(frame, nullptr);
  if (const auto digests = digests_of_files(frame); !is_ours(frame, digests)) {
    const auto ours = open.labels;
    const bool has_news = unsaved(frame);
    if (!take_over(frame, digests)) {
      set_files_aside(frame);
      open.in_files.reset();
    } else if (has_news) {
      // The history keeps both states: the other's, followed by the one saved now.
      commit(make_edit(frame, "kept over changes outside planescope", *open.labels, *ours));
    }
  }
  if (!unsaved(frame)) return;

  const LabelFileBytes bytes = encode_label_files(dir_, frame, *open.labels);
  LabelDigests digests;
  std::transform(bytes.begin(), bytes.end(), digests.begin(),
                 [](const auto& file) { return sha256_hex(std::as_bytes(std::span(file))); });
  // Journal first: if the process ends between writing two of the files, they are recognized as
  // ours.
  auto entries = base_entries(frame);
  entries.push_back(saving(frame, digests));
  append(entries);
  journal_->sync();
  open.in_files.reset();
  write_label_files(dir_, frame, bytes);
  open.in_files = mark(frame);
  append({entry(RecordKind::written, frame)});
}

}  // namespace planescope::labels
