#pragma once
// Stand-in for rclcpp_components (Humble).

#include <memory>

#include "rclcpp_lifecycle/lifecycle_node.hpp"

/// Creates the registered component.
std::shared_ptr<rclcpp_lifecycle::LifecycleNode> make_component();

/// https://docs.ros.org/en/humble/p/rclcpp_components/generated/program_listing_file_include_rclcpp_components_register_node_macro.hpp.html
#define RCLCPP_COMPONENTS_REGISTER_NODE(NodeClass)                    \
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> make_component() { \
    return std::make_shared<NodeClass>(rclcpp::NodeOptions());        \
  }
