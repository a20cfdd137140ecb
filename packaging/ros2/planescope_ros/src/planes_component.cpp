// Lifecycle node and component: depth images in; planes, markers, points and /tf out. This file has
// the subscriptions, publishers and parameters. planescope::RosSegmenter, which needs no ROS,
// processes the messages.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <planescope/ros.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace planescope_ros {
namespace {

constexpr int kLogPeriod_ms = 5000;
constexpr std::int64_t kMostThreads = 256;

rcl_interfaces::msg::ParameterDescriptor descriptor(const planescope::OptionInfo& option) {
  using planescope::OptionKind;
  rcl_interfaces::msg::ParameterDescriptor result;
  result.name = option.name;
  result.description = option.meaning;
  if (!option.unit.empty()) result.description += " [" + option.unit + "]";
  if (option.kind == OptionKind::choice) {
    for (const std::string& choice : option.choices)
      result.additional_constraints +=
          (result.additional_constraints.empty() ? "one of " : ", ") + choice;
  } else if (option.kind == OptionKind::whole && std::isfinite(option.max)) {
    rcl_interfaces::msg::IntegerRange range;
    range.from_value = static_cast<std::int64_t>(option.min);
    range.to_value = static_cast<std::int64_t>(option.max);
    range.step = 1;
    result.integer_range.push_back(range);
  } else if (option.kind == OptionKind::number && std::isfinite(option.max)) {
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value = option.min;
    range.to_value = option.max;
    result.floating_point_range.push_back(range);
  }
  if (option.kind == OptionKind::number || option.kind == OptionKind::whole) {
    std::ostringstream constraints;  // those that a range cannot express
    if (option.min_excluded)
      constraints << "above " << option.min;
    else if (!std::isfinite(option.max))
      constraints << "at least " << option.min;
    result.additional_constraints = constraints.str();
  }
  return result;
}

/// Default value of an option, as a parameter value of the same type.
rclcpp::ParameterValue default_value(const planescope::OptionInfo& option) {
  switch (option.kind) {
    case planescope::OptionKind::number:
      return rclcpp::ParameterValue(std::stod(option.refined));
    case planescope::OptionKind::whole:
      return rclcpp::ParameterValue(static_cast<std::int64_t>(std::stoll(option.refined)));
    case planescope::OptionKind::on_off:
      return rclcpp::ParameterValue(option.refined == "on");
    default:
      return rclcpp::ParameterValue(option.refined);
  }
}

/// Sets the option with the parameter's name to its value.
void set_option(planescope::Options& options, const rclcpp::Parameter& parameter) {
  const std::string& name = parameter.get_name();
  switch (parameter.get_type()) {
    case rclcpp::ParameterType::PARAMETER_DOUBLE:
      options.set(name, parameter.as_double());
      break;
    case rclcpp::ParameterType::PARAMETER_INTEGER:
      options.set(name, std::to_string(parameter.as_int()));
      break;
    case rclcpp::ParameterType::PARAMETER_BOOL:
      options.set(name, parameter.as_bool() ? "on" : "off");
      break;
    default:
      options.set(name, parameter.as_string());
  }
}

planescope::View<std::uint8_t> bytes_of(const rclcpp::SerializedMessage& message) {
  const auto& raw = message.get_rcl_serialized_message();
  return {raw.buffer, raw.buffer_length};
}

}  // namespace

class PlanesNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  explicit PlanesNode(const rclcpp::NodeOptions& options)
      : LifecycleNode("planescope", options), options_(planescope::Options::all()) {
    rcl_interfaces::msg::ParameterDescriptor fixed;
    fixed.read_only = true;
    fixed.description = "Upright coordinate frame with its origin at the camera";
    declare_parameter("world_frame", rclcpp::ParameterValue("planescope_world"), fixed);
    rcl_interfaces::msg::ParameterDescriptor threads;
    threads.description = "Threads for one image; results do not depend on it";
    rcl_interfaces::msg::IntegerRange range;
    range.from_value = 1;
    range.to_value = kMostThreads;
    range.step = 1;
    threads.integer_range.push_back(range);
    declare_parameter("threads", rclcpp::ParameterValue(2), threads);
    for (const planescope::OptionInfo& option : options_)
      declare_parameter(option.name, default_value(option), descriptor(option));
    on_set_ = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter>& changed) { return on_parameters(changed); });
  }

 private:
  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    try {
      segmenter_.emplace(chosen_options({}), chosen_threads({}),
                         get_parameter("world_frame").as_string());
    } catch (const planescope::Error& error) {
      RCLCPP_ERROR(get_logger(), "%s", error.what());
      return CallbackReturn::FAILURE;
    }
    for (const planescope::RosTopic& topic : planescope::RosSegmenter::topics()) {
      const bool is_global = topic.name.front() == '/';
      publishers_.emplace_back(
          topic.name, rclcpp::create_generic_publisher(get_node_topics_interface(),
                                                       is_global ? topic.name : "~/" + topic.name,
                                                       topic.type, rclcpp::QoS(10)));
    }
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override {
    info_ = subscribe("depth/camera_info", "sensor_msgs/msg/CameraInfo",
                      [this](const rclcpp::SerializedMessage& message) {
                        segmenter_->set_camera_info(bytes_of(message));
                      });
    image_ = subscribe("depth/image", "sensor_msgs/msg/Image",
                       [this](const rclcpp::SerializedMessage& message) { on_image(message); });
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) override {
    image_.reset();
    info_.reset();
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_cleanup(const rclcpp_lifecycle::State&) override {
    publishers_.clear();
    segmenter_.reset();
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_shutdown(const rclcpp_lifecycle::State& state) override {
    on_deactivate(state);
    return on_cleanup(state);
  }

  /// Subscribes to messages of a camera; only the newest is kept. Errors are logged, because the
  /// next message may be valid.
  template <typename Take>
  std::shared_ptr<rclcpp::GenericSubscription> subscribe(const std::string& topic,
                                                         const std::string& type,
                                                         Take take) {
    return rclcpp::create_generic_subscription(
        get_node_topics_interface(), topic, type, rclcpp::SensorDataQoS().keep_last(1),
        [this, take](std::shared_ptr<rclcpp::SerializedMessage> message) {
          try {
            take(*message);
          } catch (const planescope::Error& error) {
            RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kLogPeriod_ms, "%s", error.what());
          }
        });
  }

  void on_image(const rclcpp::SerializedMessage& message) {
    if (std::exchange(options_changed_, false))
      segmenter_->set_options(chosen_options({}), chosen_threads({}));
    const auto wanted = [this](const planescope::RosTopic& topic) {
      return publisher(topic).get_subscription_count() > 0;
    };
    for (const planescope::RosMessage& made : segmenter_->segment(bytes_of(message), wanted)) {
      rclcpp::SerializedMessage serialized(made.cdr.size());
      auto& raw = serialized.get_rcl_serialized_message();
      std::memcpy(raw.buffer, made.cdr.data(), made.cdr.size());
      raw.buffer_length = made.cdr.size();
      publisher(made.topic).publish(serialized);
    }
  }

  rclcpp::GenericPublisher& publisher(const planescope::RosTopic& topic) const {
    return *std::find_if(publishers_.begin(), publishers_.end(), [&](const auto& publisher) {
              return publisher.first == topic.name;
            })->second;
  }

  /// Value of a parameter: from `changed`, otherwise from the node.
  rclcpp::Parameter chosen(const std::string& name,
                           const std::vector<rclcpp::Parameter>& changed) const {
    const auto found =
        std::find_if(changed.begin(), changed.end(),
                     [&](const rclcpp::Parameter& one) { return one.get_name() == name; });
    return found != changed.end() ? *found : get_parameter(name);
  }
  int chosen_threads(const std::vector<rclcpp::Parameter>& changed) const {
    return static_cast<int>(chosen("threads", changed).as_int());
  }

  /// The profile, with all parameters that differ from their defaults.
  planescope::Options chosen_options(const std::vector<rclcpp::Parameter>& changed) const {
    planescope::Options options;
    set_option(options, chosen("profile", changed));
    for (const planescope::OptionInfo& option : options_) {
      const rclcpp::Parameter parameter = chosen(option.name, changed);
      if (option.name != "profile" && parameter.get_parameter_value() != default_value(option))
        set_option(options, parameter);
    }
    return options;
  }

  rcl_interfaces::msg::SetParametersResult on_parameters(
      const std::vector<rclcpp::Parameter>& changed) {
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = true;
    try {
      planescope::Segmenter(chosen_options(changed), chosen_threads(changed));
      options_changed_ = true;  // the parameters are set after this
    } catch (const planescope::Error& error) {
      result.successful = false;
      result.reason = error.what();
    }
    return result;
  }

  const std::vector<planescope::OptionInfo> options_;
  std::optional<planescope::RosSegmenter> segmenter_;  // while configured
  std::vector<std::pair<std::string, std::shared_ptr<rclcpp::GenericPublisher>>> publishers_;
  std::shared_ptr<rclcpp::GenericSubscription> info_, image_;
  OnSetParametersCallbackHandle::SharedPtr on_set_;
  bool options_changed_ = false;  // since the last image
};

}  // namespace planescope_ros

RCLCPP_COMPONENTS_REGISTER_NODE(planescope_ros::PlanesNode)
