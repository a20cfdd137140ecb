// What one can stand on in a frame: its planes' figures, stairs, and what became of them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/report/page/page.hpp"

namespace planescope::report::html {
namespace {

constexpr const char* kNone = "\u2013";

std::string or_none(double value, int digits) {
  return std::isnan(value) ? kNone : decimal(value, digits);
}

PageJson footing_data(const PageFrame& frame, const ReportPlane& plane) {
  const Footing& footing = *plane.footing;
  PageJson row = {{"id", plane.summary.id},
                  {"place", fmt::format("{}/p{}", frame.anchor, plane.summary.id)},
                  {"color", safe_color(plane.color)},
                  {"outline_area", fmt::format("{:.3f}", footing.outline_area_m2)},
                  {"height", or_none(footing.height_m, 3)},
                  {"slope", or_none(footing.slope_deg, 1)},
                  {"tilt_sigma", fmt::format("{:.2f}", std::max(footing.tilt_sigma_deg[0],
                                                                footing.tilt_sigma_deg[1]))},
                  {"offset_sigma", fmt::format("{:.1f}", 1000 * footing.offset_sigma_m)},
                  {"rough", fmt::format("{:.1f}", 1000 * footing.rough_rms_m)},
                  {"support", fmt::format("{:.0f} %", 100 * footing.support)},
                  {"clearance", fmt::format("{:.1f}", 100 * footing.clearance_m)},
                  {"has_foot", footing.foot.has_value()}};
  if (!footing.foot) return row;
  const FootRoom& foot = *footing.foot;
  row.update(
      {{"foot_area", fmt::format("{:.3f}", foot.area_m2)},
       {"pieces", foot.piece_count},
       {"steppable", foot.steppable ? "yes" : "no"},
       {"class", foot.steppable ? "passed" : "failed"},
       {"title", foot.steppable ? "A foot may be set on it" : "Not steppable: " + foot.why_not},
       {"why_not", foot.why_not}});
  return row;
}

/// A line for each of what leads up; lengths that it does not have are empty.
PageJson ways_data(const Terrain& terrain) {
  PageJson ways = PageJson::array();
  const auto mm = [](double m) { return fmt::format("{:.0f}", 1000 * m); };
  const auto add = [&](const std::string& what, double rise_m, const std::string& going,
                       double width_m, const std::vector<int>& planes) {
    ways.push_back({{"what", what},
                    {"rise", mm(rise_m)},
                    {"going", going},
                    {"width", fmt::format("{:.2f}", width_m)},
                    {"planes", fmt::format("{}", fmt::join(planes, ", "))}});
  };
  const char* const way[] = {"", ", seen from below: up", ", seen from above: down"};
  for (const FlightFigures& flight : terrain.flights)
    add(fmt::format("flight of {}{}{}", counted(static_cast<std::size_t>(flight.count), "step"),
                    way[static_cast<std::size_t>(flight.seen)],
                    flight.landing ? ", to a landing" : ""),
        flight.rise_m, mm(flight.going_m), flight.width_m, flight.planes);
  for (const KerbFigures& kerb : terrain.kerbs)
    add("kerb", kerb.rise_m, "", kerb.width_m, kerb.planes);
  for (const RampFigures& ramp : terrain.ramps)
    add(fmt::format("ramp, {:.1f}\u00b0", ramp.slope_deg), ramp.rise_m, mm(ramp.run_m),
        ramp.width_m, {ramp.plane});
  return ways;
}

}  // namespace

void set_terrain(const PageFrame& of, PageJson& data) {
  if (of.is_compared()) data["terrain_changes"] = terrain_changes(*of.comparison);
  if (of.is_refused()) return;
  bool has_foot = false;
  for (const ReportPlane& plane : of.frame->planes) {
    if (!plane.footing) continue;
    data["footings"].push_back(footing_data(of, plane));
    has_foot |= plane.footing->foot.has_value();
  }
  data["has_foot"] = has_foot;
  if (of.frame->terrain) data["ways"] = ways_data(*of.frame->terrain);
}

}  // namespace planescope::report::html
