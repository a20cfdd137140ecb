// One frame of report.json: docs/report.md describes each field.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/report/data/report_json.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostSamples = 1 << 22;
constexpr int kMostBins = 1000;

void counts_fields(auto& fields, auto& frame) {
  planes::dropped_fields(fields, frame.counts);
  fields("n_m", frame.counts.kept, kCompared);
  fields("n_d", frame.voxels);
  fields("voxels_in_no_plane", frame.segment.unassigned);
  fields("points_on_planes", frame.points_on_planes, kCompared);
}

void nodes_fields(auto& fields, auto& counts) {
  const auto name_of = [](int c) { return planes::to_string(static_cast<planes::Case>(c)); };
  const auto depths = static_cast<std::size_t>(used_depths(counts));
  fields("visited", counts.nodes_visited);
  fields.object("per_case", kPlain, [&](auto& per_case) {
    for (int c = 1; c <= 4; ++c) per_case(name_of(c), counts.nodes_per_case[c]);
  });
  fields.object("per_case_depth", kPlain, [&](auto& per_case) {
    for (int c = 1; c <= 4; ++c)
      per_case.numbers(name_of(c), counts.nodes_per_case_depth[c], depths, "at most 22 depths");
  });
}

void segmentation_fields(auto& fields, auto& frame) {
  fields("candidates", frame.segment.candidates);
  fields("merges", frame.segment.merges);
  fields("leftovers", frame.segment.leftovers);
  fields("assigned", frame.segment.assigned);
  fields("unassigned", frame.segment.unassigned);
  fields("noise", frame.noise);
}

/// The fields of planes.json, without polygons.
template <typename Fields>
void footing_fields(Fields& fields, auto& footing) {
  fields("outline_area_m2", footing.outline_area_m2, kCompared | kRounded);
  fields("height_m", footing.height_m, kRounded | kOrNull);
  fields.object("surface", kPlain, [&](auto& of) { planes::surface_fields(of, footing); });
  fields.object("certainty", kPlain, [&](auto& certainty) {
    certainty.numbers("tilt_sigma_deg", footing.tilt_sigma_deg, 2, "at most 2 tilts");
    certainty("offset_sigma_m", footing.offset_sigma_m, kRounded);
  });
  fields.maybe_object("foot", footing.foot.has_value(), kCompared, [&](auto& of) {
    if constexpr (Fields::kReads) footing.foot.emplace();
    auto& foot = *footing.foot;
    of("steppable", foot.steppable, kCompared);
    of("why_not", foot.why_not, kCompared | kOrNull);
    of("area_m2", foot.area_m2, kCompared | kRounded);
    of("piece_count", foot.piece_count, kCompared);
  });
}

/// Id of a plane, null: none.
template <typename Fields>
void floor_field(Fields& fields, auto& floor) {
  if constexpr (Fields::kReads) {
    if (fields.place().has("floor")) floor = fields.place().at("floor").whole(1);
  } else if (floor > 0) {
    fields("floor", floor);
  } else {
    fields.null("floor");
  }
}

/// "up", "down", null.
template <typename Fields>
void seen_field(Fields& fields, auto& seen) {
  using enum planes::SeenFrom;
  if constexpr (Fields::kReads) {
    if (!fields.place().has("direction")) return;
    const JsonPlace place = fields.place().at("direction");
    const std::string text = place.text();
    if (text != "up" && text != "down") place.fail_kind("up, down, or null");
    seen = text == "up" ? below : above;
  } else {
    fields("direction", std::string(seen == below ? "up" : seen == above ? "down" : ""), kOrNull);
  }
}

template <typename Fields>
void terrain_fields(Fields& fields, auto& terrain) {
  fields("steppable_area_m2", terrain.steppable_area_m2, kCompared | kRounded | kOrNull);
  floor_field(fields, terrain.floor);
  fields.list("flights", terrain.flights, kCompared, [](auto& of, auto& flight) {
    of.whole("count", flight.count, kCompared, 1);
    seen_field(of, flight.seen);
    of("rise_m", flight.rise_m, kCompared | kRounded);
    of("going_m", flight.going_m, kCompared | kRounded);
    of("width_m", flight.width_m, kCompared | kRounded);
    of("landing", flight.landing, kCompared);
    of("planes", flight.planes, kCompared);
  });
  fields.list("kerbs", terrain.kerbs, kCompared, [](auto& of, auto& kerb) {
    of("rise_m", kerb.rise_m, kCompared | kRounded);
    of("width_m", kerb.width_m, kCompared | kRounded);
    of("planes", kerb.planes, kCompared);
  });
  fields.list("ramps", terrain.ramps, kCompared,
              [](auto& of, auto& ramp) { planes::ramp_fields(of, ramp); });
}

/// `id`: the expected id of the plane.
void plane_fields(auto& fields, auto& plane, int id) {
  auto& s = plane.summary;
  fields.whole("id", s.id, kCompared, id, id);
  fields("label", s.label, kCompared);
  fields("color", plane.color);
  fields("normal", s.normal, kCompared | kRounded);
  fields("centroid", s.centroid, kCompared | kRounded);
  fields("offset_m", s.offset_m, kCompared | kRounded);
  fields("tilt_deg", s.tilt_deg, kCompared | kRounded | kOrNull);
  fields("rms_m", s.rms_m, kCompared | kRounded);
  fields("area_m2", s.area_m2, kCompared | kRounded);
  fields("points", s.points, kCompared);
  fields("voxels", s.voxels, kCompared);
  fields("margin", s.margin, kCompared | kOptional | kRounded);  // null: infinite
  fields("undecided", s.undecided, kCompared | kOptional);
  fields.maybe_fields("outline_area_m2", plane.footing, kCompared,
                      [&](auto& of, auto& footing) { footing_fields(of, footing); });
}

/// `runs`: pairs of plane id and number of samples, flattened.
Json runs_json(const RegionSample& sample) {
  Json runs = Json::array();
  for (const RegionSample::Run& run : sample.runs) {
    runs.push_back(run.plane);
    runs.push_back(run.count);
  }
  return runs;
}
void read_runs(const JsonPlace& place, int planes, RegionSample& sample) {
  const int size = sample.columns * sample.rows;
  int samples = 0;
  bool is_count = false;
  place.each([&](const JsonPlace& value) {
    if (is_count)
      samples += sample.runs.back().count = value.whole(0, size - samples);
    else
      sample.runs.push_back({value.whole(-1, planes), 0});
    is_count = !is_count;
  });
  if (is_count || samples != size) place.fail_kind(fmt::format("runs of {} samples", size));
}

/// `planes`: number of planes in the frame.
template <typename Fields>
void regions_fields(Fields& fields, auto& sample, [[maybe_unused]] std::size_t planes) {
  fields.whole("step", sample.step, kCompared, 1, 1 << 16);
  // The sampled positions must fit into an int.
  fields.whole("columns", sample.columns, kCompared, 0,
               std::min(kMostSamples, std::numeric_limits<int>::max() / 2 / sample.step));
  fields.whole("rows", sample.rows, kCompared, 0, kMostSamples / std::max(1, sample.columns));
  if constexpr (Fields::kReads)
    read_runs(fields.place().at("runs"), static_cast<int>(planes), sample);
  else
    fields.json()["runs"] = runs_json(sample);
}

/// Omits trailing zeros, since most of the counts are in the first bins.
template <typename Fields>
void histogram_fields(Fields& fields, auto& histogram) {
  fields("name", histogram.name);
  fields("high", histogram.high, kRounded);
  fields("threshold", histogram.threshold, kRounded);
  int bins = static_cast<int>(histogram.counts.size());
  fields.whole("bins", bins, kPlain, 3, kMostBins);
  if constexpr (Fields::kReads) histogram.counts.resize(static_cast<std::size_t>(bins));
  std::size_t used = histogram.counts.size();
  while (used > 0 && histogram.counts[used - 1] == 0) --used;
  fields.numbers("counts", histogram.counts, used, "at most as many counts as bins");
}

void metrics_fields(auto& fields, auto& metrics) {
  planes::visit_values(metrics, [&](const char* name, auto& value) {
    const unsigned late = planes::is_late_value(name) ? kOptional : kPlain;
    fields(name, value, kCompared | kRounded | kOrNull | late);
  });
}

void picture_fields(auto& fields, auto& picture) {
  fields("name", picture.name);
  fields("title", picture.title);
  fields("alt", picture.alt);
  fields("file", picture.file);
  fields.whole("width", picture.width, kPlain, 1);
  fields.whole("height", picture.height, kPlain, 1);
  fields("pixels_sha256", picture.pixels_sha256);
  fields.list("legend", picture.legend, kOptional, [](auto& of, auto& mark) {
    of("shape", mark.shape);
    of("color", mark.color);
    of("text", mark.text);
  });
}

void timings_fields(auto& fields, auto& frame) {
  visit_fields(fields, frame.timings);
  fields("reference_ms", frame.reference_ms);
}

/// Whether the frame was processed; if not, it has no other data.
template <typename Fields>
bool status_fields(Fields& fields, auto& frame) {
  if constexpr (Fields::kReads) {
    const std::string status = fields.place().at("status").text();
    if (status == "done") return true;
    frame.unreadable = status == "unreadable";
    frame.refused = fields.place().at("message").text();
    return false;
  } else {
    const bool done = frame.refused.empty();
    fields("status", std::string(done ? "done" : frame.unreadable ? "unreadable" : "refused"));
    fields("message", frame.refused, kOrNull);
    return done;
  }
}

template <typename Fields>
void tracks_fields(Fields& fields, auto& tracks) {
  fields("track_breaks", tracks.breaks, kCompared);
  fields("track_swaps", tracks.swaps, kCompared);
  fields("tracks_kept_percent", tracks.kept_percent, kCompared | kRounded | kOrNull);
  fields("normal_jitter_deg", tracks.normal_jitter_deg, kCompared | kRounded | kOrNull);
  fields("offset_jitter_m", tracks.offset_jitter_m, kCompared | kRounded | kOrNull);
}

/// `ours`: whether to write data from the octree's traversal.
template <typename Fields>
void frame_fields(Fields& fields, auto& frame, bool ours) {
  fields("index", frame.index, kCompared);
  fields("name", frame.name, kCompared);
  fields("timestamp_s", frame.timestamp_s);
  fields("sha256", frame.sha256, kCompared);
  if (!status_fields(fields, frame)) return;
  fields.object("gravity", kPlain, [&](auto& of) { planes::gravity_fields(of, frame.gravity); });
  fields.object("counts", kCompared, [&](auto& of) { counts_fields(of, frame); });
  fields.maybe_object("nodes", ours, kPlain, [&](auto& of) { nodes_fields(of, frame.segment); });
  fields.maybe_object("segmentation", ours, kPlain,
                      [&](auto& of) { segmentation_fields(of, frame); });
  int id = 0;
  fields.list("planes", frame.planes, kCompared,
              [&](auto& of, auto& plane) { plane_fields(of, plane, ++id); });
  fields.maybe_fields("flights", frame.terrain, kCompared,
                      [&](auto& of, auto& terrain) { terrain_fields(of, terrain); });
  fields.maybe_fields("track_breaks", frame.tracks, kCompared,
                      [&](auto& of, auto& tracks) { tracks_fields(of, tracks); });
  fields.object("regions", kCompared,
                [&](auto& of) { regions_fields(of, frame.regions, frame.planes.size()); });
  fields.list("histograms", frame.histograms, kOptional,
              [](auto& of, auto& histogram) { histogram_fields(of, histogram); });
  fields.maybe_object("metrics", frame.metrics.has_value(), kCompared, [&](auto& of) {
    if constexpr (Fields::kReads) frame.metrics.emplace();
    metrics_fields(of, *frame.metrics);
  });
  fields.list("pictures", frame.pictures, kPlain,
              [](auto& of, auto& picture) { picture_fields(of, picture); });
}

}  // namespace

Json metrics_json(const planes::Metrics& metrics) {
  Json json;
  FieldWriter fields(json);
  metrics_fields(fields, metrics);
  return json;
}

Json timings_json(const ReportFrame& frame) {
  Json json;
  FieldWriter fields(json);
  timings_fields(fields, frame);
  return json;
}

Json frame_json(const ReportFrame& frame, bool ours) {
  Json json;
  FieldWriter fields(json);
  frame_fields(fields, frame, ours);
  return json;
}

ReportFrame read_frame(const JsonPlace& place, Extent extent) {
  ReportFrame frame;
  FieldReader fields(place, extent);
  frame_fields(fields, frame, false);
  for (const ReportPlane& plane : frame.planes) {
    frame.planes_h += plane.summary.label == Label::h;
    frame.planes_v += plane.summary.label == Label::v;
    frame.planes_undecided += plane.summary.undecided;
  }
  return frame;
}

void read_timings(const JsonPlace& place, ReportFrame& frame) {
  FieldReader fields(place, Extent::whole);
  timings_fields(fields, frame);
}

}  // namespace planescope::report
