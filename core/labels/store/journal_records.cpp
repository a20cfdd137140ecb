#include "core/labels/store/journal_records.hpp"

#include <algorithm>
#include <cassert>

#include "core/labels/model/label_bytes.hpp"

namespace planescope::labels {
namespace {

void write(RecordWriter& out, const RecordHead& head) {
  write_enum(out, head.kind);
  out.number(static_cast<std::uint64_t>(head.frame));
  out.number(static_cast<std::uint64_t>(head.time_ms));
  out.text(head.annotator);
}

RecordHead read_head(RecordReader& in) {
  RecordHead head;
  head.kind = read_enum(in, RecordKind::written);
  head.frame = in.integer();
  head.time_ms = static_cast<std::int64_t>(in.number());
  head.annotator = in.text();
  return head;
}

void write(RecordWriter& out, const std::optional<LabelPlane>& plane) {
  out.number(plane ? 1 : 0);
  if (plane) write(out, *plane);
}

std::optional<LabelPlane> read_optional_plane(RecordReader& in) {
  if (in.number(1) == 0) return std::nullopt;
  return read_plane(in);
}

std::uint16_t read_plane_id(RecordReader& in) {
  return static_cast<std::uint16_t>(in.number(kPlaneIgnore));
}

std::uint8_t read_hv(RecordReader& in) { return static_cast<std::uint8_t>(in.number(kHvIgnore)); }

/// Each run as pixels without a change before it, then its own.
void write(RecordWriter& out, const std::vector<LabelRun>& runs) {
  out.number(runs.size());
  std::uint32_t end = 0;
  for (const LabelRun& run : runs) {
    out.number(run.first - end);
    out.number(run.count);
    out.number(run.plane_before);
    out.number(run.plane_after);
    out.number(run.hv_before);
    out.number(run.hv_after);
    end = run.first + run.count;
  }
}

std::vector<LabelRun> read_runs(RecordReader& in, std::size_t pixels) {
  std::vector<LabelRun> runs(in.count());
  std::uint64_t end = 0;
  for (LabelRun& run : runs) {
    run.first = static_cast<std::uint32_t>(end + in.number(pixels - end));
    run.count = static_cast<std::uint32_t>(in.number(pixels - run.first));
    run.plane_before = read_plane_id(in);
    run.plane_after = read_plane_id(in);
    run.hv_before = read_hv(in);
    run.hv_after = read_hv(in);
    end = run.first + run.count;
  }
  return runs;
}

/// As runs of equal pixels: how many, plane, h/v.
void write_images(RecordWriter& out, const Image16& plane, const Image8& hv) {
  for (std::size_t i = 0; i < plane.data.size();) {
    std::size_t end = i + 1;
    while (end < plane.data.size() && plane.data[end] == plane.data[i] &&
           hv.data[end] == hv.data[i]) {
      ++end;
    }
    out.number(end - i);
    out.number(plane.data[i]);
    out.number(hv.data[i]);
    i = end;
  }
}

void read_images(RecordReader& in, Image16& plane, Image8& hv) {
  for (std::size_t i = 0; i < plane.data.size();) {
    const auto count = static_cast<std::size_t>(in.number(plane.data.size() - i));
    std::fill_n(plane.data.begin() + static_cast<std::ptrdiff_t>(i), count, read_plane_id(in));
    std::fill_n(hv.data.begin() + static_cast<std::ptrdiff_t>(i), count, read_hv(in));
    i += count;
  }
}

}  // namespace

JournalBytes base_record(const RecordHead& head, const FrameLabels& labels) {
  assert(head.kind == RecordKind::base);
  RecordWriter out;
  write(out, head);
  out.text(labels.depth_sha256);
  write(out, labels.intrinsics);
  write(out, LabelNotes{labels.gravity, labels.annotator, labels.review_state, labels.review});
  out.number(labels.planes.size());
  for (const LabelPlane& plane : labels.planes) write(out, plane);
  out.number(static_cast<std::uint64_t>(labels.plane.width));
  out.number(static_cast<std::uint64_t>(labels.plane.height));
  write_images(out, labels.plane, labels.hv);
  return out.take();
}

JournalBytes edit_record(const RecordHead& head, const LabelEdit& edit) {
  assert(head.kind == RecordKind::edit && head.frame == edit.frame);
  RecordWriter out;
  write(out, head);
  out.text(edit.title);
  out.number(edit.changed_pixels());
  write(out, edit.runs);
  out.number(edit.planes.size());
  for (const auto& change : edit.planes) {
    out.number(static_cast<std::uint64_t>(change.id));
    write(out, change.before);
    write(out, change.after);
  }
  out.number(edit.notes ? 1 : 0);
  if (edit.notes) {
    write(out, edit.notes->before);
    write(out, edit.notes->after);
  }
  return out.take();
}

JournalBytes saving_record(const RecordHead& head, const LabelDigests& digests) {
  assert(head.kind == RecordKind::saving);
  RecordWriter out;
  write(out, head);
  for (const std::string& digest : digests) out.text(digest);
  return out.take();
}

JournalBytes plain_record(const RecordHead& head) {
  RecordWriter out;
  write(out, head);
  return out.take();
}

RecordHead read_head(std::span<const unsigned char> record) {
  RecordReader in(record);
  return read_head(in);
}

FrameLabels read_base(std::span<const unsigned char> record) {
  RecordReader in(record);
  read_head(in);
  FrameLabels labels;
  labels.depth_sha256 = in.text();
  labels.intrinsics = read_intrinsics(in);
  const LabelNotes notes = read_notes(in);
  labels.gravity = notes.gravity;
  labels.annotator = notes.annotator;
  labels.review_state = notes.review_state;
  labels.review = notes.review;
  labels.planes.resize(in.count());
  for (LabelPlane& plane : labels.planes) plane = read_plane(in);
  const auto width = static_cast<int>(in.number(kMaxPixels));
  const auto height = static_cast<int>(in.number(kMaxPixels / std::max(width, 1)));
  labels.plane = Image16(width, height);
  labels.hv = Image8(width, height);
  read_images(in, labels.plane, labels.hv);
  return labels;
}

EditSummary read_edit_summary(std::span<const unsigned char> record) {
  RecordReader in(record);
  read_head(in);
  EditSummary summary;
  summary.title = in.text();
  summary.pixels = static_cast<std::size_t>(in.number(kMaxPixels));
  return summary;
}

LabelEdit read_edit(std::span<const unsigned char> record, std::size_t pixels) {
  RecordReader in(record);
  LabelEdit edit;
  edit.frame = read_head(in).frame;
  edit.title = in.text();
  in.number();  // changed pixels, for the summary
  edit.runs = read_runs(in, pixels);
  edit.planes.resize(in.count());
  for (auto& change : edit.planes) {
    change.id = static_cast<int>(in.number(kPlaneIgnore - 1));
    change.before = read_optional_plane(in);
    change.after = read_optional_plane(in);
  }
  if (in.number(1) != 0) {
    NotesChange notes;
    notes.before = read_notes(in);
    notes.after = read_notes(in);
    edit.notes = notes;
  }
  return edit;
}

LabelDigests read_saving(std::span<const unsigned char> record) {
  RecordReader in(record);
  read_head(in);
  LabelDigests digests;
  for (std::string& digest : digests) digest = in.text();
  return digests;
}

}  // namespace planescope::labels
