#include "core/labels/store/journal_records.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::labels {
namespace {

constexpr std::uint64_t kMaxPixels = 1u << 28u;  // of a frame, where it is read

// Values as bytes and back, the same on every machine: whole numbers in groups of seven bits, the
// lowest first; floating point as its eight bytes, the lowest first; text after its length.
class RecordWriter {
 public:
  void number(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<unsigned char>(value | 0x80));
    bytes_.push_back(static_cast<unsigned char>(value));
  }
  void real(double value) {
    auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i, bits >>= 8) bytes_.push_back(static_cast<unsigned char>(bits));
  }
  void text(const std::string& value) {
    number(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }

  std::vector<unsigned char> take() { return std::move(bytes_); }

 private:
  std::vector<unsigned char> bytes_;
};

/// Throws Error where the bytes do not hold what is asked for.
class RecordReader {
 public:
  explicit RecordReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  std::uint64_t number(std::uint64_t most = UINT64_MAX) {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint64_t byte = next();
      if (shift > 63) fail();
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) break;
    }
    if (value > most) fail();
    return value;
  }
  int integer() { return static_cast<int>(number(INT32_MAX)); }
  double real() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits |= static_cast<std::uint64_t>(next()) << (8 * i);
    return std::bit_cast<double>(bits);
  }
  std::string text() {
    const std::size_t size = count();
    std::string value(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
    bytes_ = bytes_.subspan(size);
    return value;
  }
  bool at_end() const { return bytes_.empty(); }
  /// How many things of at least a byte each follow.
  std::size_t count() {
    const std::uint64_t value = number();  // taken before it is compared with what is left
    if (value > bytes_.size()) fail();
    return static_cast<std::size_t>(value);
  }

 private:
  unsigned char next() {
    if (bytes_.empty()) fail();
    const unsigned char byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }
  [[noreturn]] static void fail() {
    throw Error("a record of labels does not hold what its kind needs");
  }

  std::span<const unsigned char> bytes_;
};

template <typename Enum>
Enum read_enum(RecordReader& in, Enum last) {
  return static_cast<Enum>(in.number(static_cast<std::uint64_t>(last)));
}

template <typename Enum>
void write_enum(RecordWriter& out, Enum value) {
  out.number(static_cast<std::uint64_t>(value));
}

void write(RecordWriter& out, const Vec3d& v) {
  for (int i = 0; i < 3; ++i) out.real(v[i]);
}

Vec3d read_vector(RecordReader& in) {
  Vec3d v;
  for (int i = 0; i < 3; ++i) v[i] = in.real();
  return v;
}

void write(RecordWriter& out, const ReviewNote& note) {
  write_enum(out, note.kind);
  out.number(note.pixel);
  out.number(note.pixels);
  out.number(static_cast<std::uint64_t>(note.label_plane));
  out.number(static_cast<std::uint64_t>(note.other_plane));
  write_enum(out, note.decision);
  out.text(note.reviewer);
  out.number(static_cast<std::uint64_t>(note.time_s));
}

ReviewNote read_note(RecordReader& in) {
  ReviewNote note;
  note.kind = read_enum(in, DisagreementKind::boundary);
  note.pixel = static_cast<std::uint32_t>(in.number(kMaxPixels));
  note.pixels = static_cast<std::uint32_t>(in.number(kMaxPixels));
  note.label_plane = in.integer();
  note.other_plane = in.integer();
  note.decision = read_enum(in, ReviewDecision::ignore);
  note.reviewer = in.text();
  note.time_s = static_cast<std::int64_t>(in.number());
  return note;
}

void write(RecordWriter& out, const LabelPlane& plane) {
  out.number(static_cast<std::uint64_t>(plane.id));
  write_enum(out, plane.label);
  write(out, plane.normal);
  out.real(plane.offset_m);
  out.real(plane.rms_m);
  out.real(plane.tolerance_m);
  out.number(static_cast<std::uint64_t>(plane.fragments));
  write_enum(out, plane.origin);
  out.real(plane.confidence);
  out.number(plane.locked ? 1 : 0);
  out.number(plane.hidden ? 1 : 0);
}

LabelPlane read_plane(RecordReader& in) {
  LabelPlane plane;
  plane.id = static_cast<int>(in.number(kPlaneIgnore - 1));
  plane.label = read_enum(in, Label::v);
  plane.normal = read_vector(in);
  plane.offset_m = in.real();
  plane.rms_m = in.real();
  plane.tolerance_m = in.real();
  plane.fragments = in.integer();
  plane.origin = read_enum(in, LabelOrigin::imported);
  plane.confidence = in.real();
  plane.locked = in.number(1) != 0;
  plane.hidden = in.number(1) != 0;
  return plane;
}

void write(RecordWriter& out, const LabelNotes& notes) {
  write(out, notes.gravity.direction);
  write_enum(out, notes.gravity.source);
  out.real(notes.gravity.confidence);
  out.text(notes.gravity.note);
  out.text(notes.annotator);
  out.text(notes.review_state);
  out.number(notes.review.size());
  for (const ReviewNote& note : notes.review) write(out, note);
}

LabelNotes read_notes(RecordReader& in) {
  LabelNotes notes;
  notes.gravity.direction = read_vector(in);
  notes.gravity.source = read_enum(in, kLastGravitySource);
  notes.gravity.confidence = in.real();
  notes.gravity.note = in.text();
  notes.annotator = in.text();
  notes.review_state = in.text();
  notes.review.resize(in.count());
  for (ReviewNote& note : notes.review) note = read_note(in);
  return notes;
}

void write(RecordWriter& out, const Intrinsics& k) {
  out.number(static_cast<std::uint64_t>(k.width));
  out.number(static_cast<std::uint64_t>(k.height));
  for (const double value : {k.fx, k.fy, k.cx, k.cy}) out.real(value);
  write_enum(out, k.distortion);
  for (const double value : k.coefficients) out.real(value);
}

Intrinsics read_intrinsics(RecordReader& in) {
  Intrinsics k;
  k.width = in.integer();
  k.height = in.integer();
  for (double* value : {&k.fx, &k.fy, &k.cx, &k.cy}) *value = in.real();
  k.distortion = read_enum(in, Distortion::inverse_brown_conrady);
  for (double& value : k.coefficients) value = in.real();
  return k;
}

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
  out.real(labels.depth_unit_m);
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
  expect_within_read_limit(3.0 * width * height, "a record of labels: its frame");
  labels.plane = Image16(width, height);
  labels.hv = Image8(width, height);
  read_images(in, labels.plane, labels.hv);
  if (!in.at_end()) labels.depth_unit_m = in.real();  // older journals end here
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
