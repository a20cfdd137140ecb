#include "core/io/bag/ros_messages.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/io/bag/compression.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io::ros {
namespace {

int read_side(FieldReader& reader) {
  const auto side = reader.read<std::uint32_t>();
  if (side > kMaxSide) throw OutOfBytes{};
  return static_cast<int>(side);
}

Vec3d read_vector(FieldReader& reader) {
  Vec3d vector;
  for (int i = 0; i < 3; ++i) vector[i] = reader.read<double>();
  return vector;
}

Pose read_transform(FieldReader& reader) {
  const Vec3d translation = read_vector(reader);
  const Vec3d xyz = read_vector(reader);
  Eigen::Quaterniond rotation(reader.read<double>(), xyz.x(), xyz.y(), xyz.z());
  if (!translation.allFinite() || !rotation.coeffs().allFinite() || rotation.norm() < 1e-6) {
    throw OutOfBytes{};
  }
  Pose pose = Pose::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

}  // namespace

Header read_header(FieldReader& reader) {
  Header header;
  if (!reader.is_cdr()) header.seq = reader.read<std::uint32_t>();
  const auto seconds = reader.read<std::uint32_t>();
  const auto nanoseconds = reader.read<std::uint32_t>();
  header.stamp_s = seconds + nanoseconds * 1e-9;
  header.frame_id = reader.text();
  return header;
}

Header parse_header(const Message& message) {
  FieldReader reader(message);
  return read_header(reader);
}

Image parse_image(const Message& message) {
  FieldReader reader(message);
  Image image;
  image.header = read_header(reader);
  image.height = read_side(reader);
  image.width = read_side(reader);
  image.encoding = reader.text();
  image.big_endian = reader.read<std::uint8_t>() != 0;
  image.step = reader.read<std::uint32_t>();
  image.data = reader.bytes();
  if (image.step * image.height > image.data.size()) throw OutOfBytes{};
  if (!reader.is_cdr() && reader.left() >= 4) {
    const auto unit = reader.read<float>();
    if (unit > 1e-7f && unit < 1.0f) image.depth_unit_m = unit;
  }
  return image;
}

CameraInfo parse_camera_info(const Message& message) {
  FieldReader reader(message);
  read_header(reader);
  CameraInfo info;
  info.height = read_side(reader);
  info.width = read_side(reader);
  info.distortion_model = reader.text();
  info.d = reader.doubles();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) info.k(row, column) = reader.read<double>();
  }
  return info;
}

Acceleration parse_imu(const Message& message) {
  FieldReader reader(message);
  Acceleration acceleration;
  acceleration.header = read_header(reader);
  // orientation and angular velocity, each with its covariance
  for (int i = 0; i < 4 + 9 + 3 + 9; ++i) reader.read<double>();
  acceleration.meters_per_s2 = read_vector(reader);
  return acceleration;
}

Pose parse_transform(const Message& message) {
  FieldReader reader(message);
  return read_transform(reader);
}

std::vector<NamedTransform> parse_tf_message(const Message& message) {
  FieldReader reader(message);
  std::vector<NamedTransform> transforms;
  const auto count = reader.read<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) {
    NamedTransform transform;
    transform.parent = read_header(reader).frame_id;
    transform.child = reader.text();
    transform.T_parent_child = read_transform(reader);
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

Pose to_pose(const Mat3d& rotation, const Vec3d& translation) {
  const bool is_rotation = rotation.allFinite() && translation.allFinite() &&
                           (rotation * rotation.transpose()).isIdentity(1e-3) &&
                           rotation.determinant() > 0;
  if (!is_rotation) throw OutOfBytes{};
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

Pose parse_extrinsics(const Message& message) {
  // Older messages start with a header: 9 + 3 doubles end both.
  constexpr std::size_t kBytes = 12 * sizeof(double);
  if (message.bytes.size() < kBytes) throw OutOfBytes{};
  FieldReader reader({message.held, message.bytes.last(kBytes)});
  Mat3d rotation;
  for (int column = 0; column < 3; ++column) rotation.col(column) = read_vector(reader);
  const Vec3d translation = read_vector(reader);
  return to_pose(rotation, translation);
}

KeyValue parse_key_value(const Message& message) {
  FieldReader reader(message);
  KeyValue pair;
  pair.key = reader.text();
  pair.value = reader.text();
  return pair;
}

float parse_float32(const Message& message) { return FieldReader(message).read<float>(); }

namespace {

struct Layout {
  int channels = 0;
  int red = 0, green = 0, blue = 0;
};

Layout layout_of(const std::string& encoding) {
  if (encoding == "rgb8" || encoding == "8UC3") return {3, 0, 1, 2};
  if (encoding == "bgr8") return {3, 2, 1, 0};
  if (encoding == "rgba8" || encoding == "8UC4") return {4, 0, 1, 2};
  if (encoding == "bgra8") return {4, 2, 1, 0};
  if (encoding == "mono8" || encoding == "8UC1") return {1, 0, 0, 0};
  return {};
}

}  // namespace

void check_depth_encoding(const Image& image,
                          const std::filesystem::path& bag,
                          const std::string& topic) {
  if (image.lossy)
    throw Error(bag.string() + ": depth images on " + topic +
                " are JPEG, which does not keep depth; expected compressedDepth, PNG or zstd");
  if (image.encoding == "mono16" || image.encoding == "16UC1") return;
  throw Error(bag.string() + ": depth images on " + topic + " are encoded as \"" + image.encoding +
              "\", expected mono16 or 16UC1 (16-bit counts)");
}

Image16 to_depth(const Image& image, const std::filesystem::path& bag, const std::string& topic) {
  check_depth_encoding(image, bag, topic);
  const std::size_t row_bytes = sizeof(std::uint16_t) * image.width;
  if (image.width == 0 || image.height == 0 || image.step < row_bytes) throw OutOfBytes{};
  Image16 depth(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(&depth.at(0, y), image.data.data() + y * image.step, row_bytes);
  }
  if (image.big_endian) {
    for (auto& count : depth.data) {
      count = static_cast<std::uint16_t>((count << 8) | (count >> 8));
    }
  }
  return depth;
}

Image8 to_rgb(const Image& image, const std::filesystem::path& bag, const std::string& topic) {
  const Layout layout = layout_of(image.encoding);
  if (layout.channels == 0) {
    throw Error(bag.string() + ": colour images on " + topic + " are encoded as \"" +
                image.encoding + "\", expected rgb8, bgr8, rgba8, bgra8 or mono8");
  }
  const std::size_t row_bytes = std::size_t(layout.channels) * image.width;
  if (image.width == 0 || image.height == 0 || image.step < row_bytes) throw OutOfBytes{};
  Image8 rgb(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(image.data.data() + y * image.step);
    std::uint8_t* to = &rgb.at(0, y);
    for (int x = 0; x < image.width; ++x, from += layout.channels, to += 3) {
      to[0] = from[layout.red];
      to[1] = from[layout.green];
      to[2] = from[layout.blue];
    }
  }
  return rgb;
}

double decimal(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  double result = value;
  std::from_chars(text, end, result);
  return result;
}

Message cdr_message(std::shared_ptr<const std::vector<std::byte>> held,
                    Bytes bytes,
                    std::size_t at_most,
                    const std::string& what) {
  if (!is_zstd(bytes)) return {std::move(held), bytes, Wire::cdr};
  const std::uint64_t limit = std::min<std::uint64_t>(at_most, read_limit_bytes());
  Unpacked unpacked = unpack_zstd(bytes, limit);
  if (!unpacked.whole && at_most == kWholeMessage) {
    throw Error(what + " is damaged: " + std::to_string(unpacked.bytes.size()) +
                " bytes could be unpacked of its zstd frame");
  }
  held = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  return {held, *held, Wire::cdr};
}

void warn_of_encodings(const std::map<std::string, int>& topics,
                       std::vector<std::string>& warnings) {
  for (const auto& [encoding, count] : topics)
    warnings.push_back(std::to_string(count) + " topics are serialized as \"" + encoding +
                       "\", expected cdr; they are left out");
}

std::string ros_type(std::string type) {
  const std::size_t middle = type.find("/msg/");
  if (middle != std::string::npos) type.erase(middle, 4);
  return type;
}

namespace {

/// The values of a text "key=value;key=value".
class Texts {
 public:
  explicit Texts(const Message& message) : text_(FieldReader(message).text()) {}

  std::optional<std::string_view> find(std::string_view key) const {
    for (std::string_view rest = text_; !rest.empty();) {
      const std::string_view pair = rest.substr(0, rest.find(';'));
      rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
      const std::size_t equals = pair.find('=');
      if (equals != std::string_view::npos && pair.substr(0, equals) == key) {
        return pair.substr(equals + 1);
      }
    }
    return std::nullopt;
  }
  std::optional<double> number(std::string_view key) const {
    const auto value = find(key);
    if (!value) return std::nullopt;
    return to_number(*value);
  }
  double required(std::string_view key) const {
    const auto value = number(key);
    if (!value) throw OutOfBytes{};
    return *value;
  }
  /// Numbers with commas between.
  std::vector<double> numbers(std::string_view key) const {
    std::vector<double> values;
    const auto found = find(key);
    for (std::string_view rest = found.value_or(""); !rest.empty();) {
      const std::string_view value = rest.substr(0, rest.find(','));
      rest.remove_prefix(std::min(value.size() + 1, rest.size()));
      values.push_back(to_number(value));
    }
    return values;
  }
  std::string_view all() const { return text_; }

  static double to_number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
      throw OutOfBytes{};
    }
    return value;
  }

 private:
  std::string_view text_;
};

int to_side(double value) {
  if (!(value >= 0 && value <= kMaxSide)) throw OutOfBytes{};
  return static_cast<int>(value);
}

}  // namespace

CameraInfo parse_sdk_camera_info(const Message& message) {
  if (message.wire == Wire::ros1) return parse_camera_info(message);
  const Texts texts(message);
  CameraInfo info;
  info.width = to_side(texts.required("width"));
  info.height = to_side(texts.required("height"));
  const double fx = texts.required("fx"), fy = texts.required("fy");  // any may throw
  const double cx = texts.required("ppx"), cy = texts.required("ppy");
  info.k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  info.distortion_model = texts.find("model").value_or("");
  info.d = texts.numbers("coeffs");
  return info;
}

double parse_sdk_option(const Message& message) {
  if (message.wire == Wire::ros1) return decimal(parse_float32(message));
  return Texts::to_number(Texts(message).all());
}

Pose parse_sdk_extrinsics(const Message& message) {
  if (message.wire == Wire::ros1) return parse_transform(message);
  const Texts texts(message);
  const std::vector<double> rotation = texts.numbers("rotation");  // column by column
  const std::vector<double> translation = texts.numbers("translation");
  if (rotation.size() != 9 || translation.size() != 3) throw OutOfBytes{};
  return to_pose(Eigen::Map<const Mat3d>(rotation.data()),
                 Eigen::Map<const Vec3d>(translation.data()));
}

std::optional<std::string> parse_sdk_info(const Message& message, const std::string& key) {
  if (message.wire == Wire::ros1) {
    const KeyValue pair = parse_key_value(message);
    return pair.key == key ? std::optional(pair.value) : std::nullopt;
  }
  const auto found = Texts(message).find(key);
  return found ? std::optional<std::string>(*found) : std::nullopt;
}

SdkFrameFacts parse_sdk_metadata(const Message& message) {
  const Texts texts(message);
  SdkFrameFacts facts;
  if (const auto number = texts.find("Frame number")) facts.number = *number;
  if (const auto ms = texts.number("timestamp")) facts.timestamp_s = 1e-3 * *ms;
  const auto unit = texts.number("depth_units");
  if (unit && *unit > 1e-7 && *unit < 1) facts.depth_unit_m = unit;
  return facts;
}

}  // namespace planescope::io::ros
