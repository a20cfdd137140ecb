#pragma once

// What stands above the floor: flights of stairs, kerbs and ramps, from the planes of a frame and
// what they cover. Seen from above: a step is where a level ends and a higher one begins behind its
// nosing, the line along which the higher one ends. World frame: z up, metres.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/planes/outline/outline.hpp"
#include "core/planes/result/options.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

/// From right to left for who goes up [m].
struct NosingLine {
  Vec3d right = Vec3d::Zero(), left = Vec3d::Zero();
  double width_m() const { return (left - right).norm(); }
};

/// Ids of planes: pieces of one level, the largest first; none where it was not seen. Of a minor
/// plane -1 - its index.
using LevelPlanes = std::vector<int>;

/// Planes and what they cover.
struct CoveringPlanes {
  std::span<const PlaneRegion> planes;
  std::span<const Outline> outlines;  // of each
};

enum class SeenFrom : std::uint8_t { unknown, below, above };  // clouds: unknown

struct Flight {
  struct Step {
    LevelPlanes tread;   // behind the nosing
    int riser = 0;       // id of a plane, 0 none seen
    double rise_m = 0;   // from the level below
    double going_m = 0;  // from the nosing below to this one; of the first step 0: there is none
    NosingLine nosing;
  };
  LevelPlanes foot;                             // before the first riser
  std::vector<Step> steps;                      // from the lowest
  double rise_m = 0, going_m = 0, width_m = 0;  // means over steps; width: the median
  Vec3d uphill = Vec3d::UnitX();                // unit, level
  SeenFrom seen = SeenFrom::unknown;            // from below: it leads up
  bool landing = false;                         // the last tread is one
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
  double rise_m = 0, run_m = 0, width_m = 0;  // as far as it is seen
  Vec3d uphill = Vec3d::UnitX();
  LevelPlanes lower, upper;  // what it leads from and to; one may be unseen
};

/// Why there is no step between two levels, or none that a flight goes on by.
enum class NoStep : std::uint8_t {
  rise,          // is too low or too high
  apart,         // the upper one does not begin where the lower one ends
  narrow,        // too little of the nosing is seen
  crooked,       // the upper one's border is no straight line
  rise_uneven,   // the step is not like the one below it
  going,         // too short or too long
  going_uneven,  // likewise
  alone,         // one step is no flight, and it is too narrow for a kerb
  shallow,       // likewise, and a level is not deep enough for a kerb
};

struct StepDecision {
  int lower = 0, upper = 0;  // planes
  NoStep why = NoStep::rise;
  double value = 0, limit = 0;  // [m]; crooked: share of the border
};
/// "P3 -> P5 no step: rise 41 cm, limit 30 cm".
std::string to_text(const StepDecision& decision);
const char* to_string(NoStep why);

struct Stairs {
  int floor = 0;                 // plane, 0 none: the lowest level of floor_m2, else the largest
  std::vector<double> height_m;  // above the floor, by plane id - 1; NaN where it is not level
  std::vector<Flight> flights;   // those of most steps first
  std::vector<Kerb> kerbs;       // by their upper plane
  std::vector<SlopingPlane> ramps;
  std::vector<StepDecision> decisions;  // of each level that no step leads up to, the nearest miss
};

/// `sensor`: where it stood, in the world; nothing: nobody knows, and gaps are not explained by
/// what an upper level hides. `minor`: planes too small to be listed; they may be the foot and the
/// last tread of a flight, and no more. Where gravity is not known no plane is level, and nothing
/// is found.
Stairs find_stairs(const CoveringPlanes& found,
                   const CoveringPlanes& minor,
                   const std::optional<Vec3d>& sensor,
                   const StairsOptions& options);

}  // namespace planescope::planes
