#pragma once

// The parts of FrameLabels as the journal keeps them: exactly, text with whatever bytes it has.

#include "core/labels/edit/edit.hpp"
#include "core/labels/store/byte_stream.hpp"

namespace planescope::labels {

inline constexpr std::uint64_t kMaxPixels = 1u << 28u;  // of a frame, where it is read

template <typename Enum>
Enum read_enum(RecordReader& in, Enum last) {
  return static_cast<Enum>(in.number(static_cast<std::uint64_t>(last)));
}

template <typename Enum>
void write_enum(RecordWriter& out, Enum value) {
  out.number(static_cast<std::uint64_t>(value));
}

void write(RecordWriter& out, const LabelPlane& plane);
void write(RecordWriter& out, const LabelNotes& notes);
void write(RecordWriter& out, const Intrinsics& intrinsics);

// All throw Error where the bytes hold something else.
LabelPlane read_plane(RecordReader& in);
LabelNotes read_notes(RecordReader& in);
Intrinsics read_intrinsics(RecordReader& in);

}  // namespace planescope::labels
