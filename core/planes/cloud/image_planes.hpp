#pragma once

#include <vector>

#include "core/model/frame.hpp"

namespace planescope::planes {

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
