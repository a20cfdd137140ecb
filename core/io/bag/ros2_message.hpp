#pragma once

#include <string>

#include "core/io/bag/message_log.hpp"

namespace planescope::io::rosbag2 {

/// The message that bytes of a ROS 2 container hold. They may be a zstd frame: `ros2 bag` says so
/// in metadata.yaml, the RealSense SDK nowhere. Throws Error that begins with `what` where that is
/// damaged.
Message cdr_message(std::shared_ptr<const std::vector<std::byte>> held,
                    Bytes bytes,
                    std::size_t at_most,
                    const std::string& what);

/// Tells of topics that are left out, by how they are serialized.
void warn_of_encodings(const std::map<std::string, int>& topics,
                       std::vector<std::string>& warnings);

/// A type as ROS 1 calls it: "sensor_msgs/Image" for "sensor_msgs/msg/Image".
std::string ros_type(std::string type);

}  // namespace planescope::io::rosbag2
