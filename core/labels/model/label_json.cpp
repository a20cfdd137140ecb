// The JSON among the label files.

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/json.hpp"

namespace planescope::labels {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLargestUnit_m = 1;  // of a count
constexpr const char* kSchema = "planescope.labels/1";
constexpr std::array kOrigins = {"hand", "wand", "algorithm", "carried", "imported"};
constexpr std::array kDisagreements = {"missed", "invented",   "split",
                                       "merged", "class_flip", "boundary"};
constexpr std::array kDecisions = {"keep", "take", "edit", "ignore"};

/// The whole number of that name, of 0 to what the member can hold.
template <typename Member>
void take(const Json& json, const char* name, Member& member, const std::string& where) {
  constexpr auto kMost = static_cast<std::int64_t>(std::numeric_limits<Member>::max());
  member = static_cast<Member>(whole_number(json.at(name), 0, kMost, where + ": " + name));
}

Json to_json(const Vec3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vec3d vector_from(const Json& json) {
  const auto values = json.get<std::array<double, 3>>();
  return {values[0], values[1], values[2]};
}

const char* to_string(LabelOrigin origin) { return kOrigins[static_cast<std::size_t>(origin)]; }
const char* to_string(DisagreementKind kind) {
  return kDisagreements[static_cast<std::size_t>(kind)];
}
const char* to_string(ReviewDecision decision) {
  return kDecisions[static_cast<std::size_t>(decision)];
}

/// The value that is called so, of those up to `last`.
template <typename Enum>
Enum named(const Json& json, Enum last, const std::string& where) {
  const auto name = json.get<std::string>();
  for (int i = 0; i <= static_cast<int>(last); ++i)
    if (name == to_string(static_cast<Enum>(i))) return static_cast<Enum>(i);
  throw Error(where + ": unknown name \"" + name + "\"");
}

Json to_json(const Intrinsics& k) {
  return {{"width", k.width},
          {"height", k.height},
          {"fx", k.fx},
          {"fy", k.fy},
          {"cx", k.cx},
          {"cy", k.cy},
          {"distortion_model", to_string(k.distortion)},
          {"distortion", k.coefficients}};
}

Intrinsics intrinsics_from(const Json& json, const std::string& where) {
  Intrinsics k;
  take(json, "width", k.width, where);
  take(json, "height", k.height, where);
  k.fx = json.at("fx").get<double>();
  k.fy = json.at("fy").get<double>();
  k.cx = json.at("cx").get<double>();
  k.cy = json.at("cy").get<double>();
  k.distortion = named(json.at("distortion_model"), Distortion::inverse_brown_conrady, where);
  k.coefficients = json.at("distortion").get<std::array<double, 5>>();
  return k;
}

Json to_json(const Gravity& gravity) {
  return {{"direction", gravity.known() ? to_json(gravity.direction) : Json()},
          {"source", to_string(gravity.source)},
          {"confidence", gravity.confidence},
          {"note", gravity.note}};
}

Gravity gravity_from(const Json& json, const std::string& where) {
  Gravity gravity;
  gravity.source = named(json.at("source"), kLastGravitySource, where);
  if (gravity.known()) gravity.direction = vector_from(json.at("direction"));
  gravity.confidence = json.at("confidence").get<double>();
  gravity.note = json.at("note").get<std::string>();
  return gravity;
}

/// Values that most planes share are left out.
Json to_json(const LabelPlane& plane) {
  Json json = {{"id", plane.id},
               {"label", to_string(plane.label)},
               {"normal", to_json(plane.normal)},
               {"offset_m", plane.offset_m},
               {"rms_m", plane.rms_m},
               {"tolerance_m", plane.tolerance_m},
               {"fragments", plane.fragments}};
  const LabelPlane usual;
  if (plane.origin != usual.origin) {
    json["origin"] = to_string(plane.origin);
  }
  if (plane.confidence != usual.confidence) json["confidence"] = plane.confidence;
  if (plane.locked) json["locked"] = true;
  if (plane.hidden) json["hidden"] = true;
  return json;
}

LabelPlane plane_from(const Json& json, const std::string& where) {
  LabelPlane plane;
  take(json, "id", plane.id, where);
  plane.label = named(json.at("label"), Label::v, where);
  plane.normal = vector_from(json.at("normal"));
  plane.offset_m = json.at("offset_m").get<double>();
  plane.rms_m = json.at("rms_m").get<double>();
  plane.tolerance_m = json.at("tolerance_m").get<double>();
  take(json, "fragments", plane.fragments, where);
  if (json.contains("origin"))
    plane.origin = named(json.at("origin"), LabelOrigin::imported, where);
  plane.confidence = json.value("confidence", plane.confidence);
  plane.locked = json.value("locked", plane.locked);
  plane.hidden = json.value("hidden", plane.hidden);
  return plane;
}

Json to_json(const ReviewNote& note) {
  return {{"kind", to_string(note.kind)},    {"pixel", note.pixel},
          {"pixels", note.pixels},           {"label_plane", note.label_plane},
          {"other_plane", note.other_plane}, {"decision", to_string(note.decision)},
          {"reviewer", note.reviewer},       {"time_s", note.time_s}};
}

ReviewNote note_from(const Json& json, const std::string& where) {
  ReviewNote note;
  note.kind = named(json.at("kind"), DisagreementKind::boundary, where);
  take(json, "pixel", note.pixel, where);
  take(json, "pixels", note.pixels, where);
  take(json, "label_plane", note.label_plane, where);
  take(json, "other_plane", note.other_plane, where);
  note.decision = named(json.at("decision"), ReviewDecision::ignore, where);
  note.reviewer = json.at("reviewer").get<std::string>();
  take(json, "time_s", note.time_s, where);
  return note;
}

FrameLabels labels_from(const Json& json, int frame_index, const std::string& where) {
  const auto schema = json.at("schema").get<std::string>();
  if (schema != kSchema) {
    throw Error(where + ": schema \"" + schema + "\", expected \"" + kSchema + "\"");
  }
  int frame = 0;
  take(json, "frame", frame, where);
  if (frame != frame_index) {
    throw Error(where + ": labels of frame " + std::to_string(frame) + ", expected frame " +
                std::to_string(frame_index));
  }
  FrameLabels labels;
  const bool is_cloud = json.contains("points");
  labels.depth_sha256 = json.at(is_cloud ? "cloud_sha256" : "depth_sha256").get<std::string>();
  if (is_cloud) {
    labels.intrinsics.width = static_cast<int>(
        whole_number(json.at("points"), 1, std::int64_t{kMostPoints}, where + ": points"));
    labels.intrinsics.height = 1;
    if (json.contains("origin")) labels.origin = vector_from(json.at("origin"));
  } else {
    labels.intrinsics = intrinsics_from(json.at("intrinsics"), where);
  }
  labels.depth_unit_m = json.value("depth_unit_m", 0.0);
  if (!(labels.depth_unit_m >= 0 && labels.depth_unit_m <= kLargestUnit_m))
    throw Error(where + ": depth_unit_m is " + std::to_string(labels.depth_unit_m) +
                ", expected 0 to 1");
  labels.gravity = gravity_from(json.at("gravity"), where);
  for (const Json& plane : json.at("planes")) labels.planes.push_back(plane_from(plane, where));
  labels.annotator = json.at("annotator").get<std::string>();
  labels.review_state = json.at("review_state").get<std::string>();
  if (json.contains("review")) {
    for (const Json& note : json.at("review")) labels.review.push_back(note_from(note, where));
  }
  return labels;
}

}  // namespace

std::string label_json(int frame_index, const FrameLabels& labels) {
  Json planes = Json::array();
  for (const LabelPlane& plane : labels.planes) planes.push_back(to_json(plane));
  Json json = {{"schema", kSchema}, {"frame", frame_index}};
  if (labels.is_cloud()) {
    json.update({{"cloud_sha256", labels.depth_sha256}, {"points", labels.intrinsics.width}});
    if (!labels.origin.isZero(0)) json["origin"] = to_json(labels.origin);
  } else {
    json.update(
        {{"depth_sha256", labels.depth_sha256}, {"intrinsics", to_json(labels.intrinsics)}});
  }
  if (!labels.is_cloud() && labels.depth_unit_m > 0) json["depth_unit_m"] = labels.depth_unit_m;
  json.update({{"gravity", to_json(labels.gravity)},
               {"planes", planes},
               {"annotator", labels.annotator},
               {"review_state", labels.review_state}});
  for (const ReviewNote& note : labels.review) json["review"].push_back(to_json(note));
  // Text that people typed may hold any bytes: what is not UTF-8 is replaced, not refused.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

FrameLabels parse_label_json(const std::string& text, int frame_index, const std::string& where) {
  try {
    return labels_from(parse_json<Json>(text, where), frame_index, where);
  } catch (const Json::exception& error) {
    throw Error(where + ": not a label file of planescope (" + error.what() + ")");
  }
}

}  // namespace planescope::labels
