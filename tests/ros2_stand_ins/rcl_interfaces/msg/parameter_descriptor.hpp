#pragma once
// Stand-in for ROS 2 Humble's generated message.
// https://docs.ros.org/en/humble/p/rcl_interfaces/interfaces/msg/ParameterDescriptor.html

#include <cstdint>
#include <string>
#include <vector>

namespace rcl_interfaces::msg {
/// https://docs.ros.org/en/humble/p/rcl_interfaces/interfaces/msg/FloatingPointRange.html
struct FloatingPointRange {
  double from_value = 0, to_value = 0, step = 0;
};
/// https://docs.ros.org/en/humble/p/rcl_interfaces/interfaces/msg/IntegerRange.html
struct IntegerRange {
  std::int64_t from_value = 0, to_value = 0;
  std::uint64_t step = 0;
};
struct ParameterDescriptor {
  std::string name;
  std::uint8_t type = 0;
  std::string description, additional_constraints;
  bool read_only = false, dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;
  std::vector<IntegerRange> integer_range;
};
}  // namespace rcl_interfaces::msg
