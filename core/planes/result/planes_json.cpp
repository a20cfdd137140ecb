// Writes planes.json and timings.json.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/model/json.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::planes {
namespace {

using Json = nlohmann::ordered_json;

/// Collects the fields that `visit(fields)` visits.
template <typename Visit>
Json object_of(const Visit& visit) {
  Json json = Json::object();
  FieldWriter fields(json);
  visit(fields);
  return json;
}

Json to_json(const Pose& pose) {
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r) {
    Json row = Json::array();
    for (int c = 0; c < 4; ++c) row.push_back(rounded(pose.matrix()(r, c)));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json options_json(const PipelineOptions& options) {
  Json json = Json::object();
  for (const OptionInfo& info : option_table()) {
    if (!info.matters(options)) continue;
    const std::string text = info.get(options);
    if (text == "on" || text == "off") {
      json[info.name] = text == "on";
      continue;
    }
    const Json value = Json::parse(text, nullptr, false);
    if (value.is_number())
      json[info.name] = value;
    else
      json[info.name] = text;
  }
  return json;
}

/// Counts specific to our method.
void add_steps(const SegmentCounts& segment, Json& json) {
  json["nodes_visited"] = segment.nodes_visited;
  for (const Case c : {Case::I, Case::II, Case::III, Case::IV})
    json["nodes_case_" + std::string(to_string(c))] =
        segment.nodes_per_case[static_cast<std::size_t>(c)];
  json["candidates"] = segment.candidates;
  json["merges"] = segment.merges;
  json["leftovers"] = segment.leftovers;
  json["assigned"] = segment.assigned;
}

Json counts_json(const FrameResult& result, bool ours) {
  const CloudCounts& cloud = result.cloud.counts;
  const SegmentCounts& segment = result.segmentation.counts;
  Json json = object_of([&](auto& fields) { dropped_fields(fields, cloud); });
  json["kept"] = cloud.kept;
  json["voxels"] = result.voxels.points.size();
  if (ours) add_steps(segment, json);
  json["unassigned"] = segment.unassigned;
  return json;
}

Json ring_json(const Outline& outline, const PolygonRing& ring) {
  Json corners = Json::array();
  for (const Vec2d& corner : ring) corners.push_back(vector_json(outline.world(corner)));
  return corners;
}

Json rings_json(const Outline& outline, const std::vector<PolygonRing>& rings) {
  Json all = Json::array();
  for (const PolygonRing& ring : rings) all.push_back(ring_json(outline, ring));
  return all;
}

Json outline_json(const Outline& outline) {
  Json parts = Json::array();
  for (const Outline::Part& part : outline.parts)
    parts.push_back({{"outer", ring_json(outline, part.outer)},
                     {"holes", rings_json(outline, part.holes)},
                     {"unknown", rings_json(outline, part.unknown)}});
  return parts;
}

Json certainty_json(const Certainty& certainty, const Vec3d& centroid) {
  Json json;
  json["sigma_m"] = rounded(certainty.sigma_m);
  json["eigenvalues_m2"] = vector_json(certainty.eigenvalues_m2);
  json["axes"] = {vector_json(certainty.axes[0]), vector_json(certainty.axes[1])};
  json["tilt_sigma_deg"] = Json::array();
  for (const double sigma_rad : certainty.sigma_tilt_rad)
    json["tilt_sigma_deg"].push_back(rounded(sigma_rad * 180 / std::numbers::pi));
  json["offset_sigma_m"] = rounded(certainty.sigma_offset_m);
  const Mat3d covariance = certainty.covariance(centroid);
  json["covariance"] = Json::array();
  for (int row = 0; row < 3; ++row) {
    // Not rounded to a nanometer: variances of good planes are smaller.
    json["covariance"].push_back({covariance(row, 0), covariance(row, 1), covariance(row, 2)});
  }
  return json;
}

Json foot_json(const Foothold& foothold, const Outline& outline) {
  Json json;
  json["steppable"] = foothold.steppable;
  json["why_not"] = foothold.why_not.empty() ? Json() : Json(foothold.why_not);
  json["area_m2"] = rounded(foothold.space->area_m2);
  json["area"] = Json::array();
  for (const Polygon& polygon : foothold.space->area)
    json["area"].push_back({{"outer", ring_json(outline, polygon.outer)},
                            {"holes", rings_json(outline, polygon.holes)}});
  json["pieces"] = rings_json(outline, foothold.space->pieces);
  return json;
}

// ---- Stairs ----

Json id_or_null(int id) { return id > 0 ? Json(id) : Json(); }

/// Lists planes by id, and a minor plane by its index in its list.
void add_planes(const std::string& name, const LevelPlanes& planes, Json& json) {
  Json listed = Json::array(), minor;
  for (const int id : planes)
    if (id > 0)
      listed.push_back(id);
    else
      minor = -1 - id;
  json[name] = listed;
  json["minor_" + name] = minor;
}

Json nosing_json(const NosingLine& nosing) {
  return {vector_json(nosing.right), vector_json(nosing.left)};
}

Json seen_json(SeenFrom seen) {
  switch (seen) {
    case SeenFrom::below:
      return "up";
    case SeenFrom::above:
      return "down";
    case SeenFrom::unknown:
      break;
  }
  return nullptr;
}

Json flight_json(const Flight& flight) {
  Json json;
  json["count"] = flight.steps.size();
  json["direction"] = seen_json(flight.seen);
  json["rise_m"] = rounded(flight.rise_m);
  json["going_m"] = rounded(flight.going_m);
  json["width_m"] = rounded(flight.width_m);
  json["uphill"] = vector_json(flight.uphill);
  json["landing"] = flight.landing;
  add_planes("foot", flight.foot, json);
  json["steps"] = Json::array();
  for (std::size_t i = 0; i < flight.steps.size(); ++i) {
    const Flight::Step& step = flight.steps[i];
    Json entry;
    add_planes("tread", step.tread, entry);
    entry["riser"] = id_or_null(step.riser);
    entry["rise_m"] = rounded(step.rise_m);
    entry["going_m"] = i > 0 ? Json(rounded(step.going_m)) : Json();
    entry["nosing"] = nosing_json(step.nosing);
    json["steps"].push_back(std::move(entry));
  }
  return json;
}

Json kerb_json(const Kerb& kerb) {
  return {{"rise_m", rounded(kerb.rise_m)},
          {"width_m", rounded(kerb.nosing.width_m())},
          {"uphill", vector_json(kerb.uphill)},
          {"lower", kerb.lower},
          {"upper", kerb.upper},
          {"riser", id_or_null(kerb.riser)},
          {"nosing", nosing_json(kerb.nosing)}};
}

Json ramp_json(const SlopingPlane& ramp) {
  Json json = object_of([&](auto& fields) { ramp_fields(fields, ramp); });
  json["uphill"] = vector_json(ramp.uphill);
  json["lower"] = ramp.lower;
  json["upper"] = ramp.upper;
  return json;
}

Json decision_json(const StepDecision& decision) {
  return {{"lower", decision.lower},          {"upper", decision.upper},
          {"why", to_string(decision.why)},   {"value", rounded(decision.value)},
          {"limit", rounded(decision.limit)}, {"text", to_text(decision)}};
}

template <typename Thing>
Json all_of(const std::vector<Thing>& things, Json (*json_of)(const Thing&)) {
  Json all = Json::array();
  for (const Thing& thing : things) all.push_back(json_of(thing));
  return all;
}

/// floor, flights, kerbs, ramps and no_steps.
void add_stairs(const Stairs& stairs, Json& json) {
  json["floor"] = id_or_null(stairs.floor);
  json["flights"] = all_of(stairs.flights, flight_json);
  json["kerbs"] = all_of(stairs.kerbs, kerb_json);
  json["ramps"] = all_of(stairs.ramps, ramp_json);
  json["no_steps"] = all_of(stairs.decisions, decision_json);
}

// ---- Text ----

// One line per field; vectors, hull corners and matrix rows take one line each.
void print(std::string& out, const Json& json, const std::string& indent) {
  const bool has_parts = json.is_structured() && !json.empty();
  const bool is_row =
      json.is_array() && (json.empty() || std::none_of(json.begin(), json.end(), [](const Json& j) {
                            return j.is_structured();
                          }));
  if (!has_parts || is_row) {
    out += json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const std::string inner = indent + "  ";
  const char* separator = "\n";
  out += json.is_object() ? '{' : '[';
  for (const auto& [key, value] : json.items()) {
    out += separator + inner;
    if (json.is_object()) out += Json(key).dump() + ": ";
    print(out, value, inner);
    separator = ",\n";
  }
  out += "\n" + indent + (json.is_object() ? '}' : ']');
}

std::string printed(const Json& json) {
  std::string text;
  print(text, json, "");
  return text + "\n";
}

}  // namespace

std::string planes_json(const Frame& frame,
                        const FrameResult& result,
                        const FramePlanes& found,
                        const PipelineOptions& options) {
  Json json;
  json["schema"] = "planescope.planes/4";
  json["frame"] = {
      {"index", frame.index}, {"name", frame.name}, {"timestamp_s", frame.timestamp_s}};
  json["T_world_camera"] = to_json(result.cloud.T_world_sensor);
  json["gravity"] = object_of([&](auto& fields) { gravity_fields(fields, result.gravity); });
  json["options"] = options_json(options);
  const bool ours = options.method == Method::ours;
  json["counts"] = counts_json(result, ours);
  if (ours) json["noise"] = json_of(noise_figures(result.segmentation.noise));
  json["planes"] = Json::array();
  for (std::size_t k = 0; k < found.summaries.size(); ++k) {
    const PlaneSummary& s = found.summaries[k];
    const Outline& outline = found.outlines[k];
    const Foothold& foothold = found.footholds[k];
    Json plane;
    plane["id"] = s.id;
    if (found.tracks) plane["track"] = (*found.tracks)[k];
    plane["label"] = to_string(s.label);
    plane["normal"] = vector_json(s.normal);
    plane["centroid"] = vector_json(s.centroid);
    plane["offset_m"] = rounded(s.offset_m);
    plane["points"] = s.points;
    plane["voxels"] = s.voxels;
    plane["rms_m"] = rounded(s.rms_m);
    plane["area_m2"] = rounded(s.area_m2);
    plane["margin"] = std::isfinite(s.margin) ? Json(rounded(s.margin)) : Json();
    plane["undecided"] = s.undecided;
    plane["hull"] = Json::array();
    for (const Vec3d& corner : s.hull) plane["hull"].push_back(vector_json(corner));
    plane["outline"] = outline_json(outline);
    plane["outline_area_m2"] = rounded(outline.area_m2);
    const double height_m = found.stairs.height_m[k];
    plane["height_m"] = std::isnan(height_m) ? Json() : Json(rounded(height_m));
    plane["surface"] = object_of([&](auto& fields) { surface_fields(fields, foothold.surface); });
    plane["certainty"] = certainty_json(foothold.certainty, s.centroid);
    if (foothold.space) plane["foot"] = foot_json(foothold, outline);
    json["planes"].push_back(std::move(plane));
  }
  add_stairs(found.stairs, json);
  if (!result.from_cloud && ours) {
    json["minor_planes"] = Json::array();
    for (const PlaneRegion& minor : result.segmentation.minor)
      json["minor_planes"].push_back(
          {{"label", to_string(minor.label)},
           {"normal", vector_json(minor.fit.normal)},
           {"centroid", vector_json(Vec3d(result.cloud.origin + minor.fit.centroid))},
           {"voxels", minor.points},
           {"rms_m", rounded(minor.fit.rms_m())}});
  }
  return printed(json);
}

std::string timings_json(const FrameTimings& t) {
  Json json;
  json["schema"] = "planescope.timings/1";
  FieldWriter fields(json);
  visit_fields(fields, t);
  json["total_ms"] = total_ms(t);
  return printed(json);
}

}  // namespace planescope::planes
