#include "app/desktop/debugger/plane_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr double kDegrees = 57.29577951308232;  // in a radian

std::string mm(double m) { return fmt::format("{:.0f} mm", 1000 * m); }
std::string fine_mm(double m) { return fmt::format("{:.3g} mm", 1000 * m); }

/// "P3"; "a minor plane" where the result does not list it.
std::string name_of(const State& state, int id) {
  const std::int32_t plane = state.run()->timeline.plane_of_number(id);
  return plane >= 0 ? debug::plane_name(*state.run(), plane) : "a minor plane";
}

std::string names_of(const State& state, const planes::LevelPlanes& ids) {
  if (ids.empty()) return "not visible";
  std::vector<std::string> names;
  for (const int id : ids) names.push_back(name_of(state, id));
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_planes(const State& state, const planes::LevelPlanes& ids, StairsEntry& entry) {
  for (const int id : ids)
    if (const std::int32_t plane = state.run()->timeline.plane_of_number(id); plane >= 0)
      entry.planes.push_back(plane);
}

StairsEntry entry_of(const State& state, const planes::Flight& flight) {
  const char* const way[] = {"", " up", " down"};
  StairsEntry entry;
  entry.title = fmt::format("{}{}, rise {}, going {}", counted(flight.steps.size(), "step"),
                            way[static_cast<std::size_t>(flight.seen)], mm(flight.rise_m),
                            mm(flight.going_m));
  add_planes(state, flight.foot, entry);
  entry.lines.push_back(
      fmt::format("{} wide, from {}", mm(flight.width_m), names_of(state, flight.foot)));
  for (std::size_t i = 0; i < flight.steps.size(); ++i) {
    const planes::Flight::Step& step = flight.steps[i];
    const std::string going = step.going_m > 0 ? ", going " + mm(step.going_m) : "";
    const std::string riser =
        step.riser > 0 ? ", riser " + name_of(state, step.riser) : ", riser not visible";
    entry.lines.push_back(fmt::format("step {}: rise {}{}, tread {}{}", i + 1, mm(step.rise_m),
                                      going, names_of(state, step.tread), riser));
    add_planes(state, step.tread, entry);
    if (step.riser > 0) add_planes(state, {step.riser}, entry);
  }
  if (flight.landing) entry.lines.emplace_back("The last tread is a landing");
  return entry;
}

StairsEntry entry_of(const State& state, const planes::Kerb& kerb) {
  StairsEntry entry;
  entry.title = fmt::format("kerb, rise {}", mm(kerb.rise_m));
  entry.lines.push_back(fmt::format("{} wide, from {} to {}", mm(kerb.nosing.width_m()),
                                    names_of(state, kerb.lower), names_of(state, kerb.upper)));
  add_planes(state, kerb.lower, entry);
  add_planes(state, kerb.upper, entry);
  if (kerb.riser > 0) add_planes(state, {kerb.riser}, entry);
  return entry;
}

StairsEntry entry_of(const State& state, const planes::SlopingPlane& ramp) {
  StairsEntry entry;
  entry.title = fmt::format("ramp {}, {:.1f}°, rise {}, run {}", name_of(state, ramp.plane),
                            ramp.slope_deg, mm(ramp.rise_m), mm(ramp.run_m));
  entry.lines.push_back(
      fmt::format("from {} to {}", names_of(state, ramp.lower), names_of(state, ramp.upper)));
  add_planes(state, {ramp.plane}, entry);
  return entry;
}

/// What is known of a finished plane; null where nothing is.
const planes::Foothold* foothold_of(const State& state, int id) {
  const RunPlanes* planes = state.planes();
  const auto k = static_cast<std::size_t>(id) - 1;
  return planes && k < planes->found.footholds.size() ? &planes->found.footholds[k] : nullptr;
}

}  // namespace

int finished_plane(const State& state, std::int32_t plane) {
  const debug::Run* run = state.run();
  if (!run || plane < 0 || plane >= run->timeline.plane_count()) return 0;
  return state.view.step == run->steps() ? run->timeline.result_of_plane(plane) : 0;
}

std::string verdict_text(const State& state, std::int32_t plane) {
  const planes::Foothold* foothold = foothold_of(state, finished_plane(state, plane));
  if (!foothold || !foothold->space) return "";
  return foothold->steppable ? "steppable" : "not steppable: " + foothold->why_not;
}

std::string describe_plane(const State& state, std::int32_t plane) {
  std::string text = debug::plane_name(*state.run(), plane);
  const int id = finished_plane(state, plane);
  const planes::Foothold* foothold = foothold_of(state, id);
  if (!foothold) return text + (id > 0 ? "" : ", unfinished: hull of its points");
  const std::size_t k = static_cast<std::size_t>(id) - 1;
  text += ", " + area_text(state.planes()->found.outlines[k].area_m2);
  if (!std::isnan(foothold->surface.slope_deg))
    text += fmt::format(", slope {:.1f}°", foothold->surface.slope_deg);
  if (state.planes()->found.summaries[k].undecided) text += ", undecided";
  const std::string verdict = verdict_text(state, plane);
  return verdict.empty() ? text : text + "\n" + verdict;
}

std::vector<PlaneLine> plane_lines(const State& state, std::int32_t plane) {
  const int id = finished_plane(state, plane);
  const planes::Foothold* foothold = foothold_of(state, id);
  if (!foothold) return {};
  const planes::FramePlanes& found = state.planes()->found;
  const std::size_t k = static_cast<std::size_t>(id) - 1;
  const planes::Surface& surface = foothold->surface;
  const planes::Certainty& certainty = foothold->certainty;
  std::vector<PlaneLine> lines = {
      {"area", area_text(found.outlines[k].area_m2), "Area of its outline, without holes"}};
  if (!std::isnan(surface.slope_deg))
    lines.push_back(
        {"slope", fmt::format("{:.1f}°", surface.slope_deg), "Angle to the horizontal"});
  lines.push_back(
      {"rough",
       fmt::format("{}, steps of {}", fine_mm(surface.rough_rms_m), fine_mm(surface.rough_step_m)),
       "RMS height above the mean within 5 cm, and the 95th percentile of "
       "steps between neighbors"});
  lines.push_back(
      {"support", fmt::format("{:.0f} %", 100 * surface.support), "Measured share of its outline"});
  lines.push_back(
      {"uncertainty",
       fmt::format("tilt {:.2g}°, {:.2g}°; offset {}", kDegrees * certainty.sigma_tilt_rad[0],
                   kDegrees * certainty.sigma_tilt_rad[1], fine_mm(certainty.sigma_offset_m)),
       "Standard deviations of the tilt about its two axes, longer extent first, "
       "and of the offset at its centroid"});
  lines.push_back(
      {"clearance", mm(surface.clearance_m), "Radius of the largest circle in its outline"});
  if (const planes::PlaneSummary& summary = found.summaries[k]; std::isfinite(summary.margin))
    lines.push_back(
        {"margin", fmt::format("{:.2g}{}", summary.margin, summary.undecided ? ", undecided" : ""),
         "Distance from being dropped or merged with a larger neighbor"});
  if (k < found.stairs.height_m.size() && !std::isnan(found.stairs.height_m[k]))
    lines.push_back({"height", mm(found.stairs.height_m[k]), "Above the floor"});
  if (foothold->space)
    lines.push_back({"foot space",
                     foothold->space->area.empty()
                         ? "none"
                         : fmt::format("{} in {}", area_text(foothold->space->area_m2),
                                       counted(foothold->space->pieces.size(), "convex piece")),
                     "Allowed positions of its center"});
  return lines;
}

std::vector<std::string> no_steps_of(const State& state, std::int32_t plane) {
  const int id = finished_plane(state, plane);
  if (id == 0 || !state.planes()) return {};
  std::vector<std::string> texts;
  for (const planes::StepDecision& decision : state.planes()->found.stairs.decisions) {
    if (decision.lower != id && decision.upper != id) continue;
    texts.push_back(planes::to_text(decision));
  }
  return texts;
}

std::vector<StairsEntry> stairs_entries(const State& state) {
  if (!state.run() || !state.planes()) return {};
  const planes::Stairs& stairs = state.planes()->found.stairs;
  std::vector<StairsEntry> entries;
  for (const planes::Flight& flight : stairs.flights) entries.push_back(entry_of(state, flight));
  for (const planes::Kerb& kerb : stairs.kerbs) entries.push_back(entry_of(state, kerb));
  for (const planes::SlopingPlane& ramp : stairs.ramps) entries.push_back(entry_of(state, ramp));
  return entries;
}

}  // namespace planescope::desktop
