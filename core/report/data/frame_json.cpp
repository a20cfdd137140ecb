// One frame of report.json: docs/report.md says what each field means.

#include "core/report/data/frame_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/planes/evaluate/metrics.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostSamples = 1 << 22;
constexpr int kDepths = 22;  // of the octree

Json to_json(const Gravity& gravity) {
  return {{"direction", gravity.known() ? vector_json(gravity.direction) : Json()},
          {"source", to_string(gravity.source)},
          {"confidence", rounded(gravity.confidence)},
          {"note", gravity.note}};
}

Json to_json(const ReportPlane& plane) {
  const PlaneSummary& s = plane.summary;
  return {{"id", s.id},
          {"label", to_string(s.label)},
          {"color", plane.color},
          {"normal", vector_json(s.normal)},
          {"centroid", vector_json(s.centroid)},
          {"offset_m", rounded(s.offset_m)},
          {"tilt_deg", std::isnan(s.tilt_deg) ? Json() : Json(rounded(s.tilt_deg))},
          {"rms_m", rounded(s.rms_m)},
          {"area_m2", rounded(s.area_m2)},
          {"points", s.points},
          {"voxels", s.voxels}};
}

/// `runs`: plane id and how many samples have it, one after the other.
Json to_json(const RegionSample& sample) {
  Json runs = Json::array();
  for (const RegionSample::Run& run : sample.runs) {
    runs.push_back(run.plane);
    runs.push_back(run.count);
  }
  return {
      {"step", sample.step}, {"columns", sample.columns}, {"rows", sample.rows}, {"runs", runs}};
}

/// Trailing zeros are left out: most of the counts are in the first bins.
Json to_json(const ValueHistogram& histogram) {
  Json counts = Json::array();
  std::size_t used = histogram.counts.size();
  while (used > 0 && histogram.counts[used - 1] == 0) --used;
  for (std::size_t bin = 0; bin < used; ++bin) counts.push_back(histogram.counts[bin]);
  return {{"name", histogram.name},
          {"high", rounded(histogram.high)},
          {"threshold", rounded(histogram.threshold)},
          {"bins", histogram.counts.size()},
          {"counts", counts}};
}

Json to_json(const ReportPicture& picture) {
  return {{"name", picture.name},
          {"title", picture.title},
          {"alt", picture.alt},
          {"file", picture.file},
          {"width", picture.width},
          {"height", picture.height},
          {"pixels_sha256", picture.pixels_sha256}};
}

Json nodes_json(const planes::SegmentCounts& counts) {
  Json json;
  json["visited"] = counts.nodes_visited;
  json["per_case"] = Json::object();
  json["per_case_depth"] = Json::object();
  int deepest = 0;
  for (int c = 1; c <= 4; ++c)
    for (int depth = 0; depth < 22; ++depth)
      if (counts.nodes_per_case_depth[c][depth] > 0) deepest = std::max(deepest, depth);
  for (int c = 1; c <= 4; ++c) {
    const std::string name = planes::to_string(static_cast<planes::Case>(c));
    json["per_case"][name] = counts.nodes_per_case[c];
    for (int depth = 0; depth <= deepest; ++depth)
      json["per_case_depth"][name].push_back(counts.nodes_per_case_depth[c][depth]);
  }
  return json;
}

Json noise_json(const ReportNoise& noise) {
  return {{"estimated", noise.estimated},
          {"by_range", noise.by_range},
          {"of_spreads", noise.of_spreads},
          {"sigma_at_1m_m", rounded(noise.sigma_m)},
          {"theta_rms_at_1m_m", rounded(noise.theta_rms_m)},
          {"tau_at_1m_m", rounded(noise.tau_m)}};
}

GravitySource gravity_source(const JsonPlace& place) {
  using enum GravitySource;
  for (const GravitySource source : {option, sidecar, imu, picked, estimate, assumed, none})
    if (place.text() == to_string(source)) return source;
  place.fail_kind("a source of gravity");
}

Gravity read_gravity(const JsonPlace& place) {
  Gravity gravity;
  gravity.source = gravity_source(place.at("source"));
  if (gravity.known()) gravity.direction = place.at("direction").vector();
  gravity.confidence = place.at("confidence").number();
  gravity.note = place.at("note").text();
  return gravity;
}

void read_nodes(const JsonPlace& place, planes::SegmentCounts& counts) {
  counts.nodes_visited = static_cast<std::uint32_t>(place.at("visited").count());
  for (int c = 1; c <= 4; ++c) {
    const char* name = planes::to_string(static_cast<planes::Case>(c));
    counts.nodes_per_case[c] = static_cast<std::uint32_t>(place.at("per_case").at(name).count());
    int depth = 0;
    place.at("per_case_depth").at(name).each([&](const JsonPlace& count) {
      if (depth >= kDepths) count.fail_kind("at most 22 depths");
      counts.nodes_per_case_depth[c][depth++] = static_cast<std::uint32_t>(count.count());
    });
  }
}

void read_segmentation(const JsonPlace& place, ReportFrame& frame) {
  const auto count = [&](const char* name) {
    return static_cast<std::uint32_t>(place.at(name).count());
  };
  frame.segment.candidates = count("candidates");
  frame.segment.merges = count("merges");
  frame.segment.leftovers = count("leftovers");
  frame.segment.assigned = count("assigned");
  const JsonPlace noise = place.at("noise");
  frame.noise.estimated = noise.at("estimated").boolean();
  frame.noise.by_range = noise.at("by_range").boolean();
  frame.noise.of_spreads = noise.at("of_spreads").boolean();
  frame.noise.sigma_m = noise.at("sigma_at_1m_m").number();
  frame.noise.theta_rms_m = noise.at("theta_rms_at_1m_m").number();
  frame.noise.tau_m = noise.at("tau_at_1m_m").number();
}

ValueHistogram read_histogram(const JsonPlace& place) {
  constexpr int kMostBins = 1000;
  ValueHistogram histogram;
  histogram.name = place.at("name").text();
  histogram.high = place.at("high").number();
  histogram.threshold = place.at("threshold").number();
  histogram.counts.resize(static_cast<std::size_t>(place.at("bins").whole(3, kMostBins)));
  std::size_t bin = 0;
  place.at("counts").each([&](const JsonPlace& count) {
    if (bin == histogram.counts.size()) count.fail_kind("at most as many counts as bins");
    histogram.counts[bin++] = static_cast<std::uint32_t>(count.count());
  });
  return histogram;
}

/// JSON has no NaN: it is written as null.
double number_or_nan(const JsonPlace& place) {
  return place.json().is_null() ? std::nan("") : place.number();
}

ReportPicture read_picture(const JsonPlace& place) {
  ReportPicture picture;
  picture.name = place.at("name").text();
  picture.title = place.at("title").text();
  picture.alt = place.at("alt").text();
  picture.file = place.at("file").text();
  picture.width = place.at("width").whole(1);
  picture.height = place.at("height").whole(1);
  picture.pixels_sha256 = place.at("pixels_sha256").text();
  return picture;
}

}  // namespace

double rounded(double value) {
  return std::round(value * 1e9) / 1e9 + 0.0;  // + 0.0: no minus zero
}

Json vector_json(const Vec3d& v) {
  return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())});
}

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json metrics_json(const planes::Metrics& metrics) {
  Json json;
  planes::visit_values(metrics, [&](const char* name, auto value) {
    if constexpr (std::is_floating_point_v<decltype(value)>)
      json[name] = rounded(value);
    else
      json[name] = value;
  });
  return json;
}

Json timings_json(const ReportFrame& frame) {
  const planes::FrameTimings& t = frame.timings;
  return {{"load_ms", t.load_ms},
          {"cloud_ms", t.cloud_ms},
          {"t_d_ms", t.t_d_ms},
          {"t_c_ms", t.t_c_ms},
          {"t_b_ms", t.t_b_ms},
          {"t_s_ms", t.t_s_ms},
          {"reference_ms", frame.reference_ms}};
}

Json frame_json(const ReportFrame& frame, bool ours) {
  Json json;
  json["index"] = frame.index;
  json["name"] = frame.name;
  json["timestamp_s"] = frame.timestamp_s;
  json["sha256"] = frame.sha256;
  json["status"] = frame.refused.empty() ? "done" : frame.unreadable ? "unreadable" : "refused";
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
                    {"voxels_in_no_plane", frame.segment.unassigned},
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
  json["regions"] = to_json(frame.regions);
  json["histograms"] = Json::array();
  for (const ValueHistogram& histogram : frame.histograms)
    json["histograms"].push_back(to_json(histogram));
  json["metrics"] = frame.metrics ? metrics_json(*frame.metrics) : Json();
  json["pictures"] = Json::array();
  for (const ReportPicture& picture : frame.pictures) json["pictures"].push_back(to_json(picture));
  return json;
}

PlaneSummary read_plane(const JsonPlace& place, int id) {
  PlaneSummary plane;
  plane.id = place.at("id").whole(id, id);
  const std::string label = place.at("label").text();
  plane.label = label == "h" ? Label::h : label == "v" ? Label::v : Label::unknown;
  plane.normal = place.at("normal").vector();
  plane.centroid = place.at("centroid").vector();
  plane.offset_m = place.at("offset_m").number();
  plane.tilt_deg = number_or_nan(place.at("tilt_deg"));
  plane.rms_m = place.at("rms_m").number();
  plane.area_m2 = place.at("area_m2").number();
  plane.points = place.at("points").count();
  plane.voxels = place.at("voxels").count();
  return plane;
}

RegionSample read_regions(const JsonPlace& place, int planes) {
  RegionSample sample;
  sample.step = place.at("step").whole(1, 1 << 16);
  // The positions that it samples must fit into an int.
  sample.columns = place.at("columns").whole(
      0, std::min(kMostSamples, std::numeric_limits<int>::max() / 2 / sample.step));
  sample.rows = place.at("rows").whole(0, kMostSamples / std::max(1, sample.columns));
  const int size = sample.columns * sample.rows;
  const JsonPlace runs = place.at("runs");
  int samples = 0;
  bool is_count = false;
  runs.each([&](const JsonPlace& value) {
    if (is_count)
      samples += sample.runs.back().count = value.whole(0, size - samples);
    else
      sample.runs.push_back({value.whole(-1, planes), 0});
    is_count = !is_count;
  });
  if (is_count || samples != size) runs.fail_kind(fmt::format("runs of {} samples", size));
  return sample;
}

planes::Metrics read_metrics(const JsonPlace& place) {
  planes::Metrics metrics;
  planes::visit_values(metrics, [&](const char* name, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    if (planes::is_late_value(name) && !place.has(name)) return;
    if constexpr (std::is_same_v<Value, int>)
      value = place.at(name).whole(0);
    else if constexpr (std::is_same_v<Value, double>)
      value = std::string_view(name) == "pq" && !place.has(name) ? std::nan("")
                                                                 : number_or_nan(place.at(name));
    else
      value = place.at(name).count();
  });
  return metrics;
}

void read_timings(const JsonPlace& place, ReportFrame& frame) {
  planes::FrameTimings& t = frame.timings;
  t.load_ms = place.at("load_ms").number();
  t.cloud_ms = place.at("cloud_ms").number();
  t.t_d_ms = place.at("t_d_ms").number();
  t.t_c_ms = place.at("t_c_ms").number();
  t.t_b_ms = place.at("t_b_ms").number();
  t.t_s_ms = place.at("t_s_ms").number();
  frame.reference_ms = place.at("reference_ms").number();
}

ReportFrame read_frame(const JsonPlace& place) {
  ReportFrame frame;
  frame.index = place.at("index").whole(0);
  frame.name = place.at("name").text();
  frame.timestamp_s = place.at("timestamp_s").number();
  frame.sha256 = place.at("sha256").text();
  if (const std::string status = place.at("status").text(); status != "done") {
    frame.unreadable = status == "unreadable";
    frame.refused = place.at("message").text();
    return frame;
  }
  frame.gravity = read_gravity(place.at("gravity"));
  const JsonPlace counts = place.at("counts");
  frame.counts.pixels = counts.at("pixels").count();
  frame.counts.no_measurement = counts.at("no_measurement").count();
  frame.counts.invalid = counts.at("invalid").count();
  frame.counts.beyond_range = counts.at("beyond_range").count();
  frame.counts.outside_cube = counts.at("outside_cube").count();
  frame.counts.kept = counts.at("n_m").count();
  frame.voxels = counts.at("n_d").count();
  frame.segment.unassigned = static_cast<std::uint32_t>(counts.at("voxels_in_no_plane").count());
  frame.points_on_planes = counts.at("points_on_planes").count();
  if (place.has("nodes")) read_nodes(place.at("nodes"), frame.segment);
  if (place.has("segmentation")) read_segmentation(place.at("segmentation"), frame);
  place.at("planes").each([&](const JsonPlace& plane) {
    frame.planes.push_back({read_plane(plane, static_cast<int>(frame.planes.size()) + 1),
                            plane.at("color").text(), 0});
    const Label label = frame.planes.back().summary.label;
    frame.planes_h += label == Label::h;
    frame.planes_v += label == Label::v;
  });
  frame.regions = read_regions(place.at("regions"), static_cast<int>(frame.planes.size()));
  if (place.has("histograms"))  // not in reports of earlier versions
    place.at("histograms").each([&](const JsonPlace& histogram) {
      frame.histograms.push_back(read_histogram(histogram));
    });
  if (place.has("metrics")) frame.metrics = read_metrics(place.at("metrics"));
  place.at("pictures").each([&](const JsonPlace& picture) {
    frame.pictures.push_back(read_picture(picture));
  });
  return frame;
}

}  // namespace planescope::report
