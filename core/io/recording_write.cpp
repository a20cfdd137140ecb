// Writes folders with a sidecar, and ROS 2 messages as MCAP (https://mcap.dev/spec).

#include "core/io/recording_write.hpp"

#include <fmt/format.h>
#include <libdeflate.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/io/bag/message_log.hpp"
#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const char* color_folder(FolderForm form) { return form == FolderForm::tum ? "rgb" : "color"; }

std::string name_of(FolderForm form, int number, const Frame& frame) {
  return form == FolderForm::tum ? fmt::format("{:.6f}", frame.timestamp_s)
                                 : fmt::format("{:06}", number);
}

/// Camera of color that is not aligned to depth.
Json color_json(const Frame& facts) {
  Json pose = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      pose.push_back(facts.T_color_depth.matrix()(row, column));
  return {{"intrinsics", intrinsics_json(facts.color_intrinsics)}, {"T_color_depth", pose}};
}

Json frames_json(const std::vector<WrittenFrame>& frames) {
  Json list = Json::array();
  for (const WrittenFrame& frame : frames) {
    Json entry = {{"name", frame.name}, {"timestamp_s", frame.facts.timestamp_s}};
    if (const auto& gravity = frame.facts.gravity; gravity && gravity->known())
      entry["gravity"] = {gravity->direction.x(), gravity->direction.y(), gravity->direction.z()};
    if (frame.facts.T_world_camera)
      entry["T_world_camera"] = pose_numbers(*frame.facts.T_world_camera);
    list.push_back(std::move(entry));
  }
  return list;
}

const WrittenFrame* first_in_color(const std::vector<WrittenFrame>& frames) {
  for (const WrittenFrame& frame : frames)
    if (frame.has_color) return &frame;
  return nullptr;
}

void expect_one_camera(const std::vector<WrittenFrame>& frames) {
  const Frame& first = frames.front().facts;
  for (const WrittenFrame& frame : frames)
    if (!(frame.facts.intrinsics == first.intrinsics) ||
        frame.facts.depth_unit_m != first.depth_unit_m)
      throw Error(
          fmt::format("frame {}: camera or depth unit differs from that of frame {}; expected the "
                      "same for all frames",
                      frame.facts.index, first.index));
}

void write_tum_list(const fs::path& path,
                    const char* folder,
                    const std::vector<WrittenFrame>& frames,
                    bool all) {
  std::string text = "# timestamp filename\n";
  for (const WrittenFrame& frame : frames)
    if (all || frame.has_color) text += fmt::format("{0} {1}/{0}.png\n", frame.name, folder);
  write_file_text(path, text);
}

/// In Open3D's form: column by column, depth scale in counts per meter.
Json open3d_camera(const Frame& facts) {
  const Intrinsics& k = facts.intrinsics;
  return {{"width", k.width},
          {"height", k.height},
          {"intrinsic_matrix", {k.fx, 0, 0, 0, k.fy, 0, k.cx, k.cy, 1}},
          {"depth_scale", 1 / facts.depth_unit_m}};
}

}  // namespace

WrittenFrame write_frame(const fs::path& dir, FolderForm form, int number, const Frame& frame) {
  const std::string name = name_of(form, number, frame);
  fs::create_directories(dir / "depth");
  write_png(dir / "depth" / (name + ".png"), frame.depth);
  const bool has_color = frame.color.channels == 3;
  if (has_color) {
    fs::create_directories(dir / color_folder(form));
    write_png(dir / color_folder(form) / (name + ".png"), frame.color);
  }
  return facts_of(frame, name);
}

WrittenFrame facts_of(Frame frame, const std::string& name) {
  const bool has_color = frame.color.channels == 3;
  frame.depth = {};
  frame.color = {};
  return {std::move(frame), name, has_color};
}

void write_folder_facts(const fs::path& dir,
                        FolderForm form,
                        const std::vector<WrittenFrame>& frames) {
  if (form == FolderForm::tum) {
    for (std::size_t i = 1; i < frames.size(); ++i)
      if (!(frames[i].facts.timestamp_s > frames[i - 1].facts.timestamp_s))
        throw Error(
            fmt::format("frame {}: time {:.6f} s is not later than the previous frame's; expected "
                        "increasing times, because the TUM format names files by time",
                        frames[i].facts.index, frames[i].facts.timestamp_s));
    write_tum_list(dir / "depth.txt", "depth", frames, true);
    if (first_in_color(frames)) write_tum_list(dir / "rgb.txt", "rgb", frames, false);
  } else {
    write_file_text(dir / "camera_intrinsic.json", json_text(open3d_camera(frames.front().facts)));
  }
  write_recording_facts(dir / "planescope.json", frames);
}

void write_recording_facts(const fs::path& path, const std::vector<WrittenFrame>& frames) {
  expect_one_camera(frames);
  const Frame& facts = frames.front().facts;
  Json sidecar = {{"schema", "planescope.recording/1"},
                  {"intrinsics", intrinsics_json(facts.intrinsics)},
                  {"depth_unit_m", facts.depth_unit_m}};
  if (const WrittenFrame* colored = first_in_color(frames)) {
    sidecar["color_aligned"] = colored->facts.color_aligned;
    if (!colored->facts.color_aligned && colored->facts.color_intrinsics.fx > 0)
      sidecar["color"] = color_json(colored->facts);
  }
  sidecar["frames"] = frames_json(frames);
  write_file_text(path, json_text(sidecar));
}

void write_frame_facts(const fs::path& sidecar, const std::vector<WrittenFrame>& frames) {
  write_file_text(
      sidecar, json_text({{"schema", "planescope.recording/1"}, {"frames", frames_json(frames)}}));
}

// ---- MCAP ----

namespace {

/// Consecutive little-endian fields.
class Fields {
 public:
  template <typename T>
  Fields& put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
    return *this;
  }
  Fields& text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes += text;
    return *this;
  }

  std::string bytes;
};

std::string record(std::uint8_t op, const std::string& content) {
  return Fields().put(op).put(std::uint64_t{content.size()}).bytes + content;
}

/// QoS with which `ros2 bag play` publishes a topic to late subscribers as well: reliable,
/// transient local. In rosbag2's own form.
constexpr const char* kLatched =
    "- history: 3\n  depth: 0\n  reliability: 1\n  durability: 1\n"
    "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  liveliness: 1\n"
    "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  avoid_ros_namespace_conventions: false\n";

}  // namespace

McapWriter::McapWriter(std::ostream& out) : out_(out) {
  write(std::string(kMcapMagic) + record(0x01, Fields().text("ros2").text("planescope").bytes));
}

void McapWriter::write(const std::string& bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

void McapWriter::add(const RosMessage& message, std::int64_t stamp_ns, bool latched) {
  const auto [at, is_new] = channels_.try_emplace(
      message.topic, Channel{static_cast<std::uint16_t>(channels_.size()), 0});
  Channel& channel = at->second;
  if (latched && !is_new) return;
  if (is_new) {
    const auto known = schema_ids_.try_emplace(
        message.type, static_cast<std::uint16_t>(schema_ids_.size() + 1));  // 0 means none
    const std::uint16_t schema = known.first->second;
    Fields metadata;
    if (latched) metadata.text("offered_qos_profiles").text(kLatched);
    if (known.second) {
      const std::string of_schema = record(0x03, Fields()
                                                     .put(schema)
                                                     .text(message.type)
                                                     .text("ros2msg")
                                                     .text(ros_definition(message.type))
                                                     .bytes);
      chunk_ += of_schema;
      schemas_ += of_schema;
    }
    const std::string of_channel = record(0x04, Fields()
                                                    .put(channel.id)
                                                    .put(schema)
                                                    .text(message.topic)
                                                    .text("cdr")
                                                    .text(metadata.bytes)
                                                    .bytes);
    chunk_ += of_channel;
    channel_records_ += of_channel;
  }
  const auto time_ns = static_cast<std::uint64_t>(stamp_ns);
  if (entries_.empty()) chunk_first_ns_ = chunk_last_ns_ = time_ns;
  if (messages_ == 0) first_ns_ = last_ns_ = time_ns;
  for (std::uint64_t* first : {&chunk_first_ns_, &first_ns_}) *first = std::min(*first, time_ns);
  for (std::uint64_t* last : {&chunk_last_ns_, &last_ns_}) *last = std::max(*last, time_ns);
  entries_[channel.id] += Fields().put(time_ns).put(std::uint64_t{chunk_.size()}).bytes;
  chunk_ += record(
      0x05, Fields().put(channel.id).put(chunks_).put(time_ns).put(time_ns).bytes + message.cdr);
  ++channel.messages;
  ++messages_;
}

void McapWriter::end_chunk() {
  std::string stored(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size =
      ZSTD_compress(stored.data(), stored.size(), chunk_.data(), chunk_.size(), 3);
  if (ZSTD_isError(size)) throw Error(std::string("zstd: ") + ZSTD_getErrorName(size));
  stored.resize(size);
  const std::uint64_t start = position_;
  write(record(0x06, Fields().put(chunk_first_ns_)
                             .put(chunk_last_ns_)
                             .put(std::uint64_t{chunk_.size()})
                             .put(libdeflate_crc32(0, chunk_.data(), chunk_.size()))
                             .text("zstd")
                             .put(std::uint64_t{stored.size()})
                             .bytes +
                         stored));
  const std::uint64_t index_start = position_;
  Fields places;
  for (const auto& [channel, entries] : entries_) {
    places.put(channel).put(position_);
    write(record(0x07, Fields().put(channel).text(entries).bytes));
  }
  chunk_indexes_ += record(0x08, Fields()
                                     .put(chunk_first_ns_)
                                     .put(chunk_last_ns_)
                                     .put(start)
                                     .put(index_start - start)
                                     .text(places.bytes)
                                     .put(position_ - index_start)
                                     .text("zstd")
                                     .put(std::uint64_t{stored.size()})
                                     .put(std::uint64_t{chunk_.size()})
                                     .bytes);
  chunk_.clear();
  entries_.clear();
  ++chunks_;
}

void McapWriter::finish() {
  write(record(0x0f, Fields().put(std::uint32_t{0}).bytes));
  const std::uint64_t summary = position_;
  Fields counts, statistics;
  for (const auto& [topic, channel] : channels_) counts.put(channel.id).put(channel.messages);
  statistics.put(messages_)
      .put(static_cast<std::uint16_t>(schema_ids_.size()))
      .put(static_cast<std::uint32_t>(channels_.size()))
      .put(std::uint32_t{0})  // attachments
      .put(std::uint32_t{0})  // metadata
      .put(chunks_)
      .put(first_ns_)
      .put(last_ns_)
      .text(counts.bytes);
  write(schemas_ + channel_records_ + chunk_indexes_ + record(0x0b, statistics.bytes));
  write(record(0x02, Fields().put(summary).put(std::uint64_t{0}).put(std::uint32_t{0}).bytes) +
        std::string(kMcapMagic));
}

}  // namespace planescope::io
