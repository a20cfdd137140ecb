#pragma once

#include <string>

#include "core/io/bag/rosbag1.hpp"
#include "core/model/types.hpp"

namespace planescope::io {

/// What each topic of a bag is used for. Names are empty where there is no such topic.
struct BagLayout {
  std::string format;  // "RealSense SDK bag" or "realsense-ros bag"
  std::string device;
  std::string depth, depth_info;
  std::string color, color_info;
  bool color_aligned = false;
  bool has_extrinsics = false;
  Pose T_color_depth = Pose::Identity();
  std::string depth_unit;  // SDK option topic
  std::string accel;
  Mat3d R_depth_accel = Mat3d::Identity();
  std::vector<std::string> warnings;
};

/// Throws Error that lists the image topics found when there is none with depth.
BagLayout find_bag_layout(const rosbag1::Bag& bag);

}  // namespace planescope::io
