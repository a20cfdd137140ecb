// The JSON among the label files.

#include <nlohmann/json.hpp>

#include "core/labels/model/label_files.hpp"
#include "core/model/json_fields.hpp"

namespace planescope::labels {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLargestUnit_m = 1;  // of a count
constexpr const char* kSchema = "planescope.labels/1";

void intrinsics_fields(auto& fields, auto& k) {
  fields("width", k.width);
  fields("height", k.height);
  fields("fx", k.fx);
  fields("fy", k.fy);
  fields("cx", k.cx);
  fields("cy", k.cy);
  fields("distortion_model", k.distortion);
  fields("distortion", k.coefficients);
}

template <typename Fields>
void gravity_fields(Fields& fields, auto& gravity) {
  if constexpr (Fields::kReads) fields("source", gravity.source);  // is there a direction?
  if (gravity.known())
    fields("direction", gravity.direction);
  else if constexpr (!Fields::kReads)
    fields.null("direction");
  if constexpr (!Fields::kReads) fields("source", gravity.source);
  fields("confidence", gravity.confidence);
  fields("note", gravity.note);
}

/// Values that most planes share are left out.
void plane_fields(auto& fields, auto& plane) {
  const LabelPlane usual;
  fields("id", plane.id);
  fields("label", plane.label);
  fields("normal", plane.normal);
  fields("offset_m", plane.offset_m);
  fields("rms_m", plane.rms_m);
  fields("tolerance_m", plane.tolerance_m);
  fields("fragments", plane.fragments);
  fields.with_default("origin", plane.origin, usual.origin);
  fields.with_default("confidence", plane.confidence, usual.confidence);
  fields.with_default("locked", plane.locked, false);
  fields.with_default("hidden", plane.hidden, false);
}

void note_fields(auto& fields, auto& note) {
  fields("kind", note.kind);
  fields("pixel", note.pixel);
  fields("pixels", note.pixels);
  fields("label_plane", note.label_plane);
  fields("other_plane", note.other_plane);
  fields("decision", note.decision);
  fields("reviewer", note.reviewer);
  fields("time_s", note.time_s);
}

void cloud_fields(auto& fields, auto& labels) {
  fields("cloud_sha256", labels.depth_sha256);
  fields.whole("points", labels.intrinsics.width, kPlain, 1, int{kMostPoints});
  fields.with_default("origin", labels.origin, Vec3d::Zero());
}

void image_fields(auto& fields, auto& labels) {
  fields("depth_sha256", labels.depth_sha256);
  fields.object("intrinsics", kPlain, [&](auto& of) { intrinsics_fields(of, labels.intrinsics); });
  fields.with_default("depth_unit_m", labels.depth_unit_m, 0);
}

template <typename Fields>
void label_fields(Fields& fields, auto& labels) {
  bool is_cloud = labels.is_cloud();
  if constexpr (Fields::kReads) {
    is_cloud = fields.place().has("points");
    if (is_cloud) labels.intrinsics.height = 1;
  }
  if (is_cloud)
    cloud_fields(fields, labels);
  else
    image_fields(fields, labels);
  fields.object("gravity", kPlain, [&](auto& of) { gravity_fields(of, labels.gravity); });
  fields.list("planes", labels.planes, kPlain,
              [](auto& of, auto& plane) { plane_fields(of, plane); });
  fields("annotator", labels.annotator);
  fields("review_state", labels.review_state);
  if (Fields::kReads || !labels.review.empty())
    fields.list("review", labels.review, kOptional,
                [](auto& of, auto& note) { note_fields(of, note); });
}

}  // namespace

std::string label_json(int frame_index, const FrameLabels& labels) {
  Json json = {{"schema", kSchema}, {"frame", frame_index}};
  FieldWriter fields(json);
  label_fields(fields, labels);
  return json_text(json);
}

FrameLabels parse_label_json(const std::string& text, int frame_index, const std::string& where) {
  return read_place(where, parse_json<Json>(text, where), [&](const JsonPlace& place) {
    place.schema({kSchema});
    if (const int frame = place.at("frame").whole(0); frame != frame_index)
      throw Error("labels of frame " + std::to_string(frame) + ", expected frame " +
                  std::to_string(frame_index));
    FrameLabels labels;
    FieldReader fields(place);
    label_fields(fields, labels);
    if (!(labels.depth_unit_m >= 0 && labels.depth_unit_m <= kLargestUnit_m))
      place.at("depth_unit_m").fail_kind("0 to 1");
    return labels;
  });
}

}  // namespace planescope::labels
