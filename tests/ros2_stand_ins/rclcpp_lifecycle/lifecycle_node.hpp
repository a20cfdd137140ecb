#pragma once
// Stand-in for rclcpp_lifecycle (Humble).
// https://docs.ros.org/en/humble/p/rclcpp_lifecycle/generated/program_listing_file_include_rclcpp_lifecycle_lifecycle_node.hpp.html

#include <map>

#include "rclcpp/rclcpp.hpp"

namespace rclcpp_lifecycle {
/// https://docs.ros.org/en/humble/p/rclcpp_lifecycle/generated/classrclcpp__lifecycle_1_1State.html
class State {};

class LifecycleNode {
 public:
  /// https://docs.ros.org/en/humble/p/rclcpp_lifecycle/generated/classrclcpp__lifecycle_1_1node__interfaces_1_1LifecycleNodeInterface.html
  enum class CallbackReturn : std::uint8_t { SUCCESS, FAILURE, ERROR };
  using OnSetParametersCallbackHandle = rclcpp::node_interfaces::OnSetParametersCallbackHandle;
  using OnParametersSetCallbackType = std::function<rcl_interfaces::msg::SetParametersResult(
      const std::vector<rclcpp::Parameter>&)>;

  explicit LifecycleNode(const std::string&, const rclcpp::NodeOptions&) {}
  virtual ~LifecycleNode() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State& state) { return on_configure(state); }
  virtual CallbackReturn on_shutdown(const State& state) { return on_configure(state); }
  virtual CallbackReturn on_activate(const State& state) { return on_configure(state); }
  virtual CallbackReturn on_deactivate(const State& state) { return on_configure(state); }

  rclcpp::Logger get_logger() const { return logger_; }
  rclcpp::Clock::SharedPtr get_clock() { return clock_; }
  rclcpp::node_interfaces::NodeTopicsInterface::SharedPtr get_node_topics_interface() {
    return topics_;
  }
  const rclcpp::ParameterValue& declare_parameter(
      const std::string& name,
      const rclcpp::ParameterValue& default_value,
      const rcl_interfaces::msg::ParameterDescriptor& descriptor,
      bool /*ignore_override*/ = false) {
    descriptors_[name] = descriptor;
    return values_.emplace(name, default_value).first->second;
  }
  rclcpp::Parameter get_parameter(const std::string& name) const {
    return {name, values_.at(name)};
  }
  rcl_interfaces::msg::ParameterDescriptor describe_parameter(const std::string& name) const {
    return descriptors_.at(name);
  }
  OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(
      OnParametersSetCallbackType callback) {
    on_set_ = std::move(callback);
    return std::make_shared<OnSetParametersCallbackHandle>();
  }
  rcl_interfaces::msg::SetParametersResult set_parameter(const rclcpp::Parameter& parameter) {
    const auto result = on_set_({parameter});
    if (result.successful)
      values_.insert_or_assign(parameter.get_name(), parameter.get_parameter_value());
    return result;
  }

 private:
  rclcpp::Logger logger_;
  rclcpp::Clock::SharedPtr clock_ = std::make_shared<rclcpp::Clock>();
  rclcpp::node_interfaces::NodeTopicsInterface::SharedPtr topics_ =
      std::make_shared<rclcpp::node_interfaces::NodeTopicsInterface>();
  std::map<std::string, rclcpp::ParameterValue> values_;
  std::map<std::string, rcl_interfaces::msg::ParameterDescriptor> descriptors_;
  OnParametersSetCallbackType on_set_;
};
}  // namespace rclcpp_lifecycle
