#pragma once

// What a report keeps of what one can stand on: figures of planes.json, without its polygons.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/planes/result/analyze.hpp"

namespace planescope::report {

struct FootRoom {
  bool steppable = false;
  std::string why_not;  // empty: steppable
  double area_m2 = 0;   // where the foot's centre may go
  int piece_count = 0;  // convex, of that area
};

/// Of a plane.
struct Footing {
  double outline_area_m2 = 0;
  double height_m = std::nan("");  // above the floor; NaN: it is not level
  // As planes::Surface has them.
  double slope_deg = std::nan("");
  double rough_rms_m = 0, rough_step_m = 0, support = 0, clearance_m = 0;
  double tilt_sigma_deg[2] = {0, 0};  // towards the axis of the longer extent, the shorter
  double offset_sigma_m = 0;

  std::optional<FootRoom> foot;  // where one was given
};

struct FlightFigures {
  int count = 0;  // of steps
  planes::SeenFrom seen = planes::SeenFrom::unknown;
  double rise_m = 0, going_m = 0, width_m = 0;
  bool landing = false;
  std::vector<int> planes;  // ids of the foot and of the treads, from the lowest
};
/// "4 steps up, rise 170 mm, going 289 mm".
std::string text_of(const FlightFigures& flight);

struct KerbFigures {
  double rise_m = 0, width_m = 0;
  std::vector<int> planes;  // the lower ones, then the upper ones
};
std::string text_of(const KerbFigures& kerb);  // "120 mm"

struct RampFigures {
  int plane = 0;
  double slope_deg = 0, rise_m = 0, run_m = 0, width_m = 0;
};
std::string text_of(const RampFigures& ramp);  // "12 deg"

/// Of a frame.
struct Terrain {
  int floor = 0;  // plane, 0 none
  // Where a foot's centre may go, over all steppable planes; NaN: no foot was given.
  double steppable_area_m2 = std::nan("");
  std::vector<FlightFigures> flights;  // those of most steps first
  std::vector<KerbFigures> kerbs;
  std::vector<RampFigures> ramps;

  int steps() const;  // of all flights
  /// "1 flight: 4 steps up, rise 170 mm, going 289 mm; 1 kerb: 120 mm"; empty where there is
  /// nothing.
  std::string text() const;
};

/// One for each plane, by id - 1; none where only summaries are there.
std::vector<Footing> footings_of(const planes::FramePlanes& found);
/// `foot`: whether one was given, and areas are known.
Terrain terrain_of(const planes::Stairs& stairs);
Terrain terrain_of(const planes::FramePlanes& found, bool foot);

}  // namespace planescope::report
