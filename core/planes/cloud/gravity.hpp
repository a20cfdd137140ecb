#pragma once

// Direction of gravity: specified, recorded with the frame, picked, or estimated from the scene.

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
  Vec3d direction = Vec3d(0, 1, 0);  // for `fixed`: sensor frame, any length > 0
  double max_tilt_deg = 60;          // limit on the camera tilt (pitch or roll) of an estimate
  bool none_where_unknown = false;   // continue without gravity if it is unknown, instead
                                     // of throwing
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = GravityOptions;
    rows.number("gravity_max_tilt_deg", "Maximum camera tilt", "deg",
                "Maximum camera tilt that the gravity estimate allows", &O::max_tilt_deg,
                {0, 90, true});
  }
};

/// Parses auto | X,Y,Z | imu | estimate | none. Throws Error on anything else.
GravityOptions parse_gravity(const std::string& text);

/// Votes over plane normals, assuming orthogonal structure and the camera-tilt prior of `options`
/// (depth frames only). nullopt if the scene is ambiguous.
std::optional<Gravity> estimate_gravity(const Frame& frame, const GravityOptions& options);

/// Returns gravity from the first available source: the option; the frame (sidecar, IMU, a picked
/// floor, a neighboring frame); the estimate, or for clouds -z (assumed). Throws Error with the
/// reason and how to specify gravity, unless `options` permit unknown gravity. `max_range_m`: range
/// of the kept points, to detect a wrong depth unit; 0 if unknown.
Gravity resolve_gravity(const Frame& frame, const GravityOptions& options, double max_range_m = 0);

/// A warning about a given direction (sensor frame): a confident estimate from the scene differs by
/// more than 20 degrees. Empty if not, and for clouds.
std::string doubt_in_gravity(const Frame& frame,
                             const Vec3d& given,
                             const GravityOptions& options = {});

/// Assumed direction for a frame with unknown gravity (source `none`): the lower edge of the image,
/// or -z of a cloud. `why` becomes the note.
Gravity unknown_gravity(const Frame& frame, const std::string& why);

/// User hint: how to specify gravity.
inline constexpr const char* kHowToGiveGravity =
    "specify the downward direction in the sensor's frame with --gravity X,Y,Z, "
    "or click a floor in planescope view";

// Gravity from picked floors and walls. Normals have unit length and face the sensor; all vectors
// are in the sensor's (or cloud's) frame.

/// Gravity opposes the normal of a floor seen from above.
Vec3d gravity_of_floor(const Vec3d& normal);

/// Gravity is perpendicular to all wall normals. With one wall, `before` (the direction known so
/// far, or the camera's own) fixes the remaining angle. Several walls are fitted by least squares,
/// and `before` only distinguishes up from down. Returns nullopt and a reason if the wall is nearly
/// level according to `before`, or if all walls are parallel.
std::optional<Vec3d> gravity_of_walls(std::span<const Vec3d> normals,
                                      const Vec3d& before,
                                      std::string* why_not = nullptr);

/// A large plane of a depth image, used to estimate gravity (not for segmentation).
struct ImagePlane {
  Vec3d normal = Vec3d::UnitZ();   // unit length, sensor frame, toward the sensor
  Vec3d centroid = Vec3d::Zero();  // [m], sensor frame
  double area_m2 = 0;              // surface area, not image area
  double nearest_m = 0;            // depth of its nearest part
  double angle_sigma_deg = 0;      // uncertainty of the normal
  int pixels = 0;
};

/// Grows planes over small patches of the whole image, at any range. Planes are fitted in inverse
/// depth, which is linear across a plane's image and, for stereo, equally noisy at any range.
/// Largest area first.
std::vector<ImagePlane> find_image_planes(const Frame& frame);

}  // namespace planescope::planes
