#pragma once

// Planes for ROS 2 without linking ROS: serialized messages in, serialized messages out. The node
// in packaging/ros2/planescope_ros subscribes and publishes.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // planescope itself has types of the same names
namespace v0 {
#else
inline namespace v0 {
#endif

/// A published topic: the node's "planes", "markers" and "points", and "/tf".
struct RosTopic {
  std::string name;
  std::string type;  // "visualization_msgs/msg/MarkerArray"
};

struct RosMessage {
  RosTopic topic;
  std::vector<std::uint8_t> cdr;
};

/// Finds planes in depth images of one camera, as `planescope segment -o X.mcap` does.
class PLANESCOPE_API RosSegmenter {
 public:
  /// `world_frame`: the upright coordinate frame with its origin at the camera.
  explicit RosSegmenter(const Options& options = Options(),
                        int threads = 1,
                        const std::string& world_frame = "planescope_world");

  static std::vector<RosTopic> topics();

  /// sensor_msgs/msg/CameraInfo of the depth images. Throws Error if it is damaged, has no focal
  /// length, or has a distortion that planescope does not support.
  void set_camera_info(View<std::uint8_t> cdr);
  bool has_camera_info() const;
  /// Keeps the camera. Throws Error like Segmenter's constructor.
  void set_options(const Options& options, int threads = 1);

  /// Segments a sensor_msgs/msg/Image: 16UC1 or mono16 [mm], or 32FC1 [m], stored like
  /// DepthImage::meters. Returns messages with the image's stamp, on the topics that `wanted`
  /// accepts; null: all topics. Throws Error if there is no camera, it does not fit the image, or
  /// the image is damaged.
  std::vector<RosMessage> segment(
      View<std::uint8_t> cdr, const std::function<bool(const RosTopic&)>& wanted = nullptr) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace v0
}  // namespace planescope
