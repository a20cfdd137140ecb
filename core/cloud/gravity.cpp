#include "core/cloud/gravity.hpp"

#include <cmath>
#include <sstream>

#include "core/base/error.hpp"

namespace planescope {

const char* to_string(GravitySource source) {
  switch (source) {
    case GravitySource::option:
      return "option";
    case GravitySource::sidecar:
      return "sidecar";
    case GravitySource::imu:
      return "imu";
    case GravitySource::picked:
      return "picked";
    case GravitySource::estimate:
      return "estimate";
    case GravitySource::assumed:
      return "assumed";
  }
  return "unknown";
}

GravityOptions parse_gravity(const std::string& text) {
  GravityOptions options;
  if (text == "auto") return options;
  if (text == "imu") {
    options.mode = GravityMode::imu;
    return options;
  }
  if (text == "estimate") {
    options.mode = GravityMode::estimate;
    return options;
  }
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  Vec3d direction;
  char comma1 = 0, comma2 = 0, rest = 0;
  in >> direction.x() >> comma1 >> direction.y() >> comma2 >> direction.z();
  if (in.fail() || comma1 != ',' || comma2 != ',' || in >> rest || !direction.allFinite() ||
      !(direction.norm() > 0))
    throw Error("gravity is \"" + text +
                "\", expected auto, imu, estimate or a direction X,Y,Z that is not zero");
  options.mode = GravityMode::fixed;
  options.direction = direction;
  return options;
}

Gravity resolve_gravity(const Frame& frame, const GravityOptions& options) {
  const std::string give_one =
      "; give the direction in which things fall, in the sensor's frame, with --gravity X,Y,Z";
  if (options.mode == GravityMode::fixed) {
    Gravity gravity;
    // Scaled first: the squares of a tiny direction must not vanish.
    const Vec3d scaled = options.direction / options.direction.cwiseAbs().maxCoeff();
    if (!scaled.allFinite()) throw Error("gravity is not a direction: expected X,Y,Z not all zero");
    gravity.direction = scaled.normalized();
    gravity.source = GravitySource::option;
    gravity.note = "given by the user";
    return gravity;
  }
  if (options.mode == GravityMode::imu) {
    if (frame.gravity && frame.gravity->source == GravitySource::imu) return *frame.gravity;
    throw Error("frame " + frame.name + ": the recording has no accelerometer data" + give_one);
  }
  if (options.mode == GravityMode::automatic) {
    if (frame.gravity) return *frame.gravity;
    if (frame.is_cloud()) {
      Gravity gravity;
      gravity.direction = -Vec3d::UnitZ();
      gravity.source = GravitySource::assumed;
      gravity.note = "assumed: the cloud's z axis points up";
      return gravity;
    }
  }
  if (frame.is_cloud())
    throw Error("frame " + frame.name + ": gravity is estimated from depth images only" + give_one);
  if (const auto estimate = estimate_gravity(frame, options)) return *estimate;
  throw Error("frame " + frame.name + ": gravity cannot be told from the scene" + give_one);
}

}  // namespace planescope
