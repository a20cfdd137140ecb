#include "core/report/data/stairs_json.hpp"

#include <nlohmann/json.hpp>

#include "core/model/json_fields.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

Json id_or_null(int id) { return id > 0 ? Json(id) : Json(); }

/// Planes by their ids, and a minor one by its place in its list.
void add_planes(const std::string& name, const planes::LevelPlanes& planes, Json& json) {
  Json listed = Json::array(), minor;
  for (const int id : planes)
    if (id > 0)
      listed.push_back(id);
    else
      minor = -1 - id;
  json[name] = listed;
  json["minor_" + name] = minor;
}

Json nosing_json(const planes::NosingLine& nosing) {
  return {vector_json(nosing.right), vector_json(nosing.left)};
}

Json seen_json(planes::SeenFrom seen) {
  switch (seen) {
    case planes::SeenFrom::below:
      return "up";
    case planes::SeenFrom::above:
      return "down";
    case planes::SeenFrom::unknown:
      break;
  }
  return nullptr;
}

Json flight_json(const planes::Flight& flight) {
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
    const planes::Flight::Step& step = flight.steps[i];
    Json told;
    add_planes("tread", step.tread, told);
    told["riser"] = id_or_null(step.riser);
    told["rise_m"] = rounded(step.rise_m);
    told["going_m"] = i > 0 ? Json(rounded(step.going_m)) : Json();
    told["nosing"] = nosing_json(step.nosing);
    json["steps"].push_back(std::move(told));
  }
  return json;
}

Json kerb_json(const planes::Kerb& kerb) {
  return {{"rise_m", rounded(kerb.rise_m)},
          {"width_m", rounded(kerb.nosing.width_m())},
          {"uphill", vector_json(kerb.uphill)},
          {"lower", kerb.lower},
          {"upper", kerb.upper},
          {"riser", id_or_null(kerb.riser)},
          {"nosing", nosing_json(kerb.nosing)}};
}

Json ramp_json(const planes::SlopingPlane& ramp) {
  return {{"plane", ramp.plane},
          {"slope_deg", rounded(ramp.slope_deg)},
          {"rise_m", rounded(ramp.rise_m)},
          {"run_m", rounded(ramp.run_m)},
          {"width_m", rounded(ramp.width_m)},
          {"uphill", vector_json(ramp.uphill)},
          {"lower", ramp.lower},
          {"upper", ramp.upper}};
}

Json decision_json(const planes::StepDecision& decision) {
  return {{"lower", decision.lower},
          {"upper", decision.upper},
          {"why", planes::to_string(decision.why)},
          {"value", rounded(decision.value)},
          {"limit", rounded(decision.limit)},
          {"text", planes::to_text(decision)}};
}

template <typename Thing>
Json all_of(const std::vector<Thing>& things, Json (*to_json)(const Thing&)) {
  Json all = Json::array();
  for (const Thing& thing : things) all.push_back(to_json(thing));
  return all;
}

}  // namespace

void add_stairs(const planes::Stairs& stairs, Json& json) {
  json["floor"] = id_or_null(stairs.floor);
  json["flights"] = all_of(stairs.flights, flight_json);
  json["kerbs"] = all_of(stairs.kerbs, kerb_json);
  json["ramps"] = all_of(stairs.ramps, ramp_json);
  json["no_steps"] = all_of(stairs.decisions, decision_json);
}

}  // namespace planescope::report
