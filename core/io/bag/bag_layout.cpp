// Finds out the use of each topic of a recording, and gravity from its accelerometer.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "core/io/bag/ros_messages.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

/// Passes the first message of a topic to `parse`; nullopt if there is no readable message.
template <typename Parse>
auto first_message(const MessageLog& bag, const std::string& topic, Parse parse)
    -> std::optional<decltype(parse(Message{}))> {
  const auto& messages = bag.messages(topic);
  if (messages.empty()) return std::nullopt;
  try {
    return parse(bag.read(messages.front()));
  } catch (OutOfBytes) {
    return std::nullopt;
  }
}

bool starts_with_token(const std::string& text, const std::string& token, std::size_t& at) {
  if (text.compare(at, token.size(), token) != 0) return false;
  at += token.size();
  const std::size_t digits = at;
  while (at < text.size() && text[at] >= '0' && text[at] <= '9') ++at;
  return at > digits;
}

// --- RealSense SDK: /device_0/sensor_0/Depth_0/image/data ---

/// Prefixes of the topics that end in `suffix`, such as "/device_0/sensor_1/Color_0".
std::vector<std::string> sdk_streams(const MessageLog& bag,
                                     const std::string& kind,
                                     const std::string& suffix) {
  std::vector<std::string> prefixes;
  for (const auto& [topic, type] : bag.topics()) {
    std::size_t at = 0;
    if (starts_with_token(topic, "/device_", at) && starts_with_token(topic, "/sensor_", at) &&
        starts_with_token(topic, "/" + kind + "_", at) && topic.substr(at) == suffix &&
        !bag.messages(topic).empty()) {
      prefixes.push_back(topic.substr(0, at));
    }
  }
  return prefixes;
}

/// T_stream_reference by extrinsics group: streams of one group share their reference.
std::map<std::string, Pose> sdk_extrinsics(const MessageLog& bag, const std::string& prefix) {
  std::map<std::string, Pose> by_group;
  const std::string start = prefix + "/tf/";
  for (const auto& [topic, type] : bag.topics()) {
    if (!topic.starts_with(start)) continue;
    const auto pose = first_message(bag, topic, ros::parse_sdk_extrinsics);
    if (pose) by_group.emplace(topic.substr(start.size()), *pose);
  }
  return by_group;
}

std::optional<Pose> sdk_transform(const MessageLog& bag,
                                  const std::string& to,
                                  const std::string& from) {
  const auto from_groups = sdk_extrinsics(bag, from);
  for (const auto& [group, T_to_reference] : sdk_extrinsics(bag, to)) {
    const auto match = from_groups.find(group);
    if (match != from_groups.end()) return T_to_reference * match->second.inverse();
  }
  return std::nullopt;
}

std::string sdk_device_name(const MessageLog& bag, const std::string& device) {
  for (const auto& message : bag.messages(device + "/info")) {
    try {
      if (const auto name = ros::parse_sdk_info(bag.read(message), "Name")) return *name;
    } catch (OutOfBytes) {
      continue;
    }
  }
  return {};
}

std::string first_topic(const MessageLog& bag, const std::vector<std::string>& candidates) {
  for (const std::string& topic : candidates) {
    if (!bag.messages(topic).empty()) return topic;
  }
  return {};
}

std::string sdk_camera_info(const MessageLog& bag, const std::string& prefix) {
  return first_topic(bag, {prefix + "/info/camera_info", prefix + "/camera_info"});
}

std::optional<BagLayout> sdk_layout(const MessageLog& bag, const std::string& wanted) {
  auto depth = sdk_streams(bag, "Depth", "/image/data");
  std::erase_if(depth, [&](const std::string& stream) {
    return !wanted.empty() && stream + "/image/data" != wanted;
  });
  if (depth.empty()) return std::nullopt;
  const std::string& prefix = depth.front();
  const std::string device = prefix.substr(0, prefix.find('/', 1));
  const std::string sensor = prefix.substr(0, prefix.rfind('/'));
  BagLayout layout;
  layout.format = "RealSense SDK " + bag.kind();
  layout.is_sdk = true;
  layout.device = sdk_device_name(bag, device);
  layout.depth = prefix + "/image/data";
  layout.depth_info = sdk_camera_info(bag, prefix);
  const auto metadata = bag.topics().find(prefix + "/image/metadata");
  if (metadata != bag.topics().end() && metadata->second == "std_msgs/String") {
    layout.depth_metadata = metadata->first;
  }
  layout.depth_unit = first_topic(
      bag, {sensor + "/option/Depth Units/value", sensor + "/option/Depth_Units/value"});
  const auto on_device = [&](const std::string& other) { return other.starts_with(device + "/"); };
  for (const std::string& color : sdk_streams(bag, "Color", "/image/data")) {
    if (!on_device(color)) continue;
    layout.color = color + "/image/data";
    layout.color_info = sdk_camera_info(bag, color);
    const auto pose = sdk_transform(bag, color, prefix);
    layout.has_extrinsics = pose.has_value();
    if (pose) layout.T_color_depth = *pose;
    break;
  }
  auto accels = sdk_streams(bag, "Accel", "/imu/data");
  if (accels.empty()) accels = sdk_streams(bag, "Motion", "/imu/data");  // with the gyroscope
  for (const std::string& accel : accels) {
    if (!on_device(accel)) continue;
    layout.accel = accel + "/imu/data";
    const auto pose = sdk_transform(bag, prefix, accel);
    if (pose) layout.R_depth_accel = pose->linear();
    break;
  }
  return layout;
}

// --- realsense-ros: /camera/depth/image_rect_raw, 4.x: /camera/camera/depth/image_rect_raw ---

/// Uncompressed topics first, then those that are known to preserve depth.
std::vector<std::string> image_topics(const MessageLog& bag) {
  std::vector<std::string> topics;
  for (const auto& [topic, type] : bag.topics()) {
    if (ros::is_image_type(type) && !bag.messages(topic).empty()) topics.push_back(topic);
  }
  std::ranges::stable_sort(topics, {}, [&](const std::string& topic) {
    if (bag.topics().at(topic) == "sensor_msgs/Image") return 0;
    return topic.ends_with("/compressed") ? 2 : 1;
  });
  return topics;
}

/// The topic's folder, without the transport name at the end of an image topic.
std::string image_folder(const std::string& topic) {
  const std::string image = ros::without_transport(topic);
  return image.substr(0, image.rfind('/'));
}

/// The parent of the image's folder, which all images of a camera share.
std::string camera_of(const std::string& topic) {
  const std::string folder = image_folder(topic);
  return folder.substr(0, folder.rfind('/'));
}

/// The first topic whose last folder is `folder`, such as "depth" in /camera/depth/image_rect_raw.
std::string image_topic_in(const std::vector<std::string>& topics, const std::string& folder) {
  for (const std::string& topic : topics) {
    if (image_folder(topic).ends_with("/" + folder)) return topic;
  }
  return {};
}

/// The image's own camera_info, as some ROS 2 recorders write it, else the one beside the image.
std::string info_of(const MessageLog& bag, const std::string& topic) {
  const std::string own = first_topic(bag, {ros::without_transport(topic) + "/camera_info"});
  return own.empty() ? image_folder(topic) + "/camera_info" : own;
}

std::string frame_id(const MessageLog& bag, const std::string& topic) {
  const auto header = first_message(bag, topic, ros::parse_header);
  return header ? header->frame_id : "";
}

/// T_to_from along the static transforms, in whichever direction each of them points.
std::optional<Pose> static_transform(const MessageLog& bag,
                                     const std::string& to,
                                     const std::string& from) {
  if (to.empty() || from.empty()) return std::nullopt;
  std::vector<ros::NamedTransform> edges;
  for (const auto& message : bag.messages("/tf_static")) {
    try {
      const auto some = ros::parse_tf_message(bag.read(message));
      edges.insert(edges.end(), some.begin(), some.end());
    } catch (OutOfBytes) {
      continue;
    }
  }
  std::map<std::string, Pose> T_to = {{to, Pose::Identity()}};
  for (bool grown = true; grown && !T_to.contains(from);) {
    grown = false;
    for (const auto& edge : edges) {
      const auto parent = T_to.find(edge.parent);
      const auto child = T_to.find(edge.child);
      if (parent != T_to.end() && child == T_to.end()) {
        T_to.emplace(edge.child, parent->second * edge.T_parent_child);
        grown = true;
      } else if (child != T_to.end() && parent == T_to.end()) {
        T_to.emplace(edge.parent, child->second * edge.T_parent_child.inverse());
        grown = true;
      }
    }
  }
  const auto found = T_to.find(from);
  if (found == T_to.end()) return std::nullopt;
  return found->second;
}

void use_depth_topic(const MessageLog& bag, const std::string& topic, BagLayout& layout) {
  layout.depth = topic;
  layout.depth_info = info_of(bag, topic);
  layout.color_aligned = image_folder(topic).ends_with("aligned_depth_to_color");
  if (layout.color.empty() || layout.color_aligned) return;
  auto pose =
      first_message(bag, camera_of(topic) + "/extrinsics/depth_to_color", ros::parse_extrinsics);
  if (!pose) pose = static_transform(bag, frame_id(bag, layout.color), frame_id(bag, topic));
  layout.has_extrinsics = pose.has_value();
  layout.T_color_depth = pose.value_or(Pose::Identity());
}

/// The color topic of the camera, else of any camera.
std::string color_topic(const std::vector<std::string>& topics,
                        const std::string& camera,
                        bool of_any) {
  for (const char* name : {"/color", "/rgb"})
    for (const std::string& topic : topics)
      if (image_folder(topic) == camera + name) return topic;
  if (!of_any) return {};
  const std::string color = image_topic_in(topics, "color");
  return color.empty() ? image_topic_in(topics, "rgb") : color;
}

std::optional<BagLayout> ros_layout(const MessageLog& bag,
                                    const std::vector<std::string>& topics,
                                    const std::string& wanted) {
  const std::string native = wanted.empty() ? image_topic_in(topics, "depth") : wanted;
  const std::string aligned =
      wanted.empty() ? image_topic_in(topics, "aligned_depth_to_color") : std::string();
  if (native.empty() && aligned.empty()) return std::nullopt;
  BagLayout layout;
  layout.format = "realsense-ros " + bag.kind();
  layout.color = color_topic(topics, camera_of(native.empty() ? aligned : native), wanted.empty());
  if (!layout.color.empty()) layout.color_info = info_of(bag, layout.color);
  // Prefer native depth pixels; use the aligned copy only if color has no extrinsics otherwise.
  use_depth_topic(bag, native.empty() ? aligned : native, layout);
  if (!native.empty() && !aligned.empty() && !layout.color.empty() && !layout.has_extrinsics) {
    use_depth_topic(bag, aligned, layout);
  }
  const std::string camera = camera_of(layout.depth);
  layout.accel = first_topic(bag, {camera + "/accel/sample", camera + "/imu"});
  if (!layout.accel.empty()) {
    const auto pose =
        static_transform(bag, frame_id(bag, layout.depth), frame_id(bag, layout.accel));
    if (pose) layout.R_depth_accel = pose->linear();
  }
  return layout;
}

// --- Point clouds ---

/// The accelerometer may be in any namespace around the clouds, but transforms must locate it.
BagLayout cloud_layout(const MessageLog& bag, const std::string& topic) {
  BagLayout layout;
  layout.format = "point clouds in a " + bag.kind();
  layout.depth = topic;
  layout.is_cloud = true;
  for (std::string scope = topic; !scope.empty() && layout.accel.empty();) {
    scope.resize(scope.rfind('/') == std::string::npos ? 0 : scope.rfind('/'));
    const std::string accel = first_topic(bag, {scope + "/accel/sample", scope + "/imu"});
    if (accel.empty()) continue;
    const auto pose = static_transform(bag, frame_id(bag, topic), frame_id(bag, accel));
    if (!pose) continue;
    layout.accel = accel;
    layout.R_depth_accel = pose->linear();
  }
  return layout;
}

/// Depth image topics, recognized by the name of the stream, folder or image. For each image, only
/// the transport that will be read.
std::vector<std::string> depth_topics(const std::vector<std::string>& images) {
  std::vector<std::string> topics;
  std::set<std::string> known;
  for (const std::string& topic : images) {
    const std::string name = lower_case(topic.substr(camera_of(topic).size()));
    const bool is_depth =
        name.find("depth") != std::string::npos || topic.find("/Depth_") != std::string::npos;
    if (is_depth && known.insert(ros::without_transport(topic)).second) topics.push_back(topic);
  }
  return topics;
}

/// A few of the topics, and the number of the others.
std::string listed(const std::vector<std::string>& topics) {
  constexpr std::size_t kMost = 10;
  const std::size_t shown = std::min(kMost, topics.size());
  std::string text = fmt::format("{}", fmt::join(topics.begin(), topics.begin() + shown, ", "));
  if (shown < topics.size()) text += fmt::format(" and {} more", topics.size() - shown);
  return text;
}

}  // namespace

BagLayout find_bag_layout(const MessageLog& bag, const std::string& wanted) {
  const std::vector<std::string> images = image_topics(bag);
  std::vector<std::string> clouds;
  for (const auto& [topic, type] : bag.topics())
    if (type == kPointCloudType && !bag.messages(topic).empty()) clouds.push_back(topic);
  std::vector<std::string> topics = depth_topics(images);
  std::set<std::string> cameras;
  for (const std::string& topic : topics) cameras.insert(camera_of(topic));
  topics.insert(topics.end(), clouds.begin(), clouds.end());

  std::optional<BagLayout> layout;
  if (std::ranges::count(clouds, wanted) > 0) {
    layout = cloud_layout(bag, wanted);
  } else if (wanted.empty()) {
    layout = sdk_layout(bag, "");
    if (!layout) layout = ros_layout(bag, images, "");
    if (!layout && !clouds.empty()) layout = cloud_layout(bag, clouds.front());
  } else {
    const auto image = std::ranges::find_if(images, [&](const std::string& topic) {
      return topic == wanted || ros::without_transport(topic) == wanted;
    });
    if (image == images.end())
      throw Error(fmt::format(
          "{}: --topic {}: no image or point cloud topic has this name; found {}",
          bag.path().string(), wanted, topics.empty() ? "no topics with depth" : listed(topics)));
    layout = sdk_layout(bag, *image);
    if (!layout) layout = ros_layout(bag, images, *image);
  }
  if (!layout) {
    std::string found = images.empty()
                            ? "no image messages in " + counted(bag.topics().size(), "topic")
                            : listed(images);
    for (const std::string& warning : bag.warnings()) found += " (" + warning + ")";
    throw Error(bag.path().string() + ": no depth images: found " + found +
                "; expected /device_*/sensor_*/Depth_*/image/data or */depth/image_rect_raw; "
                "choose a different topic with --topic");
  }
  std::erase(topics, layout->depth);
  topics.insert(topics.begin(), layout->depth);
  layout->topics = std::move(topics);
  const std::size_t sources = layout->is_cloud ? clouds.size() : cameras.size();
  if (wanted.empty() && sources > 1)
    layout->warnings.push_back(
        fmt::format("{} {}; reading {}; use --topic to choose a different one", sources,
                    layout->is_cloud ? "point cloud topics" : "depth cameras", layout->depth));
  return *layout;
}

namespace {

constexpr std::size_t kMaxSamples = 64;
// Samples are spread over the recording, and each of their compressed chunks must be unpacked.
constexpr std::size_t kMaxCost = 4 << 20;

}  // namespace

std::optional<Gravity> gravity_near(const MessageLog& bag,
                                    const std::vector<MessageRef>& accel,
                                    std::uint64_t time_ns,
                                    const Mat3d& R_depth_accel) {
  const auto gap_ns = [&](std::size_t i) {
    return accel[i].time_ns > time_ns ? accel[i].time_ns - time_ns : time_ns - accel[i].time_ns;
  };
  auto after = static_cast<std::size_t>(
      std::lower_bound(accel.begin(), accel.end(), time_ns,
                       [](const MessageRef& m, std::uint64_t t) { return m.time_ns < t; }) -
      accel.begin());
  std::size_t before = after;                                // samples used: [before, after)
  std::set<std::pair<std::uint32_t, std::uint32_t>> chunks;  // file, number
  std::size_t cost = 0;
  Vec3d sum = Vec3d::Zero();
  std::uint64_t widest_ns = 0;
  std::size_t count = 0;
  while (count < kMaxSamples && (before > 0 || after < accel.size())) {
    const bool earlier =
        before > 0 && (after == accel.size() || gap_ns(before - 1) <= gap_ns(after));
    const std::size_t i = earlier ? --before : after++;
    if (chunks.insert({accel[i].file, accel[i].chunk}).second) cost += bag.unpacking_cost(accel[i]);
    if (count > 0 && cost > kMaxCost) break;
    try {
      const Vec3d sample_m_s2 = ros::parse_imu(bag.read(accel[i]));
      if (!sample_m_s2.allFinite()) continue;
      sum += sample_m_s2;
    } catch (OutOfBytes) {
      continue;
    } catch (const Error&) {
      continue;  // a damaged chunk; use the others
    }
    widest_ns = gap_ns(i);
    ++count;
  }
  if (count == 0) return std::nullopt;
  const Vec3d mean = sum / static_cast<double>(count);
  return gravity_of_accelerometer(R_depth_accel * mean, count,
                                  1e-9 * static_cast<double>(widest_ns));
}

}  // namespace planescope::io
