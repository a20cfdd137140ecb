#pragma once

// Messages of ROS 2 to publish or to record: JSON with the fields of a message becomes CDR by the
// message's definition, which MCAP files contain as well.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::io {

struct RosMessage {
  std::string topic;
  std::string type;  // "sensor_msgs/msg/Image"
  std::string cdr;
};

/// The definition of a type and, below it, of every type in it, as MCAP's `ros2msg` schemas have
/// them (https://mcap.dev/spec/registry#ros2msg). Throws Error for types that planescope does not
/// write.
std::string ros_definition(const std::string& type);

/// The message as CDR, little-endian (XCDR1). Fields that `json` lacks are 0 or empty. Arrays of
/// bytes may be binary values. Throws Error that names a field of another type or name.
RosMessage ros_message(const std::string& topic,
                       const std::string& type,
                       const nlohmann::ordered_json& json);

// JSON of messages inside others.

/// Nanoseconds of a time; those before 1970 are 0.
std::int64_t ros_stamp(double time_s);
nlohmann::ordered_json ros_header(std::int64_t stamp_ns, const std::string& frame_id);
nlohmann::ordered_json ros_point(const Vec3d& p);  // Point, Point32 and Vector3
nlohmann::ordered_json ros_transform(const Pose& pose);
nlohmann::ordered_json ros_pose(const Pose& pose);
nlohmann::ordered_json ros_bytes(const void* data, std::size_t size);

// ---- Messages of a camera ----

inline constexpr const char* kDepthFrame = "camera_depth_optical_frame";
inline constexpr const char* kColorFrame = "camera_color_optical_frame";

struct NamedPose {
  std::string parent, child;
  Pose T_parent_child = Pose::Identity();
};
/// tf2_msgs/msg/TFMessage.
RosMessage ros_transforms(const std::string& topic,
                          std::int64_t stamp_ns,
                          const std::vector<NamedPose>& poses);

/// How depth pixels are written: counts of any unit (16UC1), or meters (32FC1).
enum class DepthEncoding : std::uint8_t { counts, meters };

/// Images and cameras on the topics of realsense-ros. On /tf_static where the color camera is, if
/// that is known.
std::vector<RosMessage> ros_camera(const Frame& frame,
                                   std::int64_t stamp_ns,
                                   DepthEncoding encoding);

}  // namespace planescope::io
