#pragma once

// ROS 2 messages to publish or record: converts JSON with the fields of a message to CDR, by the
// message's definition, which MCAP files also contain.

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

/// The definition of a type followed by those of all types in it, in the form of MCAP's `ros2msg`
/// schemas (https://mcap.dev/spec/registry#ros2msg). Throws Error for types that planescope does
/// not write.
std::string ros_definition(const std::string& type);

/// The message as little-endian CDR (XCDR1). Fields missing from `json` are 0 or empty. Byte arrays
/// may be binary values. Throws Error that names a field of the wrong type or name.
RosMessage ros_message(const std::string& topic,
                       const std::string& type,
                       const nlohmann::ordered_json& json);

// JSON of nested messages.

/// Nanoseconds of a time; 0 for times before 1970.
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

/// Encoding of depth pixels: counts of any unit (16UC1), or meters (32FC1).
enum class DepthEncoding : std::uint8_t { counts, meters };

/// Images and camera infos on the topics of realsense-ros, and the pose of the color camera on
/// /tf_static if it is known.
std::vector<RosMessage> ros_camera(const Frame& frame,
                                   std::int64_t stamp_ns,
                                   DepthEncoding encoding);

}  // namespace planescope::io
