#pragma once

// Texts about the planes of a result and the steps between them, and the table's rows in the order
// and with the filter of the view. Pure functions of the state; planes are the trace's.

#include <cstdint>
#include <string>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

// ---- The table ----------------------------------------------------------------------------------

/// What is not known is NaN.
struct PlaneRow {
  int id = 0;               // as in planes.json
  std::int32_t plane = -1;  // of the trace
  Label label = Label::unknown;
  double area_m2 = 0, tilt_deg = 0, rms_m = 0;
  std::uint64_t points = 0;
  double support = 0;  // share of what its outline covers that was measured
  bool foot = false;   // one is given, and `steppable` means something
  bool steppable = false;
  double margin = 0;  // as in planes.json; infinite: no objective was minimized
  bool undecided = false;
};

struct PlaneColumnInfo {
  const char* name;   // in actions and of widgets
  const char* title;  // as short as its numbers
  const char* meaning;
};
/// By PlaneColumn.
inline constexpr PlaneColumnInfo kPlaneColumns[] = {
    {"id", "id", "As in planes.json"},
    {"class", "class", "h: horizontal, v: vertical"},
    {"area", "area", "Area of its outline, without holes"},
    {"tilt", "tilt", "Angle to the horizontal: 0 for a floor, 90 for a wall"},
    {"rms", "RMS", "Root mean square distance of its points from the plane"},
    {"points", "points", "Measured points"},
    {"support", "support", "Measured share of its outline"},
    {"steppable", "foot", "Whether it can carry a foot of foot_radius_m"},
    {"margin", "margin",
     "Distance from being dropped or merged with a larger neighbor; ~: so small that it is "
     "undecided"}};

/// Every cell as text, by PlaneColumn; "–" where it is not known.
std::vector<std::string> cells_of(const PlaneRow& row);

/// Those that the filter leaves, sorted; empty while they are found out. Each word of the filter is
/// in one of the row's texts, or in "level", "upright", "steppable", "not steppable",
/// "undecided".
std::vector<PlaneRow> plane_rows(const State& state);

/// The same rows with a header, numbers in SI units with all their digits.
std::string planes_csv(const std::vector<PlaneRow>& rows);

// ---- Texts --------------------------------------------------------------------------------------

/// What is known of the run looked at and its plane's number in the result, from 1; 0 before the
/// last step, and of planes that did not stay.
int finished_plane(const State& state, std::int32_t plane);

/// "steppable", "not steppable: 17 mm rough, limit 10"; empty where that is not known.
std::string verdict_text(const State& state, std::int32_t plane);

/// "P1, 0.52 m2, slope 1.2 deg" and, in a second line, the verdict.
std::string describe_plane(const State& state, std::int32_t plane);

/// Area, slope, roughness, support, certainty, clearance, height; empty where none is known.
struct PlaneLine {
  std::string name, value, meaning;
};
std::vector<PlaneLine> plane_lines(const State& state, std::int32_t plane);

/// Of a level plane: why no step leads up to it, or from it.
std::vector<std::string> no_steps_of(const State& state, std::int32_t plane);

/// A flight, kerb or ramp: a line, further ones, and the planes that it leads over.
struct StairsEntry {
  std::string title;
  std::vector<std::string> lines;
  std::vector<std::int32_t> planes;  // of the trace
};
std::vector<StairsEntry> stairs_entries(const State& state);

}  // namespace planescope::desktop
