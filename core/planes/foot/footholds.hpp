#pragma once

// Footholds: how accurately each plane is known, its surface properties, and where the center of a
// foot can be placed.

#include <optional>
#include <string>
#include <vector>

#include "core/planes/foot/places.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/options.hpp"

namespace planescope::planes {

/// Uncertainty of a plane. The true plane is modeled as normal + a axes[0] + b axes[1], offset by d
/// along the normal at the centroid. The errors a, b and d are independent.
struct Certainty {
  double sigma_m = 0;                    // standard deviation of the measurements about the plane
  Vec3d eigenvalues_m2 = Vec3d::Zero();  // of the scatter, ascending; the first is e_n in the paper
  Vec3d axes[2] = {Vec3d::UnitX(), Vec3d::UnitY()};  // unit, in the plane, longer extent first
  double sigma_tilt_rad[2] = {0, 0};                 // of a and b
  double sigma_offset_m = 0;                         // of d

  /// Covariance of (a, b, offset), where the plane is normal . x = offset and its centroid
  /// is `centroid`.
  Mat3d covariance(const Vec3d& centroid) const;
};

/// One per plane, by id - 1. `against_truth` includes the sensor's low-frequency error; without it,
/// the result is what differs between frames of a recording, by which tracks compare planes.
std::vector<Certainty> certainties_of(const FrameResult& result, bool against_truth = true);

struct Surface {
  double slope_deg = 0;     // angle from the horizontal; NaN if gravity is unknown
  double rough_rms_m = 0;   // RMS height of grid cells above the mean of the cells within 5 cm
  double rough_step_m = 0;  // 95th percentile of the steps between neighboring cells
  double support = 0;       // 0..1: share of the pixels within its outline that belong to it,
                            // ignoring pixels that see something else; for clouds and at grazing
                            // angles, share of grid cells
  Vec3d best_place = Vec3d::Zero();  // farthest from borders and holes of the outline; world [m]
  double clearance_m = 0;            // distance of best_place from them
};

/// One per plane, by id - 1; `outlines` and `places` likewise.
std::vector<Surface> surfaces_of(const Frame& frame,
                                 const FrameResult& result,
                                 const std::vector<Outline>& outlines,
                                 const std::vector<Places>& places);

struct FootSpace {
  Polygons area;  // allowed positions of the foot's center, as valid polygons in the
                  // outline's plane coordinates
  double area_m2 = 0;
  std::vector<PolygonRing> pieces;  // convex_pieces() of the area
};

/// Free space for the foot's center: the outline without uneven areas, inset by the foot's radius
/// and margin. Holes where something else was seen are obstacles of any size. Unmeasured holes are
/// ignored if small enough to step over.
FootSpace foot_space(const Outline& outline, const Places& places, const FootOptions& options);

struct Foothold {
  Surface surface;
  Certainty certainty;
  std::vector<Vec2d> cut;  // measured profile along the first axis through the centroid: pairs of
                           // distance along the axis and height above the plane [m], sorted
  std::optional<FootSpace> space;  // this and the following only if foot options are set
  bool steppable = false;
  std::string why_not;  // "17 mm rough, limit 10; slope 31.0 deg, limit 25.0"; empty: steppable
};

/// One per plane, by id - 1; `outlines` likewise.
std::vector<Foothold> footholds_of(const Frame& frame,
                                   const FrameResult& result,
                                   const std::vector<Outline>& outlines,
                                   double cell_m,
                                   const FootOptions& options);

}  // namespace planescope::planes
