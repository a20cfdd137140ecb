#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/bag/message_log.hpp"
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

/// Reads the fields of a message in their order, whichever ROS wrote it. Throws OutOfBytes where
/// they end early.
/// CDR: https://www.omg.org/spec/DDSI-RTPS/2.5, 10. Plain CDR alone, which ROS 2 writes.
class FieldReader {
 public:
  explicit FieldReader(const Message& message)
      : in_(message.bytes), is_cdr_(message.wire == Wire::cdr) {
    if (!is_cdr_) return;
    const auto high = in_.read<std::uint8_t>();
    const auto low = in_.read<std::uint8_t>();
    if (high != 0 || low > 1) throw OutOfBytes{};
    swapped_ = low == 0;  // written on a big-endian machine
    in_.take(2);          // options, unused
    in_ = ByteReader(in_.take(in_.left()));
  }

  bool is_cdr() const { return is_cdr_; }
  std::size_t left() const { return in_.left(); }

  template <typename T>
  T read() {
    if (is_cdr_) in_.take((sizeof(T) - in_.position() % sizeof(T)) % sizeof(T));
    std::byte bytes[sizeof(T)];
    std::ranges::copy(in_.take(sizeof(T)), bytes);
    if (swapped_) std::reverse(bytes, bytes + sizeof(T));
    return std::bit_cast<T>(bytes);
  }
  /// An array of bytes.
  Bytes bytes() { return in_.take(read<std::uint32_t>()); }
  std::string_view text() {
    const Bytes all = bytes();
    const std::string_view view(reinterpret_cast<const char*>(all.data()), all.size());
    if (!is_cdr_) return view;
    return view.substr(0, view.find('\0'));  // CDR ends it with one
  }
  std::vector<double> doubles() {
    const auto count = read<std::uint32_t>();
    if (count > in_.left() / sizeof(double)) throw OutOfBytes{};
    std::vector<double> values(count);
    for (double& value : values) value = read<double>();
    return values;
  }
  /// The bytes that are left.
  Bytes rest() { return in_.take(in_.left()); }

 private:
  ByteReader in_;
  bool is_cdr_;
  bool swapped_ = false;
};

/// The message that bytes of a ROS 2 container hold. They may be a zstd frame: `ros2 bag` says so
/// in metadata.yaml, the RealSense SDK nowhere. Throws Error that begins with `what` where that is
/// damaged.
Message cdr_message(std::shared_ptr<const std::vector<std::byte>> held,
                    Bytes bytes,
                    std::size_t at_most,
                    const std::string& what);

/// Tells of topics that are left out, by how they are serialized.
void warn_of_encodings(const std::map<std::string, int>& topics,
                       std::vector<std::string>& warnings);

/// A type as ROS 1 calls it: "sensor_msgs/Image" for "sensor_msgs/msg/Image".
std::string ros_type(std::string type);

// What the RealSense SDK says of its streams: in messages of ROS 1, or in ROS 2 in texts such as
// "width=640;height=480;fx=390.4". Every function takes either, and throws OutOfBytes where the
// message ends early or does not hold what it should.

CameraInfo parse_sdk_camera_info(const Message& message);
/// The depth unit [m].
double parse_sdk_option(const Message& message);
/// T_stream_reference.
Pose parse_sdk_extrinsics(const Message& message);
/// The value of `key` in a message about the device; nullopt where it is about another.
std::optional<std::string> parse_sdk_info(const Message& message, const std::string& key);

/// What the SDK writes beside every frame in ROS 2.
struct SdkFrameFacts {
  std::optional<std::string> number;
  std::optional<double> timestamp_s;  // in the camera's clock
  std::optional<double> depth_unit_m;
};
SdkFrameFacts parse_sdk_metadata(const Message& message);

/// An image, and its pixels where they do not lie in the message.
struct HeldImage {
  Image image;
  std::shared_ptr<const std::vector<std::byte>> held;
};

/// An image of any type that is_image_type() knows. sensor_msgs/CompressedImage is unpacked:
/// `compressedDepth` (PNG or RVL) and PNG of 16 bits to "16UC1", PNG and JPEG to "rgb8", `zstd` to
/// what it packs; a JPEG has `lossy` set. `what` names the message in errors. Throws Error where a
/// picture in it is damaged, OutOfBytes where the message is.
HeldImage read_image(const Message& message, const std::string& type, const std::string& what);

bool is_image_type(const std::string& type);
/// A topic without the transport that image_transport puts behind it:
/// "/camera/depth/image_rect_raw" for ".../image_rect_raw/compressedDepth".
std::string without_transport(const std::string& topic);

}  // namespace planescope::io::ros
