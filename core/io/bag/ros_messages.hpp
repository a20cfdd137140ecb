#pragma once

// ROS 1 and 2 messages that recordings of depth cameras contain, and the use of each topic of a
// recording. Internal to core/io.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/io/bag/message_log.hpp"
#include "core/io/recording.hpp"
#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope::io::ros {

// Every function throws OutOfBytes if the bytes end early.

inline constexpr std::uint32_t kMaxSide = 1 << 15;  // of an image [px]

struct Header {
  std::optional<std::uint32_t> seq;  // ROS 1 only
  double stamp_s = 0;
  std::int64_t stamp_ns = 0;  // the same, exact
  std::string frame_id;
};
Header parse_header(const Message& message);
inline constexpr std::size_t kHeaderBytes = 4096;  // maximum size of a header

struct Image {
  Header header;
  int width = 0;
  int height = 0;
  std::string encoding;
  bool big_endian = false;
  std::size_t step = 0;  // bytes per row
  Bytes data;
  std::optional<float> depth_unit_m;  // trailing field of RealSense SDK 2.49 and later
  bool lossy = false;                 // pixels differ from the measured ones
};

struct CameraInfo {
  int width = 0;
  int height = 0;
  std::string distortion_model;
  std::vector<double> d;
  Mat3d k = Mat3d::Zero();
};
CameraInfo parse_camera_info(const Message& message);

/// sensor_msgs/PointCloud2.
struct PointCloud {
  struct Field {
    std::string name;
    std::uint32_t offset = 0;  // in a point's bytes
    std::uint8_t type = 0;     // as in the message, from 1: INT8, UINT8, ... FLOAT64
  };
  Header header;
  std::size_t width = 0, height = 0;
  std::vector<Field> fields;
  bool big_endian = false;
  std::size_t point_step = 0, row_step = 0;  // bytes
  Bytes data;
};
PointCloud parse_point_cloud(const Message& message);

/// Linear acceleration of a sensor_msgs/Imu [m/s2].
Vec3d parse_imu(const Message& message);

struct NamedTransform {
  std::string parent;
  std::string child;
  Pose T_parent_child = Pose::Identity();
};
std::vector<NamedTransform> parse_tf_message(const Message& message);

/// realsense2_camera/Extrinsics: rotation column-major, then translation.
Pose parse_extrinsics(const Message& message);

/// Converts a float to the decimal number it was written as: 0.001f to 0.001, not 0.0010000000475.
double decimal(float value);

// Properties of the RealSense SDK's streams: ROS 1 messages, or in ROS 2 texts such as
// "width=640;height=480;fx=390.4". Every function accepts both, and throws OutOfBytes if the
// message ends early or lacks a value.

CameraInfo parse_sdk_camera_info(const Message& message);
/// The depth unit [m].
double parse_sdk_option(const Message& message);
/// T_stream_reference.
Pose parse_sdk_extrinsics(const Message& message);
/// The value of `key` in a message about the device; nullopt if the message contains another key.
std::optional<std::string> parse_sdk_info(const Message& message, const std::string& key);

/// Metadata that the SDK records with every frame in ROS 2.
struct SdkFrameFacts {
  std::optional<std::string> number;
  std::optional<double> timestamp_s;  // in the camera's clock
  std::optional<double> depth_unit_m;
};
SdkFrameFacts parse_sdk_metadata(const Message& message);

/// An image. `held` owns its pixels unless they are part of the message.
struct HeldImage {
  Image image;
  HeldBytes held;
};

/// Reads an image of any type that is_image_type() accepts. Unpacks sensor_msgs/CompressedImage:
/// `compressedDepth` (PNG or RVL) and 16-bit PNG to "16UC1", other PNG and JPEG to "rgb8", `zstd`
/// to the original encoding. Sets `lossy` for JPEG. `what` names the message in errors. Throws
/// Error if the compressed picture is damaged, OutOfBytes if the message is.
HeldImage read_image(const Message& message, const std::string& type, const std::string& what);

bool is_image_type(const std::string& type);
/// A topic without the transport that image_transport appends: "/camera/depth/image_rect_raw" for
/// ".../image_rect_raw/compressedDepth".
std::string without_transport(const std::string& topic);

}  // namespace planescope::io::ros

namespace planescope::io {

/// Use of each topic of a recording. Names are empty if there is no such topic.
struct BagLayout {
  std::string format;   // "RealSense SDK bag", "realsense-ros ROS 2 bag (MCAP)", ...
  bool is_sdk = false;  // else realsense-ros
  std::string device;
  std::string depth, depth_info;
  bool is_cloud = false;            // `depth` is a topic of point clouds
  std::vector<std::string> topics;  // topics with frames, that of `depth` first
  std::string color, color_info;
  bool color_aligned = false;
  bool has_extrinsics = false;
  Pose T_color_depth = Pose::Identity();
  std::string depth_unit;      // SDK option topic
  std::string depth_metadata;  // SDK texts beside each depth image
  std::string accel;
  Mat3d R_depth_accel = Mat3d::Identity();
  std::vector<std::string> warnings;
};

inline constexpr const char* kPointCloudType = "sensor_msgs/PointCloud2";

/// `wanted`: the topic with the frames; empty: the first with depth images or, without any, point
/// clouds. Throws Error that lists the topics found if there is no such topic.
BagLayout find_bag_layout(const MessageLog& bag, const std::string& wanted);

/// Frames from a topic of point clouds.
std::unique_ptr<Recording> open_cloud_topic(std::unique_ptr<MessageLog> log,
                                            BagLayout layout,
                                            const RecordingOptions& options);

/// Gravity from the accelerometer samples recorded nearest to `time_ns`: at rest they measure the
/// reaction to gravity, so gravity is the negative of their mean. nullopt if there are no samples
/// or their mean is not near 1 g (shaken, or damaged). `accel` is sorted by time.
std::optional<Gravity> gravity_near(const MessageLog& bag,
                                    const std::vector<MessageRef>& accel,
                                    std::uint64_t time_ns,
                                    const Mat3d& R_depth_accel);

}  // namespace planescope::io
