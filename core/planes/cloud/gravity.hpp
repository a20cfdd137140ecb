#pragma once

// The direction of gravity: given, carried by the frame, picked, or estimated from the scene.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope::planes {

enum class GravityMode : std::uint8_t { automatic, fixed, imu, estimate, none };

struct GravityOptions {
  GravityMode mode = GravityMode::automatic;
  Vec3d direction = Vec3d(0, 1, 0);  // for `fixed`, sensor frame, any length > 0
  double max_tilt_deg = 60;  // prior of the estimate: camera tilt (pitch or roll) stays below
  bool none_where_unknown = false;  // where gravity cannot be told: go without, instead of refusing
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = GravityOptions;
    rows.number("gravity_max_tilt_deg", "Largest camera tilt", "deg",
                "Largest camera tilt that the gravity estimate allows", &O::max_tilt_deg,
                {0, 90, true});
  }
};

/// Parses auto | X,Y,Z | imu | estimate | none. Throws Error on anything else.
GravityOptions parse_gravity(const std::string& text);

/// Orthogonal-structure vote over plane normals under the camera-tilt prior of `options`
/// (depth frames only). nullopt where the scene does not tell.
std::optional<Gravity> estimate_gravity(const Frame& frame, const GravityOptions& options);

/// Takes the first that exists: option; what the frame carries (sidecar, IMU, a floor that was
/// picked, a neighbor's); the estimate, for clouds -z, assumed. Throws Error that says why even the
/// estimate fails and how to give gravity, unless the options go without. `max_range_m`: of the
/// points that are kept, so that a wrong depth unit is recognized; 0: not known.
Gravity resolve_gravity(const Frame& frame, const GravityOptions& options, double max_range_m = 0);

/// A warning about a given direction (sensor frame): a confident estimate from the scene differs by
/// more than 20 degrees. Empty if not, and for clouds.
std::string doubt_in_gravity(const Frame& frame,
                             const Vec3d& given,
                             const GravityOptions& options = {});

/// The direction of a frame whose gravity is not known, with source `none`: things are taken to
/// fall to the lower edge of the image, along -z of a cloud. `why` goes into the note.
Gravity unknown_gravity(const Frame& frame, const std::string& why);

/// What tells h from v where gravity is not known, as a hint for people.
inline constexpr const char* kHowToGiveGravity =
    "give the direction in which things fall, in the sensor's frame, with --gravity X,Y,Z, or "
    "click "
    "a floor in planescope view";

// What a click on a floor or on a wall says of gravity. Normals are unit and face the sensor; all
// is in the sensor's (or cloud's own) frame.

/// Things fall against the normal of a floor that is seen from above.
Vec3d gravity_of_floor(const Vec3d& normal);

/// Walls stand upright: gravity is perpendicular to all their normals. One wall leaves an angle
/// open, which `before` closes: the direction known so far, or the camera's own. Several are taken
/// by least squares, and `before` only tells up from down. nullopt, with a phrase why, where the
/// wall lies level by what is known, or all walls are parallel.
std::optional<Vec3d> gravity_of_walls(std::span<const Vec3d> normals,
                                      const Vec3d& before,
                                      std::string* why_not = nullptr);

/// A large plane of a depth image, for finding out which way is down (not for segmentation).
struct ImagePlane {
  Vec3d normal = Vec3d::UnitZ();   // unit, sensor frame, towards the sensor
  Vec3d centroid = Vec3d::Zero();  // [m], sensor frame
  double area_m2 = 0;              // of the surface, not of its picture
  double nearest_m = 0;            // depth of its part nearest to the sensor
  double angle_sigma_deg = 0;      // uncertainty of the normal
  int pixels = 0;
};

/// Grows planes over small patches of the whole image, whatever the range. Fits are made in inverse
/// depth, which is linear on a plane's picture and, for stereo, equally noisy at any range.
/// Largest area first.
std::vector<ImagePlane> find_image_planes(const Frame& frame);

}  // namespace planescope::planes
