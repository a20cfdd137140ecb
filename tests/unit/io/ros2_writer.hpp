#pragma once

#include <filesystem>

#include "unit/io/sample_bags.hpp"

namespace planescope::testing_bags {

// Recordings of ROS 2, written from the specifications and independently of the reader.

struct Ros2Message {
  std::string topic;
  std::string type;  // "sensor_msgs/msg/Image"
  std::uint64_t time_ns = 0;
  ByteVector bytes;
};
using Ros2Messages = std::vector<Ros2Message>;

// ROS 2 messages as CDR.
ByteVector cdr_image(const ImageMessage& image, bool big_endian = false);
ByteVector cdr_compressed_image(double stamp_s,
                                const std::string& frame_id,
                                const std::string& format,
                                const ByteVector& data);
ByteVector cdr_camera_info(int width, int height, std::array<double, 4> k);
ByteVector cdr_imu(double stamp_s, const Vec3d& acceleration, const std::string& frame_id);
ByteVector cdr_tf(const std::string& parent, const std::string& child, const Pose& pose);
ByteVector cdr_text(const std::string& text);

/// Columns, rows, and counts as Wilson packs them (RVL, 2017).
ByteVector rvl_packed(const Image16& depth);
/// With what compressedDepth puts before a picture.
ByteVector with_config(const ByteVector& picture);
/// As zstd_image_transport packs an image of counts.
ByteVector zstd_transport(const Image16& depth);

ByteVector zstd_packed(const ByteVector& bytes);
/// Each message a zstd frame of its own.
Ros2Messages packed(Ros2Messages messages);

/// As `ros2 bag` makes it: tables `topics` and `messages`.
void write_db3(const std::filesystem::path& path, const Ros2Messages& messages, int page = 4096);

/// How an MCAP file holds them.
struct McapForm {
  std::string compression;   // "", "lz4" or "zstd"
  std::size_t in_chunk = 5;  // messages in each; 0: no chunks
  bool summary = true;
  std::string encoding = "cdr";
};
void write_mcap(const std::filesystem::path& path,
                const Ros2Messages& messages,
                const McapForm& form = {});

/// As the RealSense SDK records: texts, depth frames 100, 101, ... with colour, as sdk_bag().
Ros2Messages sdk_messages(int frames);
/// As realsense-ros records under `camera`, depth_of(100), depth_of(101), ... with colour.
Ros2Messages realsense_ros_messages(int frames, const std::string& camera = "/camera/camera");

}  // namespace planescope::testing_bags
