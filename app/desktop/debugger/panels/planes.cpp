// Planes of the result: rows of their table, texts, and the tabs of planes and stairs.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/desktop/panels.hpp"
#include "app/desktop/widgets.hpp"

namespace planescope::desktop {

// ---- Table --------------------------------------------------------------------------------------

namespace {

std::string known(double value, const std::string& text) { return std::isnan(value) ? "–" : text; }

PlaneRow row_of(const debug::Run& run, const planes::FramePlanes& found, std::size_t k) {
  const planes::PlaneSummary& summary = found.summaries[k];
  PlaneRow row;
  row.id = summary.id;
  row.plane = run.timeline.plane_of_number(summary.id);
  row.label = summary.label;
  row.area_m2 = found.outlines[k].area_m2;
  row.tilt_deg = summary.tilt_deg;
  row.rms_m = summary.rms_m;
  row.points = summary.points;
  row.support = found.footholds[k].surface.support;
  row.foot = found.footholds[k].space.has_value();
  row.steppable = found.footholds[k].steppable;
  row.margin = summary.margin;
  row.undecided = summary.undecided;
  return row;
}

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr PlaneColumn kColumns[] = {
    {"id", "id", "P000", "As in planes.json", false,
     [](const PlaneRow& row) { return fmt::format("P{}", row.id); },
     [](const PlaneRow& row) { return static_cast<double>(row.id); }},
    {"class", "class", "h", "h: horizontal, v: vertical", false,
     [](const PlaneRow& row) { return std::string(to_string(row.label, "–")); },
     [](const PlaneRow& row) { return static_cast<double>(row.label); }},
    {"area", "area", "00.000 m²", "Area of its outline, without holes", true,
     [](const PlaneRow& row) { return fmt::format("{:.3f} m²", row.area_m2); },
     [](const PlaneRow& row) { return row.area_m2; }},
    {"tilt", "tilt", "00.0°", "Angle to the horizontal: 0 for a floor, 90 for a wall", true,
     [](const PlaneRow& row) { return known(row.tilt_deg, fmt::format("{:.1f}°", row.tilt_deg)); },
     [](const PlaneRow& row) { return row.tilt_deg; }},
    {"rms", "RMS", "00.0 mm", "Root mean square distance of its points from the plane", true,
     [](const PlaneRow& row) { return fmt::format("{:.1f} mm", 1000 * row.rms_m); },
     [](const PlaneRow& row) { return row.rms_m; }},
    {"points", "points", "000000", "Measured points", true,
     [](const PlaneRow& row) { return std::to_string(row.points); },
     [](const PlaneRow& row) { return static_cast<double>(row.points); }},
    {"support", "support", "000 %", "Measured share of its outline", true,
     [](const PlaneRow& row) {
       return known(row.support, fmt::format("{:.0f} %", 100 * row.support));
     },
     [](const PlaneRow& row) { return row.support; }},
    {"steppable", "foot", "yes", "Whether it can carry a foot of foot_radius_m", true,
     [](const PlaneRow& row) {
       return std::string(row.foot ? (row.steppable ? "yes" : "no") : "–");
     },
     [](const PlaneRow& row) { return row.foot ? row.steppable : kUnknown; }},
    {"margin", "margin", "0.0e-00 ~",
     "Distance from being dropped or merged with a larger neighbor; ~: so small that it is "
     "undecided",
     false,
     [](const PlaneRow& row) {
       if (!std::isfinite(row.margin)) return std::string("–");
       return fmt::format("{:.2g}{}", row.margin, row.undecided ? " ~" : "");
     },
     [](const PlaneRow& row) { return std::isfinite(row.margin) ? row.margin : kUnknown; }}};

bool fits(const PlaneRow& row, const std::vector<std::string>& words) {
  std::vector<std::string> texts;
  for (const PlaneColumn& column : kColumns) texts.push_back(column.text(row));
  if (row.label != Label::unknown)
    texts.emplace_back(row.label == Label::h ? "horizontal level" : "vertical upright");
  if (row.foot) texts.emplace_back(row.steppable ? "steppable" : "not steppable");
  if (row.undecided) texts.emplace_back("undecided");
  return std::ranges::all_of(words, [&](const std::string& word) {
    return std::ranges::any_of(texts, [&](const std::string& text) {
      return lower_case(text).find(word) != std::string::npos;
    });
  });
}

/// Sorts rows; unknown values come last in either direction.
void sort(std::vector<PlaneRow>& rows, const PlanesView& by) {
  const auto key_of = kColumns[by.sorted_by].key;
  std::ranges::stable_sort(rows, [&](const PlaneRow& a, const PlaneRow& b) {
    const double x = key_of(a), y = key_of(b);
    if (std::isnan(x) || std::isnan(y)) return !std::isnan(x) && std::isnan(y);
    return by.descending ? x > y : x < y;
  });
}

std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

std::span<const PlaneColumn> plane_columns() { return kColumns; }

std::vector<PlaneRow> plane_rows(const State& state) {
  const RunPlanes* planes = state.planes();
  if (!planes) return {};
  const std::vector<std::string> words = words_of(lower_case(state.view.planes.filter));
  std::vector<PlaneRow> rows;
  for (std::size_t k = 0; k < planes->found.summaries.size(); ++k) {
    const PlaneRow row = row_of(*planes->of->run, planes->found, k);
    if (fits(row, words)) rows.push_back(row);
  }
  sort(rows, state.view.planes);
  return rows;
}

std::string planes_csv(const std::vector<PlaneRow>& rows) {
  std::string text = "id,class,area_m2,tilt_deg,rms_m,points,support,steppable,margin,undecided\n";
  for (const PlaneRow& row : rows)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", row.id, to_string(row.label, ""),
                        number(row.area_m2), number(row.tilt_deg), number(row.rms_m), row.points,
                        number(row.support), row.foot ? (row.steppable ? "true" : "false") : "",
                        number(row.margin), row.undecided);
  return text;
}

// ---- Texts --------------------------------------------------------------------------------------

namespace {

constexpr double kDegrees = 57.29577951308232;  // in a radian

std::string mm(double m) { return fmt::format("{:.0f} mm", 1000 * m); }
std::string fine_mm(double m) { return fmt::format("{:.3g} mm", 1000 * m); }

/// "P3"; "a minor plane" if it is not listed in the result.
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

/// The foothold of a finished plane; null if unknown.
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

// ---- Planes tab ---------------------------------------------------------------------------------

namespace {

void draw_filter(const Ui& ui) {
  std::string text = ui.state.view.planes.filter;
  ImGui::SetNextItemWidth(std::max(ui.px(60), ImGui::GetContentRegionAvail().x -
                                                  button_width("Copy as CSV") -
                                                  ImGui::GetStyle().ItemSpacing.x));
  if (ImGui::InputTextWithHint("##filter", "filter: vertical, P3", &text))
    ui.act("planes.filter", text);
  ui.name("planes.filter");
  ImGui::SameLine();
  action_button(ui, "planes.copy", "Copy as CSV");
}

/// Click a header to sort by its column; click again to reverse.
void draw_header(const Ui& ui) {
  const PlanesView& view = ui.state.view.planes;
  ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
  for (const PlaneColumn& column : kColumns) {
    ImGui::TableNextColumn();
    const auto number = &column - kColumns;
    const bool sorted = view.sorted_by == number;
    const std::string title = fmt::format("{}{}", column.title,
                                          !sorted           ? ""
                                          : view.descending ? "▾"
                                                            : "▴");
    if (ImGui::Selectable((title + "###" + column.name).c_str(), false))
      ui.act("planes.sort", number);
    ui.name(std::string("planes.sort.") + column.name);
    tooltip(column.meaning);
  }
}

void draw_row(const Ui& ui, const PlaneRow& row) {
  const std::string widget = fmt::format("planes.{}", row.id);
  const bool selected = ui.state.view.selected.plane == row.plane;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  if (ImGui::Selectable((kColumns[0].text(row) + "##" + widget).c_str(), selected,
                        ImGuiSelectableFlags_SpanAllColumns))
    selected ? ui.act("select.none") : ui.act("select.plane", PlaneRef{row.plane});
  ui.name(widget);
  if (ImGui::IsItemHovered()) tooltip(describe_plane(ui.state, row.plane));
  // Scroll once to a plane that was selected elsewhere.
  double& shown = ui.memory.numbers["planes.shown"];
  if (selected && shown != row.plane + 1) {
    shown = row.plane + 1;
    if (!ImGui::IsItemVisible()) ImGui::SetScrollHereY(0.5f);
  }
  for (const PlaneColumn& column : std::span(kColumns).subspan(1)) cell(column.text(row));
}

}  // namespace

void draw_planes(const Ui& ui) {
  if (!ui.state.run()) return paragraph(ui.colors.muted, "No frame");
  if (!ui.state.planes()) return paragraph(ui.colors.muted, "Measuring the planes …");
  const std::size_t all = ui.state.planes()->found.summaries.size();
  if (all == 0) return paragraph(ui.colors.muted, "No planes in this frame");
  draw_filter(ui);
  const std::vector<PlaneRow> rows = plane_rows(ui.state);
  if (rows.size() < all) {
    ImGui::TextDisabled("%zu of %s", rows.size(), counted(all, "plane").c_str());
    ui.name("planes.found");
  }
  if (ui.state.view.selected.plane < 0) ui.memory.numbers["planes.shown"] = 0;
  const ImGuiTableFlags flags = kTable | ImGuiTableFlags_ScrollX | ImGuiTableFlags_ScrollY;
  if (!ImGui::BeginTable("##planes", static_cast<int>(std::size(kColumns)), flags)) return;
  for (const PlaneColumn& column : kColumns) {
    const bool long_numbers =
        column.name == std::string("area") || column.name == std::string("points");
    fixed_column(column.title, column.widest, long_numbers ? 0 : ImGui::CalcTextSize("▾").x);
  }
  ImGui::TableSetupScrollFreeze(1, 1);
  draw_header(ui);
  for (const PlaneRow& row : rows) draw_row(ui, row);
  ImGui::EndTable();
}

// ---- Stairs tab ---------------------------------------------------------------------------------

namespace {

/// Explains why nothing is shown at the cursor; empty if something is.
std::string why_untold(const State& state) {
  if (!state.run()->subject->prepared.gravity.known())
    return "Stairs, kerbs, and ramps need gravity, which is unknown.";
  if (!state.planes()) return "Measuring the planes …";
  return state.view.step == state.run()->steps() ? "" : "Available at the last step.";
}

void draw_entry(const Ui& ui, const StairsEntry& entry, std::size_t number) {
  heading(ui, entry.title);
  ui.name(fmt::format("stairs.{}", number));
  for (const std::string& line : entry.lines) paragraph(ui.colors.muted, line);
  for (std::size_t i = 0; i < entry.planes.size(); ++i) {
    const std::string name = debug::plane_name(*ui.state.run(), entry.planes[i]);
    if (i > 0) same_line_if_fits(name);
    if (ImGui::SmallButton(fmt::format("{}##{}.{}", name, number, i).c_str()))
      ui.act("select.plane", PlaneRef{entry.planes[i]});
    ui.name(fmt::format("stairs.{}.{}", number, name));
  }
  ImGui::Spacing();
}

}  // namespace

void draw_plane_facts(const Ui& ui, std::int32_t plane) {
  const std::string verdict = verdict_text(ui.state, plane);
  if (!verdict.empty()) {
    paragraph(verdict == "steppable" ? ui.colors.good : ui.colors.bad, verdict);
    ui.name("inspector.verdict");
  }
  for (const PlaneLine& line : plane_lines(ui.state, plane)) {
    fact(ui, line.name.c_str(), line.value);
    tooltip(line.meaning);
  }
  for (const std::string& text : no_steps_of(ui.state, plane)) paragraph(ui.colors.muted, text);
}

void draw_stairs(const Ui& ui) {
  if (!ui.state.run()) return paragraph(ui.colors.muted, "No frame");
  action_button(ui, "show.stairs", "Show in the scene");
  if (const std::string why = why_untold(ui.state); !why.empty())
    return paragraph(ui.colors.muted, why);
  const std::vector<StairsEntry> entries = stairs_entries(ui.state);
  for (std::size_t i = 0; i < entries.size(); ++i) draw_entry(ui, entries[i], i);
  if (entries.empty()) paragraph(ui.colors.muted, "No flight, kerb, or ramp found.");
  const std::vector<std::string> missed = no_steps_of(ui.state, ui.state.view.selected.plane);
  if (!missed.empty())
    heading(ui, "No step at " + debug::plane_name(*ui.state.run(), ui.state.view.selected.plane));
  for (const std::string& text : missed) paragraph(ui.colors.text, text);
  if (missed.empty())
    paragraph(ui.colors.muted, "Select a horizontal plane to see why no step leads up to it.");
}

}  // namespace planescope::desktop
