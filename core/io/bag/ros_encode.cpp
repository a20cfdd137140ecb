// Encodes messages as CDR by their definitions, and builds the messages of a camera. CDR:
// https://www.omg.org/spec/DDSI-RTPS/2.5, 10.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/io/ros_message.hpp"
#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

// packaging/ros2/ros_messages.txt and planescope_msgs: a line with each name, then its definition.
extern "C" const char planescope_asset_ros_messages_txt[];
extern "C" const char planescope_asset_ros_messages_txt_end[];

namespace planescope::io {
namespace {

using Json = nlohmann::ordered_json;

struct Definition {
  struct Field {
    std::string type, name;
    bool is_list = false;
    std::size_t count = 0;           // of lists with a fixed size
    const Definition* of = nullptr;  // null: a number, bool or string
  };
  std::string text;
  std::vector<Field> fields;
};

/// Reads "float64[9] k  # row by row". nullopt for comments, empty lines and constants.
std::optional<Definition::Field> read_field(std::string line, const std::string& package) {
  line.resize(std::min(line.find('#'), line.size()));
  const std::vector<std::string> words = words_of(line);
  if (words.size() != 2 || words[1].find('=') != std::string::npos) return std::nullopt;
  Definition::Field field{words[0], words[1], false, 0, nullptr};
  if (const std::size_t at = field.type.find('['); at != std::string::npos) {
    field.is_list = true;
    if (field.type[at + 1] != ']') field.count = std::stoul(field.type.substr(at + 1));
    field.type.resize(at);
  }
  if (std::isupper(static_cast<unsigned char>(field.type[0])))
    field.type = package + "/" + field.type;
  return field;
}

std::map<std::string, Definition> read_definitions() {
  std::map<std::string, Definition> all;
  Definition* now = nullptr;
  for (const std::string& line :
       split(std::string(planescope_asset_ros_messages_txt, planescope_asset_ros_messages_txt_end),
             '\n'))
    if (line.starts_with("MSG: "))
      now = &all[line.substr(5)];
    else if (now)
      now->text += line + "\n";
  for (auto& [type, definition] : all)
    for (const std::string& line : split(definition.text, '\n'))
      if (auto field = read_field(line, type.substr(0, type.find('/')))) {
        if (field->type.find('/') != std::string::npos) field->of = &all.at(field->type);
        definition.fields.push_back(std::move(*field));
      }
  return all;
}

/// Accepts "sensor_msgs/Image" and "sensor_msgs/msg/Image".
const Definition& definition_of(const std::string& type) {
  static const std::map<std::string, Definition> all = read_definitions();
  std::string name = type;
  if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  const auto found = all.find(name);
  if (found == all.end()) throw Error(type + ": unsupported message type");
  return found->second;
}

void add_nested(const Definition& definition,
                std::vector<const Definition*>& seen,
                std::string& text) {
  for (const Definition::Field& field : definition.fields) {
    if (!field.of || std::ranges::find(seen, field.of) != seen.end()) continue;
    seen.push_back(field.of);
    text += std::string(80, '=') + "\nMSG: " + field.type + "\n" + field.of->text;
    add_nested(*field.of, seen, text);
  }
}

class CdrWriter {
 public:
  std::string bytes = std::string("\0\1\0\0", 4);  // little-endian, without options

  void write(const Definition& definition, const Json& json, const std::string& where) {
    static const Json none;
    std::size_t found = 0;
    for (const Definition::Field& field : definition.fields) {
      const auto at = json.is_object() ? json.find(field.name) : json.end();
      const bool is_there = json.is_object() && at != json.end();
      found += is_there;
      write_field(field, is_there ? *at : none, where);
    }
    if (found == json.size() && (json.is_null() || json.is_object())) return;
    for (const auto& [name, value] : json.items())
      if (std::ranges::find(definition.fields, name, &Definition::Field::name) ==
          definition.fields.end())
        throw Error(fmt::format("{}: the message has no field {}", where, name));
  }

 private:
  template <typename T>
  void put(T value) {
    bytes.append((sizeof(T) - (bytes.size() - 4) % sizeof(T)) % sizeof(T), '\0');
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
  }
  void put_text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes.append(text.c_str(), text.size() + 1);
  }

  void write_field(const Definition::Field& field, const Json& json, const std::string& where) {
    const auto fail = [&] {
      throw Error(fmt::format("{}.{} is not of type {}", where, field.name, field.type));
    };
    if (!field.is_list) return write_value(field, json, fail);
    const std::size_t given = json.is_binary() ? json.get_binary().size() : json.size();
    const bool fits = json.is_null() || ((json.is_array() || json.is_binary()) &&
                                         (field.count == 0 || given == field.count));
    if (!fits) fail();
    if (field.count == 0) put(static_cast<std::uint32_t>(given));
    if (json.is_binary()) {
      if (field.type != "uint8") fail();
      bytes.append(reinterpret_cast<const char*>(json.get_binary().data()), given);
      return;
    }
    for (const Json& item : json) write_value(field, item, fail);
    for (std::size_t i = given; i < field.count; ++i) write_value(field, Json(), fail);
  }

  template <typename Fail>
  void write_value(const Definition::Field& field, const Json& json, const Fail& fail) {
    const std::string& type = field.type;
    if (field.of) {
      write(*field.of, json, type);
    } else if (type == "string") {
      if (!json.is_string() && !json.is_null()) fail();
      put_text(json.is_null() ? "" : json.get_ref<const std::string&>());
    } else if (type == "bool") {
      if (!json.is_boolean() && !json.is_null()) fail();
      put(std::uint8_t{json.is_boolean() && json.get<bool>()});
    } else if (type == "float64" || type == "float32") {
      if (!json.is_number() && !json.is_null()) fail();
      const double value = json.is_null() ? 0 : json.get<double>();
      type == "float64" ? put(value) : put(static_cast<float>(value));
    } else if (type == "int32") {
      put(whole<std::int32_t>(json, fail));
    } else if (type == "uint32") {
      put(whole<std::uint32_t>(json, fail));
    } else if (type == "uint8") {
      put(whole<std::uint8_t>(json, fail));
    } else {
      fail();
    }
  }

  template <typename T, typename Fail>
  static T whole(const Json& json, const Fail& fail) {
    if (json.is_null()) return 0;
    const std::int64_t value = json.is_number_integer() ? json.get<std::int64_t>() : -1;
    const bool fits = json.is_number_integer() && value >= std::numeric_limits<T>::min() &&
                      value <= std::int64_t{std::numeric_limits<T>::max()};
    if (!fits) fail();
    return static_cast<T>(value);
  }
};

}  // namespace

std::string ros_definition(const std::string& type) {
  const Definition& definition = definition_of(type);
  std::string text = definition.text;
  std::vector<const Definition*> seen;
  add_nested(definition, seen, text);
  return text;
}

RosMessage ros_message(const std::string& topic, const std::string& type, const Json& json) {
  CdrWriter writer;
  writer.write(definition_of(type), json, type);
  return {topic, type, std::move(writer.bytes)};
}

std::int64_t ros_stamp(double time_s) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const double known = std::max(0.0, time_s), whole = std::floor(known);
  return static_cast<std::int64_t>(whole) * kSecond +
         std::min<std::int64_t>(kSecond - 1, std::llround((known - whole) * kSecond));
}

Json ros_header(std::int64_t stamp_ns, const std::string& frame_id) {
  return {{"stamp", {{"sec", stamp_ns / 1'000'000'000}, {"nanosec", stamp_ns % 1'000'000'000}}},
          {"frame_id", frame_id}};
}

Json ros_point(const Vec3d& p) {
  return {{"x", rounded(p.x())}, {"y", rounded(p.y())}, {"z", rounded(p.z())}};
}

namespace {

Json moved_by(const Pose& pose, const char* translation, const char* rotation) {
  const Vec3d t = pose.translation();
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0) q.coeffs() *= -1;
  return {{translation, {{"x", t.x()}, {"y", t.y()}, {"z", t.z()}}},
          {rotation, {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
}

}  // namespace

Json ros_transform(const Pose& pose) { return moved_by(pose, "translation", "rotation"); }
Json ros_pose(const Pose& pose) { return moved_by(pose, "position", "orientation"); }

Json ros_bytes(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  return Json::binary(std::vector<std::uint8_t>(bytes, bytes + size));
}

// ---- Messages of a camera ----

RosMessage ros_transforms(const std::string& topic,
                          std::int64_t stamp_ns,
                          const std::vector<NamedPose>& poses) {
  Json transforms = Json::array();
  for (const auto& [parent, child, T_parent_child] : poses)
    transforms.push_back({{"header", ros_header(stamp_ns, parent)},
                          {"child_frame_id", child},
                          {"transform", ros_transform(T_parent_child)}});
  return ros_message(topic, "tf2_msgs/msg/TFMessage", {{"transforms", std::move(transforms)}});
}

namespace {

template <typename T>
RosMessage image_message(const std::string& topic,
                         const Image<T>& image,
                         std::int64_t stamp_ns,
                         const char* frame_id,
                         const char* encoding) {
  return ros_message(topic, "sensor_msgs/msg/Image",
                     {{"header", ros_header(stamp_ns, frame_id)},
                      {"height", image.height},
                      {"width", image.width},
                      {"encoding", encoding},
                      {"step", sizeof(T) * static_cast<std::size_t>(image.width) * image.channels},
                      {"data", ros_bytes(image.data.data(), sizeof(T) * image.data.size())}});
}

RosMessage camera_message(const std::string& topic,
                          const Intrinsics& k,
                          int width,
                          int height,
                          std::int64_t stamp_ns,
                          const char* frame_id) {
  const bool is_inverse = k.distortion == Distortion::inverse_brown_conrady;
  return ros_message(topic, "sensor_msgs/msg/CameraInfo",
                     {{"header", ros_header(stamp_ns, frame_id)},
                      {"height", height},
                      {"width", width},
                      {"distortion_model", is_inverse ? to_string(k.distortion) : "plumb_bob"},
                      {"d", k.coefficients},
                      {"k", {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0}},
                      {"r", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                      {"p", {k.fx, 0.0, k.cx, 0.0, 0.0, k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0}}});
}

RosMessage depth_message(const std::string& topic,
                         const Frame& frame,
                         std::int64_t stamp_ns,
                         DepthEncoding encoding) {
  if (encoding == DepthEncoding::counts)
    return image_message(topic, frame.depth, stamp_ns, kDepthFrame, "16UC1");
  Image<float> meters(frame.depth.width, frame.depth.height);
  std::ranges::transform(frame.depth.data, meters.data.begin(), [&](std::uint16_t count) {
    return static_cast<float>(count * frame.depth_unit_m);
  });
  return image_message(topic, meters, stamp_ns, kDepthFrame, "32FC1");
}

}  // namespace

std::vector<RosMessage> ros_camera(const Frame& frame,
                                   std::int64_t stamp_ns,
                                   DepthEncoding encoding) {
  std::vector<RosMessage> messages;
  const std::string folder =
      frame.color_aligned ? "/camera/aligned_depth_to_color/" : "/camera/depth/";
  const bool has_color = frame.color.channels == 3;
  if (has_color && !frame.color_aligned && frame.color_intrinsics.fx > 0)
    messages.push_back(ros_transforms("/tf_static", stamp_ns,
                                      {{kDepthFrame, kColorFrame, frame.T_color_depth.inverse()}}));
  messages.push_back(depth_message(folder + (frame.color_aligned ? "image_raw" : "image_rect_raw"),
                                   frame, stamp_ns, encoding));
  messages.push_back(camera_message(folder + "camera_info", frame.intrinsics, frame.depth.width,
                                    frame.depth.height, stamp_ns, kDepthFrame));
  if (!has_color) return messages;
  messages.push_back(
      image_message("/camera/color/image_raw", frame.color, stamp_ns, kColorFrame, "rgb8"));
  const Intrinsics& k = frame.color_aligned ? frame.intrinsics : frame.color_intrinsics;
  if (k.fx > 0)
    messages.push_back(camera_message("/camera/color/camera_info", k, frame.color.width,
                                      frame.color.height, stamp_ns, kColorFrame));
  return messages;
}

}  // namespace planescope::io
