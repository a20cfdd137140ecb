#include "core/labels/model/label_bytes.hpp"

namespace planescope::labels {
namespace {

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

}  // namespace

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
  notes.gravity.source = read_enum(in, GravitySource::none);
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

}  // namespace planescope::labels
