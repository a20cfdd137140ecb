#pragma once

#include "core/model/plane.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {

/// The normal on the side that is shown: floors look up, walls look at the sensor.
inline Vec3d outward_normal(const PlaneFit& fit, Label label, const Vec3d& sensor) {
  const double side = label == Label::h ? fit.normal.z() : fit.normal.dot(sensor - fit.centroid);
  return side < 0 ? Vec3d(-fit.normal) : fit.normal;
}

}  // namespace planescope::planes
