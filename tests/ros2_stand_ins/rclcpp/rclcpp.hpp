#pragma once
// Stand-ins for the parts of rclcpp (Humble) that planescope_ros uses: the same signatures, with
// enough behavior for tests to send and receive. Each links to its documentation.

#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rcl_interfaces/msg/parameter_descriptor.hpp"
#include "rcl_interfaces/msg/set_parameters_result.hpp"

/// https://docs.ros.org/en/humble/p/rcutils/generated/structrcutils__uint8__array__t.html
struct rcl_serialized_message_t {
  std::uint8_t* buffer = nullptr;
  std::size_t buffer_length = 0, buffer_capacity = 0;
};

namespace rclcpp {
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1SerializedMessage.html
class SerializedMessage {
 public:
  explicit SerializedMessage(std::size_t initial_capacity) : bytes_(initial_capacity) {
    raw_ = {bytes_.data(), 0, bytes_.size()};
  }
  rcl_serialized_message_t& get_rcl_serialized_message() { return raw_; }
  const rcl_serialized_message_t& get_rcl_serialized_message() const { return raw_; }

 private:
  std::vector<std::uint8_t> bytes_;
  rcl_serialized_message_t raw_;
};

/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1QoS.html
class QoS {
 public:
  QoS(std::size_t history_depth) : depth(history_depth) {}
  QoS& keep_last(std::size_t history_depth) {
    depth = history_depth;
    return *this;
  }
  std::size_t depth;
  bool best_effort = false;
};
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1SensorDataQoS.html
class SensorDataQoS : public QoS {
 public:
  SensorDataQoS() : QoS(5) { best_effort = true; }
};

/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1NodeOptions.html
class NodeOptions {};

/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1GenericPublisher.html
class GenericPublisher {
 public:
  void publish(const SerializedMessage& message) {
    const auto& raw = message.get_rcl_serialized_message();
    published.emplace_back(raw.buffer, raw.buffer + raw.buffer_length);
  }
  std::size_t get_subscription_count() const { return subscriptions; }

  std::string topic, type;
  std::size_t subscriptions = 1;
  std::vector<std::string> published;
};
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1GenericSubscription.html
struct GenericSubscription {
  std::string topic, type;
  QoS qos;
  std::function<void(std::shared_ptr<SerializedMessage>)> callback;
};

namespace node_interfaces {
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1node__interfaces_1_1NodeTopicsInterface.html
struct NodeTopicsInterface {
  using SharedPtr = std::shared_ptr<NodeTopicsInterface>;
  std::vector<std::weak_ptr<GenericPublisher>> publishers;
  std::vector<std::weak_ptr<GenericSubscription>> subscriptions;
};
/// https://docs.ros.org/en/humble/p/rclcpp/generated/structrclcpp_1_1node__interfaces_1_1OnSetParametersCallbackHandle.html
struct OnSetParametersCallbackHandle {
  using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;
};
}  // namespace node_interfaces

/// https://docs.ros.org/en/humble/p/rclcpp/generated/program_listing_file_include_rclcpp_create_generic_publisher.hpp.html
inline std::shared_ptr<GenericPublisher> create_generic_publisher(
    node_interfaces::NodeTopicsInterface::SharedPtr topics_interface,
    const std::string& topic_name,
    const std::string& topic_type,
    const QoS&) {
  auto made = std::make_shared<GenericPublisher>();
  made->topic = topic_name;
  made->type = topic_type;
  topics_interface->publishers.push_back(made);
  return made;
}
/// https://docs.ros.org/en/humble/p/rclcpp/generated/program_listing_file_include_rclcpp_create_generic_subscription.hpp.html
inline std::shared_ptr<GenericSubscription> create_generic_subscription(
    node_interfaces::NodeTopicsInterface::SharedPtr topics_interface,
    const std::string& topic_name,
    const std::string& topic_type,
    const QoS& qos,
    std::function<void(std::shared_ptr<SerializedMessage>)> callback) {
  auto made = std::make_shared<GenericSubscription>(
      GenericSubscription{topic_name, topic_type, qos, std::move(callback)});
  topics_interface->subscriptions.push_back(made);
  return made;
}

/// https://docs.ros.org/en/humble/p/rclcpp/generated/namespace_rclcpp.html
enum class ParameterType : std::uint8_t {
  PARAMETER_NOT_SET = 0,
  PARAMETER_BOOL = 1,
  PARAMETER_INTEGER = 2,
  PARAMETER_DOUBLE = 3,
  PARAMETER_STRING = 4,
};
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1ParameterValue.html
class ParameterValue {
 public:
  explicit ParameterValue(bool from) : value(from) {}
  explicit ParameterValue(int from) : value(std::int64_t{from}) {}
  explicit ParameterValue(std::int64_t from) : value(from) {}
  explicit ParameterValue(double from) : value(from) {}
  explicit ParameterValue(const std::string& from) : value(from) {}
  explicit ParameterValue(const char* from) : value(std::string(from)) {}
  ParameterType get_type() const { return static_cast<ParameterType>(value.index() + 1); }
  bool operator!=(const ParameterValue& other) const { return value != other.value; }
  std::variant<bool, std::int64_t, double, std::string> value;
};
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1Parameter.html
class Parameter {
 public:
  Parameter(const std::string& name, const ParameterValue& value) : name_(name), value_(value) {}
  ParameterType get_type() const { return value_.get_type(); }
  const std::string& get_name() const { return name_; }
  const ParameterValue& get_parameter_value() const { return value_; }
  bool as_bool() const { return std::get<bool>(value_.value); }
  std::int64_t as_int() const { return std::get<std::int64_t>(value_.value); }
  double as_double() const { return std::get<double>(value_.value); }
  const std::string& as_string() const { return std::get<std::string>(value_.value); }

 private:
  std::string name_;
  ParameterValue value_;
};

/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1Logger.html
struct Logger {
  std::shared_ptr<std::vector<std::string>> lines = std::make_shared<std::vector<std::string>>();
  template <typename... Values>
  void log(const char* format, Values... values) const {
    char line[1024];
    std::snprintf(line, sizeof(line), format, values...);
    lines->push_back(line);
  }
};
/// https://docs.ros.org/en/humble/p/rclcpp/generated/classrclcpp_1_1Clock.html
struct Clock {
  using SharedPtr = std::shared_ptr<Clock>;
};
}  // namespace rclcpp

// https://docs.ros.org/en/humble/p/rclcpp/generated/file_include_rclcpp_logging.hpp.html
#define RCLCPP_ERROR(logger, ...) (logger).log(__VA_ARGS__)
#define RCLCPP_WARN_THROTTLE(logger, clock, duration, ...) \
  (static_cast<void>(clock), static_cast<void>(duration), (logger).log(__VA_ARGS__))
