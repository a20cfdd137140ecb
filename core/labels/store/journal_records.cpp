// Content of the journal's records. Each kind lists its fields once, in byte order, for both
// writing and reading.

#include <algorithm>
#include <bit>
#include <cassert>

#include "core/labels/store/journal.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

constexpr std::uint64_t kMaxPixels = 1u << 28u;  // of a frame, when reading

// Machine-independent encoding of values: whole numbers in groups of seven bits, the lowest first;
// floating point as eight bytes, little-endian; text after its length.
class RecordWriter {
 public:
  static constexpr bool kReads = false;

  /// Numbers, enums and switches; only the reader uses `most`.
  template <typename Value>
  void whole(const Value& value, std::uint64_t /*most*/ = UINT64_MAX) {
    auto rest = static_cast<std::uint64_t>(value);
    for (; rest >= 0x80; rest >>= 7) bytes_.push_back(static_cast<unsigned char>(rest | 0x80));
    bytes_.push_back(static_cast<unsigned char>(rest));
  }
  void real(double value) {
    auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i, bits >>= 8) bytes_.push_back(static_cast<unsigned char>(bits));
  }
  void text(const std::string& value) {
    whole(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  void list(const auto& values, const auto& visit) {
    whole(values.size());
    for (const auto& value : values) visit(value);
  }
  void maybe(const auto& value, const auto& visit) {
    whole(value.has_value());
    if (value) visit(*value);
  }

  JournalBytes take() { return std::move(bytes_); }

 private:
  JournalBytes bytes_;
};

/// Throws Error if the bytes do not contain the requested value.
class RecordReader {
 public:
  static constexpr bool kReads = true;
  explicit RecordReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  template <typename Value>
  void whole(Value& value, std::uint64_t most = UINT64_MAX) {
    std::uint64_t read = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint64_t byte = next();
      if (shift > 63) fail();
      read |= (byte & 0x7f) << shift;
      if (byte < 0x80) break;
    }
    if (read > most) fail();
    value = static_cast<Value>(read);
  }
  void real(double& value) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits |= static_cast<std::uint64_t>(next()) << (8 * i);
    value = std::bit_cast<double>(bits);
  }
  void text(std::string& value) {
    const std::size_t size = count();
    value.assign(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
    bytes_ = bytes_.subspan(size);
  }
  void list(auto& values, const auto& visit) {
    values.resize(count());
    for (auto& value : values) visit(value);
  }
  void maybe(auto& value, const auto& visit) {
    bool is_there = false;
    whole(is_there, 1);
    if (is_there) visit(value.emplace());
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  /// The number of items that follow, of at least one byte each.
  std::size_t count() {
    std::uint64_t value = 0;
    whole(value);  // before comparing it with the remaining size
    if (value > bytes_.size()) fail();
    return static_cast<std::size_t>(value);
  }
  unsigned char next() {
    if (bytes_.empty()) fail();
    const unsigned char byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }
  [[noreturn]] static void fail() { throw Error("a label record has missing or extra fields"); }

  std::span<const unsigned char> bytes_;
};

constexpr std::uint64_t last(auto value) { return static_cast<std::uint64_t>(value); }

void vector_fields(auto& fields, auto& v) {
  for (int i = 0; i < 3; ++i) fields.real(v[i]);
}

void review_fields(auto& fields, auto& note) {
  fields.whole(note.kind, last(DisagreementKind::boundary));
  fields.whole(note.pixel, kMaxPixels);
  fields.whole(note.pixels, kMaxPixels);
  fields.whole(note.label_plane, INT32_MAX);
  fields.whole(note.other_plane, INT32_MAX);
  fields.whole(note.decision, last(ReviewDecision::ignore));
  fields.text(note.reviewer);
  fields.whole(note.time_s);
}

void plane_fields(auto& fields, auto& plane) {
  fields.whole(plane.id, kPlaneIgnore - 1);
  fields.whole(plane.label, last(Label::v));
  vector_fields(fields, plane.normal);
  fields.real(plane.offset_m);
  fields.real(plane.rms_m);
  fields.real(plane.tolerance_m);
  fields.whole(plane.fragments, INT32_MAX);
  fields.whole(plane.origin, last(LabelOrigin::imported));
  fields.real(plane.confidence);
  fields.whole(plane.locked, 1);
  fields.whole(plane.hidden, 1);
}

/// Fields of LabelNotes, which labels also have.
void notes_fields(auto& fields, auto& notes) {
  vector_fields(fields, notes.gravity.direction);
  fields.whole(notes.gravity.source, last(kLastGravitySource));
  fields.real(notes.gravity.confidence);
  fields.text(notes.gravity.note);
  fields.text(notes.annotator);
  fields.text(notes.review_state);
  fields.list(notes.review, [&](auto& note) { review_fields(fields, note); });
}

void intrinsics_fields(auto& fields, auto& k) {
  fields.whole(k.width, INT32_MAX);
  fields.whole(k.height, INT32_MAX);
  for (auto* value : {&k.fx, &k.fy, &k.cx, &k.cy}) fields.real(*value);
  fields.whole(k.distortion, last(Distortion::inverse_brown_conrady));
  for (auto& value : k.coefficients) fields.real(value);
}

void head_fields(auto& fields, auto& head) {
  fields.whole(head.kind, last(RecordKind::written));
  fields.whole(head.frame, INT32_MAX);
  fields.whole(head.time_ms);
  fields.text(head.annotator);
}

/// Each run as the number of unchanged pixels before it, then the run itself.
template <typename Fields>
void run_fields(Fields& fields, auto& runs, std::size_t pixels) {
  std::uint64_t end = 0;
  fields.list(runs, [&](auto& run) {
    std::uint64_t gap = run.first - end;
    fields.whole(gap, pixels - end);
    if constexpr (Fields::kReads) run.first = static_cast<std::uint32_t>(end + gap);
    fields.whole(run.count, pixels - run.first);
    fields.whole(run.plane_before, kPlaneIgnore);
    fields.whole(run.plane_after, kPlaneIgnore);
    fields.whole(run.hv_before, kHvIgnore);
    fields.whole(run.hv_after, kHvIgnore);
    end = run.first + run.count;
  });
}

/// As runs of equal pixels: length, plane, h/v.
template <typename Fields>
void image_fields(Fields& fields, auto& plane, auto& hv) {
  const std::size_t pixels = plane.data.size();
  for (std::size_t i = 0; i < pixels;) {
    std::size_t end = i + 1;
    if constexpr (!Fields::kReads)
      while (end < pixels && plane.data[end] == plane.data[i] && hv.data[end] == hv.data[i]) ++end;
    std::size_t count = end - i;
    fields.whole(count, pixels - i);
    std::uint16_t id = plane.data[i];
    std::uint8_t label = hv.data[i];
    fields.whole(id, kPlaneIgnore);
    fields.whole(label, kHvIgnore);
    if constexpr (Fields::kReads) {
      std::fill_n(plane.data.begin() + static_cast<std::ptrdiff_t>(i), count, id);
      std::fill_n(hv.data.begin() + static_cast<std::ptrdiff_t>(i), count, label);
    }
    i += count;
  }
}

template <typename Fields>
void base_fields(Fields& fields, auto& labels) {
  fields.text(labels.depth_sha256);
  intrinsics_fields(fields, labels.intrinsics);
  notes_fields(fields, labels);
  fields.list(labels.planes, [&](auto& plane) { plane_fields(fields, plane); });
  int width = labels.plane.width, height = labels.plane.height;
  fields.whole(width, kMaxPixels);
  fields.whole(height, kMaxPixels / static_cast<std::uint64_t>(std::max(width, 1)));
  if constexpr (Fields::kReads) {
    expect_within_read_limit(3.0 * width * height, "a label record: its frame");
    labels.plane = Image16(width, height);
    labels.hv = Image8(width, height);
  }
  image_fields(fields, labels.plane, labels.hv);
  if constexpr (Fields::kReads)
    if (fields.at_end()) return;  // older journals end here
  fields.real(labels.depth_unit_m);
}

/// `pixels`: in the frame.
void edit_fields(auto& fields, auto& edit, std::size_t pixels) {
  fields.text(edit.title);
  std::size_t changed = edit.changed_pixels();  // for the history
  fields.whole(changed);
  run_fields(fields, edit.runs, pixels);
  const auto visit_plane = [&](auto& plane) { plane_fields(fields, plane); };
  fields.list(edit.planes, [&](auto& change) {
    fields.whole(change.id, kPlaneIgnore - 1);
    fields.maybe(change.before, visit_plane);
    fields.maybe(change.after, visit_plane);
  });
  fields.maybe(edit.notes, [&](auto& notes) {
    notes_fields(fields, notes.before);
    notes_fields(fields, notes.after);
  });
}

/// Reads the head, and returns a reader of the rest.
RecordReader after_head(std::span<const unsigned char> record, RecordHead& head) {
  RecordReader in(record);
  head_fields(in, head);
  return in;
}

}  // namespace

JournalBytes base_record(const RecordHead& head, const FrameLabels& labels) {
  assert(head.kind == RecordKind::base);
  RecordWriter out;
  head_fields(out, head);
  base_fields(out, labels);
  return out.take();
}

JournalBytes edit_record(const RecordHead& head, const LabelEdit& edit) {
  assert(head.kind == RecordKind::edit && head.frame == edit.frame);
  RecordWriter out;
  head_fields(out, head);
  edit_fields(out, edit, SIZE_MAX);
  return out.take();
}

JournalBytes saving_record(const RecordHead& head, const LabelDigests& digests) {
  assert(head.kind == RecordKind::saving);
  RecordWriter out;
  head_fields(out, head);
  for (const std::string& digest : digests) out.text(digest);
  return out.take();
}

JournalBytes plain_record(const RecordHead& head) {
  RecordWriter out;
  head_fields(out, head);
  return out.take();
}

RecordHead read_head(std::span<const unsigned char> record) {
  RecordHead head;
  after_head(record, head);
  return head;
}

FrameLabels read_base(std::span<const unsigned char> record) {
  RecordHead head;
  RecordReader in = after_head(record, head);
  FrameLabels labels;
  base_fields(in, labels);
  return labels;
}

HistoryEntry read_history_entry(std::span<const unsigned char> record) {
  RecordHead head;
  RecordReader in = after_head(record, head);
  HistoryEntry entry{head.frame, {}, head.annotator, head.time_ms};
  in.text(entry.title);
  in.whole(entry.pixels, kMaxPixels);
  return entry;
}

LabelEdit read_edit(std::span<const unsigned char> record, std::size_t pixels) {
  RecordHead head;
  RecordReader in = after_head(record, head);
  LabelEdit edit;
  edit.frame = head.frame;
  edit_fields(in, edit, pixels);
  return edit;
}

LabelDigests read_saving(std::span<const unsigned char> record) {
  RecordHead head;
  RecordReader in = after_head(record, head);
  LabelDigests digests;
  for (std::string& digest : digests) in.text(digest);
  return digests;
}

}  // namespace planescope::labels
