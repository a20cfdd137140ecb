#pragma once

// The planes that one can stand on, pieces of one level taken together, and cuts through them.
// Internal to core/planes/stairs.

#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/planes/stairs/stairs.hpp"

namespace planescope::planes {

inline constexpr double kDegrees = 180 / std::numbers::pi;  // in a radian

/// A plane and what it covers, seen from above.
struct LevelPiece {
  int id = 0;
  Vec3d centroid = Vec3d::Zero();
  Vec3d normal = Vec3d::UnitZ();   // up
  std::vector<PolygonRing> rings;  // outer ones and holes, x and y of the world
  double area_m2 = 0;

  double z_at(const Vec2d& xy) const {
    return centroid.z() - normal.head<2>().dot(xy - centroid.head<2>()) / normal.z();
  }
  double tilt_deg() const;
};

struct Level {
  std::vector<LevelPiece> pieces;  // the largest first
  double z_m = 0;                  // mean over the area
  double area_m2 = 0;
  bool minor = false;
  LevelPlanes ids() const;
};

struct LevelPlanesOf {
  std::vector<Level> levels;       // from the lowest
  std::vector<LevelPiece> tilted;  // h, but not level
};
LevelPlanesOf levels_of(const CoveringPlanes& found,
                        const CoveringPlanes& minor,
                        const StairsOptions& options);

/// Axes on the ground: along is uphill, across to the left.
struct Heading {
  Vec2d along = Vec2d::UnitX();
  Vec2d across() const { return {-along.y(), along.x()}; }
  Vec2d place(double s, double t) const { return s * along + t * across(); }
};

struct Interval {
  double from = 0, to = 0;
};

/// Parallel to the heading through what is covered, one cut every kCutM.
inline constexpr double kCutM = 0.02;
struct Cuts {
  int first = 0;                           // cut k is at across = (first + k + 0.5) * kCutM
  std::vector<std::vector<Interval>> cut;  // in order, along the heading
  static double across(int index) { return (index + 0.5) * kCutM; }
  int end() const { return first + static_cast<int>(cut.size()); }
  std::span<const Interval> at(int index) const;  // of any index
};
/// Gaps of up to `close_m` are closed.
Cuts cuts_of(std::span<const PolygonRing> rings, const Heading& heading, double close_m);
Cuts cuts_of(const Level& level, const Heading& heading, double close_m);

/// The directions in which steps may lead up: in which many edges of levels, and planes that stand
/// upright, face. The strongest first, each with its opposite.
std::vector<Heading> headings_of(std::span<const Level> levels, const CoveringPlanes& found);

/// A tilted plane as a ramp; nothing where neither of its ends meets a level of that height.
std::optional<SlopingPlane> ramp_of(const LevelPiece& piece,
                                    std::span<const Level> levels,
                                    const StairsOptions& options);

}  // namespace planescope::planes
