#pragma once

// The records of a label folder's journal, byte by byte as docs/formats.md has them.

#include <array>
#include <span>
#include <string>

#include "core/labels/edit/edit.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/store/journal.hpp"

namespace planescope::labels {

enum class RecordKind : std::uint8_t {
  base = 1,  // the frame's labels before the first edit
  edit,
  undo,     // of the latest edit that is done, in any frame
  redo,     // of the latest that was undone
  saving,   // label files are about to hold the labels as they are now
  written,  // and they do
};

/// How every record opens.
struct RecordHead {
  RecordKind kind = RecordKind::base;
  int frame = 0;
  std::int64_t time_ms = 0;  // since 1970, UTC
  std::string annotator;
};

/// SHA-256 of each of a frame's label files; empty where one is missing.
using LabelDigests = std::array<std::string, kLabelFiles>;

JournalBytes base_record(const RecordHead& head, const FrameLabels& labels);
JournalBytes edit_record(const RecordHead& head, const LabelEdit& edit);
JournalBytes saving_record(const RecordHead& head, const LabelDigests& digests);
JournalBytes plain_record(const RecordHead& head);  // of any other kind

struct EditSummary {
  std::string title;
  std::size_t pixels = 0;
};

// All throw Error where the bytes are no such record, as of a later version.
RecordHead read_head(std::span<const unsigned char> record);
FrameLabels read_base(std::span<const unsigned char> record);
EditSummary read_edit_summary(std::span<const unsigned char> record);
/// `pixels`: of the frame; no run reaches beyond them.
LabelEdit read_edit(std::span<const unsigned char> record, std::size_t pixels);
LabelDigests read_saving(std::span<const unsigned char> record);

}  // namespace planescope::labels
