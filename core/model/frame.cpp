#include "core/model/frame.hpp"

namespace planescope {

const char* to_string(Distortion distortion) {
  switch (distortion) {
    case Distortion::brown_conrady:
      return "brown_conrady";
    case Distortion::inverse_brown_conrady:
      return "inverse_brown_conrady";
    case Distortion::none:
      break;
  }
  return "none";
}

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
    case GravitySource::none:
      return "none";
  }
  return "unknown";
}

}  // namespace planescope
