#pragma once

// Footing and Terrain in report.json, named once for writing and reading: json_fields.hpp. Internal
// to core/report/data.

#include <string>

#include "core/model/json_fields.hpp"
#include "core/report/data/terrain.hpp"

namespace planescope::report {

/// Those of planes.json, without polygons.
template <typename Fields>
void footing_fields(Fields& fields, auto& footing) {
  fields("outline_area_m2", footing.outline_area_m2, kCompared | kRounded);
  fields("height_m", footing.height_m, kRounded | kOrNull);
  fields.object("surface", kPlain, [&](auto& surface) {
    surface("slope_deg", footing.slope_deg, kRounded | kOrNull);
    surface("rough_rms_m", footing.rough_rms_m, kRounded);
    surface("rough_step_m", footing.rough_step_m, kRounded);
    surface("support", footing.support, kRounded);
    surface("clearance_m", footing.clearance_m, kRounded);
  });
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
    if (text != "up" && text != "down") place.fail_kind("up, down or null");
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
  fields.list("ramps", terrain.ramps, kCompared, [](auto& of, auto& ramp) {
    of.whole("plane", ramp.plane, kCompared, 1);
    of("slope_deg", ramp.slope_deg, kCompared | kRounded);
    of("rise_m", ramp.rise_m, kCompared | kRounded);
    of("run_m", ramp.run_m, kCompared | kRounded);
    of("width_m", ramp.width_m, kCompared | kRounded);
  });
}

}  // namespace planescope::report
