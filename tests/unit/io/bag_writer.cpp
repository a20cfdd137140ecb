#include "unit/io/bag_writer.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <cmath>
#include <cstring>

namespace planescope::testing_bags {
namespace {

template <typename T>
void put(ByteVector& out, T value) {
  const auto at = out.size();
  out.resize(at + sizeof(T));
  std::memcpy(out.data() + at, &value, sizeof(T));
}

void put_bytes(ByteVector& out, const ByteVector& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void put_text(ByteVector& out, const std::string& text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

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

void put_record(ByteVector& out, const std::string& header, const ByteVector& data) {
  put_text(out, header);
  put(out, static_cast<std::uint32_t>(data.size()));
  put_bytes(out, data);
}

std::string time_bytes(std::uint64_t time_ns) {
  return bytes_of(static_cast<std::uint32_t>(time_ns / 1'000'000'000)) +
         bytes_of(static_cast<std::uint32_t>(time_ns % 1'000'000'000));
}

void put_header(ByteVector& out, std::uint32_t seq, double stamp_s, const std::string& frame_id) {
  put(out, seq);
  const double seconds = std::floor(stamp_s);
  put(out, static_cast<std::uint32_t>(seconds));
  put(out, static_cast<std::uint32_t>(std::lround((stamp_s - seconds) * 1e9)));
  put_text(out, frame_id);
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
  put_text(file_,
           field("compression", format_.compression) + field("op", "\x05") +
               field("size", bytes_of(static_cast<std::uint32_t>(close ? chunk_.size() : 0))));
  put(file_, static_cast<std::uint32_t>(close ? stored.size() : 0));
  for (const auto& [topic, end] : chunk_ends_) ends_[topic].push_back(file_.size() + end);
  put_bytes(file_, stored);
  if (format_.chunk_index && close) {
    for (const auto& [id, entries] : chunk_entries_) {
      ByteVector data;
      for (const Entry& entry : entries) {
        const std::string time = time_bytes(entry.time_ns);
        data.insert(data.end(), time.begin(), time.end());
        put(data, entry.offset);
      }
      put_record(file_,
                 field("conn", bytes_of(id)) +
                     field("count", bytes_of(static_cast<std::uint32_t>(entries.size()))) +
                     field("op", "\x04") + field("ver", bytes_of(std::uint32_t{1})),
                 data);
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
    ByteVector data;
    for (const auto& [id, entries] : chunk.entries) {
      put(data, id);
      put(data, static_cast<std::uint32_t>(entries.size()));
    }
    for (int i = 0; i < format_.named_times; ++i)
      put_record(file_,
                 field("chunk_pos", bytes_of(chunk.position)) +
                     field("count", bytes_of(static_cast<std::uint32_t>(chunk.entries.size()))) +
                     field("end_time", time_bytes(0)) + field("op", "\x06") +
                     field("start_time", time_bytes(0)) + field("ver", bytes_of(std::uint32_t{1})),
                 data);
  }
  const ByteVector header =
      bag_header(index_position, connection_records_.size(),
                 chunks_.size() * static_cast<std::size_t>(format_.named_times));
  std::copy(header.begin(), header.end(), file_.begin() + kMagic.size());
  return file_;
}

ByteVector compressed_image_message(double stamp_s,
                                    const std::string& frame_id,
                                    const std::string& format,
                                    const ByteVector& data) {
  ByteVector out;
  put_header(out, 7, stamp_s, frame_id);
  put_text(out, format);
  put(out, static_cast<std::uint32_t>(data.size()));
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

ByteVector image_message(const ImageMessage& image) {
  ByteVector out;
  put_header(out, image.seq, image.stamp_s, image.frame_id);
  put(out, static_cast<std::uint32_t>(image.height));
  put(out, static_cast<std::uint32_t>(image.width));
  put_text(out, image.encoding);
  put(out, static_cast<std::uint8_t>(image.big_endian));
  const std::size_t row = image.pixels.size() / image.height;
  put(out, static_cast<std::uint32_t>(row + image.row_padding));
  put(out, static_cast<std::uint32_t>((row + image.row_padding) * image.height));
  for (int y = 0; y < image.height; ++y) {
    out.insert(out.end(), &image.pixels[y * row], &image.pixels[y * row] + row);
    out.insert(out.end(), image.row_padding, 0xee);
  }
  if (image.depth_unit_m) put(out, *image.depth_unit_m);
  return out;
}

ByteVector camera_info_message(int width,
                               int height,
                               std::array<double, 4> k,
                               const std::string& model,
                               const std::vector<double>& d) {
  ByteVector out;
  put_header(out, 0, 0, "0");
  put(out, static_cast<std::uint32_t>(height));
  put(out, static_cast<std::uint32_t>(width));
  put_text(out, model);
  put(out, static_cast<std::uint32_t>(d.size()));
  for (const double c : d) put(out, c);
  for (const double v : {k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0}) put(out, v);
  for (int i = 0; i < 9 + 12; ++i) put(out, 0.0);          // R and P
  for (int i = 0; i < 6; ++i) put(out, std::uint32_t{0});  // binning and region of interest
  put(out, std::uint8_t{0});
  return out;
}

ByteVector imu_message(std::uint32_t seq,
                       double stamp_s,
                       const Vec3d& acceleration,
                       const std::string& frame_id) {
  ByteVector out;
  put_header(out, seq, stamp_s, frame_id);
  for (int i = 0; i < 4 + 9 + 3 + 9; ++i) put(out, 0.0);
  for (int i = 0; i < 3; ++i) put(out, acceleration[i]);
  for (int i = 0; i < 9; ++i) put(out, 0.0);
  return out;
}

ByteVector transform_message(const Pose& pose, double quaternion_scale) {
  ByteVector out;
  for (int i = 0; i < 3; ++i) put(out, pose.translation()[i]);
  const Eigen::Quaterniond q(pose.linear());
  for (const double v : {q.x(), q.y(), q.z(), q.w()}) put(out, quaternion_scale * v);
  return out;
}

ByteVector tf_message(const std::string& parent, const std::string& child, const Pose& pose) {
  ByteVector out;
  put(out, std::uint32_t{1});
  put_header(out, 0, 0, parent);
  put_text(out, child);
  put_bytes(out, transform_message(pose));
  return out;
}

ByteVector extrinsics_message(const Pose& pose) {
  ByteVector out;
  put_header(out, 0, 0, "depth_to_color_extrinsics");
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) put(out, pose.linear()(row, column));
  }
  for (int i = 0; i < 3; ++i) put(out, pose.translation()[i]);
  return out;
}

ByteVector float_message(float value) {
  ByteVector out;
  put(out, value);
  return out;
}

ByteVector key_value_message(const std::string& key, const std::string& value) {
  ByteVector out;
  put_text(out, key);
  put_text(out, value);
  return out;
}

}  // namespace planescope::testing_bags
