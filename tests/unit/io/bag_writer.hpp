#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::testing_bags {

using ByteVector = std::vector<unsigned char>;

struct BagFormat {
  std::string compression = "none";  // none, lz4, bz2
  bool index = true;                 // the index section at the end and its place in the header
  bool chunk_index = true;           // the INDEX_DATA records behind each chunk
  bool close_last_chunk = true;      // false: its sizes were never written, as after a power cut
  int messages_per_chunk = 8;
  int named_times = 1;  // each chunk in the index
};

/// Writes ROS 1 bags, whole and broken ones, independently of the reader.
class BagWriter {
 public:
  explicit BagWriter(BagFormat format = {}) : format_(format) {}
  void add(const std::string& topic,
           const std::string& type,
           std::uint64_t time_ns,
           const ByteVector& message);
  /// The whole file.
  ByteVector finish();
  std::size_t bytes() const { return file_.size(); }
  /// For uncompressed bags: the byte behind each message on `topic`, in order.
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

// ROS 1 messages as bytes.
struct ImageMessage {
  std::uint32_t seq = 0;
  double stamp_s = 0;
  std::string frame_id = "0";
  std::string encoding = "mono16";
  int width = 0, height = 0;
  int row_padding = 0;  // bytes behind each row
  bool big_endian = false;
  ByteVector pixels;
  std::optional<float> depth_unit_m;  // the four extra bytes of SDK 2.49
};
ByteVector image_message(const ImageMessage& image);
ByteVector compressed_image_message(double stamp_s,
                                    const std::string& frame_id,
                                    const std::string& format,
                                    const ByteVector& data);
ByteVector camera_info_message(int width,
                               int height,
                               std::array<double, 4> k,
                               const std::string& model = "Brown Conrady",
                               const std::vector<double>& d = {0, 0, 0, 0, 0});
ByteVector imu_message(std::uint32_t seq,
                       double stamp_s,
                       const Vec3d& acceleration,
                       const std::string& frame_id = "0");
ByteVector transform_message(const Pose& pose, double quaternion_scale = 1);
ByteVector tf_message(const std::string& parent, const std::string& child, const Pose& pose);
ByteVector extrinsics_message(const Pose& pose);
ByteVector float_message(float value);
ByteVector key_value_message(const std::string& key, const std::string& value);

}  // namespace planescope::testing_bags
