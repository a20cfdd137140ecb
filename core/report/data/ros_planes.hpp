#pragma once

// A frame's planes as ROS 2 messages: for programs, for RViz and Foxglove, and as lines of JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/io/ros_message.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::report {

/// Time and pose of a frame, and the coordinate frames of its messages.
struct RosPlace {
  std::int64_t stamp_ns = 0;
  std::string camera = io::kDepthFrame;
  std::string world = "planescope_world";  // z up, the sensor at its origin; for clouds, their own
  std::string map = {};                    // the root; empty: other programs locate the camera
  Pose T_map_camera = Pose::Identity();
};

/// "planes", "markers", "points", and "/tf".
struct RosTopic {
  const char* name;
  const char* type;
  io::RosMessage (*message)(const Frame&,
                            const planes::FrameResult&,
                            const planes::FramePlanes&,
                            const RosPlace&);
};
const std::vector<RosTopic>& ros_topics();

/// planescope_msgs/PlaneArray with all its fields.
nlohmann::ordered_json plane_array(const Frame& frame,
                                   const planes::FrameResult& result,
                                   const planes::FramePlanes& found,
                                   const RosPlace& place);

/// A plane for markers.
struct MarkedPlane {
  int id = 0;
  std::uint32_t hue = 0;  // 0xRRGGBB
  std::string name, frame_id;
  Vec3d normal = Vec3d::UnitZ(), at = Vec3d::Zero();  // position of name and normal
  const planes::Outline* outline = nullptr;
};
/// visualization_msgs/msg/MarkerArray of the planes of a map.
io::RosMessage ros_map_markers(const std::string& topic,
                               std::int64_t stamp_ns,
                               const std::vector<MarkedPlane>& planes);

/// A camera's trajectory: nav_msgs/msg/Path.
struct RosPose {
  std::int64_t stamp_ns = 0;
  Pose T_map_camera = Pose::Identity();
};
io::RosMessage ros_path(const std::string& topic,
                        const std::string& map,
                        const std::vector<RosPose>& poses);

}  // namespace planescope::report
