#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/bag/message_log.hpp"
#include "core/model/image.hpp"
#include "core/model/types.hpp"

namespace planescope::io::ros {

// The messages of ROS 1 and 2 that recordings of depth cameras use. Every function throws
// OutOfBytes when the bytes end early.

inline constexpr std::uint32_t kMaxSide = 1 << 15;  // of an image [px]

struct Header {
  std::optional<std::uint32_t> seq;  // ROS 1 alone
  double stamp_s = 0;
  std::string frame_id;
};
Header parse_header(const Message& message);
class FieldReader;
Header read_header(FieldReader& reader);  // which goes on behind it

struct Image {
  Header header;
  int width = 0;
  int height = 0;
  std::string encoding;
  bool big_endian = false;
  std::size_t step = 0;  // bytes per row
  Bytes data;
  std::optional<float> depth_unit_m;  // trailing field of RealSense SDK 2.49 and later
  bool lossy = false;                 // its pixels are not those that were measured
};
Image parse_image(const Message& message);

struct CameraInfo {
  int width = 0;
  int height = 0;
  std::string distortion_model;
  std::vector<double> d;
  Mat3d k = Mat3d::Zero();
};
CameraInfo parse_camera_info(const Message& message);

struct Acceleration {
  Header header;
  Vec3d meters_per_s2 = Vec3d::Zero();
};
Acceleration parse_imu(const Message& message);

/// geometry_msgs/Transform; the quaternion is normalised. Throws OutOfBytes on a zero quaternion.
Pose parse_transform(const Message& message);

struct NamedTransform {
  std::string parent;
  std::string child;
  Pose T_parent_child = Pose::Identity();
};
std::vector<NamedTransform> parse_tf_message(const Message& message);

/// Throws OutOfBytes where it is no rotation.
Pose to_pose(const Mat3d& rotation, const Vec3d& translation);

/// realsense2_camera/Extrinsics: rotation column-major, then translation.
Pose parse_extrinsics(const Message& message);

struct KeyValue {
  std::string key;
  std::string value;
};
KeyValue parse_key_value(const Message& message);

float parse_float32(const Message& message);

/// Throws Error naming bag and topic unless the image holds 16-bit depth counts.
void check_depth_encoding(const Image& image,
                          const std::filesystem::path& bag,
                          const std::string& topic);
/// Throws Error or OutOfBytes when the image is no whole 16-bit depth image.
Image16 to_depth(const Image& image, const std::filesystem::path& bag, const std::string& topic);
/// rgb8, bgr8, rgba8, bgra8, mono8, 8UC1. Throws Error on any other encoding.
Image8 to_rgb(const Image& image, const std::filesystem::path& bag, const std::string& topic);

/// A float as the decimal number that was meant: 0.001f becomes 0.001, not 0.0010000000475.
double decimal(float value);

}  // namespace planescope::io::ros
