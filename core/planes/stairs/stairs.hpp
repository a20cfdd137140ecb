#pragma once

// Flights of stairs, kerbs and ramps, detected from the planes of a frame and their outlines, seen
// from above. A step is found where one level ends and a higher level begins behind its nosing, the
// front edge of the higher level. World frame: z up, meters.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/planes/outline/outline.hpp"
#include "core/planes/result/options.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

/// From right to left, facing uphill [m].
struct NosingLine {
  Vec3d right = Vec3d::Zero(), left = Vec3d::Zero();
  double width_m() const { return (left - right).norm(); }
};

/// Plane ids: pieces of one level, largest first; empty if it was not seen. A minor plane is -1 -
/// its index.
using LevelPlanes = std::vector<int>;

/// Planes with their outlines.
struct CoveringPlanes {
  std::span<const PlaneRegion> planes;
  std::span<const Outline> outlines;  // one per plane
};

enum class SeenFrom : std::uint8_t { unknown, below, above };  // clouds: unknown

struct Flight {
  struct Step {
    LevelPlanes tread;   // behind the nosing
    int riser = 0;       // plane id, 0 if not seen
    double rise_m = 0;   // from the level below
    double going_m = 0;  // from the previous nosing to this one; 0 for the first step
    NosingLine nosing;
  };
  LevelPlanes foot;                             // level in front of the first riser
  std::vector<Step> steps;                      // lowest first
  double rise_m = 0, going_m = 0, width_m = 0;  // rise and going: means over the steps;
                                                // width: median
  Vec3d uphill = Vec3d::UnitX();                // unit, horizontal
  SeenFrom seen = SeenFrom::unknown;            // below: it leads up from the sensor
  bool landing = false;                         // whether the last tread is a landing
};

struct Kerb {
  LevelPlanes lower, upper;
  int riser = 0;
  double rise_m = 0;
  NosingLine nosing;
  Vec3d uphill = Vec3d::UnitX();
};

struct SlopingPlane {
  int plane = 0;
  double slope_deg = 0;
  double rise_m = 0, run_m = 0, width_m = 0;  // visible extent
  Vec3d uphill = Vec3d::UnitX();
  LevelPlanes lower, upper;  // levels at its ends; one may be unseen
};

/// Reason why two levels do not form a step, or why a step does not continue a flight.
enum class NoStep : std::uint8_t {
  rise,          // too low or too high
  apart,         // the upper level does not begin where the lower level ends
  narrow,        // too little of the nosing is visible
  crooked,       // the border of the upper level is not straight
  rise_uneven,   // differs from the step below
  going,         // too short or too long
  going_uneven,  // differs from the step below
  alone,         // a single step is not a flight, and it is too narrow for a kerb
  shallow,       // same, with levels too shallow for a kerb
};

struct StepDecision {
  int lower = 0, upper = 0;  // plane ids
  NoStep why = NoStep::rise;
  double value = 0, limit = 0;  // [m]; crooked: share of the border
};
/// "P3 -> P5 no step: rise 41 cm, limit 30 cm".
std::string to_text(const StepDecision& decision);
const char* to_string(NoStep why);

struct Stairs {
  int floor = 0;                 // plane id, 0 if none: the lowest level of floor_m2, else
                                 // the largest
  std::vector<double> height_m;  // above the floor, by plane id - 1; NaN if not level
  std::vector<Flight> flights;   // most steps first
  std::vector<Kerb> kerbs;       // sorted by upper plane
  std::vector<SlopingPlane> ramps;
  std::vector<StepDecision> decisions;  // the nearest miss of each level without a step up to it
};

/// `sensor`: world position of the sensor; nullopt if unknown, and then gaps are not explained by
/// occlusion. `minor`: planes too small to be listed, which can only be the foot or the last tread
/// of a flight. Returns nothing if gravity is unknown, because no plane is level then.
Stairs find_stairs(const CoveringPlanes& found,
                   const CoveringPlanes& minor,
                   const std::optional<Vec3d>& sensor,
                   const StairsOptions& options);

}  // namespace planescope::planes
