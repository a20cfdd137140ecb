// report.json, schema "planescope.report/1": docs/report.md says what each field means.

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/report/report_files.hpp"

namespace planescope {
namespace {

using Json = nlohmann::ordered_json;

// A nanometre is far below what any sensor tells.
double rounded(double value) {
  return std::round(value * 1e9) / 1e9 + 0.0;  // + 0.0: no minus zero
}

Json to_json(const Vec3d& v) {
  return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())});
}

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

const char* text_of(Label label) {
  return label == Label::h ? "h" : label == Label::v ? "v" : "unknown";
}

Json to_json(const Gravity& gravity) {
  return {{"direction", to_json(gravity.direction)},
          {"source", to_string(gravity.source)},
          {"confidence", rounded(gravity.confidence)},
          {"note", gravity.note}};
}

Json to_json(const Metrics& m) {
  return {{"planes_truth", m.planes_truth},
          {"planes_found", m.planes_found},
          {"alpha_deg", rounded(m.alpha_deg)},
          {"r_p", rounded(m.r_p)},
          {"r_m", rounded(m.r_m)},
          {"point_accuracy", rounded(m.point_accuracy)},
          {"mean_iou", rounded(m.mean_iou)},
          {"detected_iou80", m.detected_iou80},
          {"over_segmented", m.over_segmented},
          {"under_segmented", m.under_segmented},
          {"missed", m.missed},
          {"noise", m.noise},
          {"label_accuracy_edge", rounded(m.label_accuracy_edge)},
          {"label_accuracy_inner", rounded(m.label_accuracy_inner)},
          {"points", m.points}};
}

Json to_json(const ReportPlane& plane) {
  const PlaneSummary& s = plane.summary;
  return {{"id", s.id},
          {"label", text_of(s.label)},
          {"color", plane.color},
          {"normal", to_json(s.normal)},
          {"centroid", to_json(s.centroid)},
          {"offset_m", rounded(s.offset_m)},
          {"tilt_deg", rounded(s.tilt_deg)},
          {"rms_m", rounded(s.rms_m)},
          {"area_m2", rounded(s.area_m2)},
          {"points", s.points},
          {"voxels", s.voxels}};
}

Json to_json(const ReportPicture& picture) {
  return {{"name", picture.name},     {"title", picture.title},
          {"file", picture.file},     {"width", picture.width},
          {"height", picture.height}, {"pixels_sha256", picture.pixels_sha256}};
}

Json nodes_json(const SegmentCounts& counts) {
  Json json;
  json["visited"] = counts.nodes_visited;
  json["per_case"] = Json::object();
  json["per_case_depth"] = Json::object();
  int deepest = 0;
  for (int c = 1; c <= 4; ++c)
    for (int depth = 0; depth < 22; ++depth)
      if (counts.nodes_per_case_depth[c][depth] > 0) deepest = std::max(deepest, depth);
  for (int c = 1; c <= 4; ++c) {
    const std::string name = to_string(static_cast<Case>(c));
    json["per_case"][name] = counts.nodes_per_case[c];
    for (int depth = 0; depth <= deepest; ++depth)
      json["per_case_depth"][name].push_back(counts.nodes_per_case_depth[c][depth]);
  }
  return json;
}

Json noise_json(const NoiseModel& noise) {
  return {{"estimated", noise.estimated},
          {"by_range", noise.by_range},
          {"sigma_at_1m_m", rounded(noise.sigma(1))},
          {"theta_rms_at_1m_m", rounded(noise.theta_rms(1))},
          {"tau_at_1m_m", rounded(noise.tau(1))}};
}

Json to_json(const ReportFrame& frame, bool ours) {
  Json json;
  json["index"] = frame.index;
  json["name"] = frame.name;
  json["timestamp_s"] = frame.timestamp_s;
  json["sha256"] = frame.sha256;
  json["status"] = frame.refused.empty() ? "done" : "refused";
  json["message"] = text_or_null(frame.refused);
  if (!frame.refused.empty()) return json;
  json["gravity"] = to_json(frame.gravity);
  json["counts"] = {{"pixels", frame.counts.pixels},
                    {"no_measurement", frame.counts.no_measurement},
                    {"invalid", frame.counts.invalid},
                    {"beyond_range", frame.counts.beyond_range},
                    {"outside_cube", frame.counts.outside_cube},
                    {"n_m", frame.counts.kept},
                    {"n_d", frame.voxels},
                    {"points_on_planes", frame.points_on_planes}};
  json["nodes"] = nullptr;
  json["segmentation"] = nullptr;
  if (ours) {
    json["nodes"] = nodes_json(frame.segment);
    json["segmentation"] = {
        {"candidates", frame.segment.candidates}, {"merges", frame.segment.merges},
        {"leftovers", frame.segment.leftovers},   {"assigned", frame.segment.assigned},
        {"unassigned", frame.segment.unassigned}, {"noise", noise_json(frame.noise)}};
  }
  json["planes"] = Json::array();
  for (const ReportPlane& plane : frame.planes) json["planes"].push_back(to_json(plane));
  json["metrics"] = frame.metrics ? to_json(*frame.metrics) : Json();
  json["pictures"] = Json::array();
  for (const ReportPicture& picture : frame.pictures) json["pictures"].push_back(to_json(picture));
  return json;
}

const char* text_of(Distortion distortion) {
  switch (distortion) {
    case Distortion::brown_conrady:
      return "brown_conrady";
    case Distortion::inverse_brown_conrady:
      return "inverse_brown_conrady";
    case Distortion::none:
      break;
  }
  return "none";
}

Json depth_json(const RecordingInfo& info) {
  if (info.width == 0) return {};
  const Intrinsics& k = info.intrinsics;
  return {{"width", info.width},
          {"height", info.height},
          {"unit_m", rounded(info.depth_unit_m)},
          {"unit_source", info.depth_unit_source},
          {"intrinsics",
           {{"fx", k.fx},
            {"fy", k.fy},
            {"cx", k.cx},
            {"cy", k.cy},
            {"distortion", text_of(k.distortion)},
            {"coefficients", k.coefficients},
            {"source", info.intrinsics_source}}}};
}

Json to_json(const ReportRecording& recording, bool ours) {
  Json json;
  json["path"] = recording.info.path.string();
  json["name"] = recording.name;
  json["format"] = recording.info.format;
  json["device"] = text_or_null(recording.info.device);
  json["sha256"] = text_or_null(recording.sha256);
  json["frame_count"] = recording.frame_count;
  json["frames_asked"] = recording.frames_asked;
  json["depth"] = depth_json(recording.info);
  json["color"] = recording.info.has_color ? Json(recording.info.color_note) : Json();
  json["warnings"] = recording.info.warnings;
  json["frames"] = Json::array();
  for (const ReportFrame& frame : recording.frames) json["frames"].push_back(to_json(frame, ours));
  return json;
}

Json to_json(const WeightsRecord& weights) {
  return {{"file", weights.file},
          {"sha256", weights.sha256},
          {"network", weights.network},
          {"training", Json::parse(weights.training)}};
}

Json record_json(const Report& report) {
  Json json;
  json["version"] = report.version;
  json["commit"] = report.commit;
  json["modified"] = report.modified;
  json["command"] = report.command;
  json["method"] = to_string(report.method);
  json["classifier"] = text_or_null(report.classifier);
  json["weights"] = report.weights ? to_json(*report.weights) : Json();
  json["renderer"] = text_or_null(report.renderer);
  json["renderer_error"] = text_or_null(report.renderer_error);
  json["options"] = Json::array();
  for (const ReportOption& option : report.options)
    json["options"].push_back({{"name", option.name},
                               {"value", option.value},
                               {"unit", option.unit},
                               {"section", option.section},
                               {"changed", option.changed}});
  return json;
}

Json totals_json(const Report& report) {
  const ReportTotals totals = totals_of(report);
  return {{"recordings", totals.recordings},
          {"frames_asked", totals.frames_asked},
          {"frames_done", totals.frames_done},
          {"frames_refused", totals.frames_refused},
          {"planes", totals.planes},
          {"points", totals.points},
          {"points_on_planes", totals.points_on_planes},
          {"metrics", totals.metrics ? to_json(*totals.metrics) : Json()}};
}

Json timings_json(const Report& report) {
  Json json = Json::array();
  for (std::size_t r = 0; r < report.recordings.size(); ++r) {
    for (const ReportFrame& frame : report.recordings[r].frames) {
      if (!frame.refused.empty()) continue;
      const FrameTimings& t = frame.timings;
      json.push_back({{"recording", r},
                      {"frame", frame.index},
                      {"load_ms", t.load_ms},
                      {"cloud_ms", t.cloud_ms},
                      {"t_d_ms", t.t_d_ms},
                      {"t_c_ms", t.t_c_ms},
                      {"t_b_ms", t.t_b_ms},
                      {"t_s_ms", t.t_s_ms}});
    }
  }
  return json;
}

}  // namespace

std::string report_json(const Report& report) {
  Json json;
  json["schema"] = "planescope.report/1";
  json["created_utc"] = report.created_utc;
  json["partial"] = report.partial;
  json["record"] = record_json(report);
  json["totals"] = totals_json(report);
  json["recordings"] = Json::array();
  for (const ReportRecording& recording : report.recordings)
    json["recordings"].push_back(to_json(recording, report.method == Method::ours));
  json["timings"] = timings_json(report);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace planescope
