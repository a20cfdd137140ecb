// Writes ROS 1 bags and ROS messages for tests, independently of the reader.

#include "unit/io/bag_writer.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <cmath>
#include <cstring>
#include <random>

namespace planescope::testing_bags {
namespace {

template <typename T>
std::string bytes_of(T value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}

std::string field(const std::string& name, const std::string& value) {
  const std::string text = name + "=" + value;
  return bytes_of(static_cast<std::uint32_t>(text.size())) + text;
}

void put_bytes(ByteVector& out, const ByteVector& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void put_record(ByteVector& out, const std::string& header, const ByteVector& data) {
  put_bytes(out, Fields().text(header).sized(data).out);
}

constexpr std::uint64_t kSecond = 1'000'000'000;  // [ns]

std::string time_bytes(std::uint64_t time_ns) {
  return bytes_of(static_cast<std::uint32_t>(time_ns / kSecond)) +
         bytes_of(static_cast<std::uint32_t>(time_ns % kSecond));
}

ByteVector compress(const std::string& how, const ByteVector& raw) {
  if (how == "lz4") {
    LZ4F_preferences_t preferences{};
    preferences.frameInfo.blockSizeID = LZ4F_max1MB;
    preferences.frameInfo.blockMode = LZ4F_blockIndependent;
    preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
    ByteVector out(LZ4F_compressFrameBound(raw.size(), &preferences));
    out.resize(LZ4F_compressFrame(out.data(), out.size(), raw.data(), raw.size(), &preferences));
    return out;
  }
  if (how == "bz2") {
    auto size = static_cast<unsigned>(raw.size() + raw.size() / 50 + 1000);
    ByteVector out(size);
    BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &size,
                             reinterpret_cast<char*>(const_cast<unsigned char*>(raw.data())),
                             static_cast<unsigned>(raw.size()), 9, 0, 30);
    out.resize(size);
    return out;
  }
  return raw;
}

constexpr std::size_t kBagHeaderBytes = 4096;

ByteVector bag_header(std::uint64_t index_position, std::size_t connections, std::size_t chunks) {
  const std::string header =
      field("chunk_count", bytes_of(static_cast<std::uint32_t>(chunks))) +
      field("conn_count", bytes_of(static_cast<std::uint32_t>(connections))) +
      field("index_pos", bytes_of(index_position)) + field("op", "\x03");
  ByteVector out;
  put_record(out, header, ByteVector(kBagHeaderBytes - 8 - header.size(), ' '));
  return out;
}

const std::string kMagic = "#ROSBAG V2.0\n";

}  // namespace

void BagWriter::add(const std::string& topic,
                    const std::string& type,
                    std::uint64_t time_ns,
                    const ByteVector& message) {
  if (file_.empty()) {
    file_.assign(kMagic.begin(), kMagic.end());
    put_bytes(file_, bag_header(0, 0, 0));
  }
  if (!ids_.contains(topic)) {
    const auto id = static_cast<std::uint32_t>(ids_.size());
    ids_[topic] = id;
    const std::string description = field("topic", topic) + field("type", type) +
                                    field("md5sum", "*") + field("message_definition", "");
    put_record(connection_records_[id],
               field("conn", bytes_of(id)) + field("op", "\x07") + field("topic", topic),
               ByteVector(description.begin(), description.end()));
    put_bytes(chunk_, connection_records_[id]);
  }
  const std::uint32_t id = ids_[topic];
  chunk_entries_[id].push_back({time_ns, static_cast<std::uint32_t>(chunk_.size())});
  put_record(chunk_,
             field("conn", bytes_of(id)) + field("op", "\x02") + field("time", time_bytes(time_ns)),
             message);
  chunk_ends_.emplace_back(topic, chunk_.size());
  if (++chunk_messages_ == format_.messages_per_chunk) close_chunk(false);
}

void BagWriter::close_chunk(bool last) {
  if (chunk_messages_ == 0) return;
  const ByteVector stored = compress(format_.compression, chunk_);
  const bool close = !last || format_.close_last_chunk;
  chunks_.push_back({file_.size(), chunk_entries_});
  const std::string header =
      field("compression", format_.compression) + field("op", "\x05") +
      field("size", bytes_of(static_cast<std::uint32_t>(close ? chunk_.size() : 0)));
  put_bytes(file_, Fields().text(header).put_32(close ? stored.size() : 0).out);
  for (const auto& [topic, end] : chunk_ends_) ends_[topic].push_back(file_.size() + end);
  put_bytes(file_, stored);
  if (format_.chunk_index && close) {
    for (const auto& [id, entries] : chunk_entries_) {
      Fields data;
      for (const Entry& entry : entries)
        data.put_32(entry.time_ns / kSecond).put_32(entry.time_ns % kSecond).put(entry.offset);
      put_record(file_,
                 field("conn", bytes_of(id)) +
                     field("count", bytes_of(static_cast<std::uint32_t>(entries.size()))) +
                     field("op", "\x04") + field("ver", bytes_of(std::uint32_t{1})),
                 data.out);
    }
  }
  chunk_.clear();
  chunk_entries_.clear();
  chunk_ends_.clear();
  chunk_messages_ = 0;
}

ByteVector BagWriter::finish() {
  close_chunk(true);
  if (!format_.index) return file_;
  const std::uint64_t index_position = file_.size();
  for (const auto& [id, record] : connection_records_) put_bytes(file_, record);
  for (const ChunkInfo& chunk : chunks_) {
    Fields data;
    for (const auto& [id, entries] : chunk.entries) data.put(id).put_32(entries.size());
    for (int i = 0; i < format_.named_times; ++i)
      put_record(file_,
                 field("chunk_pos", bytes_of(chunk.position)) +
                     field("count", bytes_of(static_cast<std::uint32_t>(chunk.entries.size()))) +
                     field("end_time", time_bytes(0)) + field("op", "\x06") +
                     field("start_time", time_bytes(0)) + field("ver", bytes_of(std::uint32_t{1})),
                 data.out);
  }
  const ByteVector header =
      bag_header(index_position, connection_records_.size(),
                 chunks_.size() * static_cast<std::size_t>(format_.named_times));
  std::copy(header.begin(), header.end(), file_.begin() + kMagic.size());
  return file_;
}

// ---- Messages ----

Fields& Fields::header(std::uint32_t seq, double stamp_s, const std::string& frame_id) {
  const double seconds = std::floor(stamp_s);
  if (wire_ == Wire::ros1) put(seq);
  put(static_cast<std::uint32_t>(seconds));
  put(static_cast<std::uint32_t>(std::lround((stamp_s - seconds) * 1e9)));
  return text(frame_id);
}

ByteVector compressed_image_message(double stamp_s,
                                    const std::string& frame_id,
                                    const std::string& format,
                                    const ByteVector& data,
                                    Wire wire) {
  return Fields(wire).header(7, stamp_s, frame_id).text(format).sized(data).out;
}

ByteVector image_message(const ImageMessage& image, Wire wire) {
  Fields fields(wire);
  fields.header(image.seq, image.stamp_s, image.frame_id);
  fields.put_32(image.height).put_32(image.width).text(image.encoding);
  fields.put(static_cast<std::uint8_t>(image.big_endian));
  const std::size_t row = image.pixels.size() / image.height;
  fields.put_32(row + image.row_padding).put_32((row + image.row_padding) * image.height);
  for (int y = 0; y < image.height; ++y) {
    fields.out.insert(fields.out.end(), &image.pixels[y * row], &image.pixels[y * row] + row);
    fields.out.insert(fields.out.end(), image.row_padding, 0xee);
  }
  if (image.depth_unit_m) fields.put(*image.depth_unit_m);
  return fields.out;
}

ByteVector camera_info_message(int width,
                               int height,
                               std::array<double, 4> k,
                               const std::string& model,
                               const std::vector<double>& d,
                               Wire wire) {
  Fields fields(wire);
  fields.header(0, 0, "0").put_32(height).put_32(width).text(model).put_32(d.size());
  for (const double c : d) fields.put(c);
  for (const double v : {k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0}) fields.put(v);
  for (int i = 0; i < 9 + 12; ++i) fields.put(0.0);  // R and P
  for (int i = 0; i < 6; ++i) fields.put_32(0);      // binning and region of interest
  return fields.put(std::uint8_t{0}).out;
}

ByteVector imu_message(std::uint32_t seq,
                       double stamp_s,
                       const Vec3d& acceleration,
                       const std::string& frame_id,
                       Wire wire) {
  Fields fields(wire);
  fields.header(seq, stamp_s, frame_id);
  for (int i = 0; i < 4 + 9 + 3 + 9; ++i) fields.put(-7.0);
  for (const double v : acceleration) fields.put(v);
  for (int i = 0; i < 9; ++i) fields.put(0.0);
  return fields.out;
}

namespace {

Fields& put_transform(Fields& fields, const Pose& pose, double quaternion_scale) {
  for (const double v : pose.translation()) fields.put(v);
  const Eigen::Quaterniond q(pose.linear());
  for (const double v : {q.x(), q.y(), q.z(), q.w()}) fields.put(quaternion_scale * v);
  return fields;
}

}  // namespace

ByteVector transform_message(const Pose& pose, double quaternion_scale) {
  Fields fields;
  return put_transform(fields, pose, quaternion_scale).out;
}

ByteVector tf_message(const std::string& parent,
                      const std::string& child,
                      const Pose& pose,
                      Wire wire) {
  Fields fields(wire);
  fields.put_32(1).header(0, 0, parent).text(child);
  return put_transform(fields, pose, 1).out;
}

ByteVector extrinsics_message(const Pose& pose) {
  Fields fields;
  fields.header(0, 0, "depth_to_color_extrinsics");
  for (const double v : pose.linear().reshaped()) fields.put(v);
  for (const double v : pose.translation()) fields.put(v);
  return fields.out;
}

// ---- Samples ----

Image16 depth_of(std::uint32_t seq) {
  std::mt19937 random(seq);
  Image16 depth(kWidth, kHeight);
  for (auto& count : depth.data) count = static_cast<std::uint16_t>(random() % 4000);
  return depth;
}

ByteVector pixels_of(const Image16& image) {
  ByteVector bytes;
  for (const std::uint16_t count : image.data) {
    bytes.push_back(static_cast<unsigned char>(count & 255));
    bytes.push_back(static_cast<unsigned char>(count >> 8));
  }
  return bytes;
}

ByteVector plain_color(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  ByteVector bytes;
  for (int i = 0; i < kWidth * kHeight; ++i) bytes.insert(bytes.end(), {red, green, blue});
  return bytes;
}

ImageMessage depth_message(std::uint32_t seq, double stamp_s) {
  ImageMessage image;
  image.seq = seq;
  image.stamp_s = stamp_s;
  image.width = kWidth;
  image.height = kHeight;
  image.pixels = pixels_of(depth_of(seq));
  return image;
}

ImageMessage color_message(std::uint32_t seq, double stamp_s) {
  ImageMessage image = depth_message(seq, stamp_s);
  image.encoding = "rgb8";
  image.pixels = plain_color(static_cast<std::uint8_t>(seq), 20, 30);
  return image;
}

void add_depth(BagWriter& bag, std::uint64_t time_ns, const ImageMessage& image) {
  bag.add(kSdkDepth + "/image/data", "sensor_msgs/Image", time_ns, image_message(image));
}
void add_color(BagWriter& bag, std::uint64_t time_ns, const ImageMessage& image) {
  bag.add(kSdkColor + "/image/data", "sensor_msgs/Image", time_ns, image_message(image));
}

void add_sdk_statics(BagWriter& bag, const SdkBag& options) {
  bag.add("/device_0/info", "diagnostic_msgs/KeyValue", 1, Fields().text("Serial").text("1").out);
  bag.add("/device_0/info", "diagnostic_msgs/KeyValue", 1,
          Fields().text("Name").text("Intel RealSense D435I").out);
  bag.add(kSdkDepth + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(kWidth, kHeight, {20, 21, 12, 8}));
  bag.add(kSdkColor + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(kWidth, kHeight, {30, 31, 13, 9}));
  bag.add(std::string("/device_0/sensor_0/option/") +
              (options.sdk_2_49 ? "Depth_Units" : "Depth Units") + "/value",
          "std_msgs/Float32", 1, Fields().put(options.unit_m).out);
  Pose T_color_reference = Pose::Identity();
  T_color_reference.linear() = Eigen::AngleAxisd(0.1, Vec3d::UnitY()).toRotationMatrix();
  T_color_reference.translation() = Vec3d(0.015, 0.001, -0.002);
  bag.add(kSdkDepth + "/tf/0", "geometry_msgs/Transform", 1, transform_message(Pose::Identity()));
  // Some SDK versions wrote quaternions that are not of unit length.
  bag.add(kSdkColor + "/tf/0", "geometry_msgs/Transform", 1,
          transform_message(T_color_reference, 1.7));
}

BagWriter sdk_bag(const SdkBag& options) {
  BagWriter bag(options.format);
  add_sdk_statics(bag, options);
  for (int i = 0; i < options.frames; ++i) {
    const double time_s = 500 + i * kDepthPeriod_s;
    const auto time_ns = static_cast<std::uint64_t>(1e9 * (0.001 + i * kDepthPeriod_s));
    auto depth = depth_message(100 + i, time_s);
    auto color = color_message(10 + i, time_s + 0.004);
    if (options.sdk_2_49) {
      depth.frame_id = color.frame_id = std::string("1");
      depth.depth_unit_m = options.unit_m;
      color.depth_unit_m = 0;
    }
    add_depth(bag, time_ns, depth);
    add_color(bag, time_ns + 9, color);
  }
  return bag;
}

}  // namespace planescope::testing_bags
