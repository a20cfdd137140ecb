#pragma once

// Planes to set a foot on: how well a plane is known, what it is like to stand on, and where the
// center of a foot may go.

#include <optional>
#include <string>
#include <vector>

#include "core/planes/foot/places.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/options.hpp"

namespace planescope::planes {

/// A true plane is taken to be normal + a axes[0] + b axes[1], and d along the normal from the
/// centroid: these three are independent of each other.
struct Certainty {
  double sigma_m = 0;                    // of the measurements about the plane
  Vec3d eigenvalues_m2 = Vec3d::Zero();  // of the scatter, ascending; the first is the paper's e_n
  Vec3d axes[2] = {Vec3d::UnitX(), Vec3d::UnitY()};  // unit, in the plane: the longer extent first
  double sigma_tilt_rad[2] = {0, 0};                 // of a and b
  double sigma_offset_m = 0;                         // of d

  /// Of (a, b, offset), where the plane is normal . x = offset and its centroid is `centroid`.
  Mat3d covariance(const Vec3d& centroid) const;
};

/// One for each plane, by id - 1. Not `against_truth`: of what differs between frames of a
/// recording, which share some of the sensor's low-frequency error; tracks compare planes by that.
std::vector<Certainty> certainties_of(const FrameResult& result, bool against_truth = true);

struct Surface {
  double slope_deg = 0;     // against the horizontal; NaN: gravity is not known
  double rough_rms_m = 0;   // of how high its places are above the mean of those within 5 cm
  double rough_step_m = 0;  // 95th percentile of the steps between neighbouring places
  double support = 0;       // pixels on it, of those within its outline that see nothing else; of
                            // clouds, and where rays graze it, places; 0..1
  Vec3d best_place = Vec3d::Zero();  // farthest from the outline's borders and holes; world [m]
  double clearance_m = 0;            // how far
};

/// One for each plane, by id - 1; `outlines` and `places` likewise.
std::vector<Surface> surfaces_of(const Frame& frame,
                                 const FrameResult& result,
                                 const std::vector<Outline>& outlines,
                                 const std::vector<Places>& places);

struct FootSpace {
  Polygons area;  // of the foot's centre, on the plane as the outline has it; valid
  double area_m2 = 0;
  std::vector<PolygonRing> pieces;  // convex_pieces() of it
};

/// The outline without what is not flat, inset by the foot's radius and margin. Holes where
/// something else was seen are kept off however small: what was seen there is an obstacle. Of those
/// where nothing was, small ones are stepped over.
FootSpace foot_space(const Outline& outline, const Places& places, const FootOptions& options);

struct Foothold {
  Surface surface;
  Certainty certainty;
  std::vector<Vec2d> cut;  // measured places along the first of its axes, through the centroid:
                           // how far from it, how high above the plane [m], in that order
  std::optional<FootSpace> space;  // where a foot is given, as are the following
  bool steppable = false;
  std::string why_not;  // "17 mm rough, limit 10; slope 31.0 deg, limit 25.0"; empty: steppable
};

/// One for each plane, by id - 1; `outlines` likewise.
std::vector<Foothold> footholds_of(const Frame& frame,
                                   const FrameResult& result,
                                   const std::vector<Outline>& outlines,
                                   double cell_m,
                                   const FootOptions& options);

}  // namespace planescope::planes
