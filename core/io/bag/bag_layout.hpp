#pragma once

#include <string>

#include "core/io/bag/message_log.hpp"
#include "core/model/types.hpp"

namespace planescope::io {

/// What each topic of a recording is used for. Names are empty where there is no such topic.
struct BagLayout {
  std::string format;   // "RealSense SDK bag", "realsense-ros ROS 2 bag (MCAP)", ...
  bool is_sdk = false;  // else realsense-ros
  std::string device;
  std::string depth, depth_info;
  std::string color, color_info;
  bool color_aligned = false;
  bool has_extrinsics = false;
  Pose T_color_depth = Pose::Identity();
  std::string depth_unit;      // SDK option topic
  std::string depth_metadata;  // SDK texts beside each depth image
  std::string accel;
  Mat3d R_depth_accel = Mat3d::Identity();
  std::vector<std::string> warnings;
};

/// Throws Error that lists the image topics found when there is none with depth.
BagLayout find_bag_layout(const MessageLog& bag);

}  // namespace planescope::io
