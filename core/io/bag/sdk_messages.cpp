#include "core/io/bag/sdk_messages.hpp"

#include <charconv>
#include <cmath>

#include "core/io/bag/field_reader.hpp"

namespace planescope::io::ros {
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
