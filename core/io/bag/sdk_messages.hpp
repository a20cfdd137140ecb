#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/bag/ros_messages.hpp"

namespace planescope::io::ros {

// What the RealSense SDK says of its streams: in messages of ROS 1, or in ROS 2 in texts such as
// "width=640;height=480;fx=390.4". Every function takes either, and throws OutOfBytes where the
// message ends early or does not hold what it should.

CameraInfo parse_sdk_camera_info(const Message& message);
/// The depth unit [m].
double parse_sdk_option(const Message& message);
/// T_stream_reference.
Pose parse_sdk_extrinsics(const Message& message);
/// The value of `key` in a message about the device; nullopt where it is about another.
std::optional<std::string> parse_sdk_info(const Message& message, const std::string& key);

/// What the SDK writes beside every frame in ROS 2.
struct SdkFrameFacts {
  std::optional<std::string> number;
  std::optional<double> timestamp_s;  // in the camera's clock
  std::optional<double> depth_unit_m;
};
SdkFrameFacts parse_sdk_metadata(const Message& message);

}  // namespace planescope::io::ros
