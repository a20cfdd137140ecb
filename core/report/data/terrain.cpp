#include "core/report/data/terrain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>

#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::report {
namespace {

std::string mm(double m) { return fmt::format("{:.0f} mm", 1000 * m); }

/// "2 kerbs: 100 mm, 120 mm".
template <typename Thing>
void add(const std::vector<Thing>& things,
         const char* noun,
         const char* separator,
         std::vector<std::string>& all) {
  if (things.empty()) return;
  std::vector<std::string> each;
  for (const Thing& thing : things) each.push_back(text_of(thing));
  all.push_back(fmt::format("{}: {}", counted(things.size(), noun), fmt::join(each, separator)));
}

/// Minor planes have no id of their own.
void add_listed(const planes::LevelPlanes& planes, std::vector<int>& ids) {
  std::ranges::copy_if(planes, std::back_inserter(ids), [](int id) { return id > 0; });
}

FlightFigures figures_of(const planes::Flight& flight) {
  FlightFigures figures{static_cast<int>(flight.steps.size()),
                        flight.seen,
                        flight.rise_m,
                        flight.going_m,
                        flight.width_m,
                        flight.landing,
                        {}};
  add_listed(flight.foot, figures.planes);
  for (const planes::Flight::Step& step : flight.steps) add_listed(step.tread, figures.planes);
  return figures;
}

KerbFigures figures_of(const planes::Kerb& kerb) {
  KerbFigures figures{kerb.rise_m, kerb.nosing.width_m(), {}};
  add_listed(kerb.lower, figures.planes);
  add_listed(kerb.upper, figures.planes);
  return figures;
}

RampFigures figures_of(const planes::SlopingPlane& ramp) {
  return {ramp.plane, ramp.slope_deg, ramp.rise_m, ramp.run_m, ramp.width_m};
}

template <typename Things, typename Figures>
void add_figures(const Things& things, std::vector<Figures>& all) {
  for (const auto& thing : things) all.push_back(figures_of(thing));
}

}  // namespace

std::string text_of(const FlightFigures& flight) {
  const char* const way[] = {"", " up", " down"};
  return fmt::format(
      "{}{}, rise {}, going {}", counted(static_cast<std::size_t>(flight.count), "step"),
      way[static_cast<std::size_t>(flight.seen)], mm(flight.rise_m), mm(flight.going_m));
}
std::string text_of(const KerbFigures& kerb) { return mm(kerb.rise_m); }
std::string text_of(const RampFigures& ramp) { return fmt::format("{:.0f} deg", ramp.slope_deg); }

int Terrain::steps() const {
  int steps = 0;
  for (const FlightFigures& flight : flights) steps += flight.count;
  return steps;
}

std::string Terrain::text() const {
  std::vector<std::string> all;
  add(flights, "flight", " and ", all);
  add(kerbs, "kerb", ", ", all);
  add(ramps, "ramp", ", ", all);
  return fmt::format("{}", fmt::join(all, "; "));
}

std::vector<Footing> footings_of(const planes::FramePlanes& found) {
  std::vector<Footing> footings(found.footholds.size());
  for (std::size_t k = 0; k < footings.size(); ++k) {
    const planes::Foothold& foothold = found.footholds[k];
    Footing& footing = footings[k];
    footing.outline_area_m2 = found.outlines[k].area_m2;
    footing.height_m = found.stairs.height_m[k];
    footing.slope_deg = foothold.surface.slope_deg;
    footing.rough_rms_m = foothold.surface.rough_rms_m;
    footing.rough_step_m = foothold.surface.rough_step_m;
    footing.support = foothold.surface.support;
    footing.clearance_m = foothold.surface.clearance_m;
    for (std::size_t axis = 0; axis < 2; ++axis)
      footing.tilt_sigma_deg[axis] =
          rounded(foothold.certainty.sigma_tilt_rad[axis] * 180 / std::numbers::pi);
    footing.offset_sigma_m = foothold.certainty.sigma_offset_m;
    if (foothold.space)
      footing.foot = {foothold.steppable, foothold.why_not, foothold.space->area_m2,
                      static_cast<int>(foothold.space->pieces.size())};
  }
  return footings;
}

Terrain terrain_of(const planes::Stairs& stairs) {
  Terrain terrain;
  terrain.floor = stairs.floor;
  add_figures(stairs.flights, terrain.flights);
  add_figures(stairs.kerbs, terrain.kerbs);
  add_figures(stairs.ramps, terrain.ramps);
  return terrain;
}

Terrain terrain_of(const planes::FramePlanes& found, bool foot) {
  Terrain terrain = terrain_of(found.stairs);
  if (!foot) return terrain;
  terrain.steppable_area_m2 = 0;
  for (const planes::Foothold& foothold : found.footholds)
    if (foothold.steppable) terrain.steppable_area_m2 += foothold.space->area_m2;
  return terrain;
}

}  // namespace planescope::report
