// The node of packaging/ros2/planescope_ros, compiled against stand-ins for ROS. It must publish,
// byte for byte, what `planescope segment` writes to an MCAP file of the same frames.

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>

#include "core/io/bag/message_log.hpp"
#include "core/io/bag/ros_messages.hpp"
#include "planescope/ros.hpp"
#include "rclcpp_components/register_node_macro.hpp"
#include "support/has.hpp"
#include "support/temp_dir.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Node = rclcpp_lifecycle::LifecycleNode;

/// Output of the program for the sample without color, which the node does not receive.
class PlanesFile {
 public:
  PlanesFile() {
    const fs::path sample = temp_dir() / "sample", file = temp_dir() / "planes.mcap";
    fs::create_directories(sample);
    fs::copy(PLANESCOPE_SAMPLE "/depth", sample / "depth");
    fs::copy(PLANESCOPE_SAMPLE "/planescope.json", sample);
    const std::string command = PLANESCOPE_PROGRAM " segment " + sample.string() +
                                " --foot 0.08 -o " + file.string() + " >/dev/null";
    if (std::system(command.c_str()) == 0) log_ = io::open_message_log(file);
  }
  std::string message(const std::string& topic, std::size_t i) const {
    const io::Message message = log_->read(log_->messages(topic).at(i));
    return {reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size()};
  }
  std::string depth(std::size_t i) const { return message("/camera/depth/image_rect_raw", i); }
  std::string info() const { return message("/camera/depth/camera_info", 0); }

 private:
  std::unique_ptr<io::MessageLog> log_;
};

const PlanesFile& file() {
  static const PlanesFile file;
  return file;
}

v0::View<std::uint8_t> view(const std::string& bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

/// A node, and the messages on its topics.
struct RosNode : testing::Test {
  const std::shared_ptr<Node> node = make_component();

  void configure() { ASSERT_EQ(node->on_configure({}), Node::CallbackReturn::SUCCESS); }
  void activate() {
    configure();
    ASSERT_EQ(node->on_activate({}), Node::CallbackReturn::SUCCESS);
  }
  /// Returns false if there is no subscriber.
  bool send(const std::string& topic, const std::string& bytes) {
    for (const auto& weak : node->get_node_topics_interface()->subscriptions)
      if (const auto subscription = weak.lock(); subscription && subscription->topic == topic) {
        EXPECT_TRUE(subscription->qos.best_effort);
        auto message = std::make_shared<rclcpp::SerializedMessage>(bytes.size());
        auto& raw = message->get_rcl_serialized_message();
        std::memcpy(raw.buffer, bytes.data(), bytes.size());
        raw.buffer_length = bytes.size();
        subscription->callback(message);
        return true;
      }
    return false;
  }
  std::shared_ptr<rclcpp::GenericPublisher> publisher(const std::string& topic) {
    for (const auto& weak : node->get_node_topics_interface()->publishers)
      if (auto publisher = weak.lock(); publisher && publisher->topic == topic) return publisher;
    return nullptr;
  }
  std::string last_line() { return node->get_logger().lines->back(); }
};

std::string refusal(const v0::RosSegmenter& segmenter, const std::string& image) {
  try {
    segmenter.segment(view(image));
  } catch (const v0::Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_F(RosNode, PublishesTheMessagesInTheMcapFile) {
  node->set_parameter({"foot_radius_m", rclcpp::ParameterValue(0.08)});
  activate();
  ASSERT_TRUE(send("depth/camera_info", file().info()));
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(send("depth/image", file().depth(i)));
    for (const char* topic : {"planes", "markers", "points"}) {
      const auto& published = publisher(std::string("~/") + topic)->published;
      ASSERT_EQ(published.size(), i + 1);
      EXPECT_TRUE(published[i] == file().message(std::string("/planescope/") + topic, i)) << topic;
    }
  }
  const auto transforms = [](const std::string& cdr) {
    return io::ros::parse_tf_message({nullptr, std::as_bytes(std::span(cdr)), io::Wire::cdr});
  };
  const auto ours = transforms(publisher("/tf")->published[0]);
  const auto theirs = transforms(file().message("/tf", 0));
  ASSERT_EQ(ours.size(), 1) << "the camera has a parent of its own";
  EXPECT_EQ(ours[0].parent, "camera_depth_optical_frame");
  EXPECT_EQ(ours[0].child, theirs[1].child);
  EXPECT_TRUE(ours[0].T_parent_child.isApprox(theirs[1].T_parent_child, 0));
}

TEST_F(RosNode, PublishesOnlyWhenActiveAndOnlySubscribedTopics) {
  configure();
  EXPECT_FALSE(send("depth/image", file().depth(0)));
  node->on_activate({});
  send("depth/camera_info", file().info());
  publisher("~/points")->subscriptions = 0;
  send("depth/image", file().depth(0));
  EXPECT_EQ(publisher("~/planes")->published.size(), 1);
  EXPECT_TRUE(publisher("~/points")->published.empty());
  node->on_deactivate({});
  EXPECT_FALSE(send("depth/image", file().depth(0)));
  node->on_cleanup({});
  EXPECT_EQ(publisher("~/planes"), nullptr);
}

TEST_F(RosNode, ParametersAreTheOptionsWithTheirDescriptionsAndRanges) {
  for (const v0::OptionInfo& option : v0::Options::all()) {
    const auto descriptor = node->describe_parameter(option.name);
    EXPECT_TRUE(has(descriptor.description, option.meaning)) << option.name;
    const bool has_range =
        !descriptor.floating_point_range.empty() || !descriptor.integer_range.empty();
    const bool is_number =
        option.kind == v0::OptionKind::number || option.kind == v0::OptionKind::whole;
    EXPECT_EQ(has_range, is_number && option.max < std::numeric_limits<double>::infinity());
  }
  EXPECT_EQ(node->describe_parameter("max_range_m").additional_constraints, "above 0");
  EXPECT_EQ(node->describe_parameter("method").additional_constraints.substr(0, 12),
            "one of ours,");
  EXPECT_EQ(node->describe_parameter("base_depth").integer_range.at(0).to_value, 16);

  activate();
  send("depth/camera_info", file().info());
  const auto bad = node->set_parameter({"foot_radius_m", rclcpp::ParameterValue(-1.0)});
  EXPECT_FALSE(bad.successful);
  EXPECT_TRUE(has(bad.reason, "foot_radius_m"));
  send("depth/image", file().depth(0));
  EXPECT_TRUE(node->set_parameter({"max_range_m", rclcpp::ParameterValue(1.0)}).successful);
  send("depth/image", file().depth(0));
  const auto& planes = publisher("~/planes")->published;
  EXPECT_NE(planes.at(0), planes.at(1));
}

TEST_F(RosNode, LogsInvalidMessagesAndContinues) {
  activate();
  send("depth/image", file().depth(0));
  EXPECT_EQ(last_line(), "image: its camera_info has not arrived yet");
  send("depth/camera_info", "abc");
  EXPECT_EQ(last_line(), "sensor_msgs/msg/CameraInfo: damaged 3-byte message");
  send("depth/camera_info", file().info());
  send("depth/image", file().depth(0));
  EXPECT_EQ(publisher("~/planes")->published.size(), 1);
}

TEST(RosSegmenter, RejectsUnsupportedImages) {
  v0::RosSegmenter segmenter;
  segmenter.set_camera_info(view(file().info()));
  const std::string image = file().depth(0);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string copy = image;
    return copy.replace(copy.find(from), from.size(), to);
  };
  EXPECT_TRUE(has(refusal(segmenter, changed("16UC1", "bgra8")),
                  "encoding \"bgra8\" is not supported; expected"));
  EXPECT_TRUE(has(refusal(segmenter, changed("16UC1", "32FC1")), "1280-byte rows; expected"));
  EXPECT_TRUE(has(refusal(segmenter, changed("camera", std::string("\0amera", 6))), "frame_id"));
  for (std::size_t size = 0; size < 100; ++size)
    EXPECT_TRUE(has(refusal(segmenter, image.substr(0, size)), "-byte message")) << size;
  EXPECT_TRUE(has(refusal(segmenter, image.substr(0, image.size() - 1)), "-byte message"));
}

TEST(RosSegmenter, FloatsInMetersGiveTheSamePlanesAsMillimeters) {
  v0::RosSegmenter segmenter;
  segmenter.set_camera_info(view(file().info()));
  std::string image = file().depth(0);
  const std::size_t bytes = std::size_t{640} * 480 * 2;
  std::string meters;
  for (std::size_t at = image.size() - bytes; at < image.size(); at += 2) {
    std::uint16_t count = 0;
    std::memcpy(&count, &image[at], 2);
    const float value =
        count == 0 ? std::numeric_limits<float>::quiet_NaN() : 0.001f * static_cast<float>(count);
    meters.append(reinterpret_cast<const char*>(&value), 4);
  }
  const std::uint32_t sizes[] = {640 * 4, 640 * 480 * 4};  // of a row, and in total
  image.resize(image.size() - bytes);
  std::memcpy(&image[image.size() - sizeof(sizes)], sizes, sizeof(sizes));
  image.replace(image.find("16UC1"), 5, "32FC1");
  const auto only_points = [](const v0::RosTopic& topic) { return topic.name == "points"; };
  const auto of_meters = segmenter.segment(view(image + meters), only_points).at(0).cdr;
  const auto of_counts = segmenter.segment(view(file().depth(0)), only_points).at(0).cdr;
  ASSERT_EQ(of_meters.size(), of_counts.size());
  const auto float_at = [](const std::vector<std::uint8_t>& cdr, std::size_t from_end) {
    float value = 0;
    std::memcpy(&value, &cdr[cdr.size() - from_end], 4);
    return value;
  };
  for (std::size_t from_end = 1 + 16; from_end < 16 * 200000; from_end += 16)  // x, y, z, plane
    for (const std::size_t axis : {0, 4, 8})
      ASSERT_NEAR(float_at(of_meters, from_end - axis), float_at(of_counts, from_end - axis), 1e-3);
}

}  // namespace planescope
