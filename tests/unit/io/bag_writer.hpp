#pragma once

// Writes recordings of ROS 1 and 2, intact and damaged, from the specifications and independently
// of the reader; and samples of both.

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::testing_bags {

using ByteVector = std::vector<unsigned char>;

/// Layout of fields: ROS 1, or ROS 2 (CDR), which aligns fields to multiples of their size, counted
/// after the first four bytes, little- or big-endian.
enum class Wire { ros1, cdr, cdr_big };

/// Fields in sequence; for ROS 1 also as in bags and MCAP files.
class Fields {
 public:
  explicit Fields(Wire wire = Wire::ros1) : wire_(wire) {
    if (wire != Wire::ros1) out = {0, static_cast<unsigned char>(wire == Wire::cdr), 0, 0};
  }
  template <typename T>
  Fields& put(T value) {
    if (wire_ != Wire::ros1)
      while ((out.size() - 4) % sizeof(T) != 0) out.push_back(0xcd);
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (wire_ == Wire::cdr_big) std::reverse(bytes, bytes + sizeof(T));
    out.insert(out.end(), bytes, bytes + sizeof(T));
    return *this;
  }
  Fields& put_32(std::size_t value) { return put(static_cast<std::uint32_t>(value)); }
  Fields& text(const std::string& text) {
    put_32(text.size() + (wire_ == Wire::ros1 ? 0 : 1));
    out.insert(out.end(), text.begin(), text.end());
    if (wire_ != Wire::ros1) out.push_back(0);
    return *this;
  }
  Fields& raw(const ByteVector& bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
    return *this;
  }
  Fields& sized(const ByteVector& bytes) { return put_32(bytes.size()).raw(bytes); }
  Fields& header(std::uint32_t seq, double stamp_s, const std::string& frame_id);

  ByteVector out;

 private:
  Wire wire_;
};

struct BagFormat {
  std::string compression = "none";  // none, lz4, bz2
  // write the index section at the end, and its position in the header
  bool index = true;
  bool chunk_index = true;       // write INDEX_DATA records after each chunk
  bool close_last_chunk = true;  // false: its sizes are missing, as after a power failure
  int messages_per_chunk = 8;
  int named_times = 1;  // number of times that the index lists each chunk
};

/// Writes ROS 1 bags.
class BagWriter {
 public:
  explicit BagWriter(BagFormat format = {}) : format_(format) {}
  void add(const std::string& topic,
           const std::string& type,
           std::uint64_t time_ns,
           const ByteVector& message);
  /// The complete file.
  ByteVector finish();
  /// For uncompressed bags: the position after each message on `topic`, in order.
  const std::vector<std::size_t>& ends_of(const std::string& topic) { return ends_[topic]; }

 private:
  struct Entry {
    std::uint64_t time_ns;
    std::uint32_t offset;
  };
  struct ChunkInfo {
    std::uint64_t position;
    std::map<std::uint32_t, std::vector<Entry>> entries;
  };
  void close_chunk(bool last);

  BagFormat format_;
  std::map<std::string, std::uint32_t> ids_;
  std::map<std::uint32_t, ByteVector> connection_records_;
  ByteVector file_;
  ByteVector chunk_;
  std::map<std::uint32_t, std::vector<Entry>> chunk_entries_;
  std::vector<std::pair<std::string, std::size_t>> chunk_ends_;
  int chunk_messages_ = 0;
  std::vector<ChunkInfo> chunks_;
  std::map<std::string, std::vector<std::size_t>> ends_;
};

// Messages.
struct ImageMessage {
  std::uint32_t seq = 0;
  double stamp_s = 0;
  std::string frame_id = "0";
  std::string encoding = "mono16";
  int width = 0, height = 0;
  int row_padding = 0;  // bytes after each row
  bool big_endian = false;
  ByteVector pixels;
  std::optional<float> depth_unit_m;  // the four extra bytes of SDK 2.49
};
ByteVector image_message(const ImageMessage& image, Wire wire = Wire::ros1);
ByteVector compressed_image_message(double stamp_s,
                                    const std::string& frame_id,
                                    const std::string& format,
                                    const ByteVector& data,
                                    Wire wire = Wire::ros1);
ByteVector camera_info_message(int width,
                               int height,
                               std::array<double, 4> k,
                               const std::string& model = "Brown Conrady",
                               const std::vector<double>& d = {0, 0, 0, 0, 0},
                               Wire wire = Wire::ros1);
ByteVector imu_message(std::uint32_t seq,
                       double stamp_s,
                       const Vec3d& acceleration,
                       const std::string& frame_id = "0",
                       Wire wire = Wire::ros1);
ByteVector transform_message(const Pose& pose, double quaternion_scale = 1);
ByteVector tf_message(const std::string& parent,
                      const std::string& child,
                      const Pose& pose,
                      Wire wire = Wire::ros1);
ByteVector extrinsics_message(const Pose& pose);

inline constexpr int kWidth = 24;
inline constexpr int kHeight = 16;
inline constexpr double kDepthPeriod_s = 1.0 / 30;

/// Contents of depth frame `seq`: noise, which differs between frames and compresses badly.
Image16 depth_of(std::uint32_t seq);
ByteVector pixels_of(const Image16& image);
/// A color image of one value.
ByteVector plain_color(std::uint8_t red, std::uint8_t green, std::uint8_t blue);

ImageMessage depth_message(std::uint32_t seq, double stamp_s);
ImageMessage color_message(std::uint32_t seq, double stamp_s);

struct SdkBag {
  int frames = 6;
  BagFormat format;
  bool sdk_2_49 = false;  // unit after the pixels, frame_id "1", Depth_Units
  float unit_m = 0.001f;
};

inline const std::string kSdkDepth = "/device_0/sensor_0/Depth_0";
inline const std::string kSdkColor = "/device_0/sensor_1/Color_0";
inline const std::string kSdkAccel = "/device_0/sensor_2/Accel_0";

/// Adds an image of the SDK's stream.
void add_depth(BagWriter& bag, std::uint64_t time_ns, const ImageMessage& image);
void add_color(BagWriter& bag, std::uint64_t time_ns, const ImageMessage& image);
/// Adds the messages that the SDK writes before the first frame, at time 1 ns.
void add_sdk_statics(BagWriter& bag, const SdkBag& options);
/// A bag as recorded by the RealSense SDK: depth frames 100, 101, ... with a color image each.
BagWriter sdk_bag(const SdkBag& options);

// ---- ROS 2 ----

struct Ros2Message {
  std::string topic;
  std::string type;  // "sensor_msgs/msg/Image"
  std::uint64_t time_ns = 0;
  ByteVector bytes;
};
using Ros2Messages = std::vector<Ros2Message>;

/// Width, height, and counts compressed by RVL (Wilson 2017).
ByteVector rvl_packed(const Image16& depth);
/// Prepends the header of compressedDepth to an image.
ByteVector with_config(const ByteVector& picture);
/// An image of counts as compressed by zstd_image_transport.
ByteVector zstd_transport(const Image16& depth);

ByteVector zstd_packed(const ByteVector& bytes);
/// Compresses each message as a separate zstd frame.
Ros2Messages packed(Ros2Messages messages);

/// A database as written by `ros2 bag`: tables `topics` and `messages`.
void write_db3(const std::filesystem::path& path, const Ros2Messages& messages, int page = 4096);

/// Options of an MCAP file.
struct McapForm {
  std::string compression;   // "", "lz4" or "zstd"
  std::size_t in_chunk = 5;  // messages per chunk; 0: no chunks
  bool summary = true;
  std::string encoding = "cdr";
  bool statistics = true;  // in the summary
  bool crc = false;        // of each chunk and of the data
};
void write_mcap(const std::filesystem::path& path,
                const Ros2Messages& messages,
                const McapForm& form = {});

/// Messages as recorded by the RealSense SDK: strings, depth frames 100, 101, ... with color, like
/// sdk_bag().
Ros2Messages sdk_messages(int frames);
/// Messages as recorded by realsense-ros under `camera`: depth_of(100), depth_of(101), ... with
/// color.
Ros2Messages realsense_ros_messages(int frames, const std::string& camera = "/camera/camera");

}  // namespace planescope::testing_bags
