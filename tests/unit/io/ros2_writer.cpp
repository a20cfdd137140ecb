#include "unit/io/ros2_writer.hpp"

#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace planescope::testing_bags {
namespace {

/// Lays out fields as CDR does: each at a multiple of its size, counted behind the first four
/// bytes.
class Cdr {
 public:
  explicit Cdr(bool big_endian = false) : big_endian_(big_endian) {
    out_ = {0, static_cast<unsigned char>(big_endian ? 0 : 1), 0, 0};
  }
  template <typename T>
  Cdr& put(T value) {
    while ((out_.size() - 4) % sizeof(T) != 0) out_.push_back(0xcd);
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (big_endian_) std::reverse(bytes, bytes + sizeof(T));
    out_.insert(out_.end(), bytes, bytes + sizeof(T));
    return *this;
  }
  Cdr& text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.insert(out_.end(), text.begin(), text.end());
    out_.push_back(0);
    return *this;
  }
  Cdr& bytes(const ByteVector& bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  Cdr& header(double stamp_s, const std::string& frame_id) {
    const double whole = std::floor(stamp_s);
    put(static_cast<std::int32_t>(whole));
    put(static_cast<std::uint32_t>(std::lround(1e9 * (stamp_s - whole))));
    return text(frame_id);
  }
  const ByteVector& take() const { return out_; }

 private:
  ByteVector out_;
  bool big_endian_;
};

}  // namespace

ByteVector cdr_image(const ImageMessage& image, bool big_endian) {
  ByteVector pixels = image.pixels;
  const std::size_t row = pixels.size() / image.height;
  return Cdr(big_endian)
      .header(image.stamp_s, image.frame_id)
      .put(static_cast<std::uint32_t>(image.height))
      .put(static_cast<std::uint32_t>(image.width))
      .text(image.encoding)
      .put(static_cast<std::uint8_t>(image.big_endian))
      .put(static_cast<std::uint32_t>(row))
      .bytes(pixels)
      .take();
}

ByteVector cdr_compressed_image(double stamp_s,
                                const std::string& frame_id,
                                const std::string& format,
                                const ByteVector& data) {
  return Cdr().header(stamp_s, frame_id).text(format).bytes(data).take();
}

ByteVector cdr_camera_info(int width, int height, std::array<double, 4> k) {
  Cdr out;
  out.header(0, "optical").put(static_cast<std::uint32_t>(height));
  out.put(static_cast<std::uint32_t>(width)).text("plumb_bob");
  out.put(std::uint32_t{5});
  for (int i = 0; i < 5; ++i) out.put(0.0);
  for (const double v : {k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0}) out.put(v);
  for (int i = 0; i < 9 + 12; ++i) out.put(0.0);          // R and P
  for (int i = 0; i < 6; ++i) out.put(std::uint32_t{0});  // binning and region of interest
  return out.put(std::uint8_t{0}).take();
}

ByteVector cdr_imu(double stamp_s, const Vec3d& acceleration, const std::string& frame_id) {
  Cdr out;
  out.header(stamp_s, frame_id);
  for (int i = 0; i < 4 + 9 + 3 + 9; ++i) out.put(-7.0);
  for (int i = 0; i < 3; ++i) out.put(acceleration[i]);
  for (int i = 0; i < 9; ++i) out.put(0.0);
  return out.take();
}

ByteVector cdr_tf(const std::string& parent, const std::string& child, const Pose& pose) {
  Cdr out;
  out.put(std::uint32_t{1}).header(0, parent).text(child);
  const Eigen::Quaterniond q(pose.linear());
  for (int i = 0; i < 3; ++i) out.put(pose.translation()[i]);
  for (const double v : {q.x(), q.y(), q.z(), q.w()}) out.put(v);
  return out.take();
}

ByteVector cdr_text(const std::string& text) { return Cdr().text(text).take(); }

ByteVector zstd_packed(const ByteVector& bytes) {
  ByteVector out(ZSTD_compressBound(bytes.size()));
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}

ByteVector rvl_packed(const Image16& depth) {
  ByteVector out;
  const auto put_word = [&](std::uint32_t word) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<unsigned char>(word >> (8 * i)));
  };
  put_word(static_cast<std::uint32_t>(depth.width));
  put_word(static_cast<std::uint32_t>(depth.height));
  std::uint32_t word = 0;
  int nibbles = 0;
  const auto put = [&](std::uint32_t value) {
    do {
      const std::uint32_t more = value > 7 ? 8 : 0;
      word = word << 4 | more | (value & 7);
      value >>= 3;
      if (++nibbles == 8) {
        put_word(word);
        nibbles = 0;
      }
    } while (value > 0);
  };
  int before = 0;
  for (std::size_t at = 0; at < depth.data.size();) {
    std::size_t end = at;
    while (end < depth.data.size() && depth.data[end] == 0) ++end;
    put(static_cast<std::uint32_t>(end - at));
    at = end;
    while (end < depth.data.size() && depth.data[end] != 0) ++end;
    put(static_cast<std::uint32_t>(end - at));
    for (; at < end; ++at) {
      const int change = depth.data[at] - before;
      put(static_cast<std::uint32_t>(change < 0 ? -2 * change - 1 : 2 * change));
      before = depth.data[at];
    }
  }
  if (nibbles > 0) put_word(word << (4 * (8 - nibbles)));
  return out;
}

ByteVector with_config(const ByteVector& picture) {
  ByteVector bytes(12, 7);
  bytes.insert(bytes.end(), picture.begin(), picture.end());
  return bytes;
}

ByteVector zstd_transport(const Image16& depth) {
  const std::string encoding = "16UC1";
  ByteVector out;
  const auto put = [&](std::uint32_t value) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<unsigned char>(value >> (8 * i)));
  };
  put(static_cast<std::uint32_t>(depth.height));
  put(static_cast<std::uint32_t>(depth.width));
  out.push_back(0);
  put(static_cast<std::uint32_t>(2 * depth.width));
  put(static_cast<std::uint32_t>(encoding.size()));
  out.insert(out.end(), encoding.begin(), encoding.end());
  ByteVector pixels(2 * depth.data.size());
  std::memcpy(pixels.data(), depth.data.data(), pixels.size());
  const ByteVector stored = zstd_packed(pixels);
  out.insert(out.end(), stored.begin(), stored.end());
  return out;
}

Ros2Messages packed(Ros2Messages messages) {
  for (Ros2Message& message : messages) message.bytes = zstd_packed(message.bytes);
  return messages;
}

void write_db3(const std::filesystem::path& path, const Ros2Messages& messages, int page) {
  std::filesystem::remove(path);
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  const auto run = [&](const std::string& sql) {
    if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
      throw std::runtime_error(sqlite3_errmsg(database));
    }
  };
  run("PRAGMA page_size = " + std::to_string(page) + "; PRAGMA synchronous = OFF");
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
      "timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  run("BEGIN");
  std::map<std::string, int> ids;
  for (const Ros2Message& message : messages) {
    if (ids.contains(message.topic)) continue;
    const int id = static_cast<int>(ids.size()) + 1;
    ids[message.topic] = id;
    run("INSERT INTO topics VALUES(" + std::to_string(id) + ",'" + message.topic + "','" +
        message.type + "','cdr','')");
  }
  for (const Ros2Message& message : messages) {
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", -1,
                       &insert, nullptr);
    sqlite3_bind_int(insert, 1, ids[message.topic]);
    sqlite3_bind_int64(insert, 2, static_cast<sqlite3_int64>(message.time_ns));
    sqlite3_bind_blob(insert, 3, message.bytes.data(), static_cast<int>(message.bytes.size()),
                      SQLITE_STATIC);
    sqlite3_step(insert);
    sqlite3_finalize(insert);
  }
  run("COMMIT");
  sqlite3_close(database);
}

namespace {

/// Fields and records of MCAP: https://mcap.dev/spec
class McapBytes {
 public:
  template <typename T>
  McapBytes& put(T value) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out.insert(out.end(), bytes, bytes + sizeof(T));
    return *this;
  }
  McapBytes& text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    out.insert(out.end(), text.begin(), text.end());
    return *this;
  }
  McapBytes& raw(const ByteVector& bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
    return *this;
  }
  McapBytes& record(int op, const McapBytes& content) {
    put(static_cast<std::uint8_t>(op)).put(static_cast<std::uint64_t>(content.out.size()));
    return raw(content.out);
  }
  ByteVector out;
};

ByteVector mcap_packed(const ByteVector& bytes, const std::string& compression) {
  if (compression == "zstd") return zstd_packed(bytes);
  if (compression.empty()) return bytes;
  ByteVector out(LZ4F_compressFrameBound(bytes.size(), nullptr));
  out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  return out;
}

}  // namespace

void write_mcap(const std::filesystem::path& path,
                const Ros2Messages& messages,
                const McapForm& form) {
  const ByteVector magic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
  McapBytes file, summary;
  file.raw(magic).record(1, McapBytes().text("ros2").text("a writer of tests"));
  std::map<std::string, std::uint16_t> ids;
  McapBytes chunk;  // what is written next into it
  std::map<std::uint16_t, McapBytes> entries;
  std::size_t in_chunk = 0, chunks = 0;
  std::uint64_t first_ns = 0, last_ns = 0;  // of the chunk; messages come in their order
  const auto end_chunk = [&] {
    if (in_chunk == 0) return;
    const ByteVector stored = mcap_packed(chunk.out, form.compression);
    const std::uint64_t start = file.out.size();
    McapBytes content;
    content.put(first_ns).put(last_ns).put(std::uint64_t{chunk.out.size()});
    content.put(std::uint32_t{0}).text(form.compression).put(std::uint64_t{stored.size()});
    file.record(6, content.raw(stored));
    const std::uint64_t index_start = file.out.size();
    McapBytes offsets;
    for (const auto& [channel, list] : entries) {
      offsets.put(channel).put(std::uint64_t{file.out.size()});
      McapBytes of_channel;
      of_channel.put(channel).put(static_cast<std::uint32_t>(list.out.size())).raw(list.out);
      file.record(7, of_channel);
    }
    McapBytes place;
    place.put(first_ns).put(last_ns).put(start).put(index_start - start);
    place.put(static_cast<std::uint32_t>(offsets.out.size())).raw(offsets.out);
    place.put(std::uint64_t{file.out.size() - index_start}).text(form.compression);
    place.put(std::uint64_t{stored.size()}).put(std::uint64_t{chunk.out.size()});
    summary.record(8, place);
    chunk = {};
    entries.clear();
    in_chunk = 0;
    ++chunks;
  };
  std::uint32_t sequence = 0;
  for (const Ros2Message& message : messages) {
    McapBytes& to = form.in_chunk == 0 ? file : chunk;
    const auto [known, is_new] =
        ids.try_emplace(message.topic, static_cast<std::uint16_t>(ids.size()));
    const std::uint16_t id = known->second;
    if (is_new) {
      McapBytes schema, channel;
      schema.put(static_cast<std::uint16_t>(id + 1)).text(message.type).text("ros2msg").text("");
      channel.put(id).put(static_cast<std::uint16_t>(id + 1)).text(message.topic);
      channel.text(form.encoding).put(std::uint32_t{0});
      for (McapBytes* bytes : {&to, &summary}) bytes->record(3, schema).record(4, channel);
    }
    if (in_chunk == 0) first_ns = message.time_ns;
    last_ns = message.time_ns;
    entries[id].put(message.time_ns).put(std::uint64_t{to.out.size()});
    McapBytes content;
    content.put(id).put(sequence++).put(message.time_ns).put(message.time_ns);
    to.record(5, content.raw(message.bytes));
    if (form.in_chunk > 0 && ++in_chunk == form.in_chunk) end_chunk();
  }
  end_chunk();
  file.record(0x0f, McapBytes().put(std::uint32_t{0}));
  const std::uint64_t summary_start = form.summary ? file.out.size() : 0;
  if (form.summary) {
    McapBytes counts;
    counts.put(std::uint64_t{messages.size()}).put(static_cast<std::uint16_t>(ids.size()));
    counts.put(static_cast<std::uint32_t>(ids.size())).put(std::uint32_t{0});
    counts.put(std::uint32_t{0}).put(static_cast<std::uint32_t>(chunks));
    counts.put(messages.front().time_ns).put(messages.back().time_ns).put(std::uint32_t{0});
    file.raw(summary.out).record(0x0b, counts);
  }
  McapBytes footer;
  footer.put(summary_start).put(std::uint64_t{0}).put(std::uint32_t{0});
  file.record(2, footer).raw(magic);
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(file.out.data()),
             static_cast<std::streamsize>(file.out.size()));
}

Ros2Messages sdk_messages(int frames) {
  const std::string text = "std_msgs/msg/String", image = "sensor_msgs/msg/Image";
  Ros2Messages all;
  const auto say = [&](const std::string& topic, std::uint64_t time_ns, const std::string& what) {
    all.push_back({topic, text, time_ns, cdr_text(what)});
  };
  say("/device_0/info", 0, "Name=Intel RealSense D435I;Serial Number=1");
  say("/device_0/sensor_0/option/Depth_Units/value", 0, "0.000250");
  const auto camera_info = [](const std::string& numbers) {
    return "width=24;height=16;" + numbers +
           ";model=Brown Conrady;coeffs=0.000000,0.000000,0.000000,0.000000,0.000000";
  };
  say(kSdkDepth + "/camera_info", 0, camera_info("fx=20;ppx=12;fy=21;ppy=8"));
  say(kSdkColor + "/camera_info", 0, camera_info("fx=30;ppx=13;fy=31;ppy=9"));
  say(kSdkDepth + "/tf/ref_0", 0,
      "rotation=1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0;translation=0.0,0.0,0.0");
  // A turn by 90 degrees about z, column by column.
  say(kSdkColor + "/tf/ref_0", 0,
      "rotation=0.0,1.0,0.0,-1.0,0.0,0.0,0.0,0.0,1.0;translation=0.015,0.001,-0.002");
  for (int i = 0; i < frames; ++i) {
    const auto time_ns = static_cast<std::uint64_t>(1e9 * (0.001 + i * kDepthPeriod_s));
    const auto facts = [&](int number, double time_ms) {
      return "Frame number=" + std::to_string(number) +
             ";timestamp_domain=Hardware Clock;system_time=1.5;timestamp=" +
             std::to_string(time_ms) + ";";
    };
    const auto depth = depth_message(100 + i, 1e-9 * static_cast<double>(time_ns));
    const auto color = color_message(10 + i, 1e-9 * static_cast<double>(time_ns + 9));
    const double time_ms = 1e3 * (500 + i * kDepthPeriod_s);
    all.push_back({kSdkDepth + "/image/data", image, time_ns, cdr_image(depth)});
    say(kSdkDepth + "/image/metadata", time_ns,
        facts(100 + i, time_ms) + "depth_units=0.000250;Frame Counter=1;");
    all.push_back({kSdkColor + "/image/data", image, time_ns + 9, cdr_image(color)});
    say(kSdkColor + "/image/metadata", time_ns + 9, facts(10 + i, time_ms + 4));
  }
  return all;
}

Ros2Messages realsense_ros_messages(int frames, const std::string& camera) {
  const std::string image = "sensor_msgs/msg/Image", info = "sensor_msgs/msg/CameraInfo";
  Ros2Messages all;
  const std::string depth = camera + "/depth", color = camera + "/color";
  const std::uint64_t start_ns = 1'700'000'000'000'000'000;
  Pose T_depth_color = Pose::Identity();
  T_depth_color.translation() = Vec3d(0.015, 0, 0);
  all.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", start_ns,
                 cdr_tf("depth_optical", "color_optical", T_depth_color)});
  Pose T_depth_accel = Pose::Identity();
  T_depth_accel.linear() = Eigen::AngleAxisd(M_PI / 2, Vec3d::UnitX()).toRotationMatrix();
  all.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", start_ns,
                 cdr_tf("depth_optical", "accel_optical", T_depth_accel)});
  for (int i = 0; i < frames; ++i) {
    const double time_s = i * kDepthPeriod_s;
    const std::uint64_t time_ns = start_ns + static_cast<std::uint64_t>(1e9 * time_s);
    ImageMessage message = depth_message(100 + i, 1'700'000'000 + time_s);
    message.frame_id = "depth_optical";
    message.encoding = "16UC1";
    all.push_back({depth + "/image_rect_raw", image, time_ns, cdr_image(message)});
    all.push_back(
        {depth + "/camera_info", info, time_ns, cdr_camera_info(kWidth, kHeight, {20, 21, 12, 8})});
    message = color_message(10 + i, 1'700'000'000 + time_s + 0.004);
    message.frame_id = "color_optical";
    all.push_back({color + "/image_raw", image, time_ns + 1, cdr_image(message)});
    all.push_back({color + "/camera_info", info, time_ns + 1,
                   cdr_camera_info(kWidth, kHeight, {30, 31, 13, 9})});
    all.push_back({camera + "/accel/sample", "sensor_msgs/msg/Imu", time_ns + 2,
                   cdr_imu(1'700'000'000 + time_s, Vec3d(0, 0, 9.81), "accel_optical")});
  }
  return all;
}

}  // namespace planescope::testing_bags
