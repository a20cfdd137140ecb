#pragma once

// Walkable planes, grouped into levels, and cuts through them. Internal to core/planes/stairs.

#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/planes/stairs/stairs.hpp"

namespace planescope::planes {

inline constexpr double kDegrees = 180 / std::numbers::pi;  // degrees per radian

/// A plane and its outline, seen from above.
struct LevelPiece {
  int id = 0;
  Vec3d centroid = Vec3d::Zero();
  Vec3d normal = Vec3d::UnitZ();   // upward
  std::vector<PolygonRing> rings;  // outer rings and holes, world x and y
  double area_m2 = 0;

  double z_at(const Vec2d& xy) const {
    return centroid.z() - normal.head<2>().dot(xy - centroid.head<2>()) / normal.z();
  }
  double tilt_deg() const;
};

struct Level {
  std::vector<LevelPiece> pieces;  // largest first
  double z_m = 0;                  // area-weighted mean height
  double area_m2 = 0;
  bool minor = false;
  LevelPlanes ids() const;
};

struct LevelPlanesOf {
  std::vector<Level> levels;       // lowest first
  std::vector<LevelPiece> tilted;  // h, but not level
};
LevelPlanesOf levels_of(const CoveringPlanes& found,
                        const CoveringPlanes& minor,
                        const StairsOptions& options);

/// Horizontal axes: `along` is uphill, `across` to the left.
struct Heading {
  Vec2d along = Vec2d::UnitX();
  Vec2d across() const { return {-along.y(), along.x()}; }
  Vec2d place(double s, double t) const { return s * along + t * across(); }
};

struct Interval {
  double from = 0, to = 0;
};

/// Cuts parallel to the heading through an area, one every kCutM.
inline constexpr double kCutM = 0.02;
struct Cuts {
  int first = 0;                           // cut k is at across = (first + k + 0.5) * kCutM
  std::vector<std::vector<Interval>> cut;  // sorted, along the heading
  static double across(int index) { return (index + 0.5) * kCutM; }
  int end() const { return first + static_cast<int>(cut.size()); }
  std::span<const Interval> at(int index) const;  // any index is valid
};
/// Closes gaps of up to `close_m`.
Cuts cuts_of(std::span<const PolygonRing> rings, const Heading& heading, double close_m);
Cuts cuts_of(const Level& level, const Heading& heading, double close_m);

/// Candidate directions of ascent: directions faced by many edges of levels, or by upright planes.
/// Strongest first, each followed by its opposite.
std::vector<Heading> headings_of(std::span<const Level> levels, const CoveringPlanes& found);

/// Converts a tilted plane to a ramp; nullopt if neither end meets a level of the same height.
std::optional<SlopingPlane> ramp_of(const LevelPiece& piece,
                                    std::span<const Level> levels,
                                    const StairsOptions& options);

}  // namespace planescope::planes
