#pragma once
// Stand-in for ROS 2 Humble's generated message.

#include <string>

namespace rcl_interfaces::msg {
/// https://docs.ros.org/en/humble/p/rcl_interfaces/interfaces/msg/SetParametersResult.html
struct SetParametersResult {
  bool successful = false;
  std::string reason;
};
}  // namespace rcl_interfaces::msg
