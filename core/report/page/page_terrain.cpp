// What one can stand on in a frame: its planes' figures, stairs, and what became of them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/report/compare/terrain_changes.hpp"
#include "core/report/page/page.hpp"

namespace planescope::report::html {
namespace {

constexpr const char* kNone = "\u2013";

std::string or_none(double value, int digits) {
  return std::isnan(value) ? kNone : decimal(value, digits);
}

Data footing_data(const PageFrame& frame, const ReportPlane& plane) {
  const Footing& footing = *plane.footing;
  Data row;
  row.set("id", std::to_string(plane.summary.id));
  row.set("place", fmt::format("{}/p{}", frame.anchor, plane.summary.id));
  row.set("color", safe_color(plane.color));
  row.set("outline_area", fmt::format("{:.3f}", footing.outline_area_m2));
  row.set("height", or_none(footing.height_m, 3));
  row.set("slope", or_none(footing.slope_deg, 1));
  row.set("tilt_sigma",
          fmt::format("{:.2f}", std::max(footing.tilt_sigma_deg[0], footing.tilt_sigma_deg[1])));
  row.set("offset_sigma", fmt::format("{:.1f}", 1000 * footing.offset_sigma_m));
  row.set("rough", fmt::format("{:.1f}", 1000 * footing.rough_rms_m));
  row.set("support", fmt::format("{:.0f} %", 100 * footing.support));
  row.set("clearance", fmt::format("{:.1f}", 100 * footing.clearance_m));
  row.set("has_foot", footing.foot.has_value());
  if (!footing.foot) return row;
  const FootRoom& foot = *footing.foot;
  row.set("foot_area", fmt::format("{:.3f}", foot.area_m2));
  row.set("pieces", std::to_string(foot.piece_count));
  row.set("steppable", foot.steppable ? "yes" : "no");
  row.set("class", foot.steppable ? "passed" : "failed");
  row.set("title", foot.steppable ? "A foot may be set on it" : "Not steppable: " + foot.why_not);
  row.set("why_not", text_or_false(foot.why_not));
  return row;
}

std::string mm(double m) { return fmt::format("{:.0f}", 1000 * m); }

/// A line of the table of what leads up; lengths that it does not have are empty.
Data way_data(const std::string& what,
              const std::string& rise,
              const std::string& going,
              double width_m,
              const std::vector<int>& planes) {
  Data row;
  row.set("what", what);
  row.set("rise", rise);
  row.set("going", going);
  row.set("width", fmt::format("{:.2f}", width_m));
  row.set("planes", fmt::format("{}", fmt::join(planes, ", ")));
  return row;
}

Data ways_data(const Terrain& terrain) {
  const char* const way[] = {"", ", seen from below: up", ", seen from above: down"};
  Data ways{Data::type::list};
  for (const FlightFigures& flight : terrain.flights)
    ways.push_back(way_data(
        fmt::format("flight of {}{}{}", counted(static_cast<std::size_t>(flight.count), "step"),
                    way[static_cast<std::size_t>(flight.seen)],
                    flight.landing ? ", to a landing" : ""),
        mm(flight.rise_m), mm(flight.going_m), flight.width_m, flight.planes));
  for (const KerbFigures& kerb : terrain.kerbs)
    ways.push_back(way_data("kerb", mm(kerb.rise_m), "", kerb.width_m, kerb.planes));
  for (const RampFigures& ramp : terrain.ramps)
    ways.push_back(way_data(fmt::format("ramp, {:.1f}\u00b0", ramp.slope_deg), mm(ramp.rise_m),
                            mm(ramp.run_m), ramp.width_m, {ramp.plane}));
  return ways;
}

}  // namespace

void set_terrain(const PageFrame& of, Data& data) {
  const ReportFrame& frame = *of.frame;
  Data footings{Data::type::list};
  bool has_foot = false;
  for (const ReportPlane& plane : frame.planes) {
    if (!plane.footing) continue;
    footings.push_back(footing_data(of, plane));
    has_foot |= plane.footing->foot.has_value();
  }
  data.set("has_footings", footings.is_non_empty_list());
  data.set("has_foot", has_foot);
  data.set("footings", footings);
  const Data ways = frame.terrain ? ways_data(*frame.terrain) : Data{Data::type::list};
  data.set("has_ways", ways.is_non_empty_list());
  data.set("ways", ways);
}

void set_terrain_changes(const PageFrame& frame, Data& data) {
  const std::vector<std::string> changes =
      frame.is_compared() ? terrain_changes(*frame.comparison) : std::vector<std::string>();
  data.set("has_terrain_changes", !changes.empty());
  data.set("terrain_changes", list_of("text", changes));
}

}  // namespace planescope::report::html
