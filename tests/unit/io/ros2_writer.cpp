// Writes ROS 2 databases and MCAP files for tests, independently of the reader.

#include <libdeflate.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "unit/io/bag_writer.hpp"

namespace planescope::testing_bags {
ByteVector zstd_packed(const ByteVector& bytes) {
  ByteVector out(ZSTD_compressBound(bytes.size()));
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}

ByteVector rvl_packed(const Image16& depth) {
  Fields out;
  out.put_32(depth.width).put_32(depth.height);
  std::uint32_t word = 0;
  int nibbles = 0;
  const auto put = [&](std::uint32_t value) {
    do {
      const std::uint32_t more = value > 7 ? 8 : 0;
      word = word << 4 | more | (value & 7);
      value >>= 3;
      if (++nibbles == 8) {
        out.put(word);
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
  if (nibbles > 0) out.put(word << (4 * (8 - nibbles)));
  return out.out;
}

ByteVector with_config(const ByteVector& picture) {
  return Fields().raw(ByteVector(12, 7)).raw(picture).out;
}

ByteVector zstd_transport(const Image16& depth) {
  Fields out;
  out.put_32(depth.height).put_32(depth.width).put(std::uint8_t{0}).put_32(2 * depth.width);
  return out.text("16UC1").raw(zstd_packed(pixels_of(depth))).out;
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

/// A record of MCAP: https://mcap.dev/spec
ByteVector record(int op, const Fields& content) {
  Fields fields;
  fields.put(static_cast<std::uint8_t>(op)).put(std::uint64_t{content.out.size()});
  return fields.raw(content.out).out;
}

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
  Fields file, summary;
  file.raw(magic).raw(record(1, Fields().text("ros2").text("a writer of tests")));
  std::map<std::string, std::uint16_t> ids;
  Fields chunk;  // contents of the next chunk
  std::map<std::uint16_t, Fields> entries;
  std::size_t in_chunk = 0, chunks = 0;
  const auto crc_of = [&](const ByteVector& bytes) {
    return form.crc ? libdeflate_crc32(0, bytes.data(), bytes.size()) : 0;
  };
  std::uint64_t first_ns = 0, last_ns = 0;  // of the chunk; messages are in order
  const auto end_chunk = [&] {
    if (in_chunk == 0) return;
    const ByteVector stored = mcap_packed(chunk.out, form.compression);
    const std::uint64_t start = file.out.size();
    Fields content;
    content.put(first_ns).put(last_ns).put(std::uint64_t{chunk.out.size()});
    content.put_32(crc_of(chunk.out)).text(form.compression).put(std::uint64_t{stored.size()});
    file.raw(record(6, content.raw(stored)));
    const std::uint64_t index_start = file.out.size();
    Fields offsets;
    for (const auto& [channel, list] : entries) {
      offsets.put(channel).put(std::uint64_t{file.out.size()});
      Fields of_channel;
      of_channel.put(channel).sized(list.out);
      file.raw(record(7, of_channel));
    }
    Fields place;
    place.put(first_ns).put(last_ns).put(start).put(index_start - start);
    place.sized(offsets.out);
    place.put(std::uint64_t{file.out.size() - index_start}).text(form.compression);
    place.put(std::uint64_t{stored.size()}).put(std::uint64_t{chunk.out.size()});
    summary.raw(record(8, place));
    chunk = Fields();
    entries.clear();
    in_chunk = 0;
    ++chunks;
  };
  std::uint32_t sequence = 0;
  for (const Ros2Message& message : messages) {
    Fields& to = form.in_chunk == 0 ? file : chunk;
    const auto [known, is_new] =
        ids.try_emplace(message.topic, static_cast<std::uint16_t>(ids.size()));
    const std::uint16_t id = known->second;
    if (is_new) {
      Fields schema, channel;
      schema.put(static_cast<std::uint16_t>(id + 1)).text(message.type).text("ros2msg").text("");
      channel.put(id).put(static_cast<std::uint16_t>(id + 1)).text(message.topic);
      channel.text(form.encoding).put_32(0);
      for (Fields* bytes : {&to, &summary}) bytes->raw(record(3, schema)).raw(record(4, channel));
    }
    if (in_chunk == 0) first_ns = message.time_ns;
    last_ns = message.time_ns;
    entries[id].put(message.time_ns).put(std::uint64_t{to.out.size()});
    Fields content;
    content.put(id).put(sequence++).put(message.time_ns).put(message.time_ns);
    to.raw(record(5, content.raw(message.bytes)));
    if (form.in_chunk > 0 && ++in_chunk == form.in_chunk) end_chunk();
  }
  end_chunk();
  file.raw(record(0x0f, Fields().put_32(crc_of(file.out))));
  const std::uint64_t summary_start = form.summary ? file.out.size() : 0;
  if (form.summary) {
    Fields counts;
    counts.put(std::uint64_t{messages.size()}).put(static_cast<std::uint16_t>(ids.size()));
    counts.put_32(ids.size()).put_32(0);
    counts.put_32(0).put_32(chunks);
    counts.put(messages.front().time_ns).put(messages.back().time_ns).put_32(0);
    file.raw(summary.out);
    if (form.statistics) file.raw(record(0x0b, counts));
  }
  Fields footer;
  footer.put(summary_start).put(std::uint64_t{0}).put_32(0);
  file.raw(record(2, footer)).raw(magic);
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(file.out.data()),
             static_cast<std::streamsize>(file.out.size()));
}

Ros2Messages sdk_messages(int frames) {
  const std::string text = "std_msgs/msg/String", image = "sensor_msgs/msg/Image";
  Ros2Messages all;
  const auto say = [&](const std::string& topic, std::uint64_t time_ns, const std::string& what) {
    all.push_back({topic, text, time_ns, Fields(Wire::cdr).text(what).out});
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
  // A rotation by 90 degrees about z, in column-major order.
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
    all.push_back({kSdkDepth + "/image/data", image, time_ns, image_message(depth, Wire::cdr)});
    say(kSdkDepth + "/image/metadata", time_ns,
        facts(100 + i, time_ms) + "depth_units=0.000250;Frame Counter=1;");
    all.push_back({kSdkColor + "/image/data", image, time_ns + 9, image_message(color, Wire::cdr)});
    say(kSdkColor + "/image/metadata", time_ns + 9, facts(10 + i, time_ms + 4));
  }
  return all;
}

Ros2Messages realsense_ros_messages(int frames, const std::string& camera) {
  const std::string image = "sensor_msgs/msg/Image", info = "sensor_msgs/msg/CameraInfo";
  Ros2Messages all;
  const std::string depth = camera + "/depth", color = camera + "/color";
  const auto info_of = [](std::array<double, 4> k) {
    return camera_info_message(kWidth, kHeight, k, "plumb_bob", {0, 0, 0, 0, 0}, Wire::cdr);
  };
  const std::uint64_t start_ns = 1'700'000'000'000'000'000;
  Pose T_depth_color = Pose::Identity();
  T_depth_color.translation() = Vec3d(0.015, 0, 0);
  all.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", start_ns,
                 tf_message("depth_optical", "color_optical", T_depth_color, Wire::cdr)});
  Pose T_depth_accel = Pose::Identity();
  T_depth_accel.linear() = Eigen::AngleAxisd(M_PI / 2, Vec3d::UnitX()).toRotationMatrix();
  all.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", start_ns,
                 tf_message("depth_optical", "accel_optical", T_depth_accel, Wire::cdr)});
  for (int i = 0; i < frames; ++i) {
    const double time_s = i * kDepthPeriod_s;
    const std::uint64_t time_ns = start_ns + static_cast<std::uint64_t>(1e9 * time_s);
    ImageMessage message = depth_message(100 + i, 1'700'000'000 + time_s);
    message.frame_id = "depth_optical";
    message.encoding = "16UC1";
    all.push_back({depth + "/image_rect_raw", image, time_ns, image_message(message, Wire::cdr)});
    all.push_back({depth + "/camera_info", info, time_ns, info_of({20, 21, 12, 8})});
    message = color_message(10 + i, 1'700'000'000 + time_s + 0.004);
    message.frame_id = "color_optical";
    all.push_back({color + "/image_raw", image, time_ns + 1, image_message(message, Wire::cdr)});
    all.push_back({color + "/camera_info", info, time_ns + 1, info_of({30, 31, 13, 9})});
    all.push_back(
        {camera + "/accel/sample", "sensor_msgs/msg/Imu", time_ns + 2,
         imu_message(0, 1'700'000'000 + time_s, Vec3d(0, 0, 9.81), "accel_optical", Wire::cdr)});
  }
  return all;
}

}  // namespace planescope::testing_bags
