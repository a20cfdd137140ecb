#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/bag/message_log.hpp"
#include "core/model/frame.hpp"
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

/// Gravity from the accelerometer samples recorded nearest to `time_ns`: at rest it measures the
/// reaction to gravity, so things fall along the negative of their mean. nullopt where there are
/// no samples or their mean is not near 1 g (shaken, or damaged). `accel` is sorted by time.
std::optional<Gravity> gravity_near(const MessageLog& bag,
                                    const std::vector<MessageRef>& accel,
                                    std::uint64_t time_ns,
                                    const Mat3d& R_depth_accel);

}  // namespace planescope::io
