#pragma once

// Planes for ROS 2 without ROS: serialized messages in, serialized messages out. The node of
// packaging/ros2/planescope_ros subscribes and publishes.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "planescope/core.hpp"

namespace planescope {
#ifdef PLANESCOPE_LIBRARY_SOURCE  // which has types of the same names, in planescope itself
namespace v0 {
#else
inline namespace v0 {
#endif

/// A topic that is published: "planes", "markers" and "points" of the node, and "/tf".
struct RosTopic {
  std::string name;
  std::string type;  // "visualization_msgs/msg/MarkerArray"
};

struct RosMessage {
  RosTopic topic;
  std::vector<std::uint8_t> cdr;
};

/// Depth images of one camera become planes. Results are those of `planescope segment -o X.mcap`.
class PLANESCOPE_API RosSegmenter {
 public:
  /// `world_frame`: the upright coordinate frame with its origin at the camera.
  explicit RosSegmenter(const Options& options = Options(),
                        int threads = 1,
                        const std::string& world_frame = "planescope_world");

  static std::vector<RosTopic> topics();

  /// sensor_msgs/msg/CameraInfo of the depth images. Throws Error if it is damaged, has no focal
  /// length or a distortion that planescope does not support.
  void set_camera_info(View<std::uint8_t> cdr);
  bool has_camera_info() const;
  /// Keeps the camera. Throws Error as Segmenter does.
  void set_options(const Options& options, int threads = 1);

  /// sensor_msgs/msg/Image: 16UC1 or mono16 [mm], or 32FC1 [m], which is stored as
  /// DepthImage::meters are. The messages, with the stamp of the image, on the topics that `wanted`
  /// chooses; null: all. Throws Error if there is no camera, it does not fit the image, or the
  /// image is damaged.
  std::vector<RosMessage> segment(
      View<std::uint8_t> cdr, const std::function<bool(const RosTopic&)>& wanted = nullptr) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace v0
}  // namespace planescope
