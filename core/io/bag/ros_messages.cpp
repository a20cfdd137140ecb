// Reads messages of ROS 1 and 2, of the RealSense SDK in either of them, and compressed images.

#include "core/io/bag/ros_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::io::ros {
namespace {

/// Reads the fields of a ROS 1 or ROS 2 message in order. Throws OutOfBytes if they end early. CDR:
/// https://www.omg.org/spec/DDSI-RTPS/2.5, 10. Supports only plain CDR, which ROS 2 writes.
class FieldReader {
 public:
  explicit FieldReader(const Message& message)
      : in_(message.bytes), is_cdr_(message.wire == Wire::cdr) {
    if (!is_cdr_) return;
    const auto high = in_.read<std::uint8_t>();
    const auto low = in_.read<std::uint8_t>();
    if (high != 0 || low > 1) throw OutOfBytes{};
    swapped_ = low == 0;  // written on a big-endian machine
    in_.take(2);          // options, unused
    in_ = ByteReader(in_.take(in_.left()));
  }

  bool is_cdr() const { return is_cdr_; }
  std::size_t left() const { return in_.left(); }

  template <typename T>
  T read() {
    if (is_cdr_) in_.take((sizeof(T) - in_.position() % sizeof(T)) % sizeof(T));
    std::byte bytes[sizeof(T)];
    std::ranges::copy(in_.take(sizeof(T)), bytes);
    if (swapped_) std::reverse(bytes, bytes + sizeof(T));
    return std::bit_cast<T>(bytes);
  }
  /// An array of bytes.
  Bytes bytes() { return in_.take(read<std::uint32_t>()); }
  std::string_view text() {
    const Bytes all = bytes();
    const std::string_view view(reinterpret_cast<const char*>(all.data()), all.size());
    if (!is_cdr_) return view;
    return view.substr(0, view.find('\0'));  // CDR strings end with a null
  }
  std::vector<double> doubles() {
    const auto count = read<std::uint32_t>();
    if (count > in_.left() / sizeof(double)) throw OutOfBytes{};
    std::vector<double> values(count);
    for (double& value : values) value = read<double>();
    return values;
  }

 private:
  ByteReader in_;
  bool is_cdr_;
  bool swapped_ = false;
};

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

Header read_header(FieldReader& reader) {
  Header header;
  if (!reader.is_cdr()) header.seq = reader.read<std::uint32_t>();
  const auto seconds = reader.read<std::uint32_t>();
  const auto nanoseconds = reader.read<std::uint32_t>();
  header.stamp_s = seconds + nanoseconds * 1e-9;
  header.stamp_ns = std::int64_t{seconds} * 1'000'000'000 + nanoseconds;
  header.frame_id = reader.text();
  return header;
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

}  // namespace

Header parse_header(const Message& message) {
  FieldReader reader(message);
  return read_header(reader);
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

PointCloud parse_point_cloud(const Message& message) {
  constexpr std::uint32_t kMostFields = 256;
  FieldReader reader(message);
  PointCloud cloud;
  cloud.header = read_header(reader);
  cloud.height = reader.read<std::uint32_t>();
  cloud.width = reader.read<std::uint32_t>();
  const auto fields = reader.read<std::uint32_t>();
  if (fields > kMostFields) throw OutOfBytes{};
  for (std::uint32_t i = 0; i < fields; ++i) {
    PointCloud::Field field{std::string(reader.text()), reader.read<std::uint32_t>(),
                            reader.read<std::uint8_t>()};
    reader.read<std::uint32_t>();  // values per field: only the first one is used
    cloud.fields.push_back(std::move(field));
  }
  cloud.big_endian = reader.read<std::uint8_t>() != 0;
  cloud.point_step = reader.read<std::uint32_t>();
  cloud.row_step = reader.read<std::uint32_t>();
  cloud.data = reader.bytes();
  if (cloud.height <= 1)
    cloud.row_step = cloud.width * cloud.point_step;  // some drivers leave it 0
  const bool fits = cloud.point_step > 0 && cloud.row_step / cloud.point_step >= cloud.width &&
                    (cloud.row_step == 0 || cloud.height <= cloud.data.size() / cloud.row_step);
  if (!fits) throw OutOfBytes{};
  return cloud;
}

Vec3d parse_imu(const Message& message) {
  FieldReader reader(message);
  read_header(reader);
  // orientation and angular velocity, each with its covariance
  for (int i = 0; i < 4 + 9 + 3 + 9; ++i) reader.read<double>();
  return read_vector(reader);
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

Pose parse_extrinsics(const Message& message) {
  // Older messages start with a header, but all of them end with 9 + 3 doubles.
  constexpr std::size_t kBytes = 12 * sizeof(double);
  if (message.bytes.size() < kBytes) throw OutOfBytes{};
  FieldReader reader({message.held, message.bytes.last(kBytes)});
  Mat3d rotation;
  for (int column = 0; column < 3; ++column) rotation.col(column) = read_vector(reader);
  const Vec3d translation = read_vector(reader);
  return to_pose(rotation, translation);
}

double decimal(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  double result = value;
  std::from_chars(text, end, result);
  return result;
}

namespace {

double to_number(const std::string& text) {
  const auto value = parse_number(text);
  if (!value || !std::isfinite(*value)) throw OutOfBytes{};
  return *value;
}

/// Values of a text "key=value;key=value".
class Texts {
 public:
  explicit Texts(const Message& message) : pairs_(split(text_of(message), ';')) {}

  static std::string text_of(const Message& message) {
    return std::string(FieldReader(message).text());
  }
  std::optional<std::string> find(const std::string& key) const {
    for (const std::string& pair : pairs_)
      if (pair.starts_with(key + "=")) return pair.substr(key.size() + 1);
    return std::nullopt;
  }
  std::optional<double> number(const std::string& key) const {
    const auto value = find(key);
    return value ? std::optional(to_number(*value)) : std::nullopt;
  }
  double required(const std::string& key) const {
    const auto value = number(key);
    if (!value) throw OutOfBytes{};
    return *value;
  }
  /// Comma-separated numbers.
  std::vector<double> numbers(const std::string& key) const {
    std::string text = find(key).value_or("");
    std::ranges::replace(text, ',', ' ');
    std::vector<double> values;
    for (const std::string& word : words_of(text)) values.push_back(to_number(word));
    return values;
  }

 private:
  std::vector<std::string> pairs_;
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
  const double fx = texts.required("fx"), fy = texts.required("fy");  // throws if a key is missing
  const double cx = texts.required("ppx"), cy = texts.required("ppy");
  info.k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  info.distortion_model = texts.find("model").value_or("");
  info.d = texts.numbers("coeffs");
  return info;
}

double parse_sdk_option(const Message& message) {
  if (message.wire == Wire::ros1) return decimal(FieldReader(message).read<float>());
  return to_number(Texts::text_of(message));
}

Pose parse_sdk_extrinsics(const Message& message) {
  FieldReader reader(message);
  if (message.wire == Wire::ros1) return read_transform(reader);
  const Texts texts(message);
  const std::vector<double> rotation = texts.numbers("rotation");  // column by column
  const std::vector<double> translation = texts.numbers("translation");
  if (rotation.size() != 9 || translation.size() != 3) throw OutOfBytes{};
  return to_pose(Eigen::Map<const Mat3d>(rotation.data()),
                 Eigen::Map<const Vec3d>(translation.data()));
}

std::optional<std::string> parse_sdk_info(const Message& message, const std::string& key) {
  if (message.wire == Wire::ros1) {
    FieldReader reader(message);
    const bool is_it = reader.text() == key;
    const std::string value(reader.text());
    return is_it ? std::optional(value) : std::nullopt;
  }
  return Texts(message).find(key);
}

SdkFrameFacts parse_sdk_metadata(const Message& message) {
  const Texts texts(message);
  SdkFrameFacts facts;
  facts.number = texts.find("Frame number");
  if (const auto ms = texts.number("timestamp")) facts.timestamp_s = 1e-3 * *ms;
  const auto unit = texts.number("depth_units");
  if (unit && *unit > 1e-7 && *unit < 1) facts.depth_unit_m = unit;
  return facts;
}

// ---- Compressed images, as written by compressed_image_transport,
// compressed_depth_image_transport and zstd_image_transport ----

namespace {

constexpr std::string_view kCompressed = "sensor_msgs/CompressedImage";

std::span<const unsigned char> as_chars(Bytes bytes) {
  return {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
}

bool starts_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}
bool is_png(Bytes bytes) { return starts_with(bytes, "\x89PNG"); }
bool is_jpeg(Bytes bytes) { return starts_with(bytes, "\xff\xd8\xff"); }

int read_image_side(ByteReader& in) {
  const auto side = in.read<std::uint32_t>();
  if (side == 0 || side > kMaxSide) throw OutOfBytes{};
  return static_cast<int>(side);
}

/// Takes over the pixels of `decoded`.
template <typename T>
void take_pixels(const planescope::Image<T>& decoded, const char* encoding, HeldImage& to) {
  const auto bytes = std::as_bytes(std::span(decoded.data));
  to.held = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
  to.image.width = decoded.width;
  to.image.height = decoded.height;
  to.image.encoding = encoding;
  to.image.step = sizeof(T) * static_cast<std::size_t>(decoded.width) * decoded.channels;
  to.image.data = *to.held;
}

void take_png(Bytes png, const std::string& what, HeldImage& to) {
  const PngInfo info = png_info(as_chars(png), what);
  if (info.channels == 1 && info.bit_depth == 16)
    return take_pixels(decode_png_16(as_chars(png), what), "16UC1", to);
  take_pixels(decode_png_rgb(as_chars(png), what), "rgb8", to);
}

/// Wilson, Fast Lossless Depth Image Compression, 2017: alternating runs of zeros and of other
/// values, each value as the difference from the previous one. All numbers are split into nibbles:
/// three bits and a continuation bit, eight nibbles per word, the first one in the highest bits.
class RvlReader {
 public:
  explicit RvlReader(Bytes words) : in_(words) {}

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (int bits = 0; bits < 32; bits += 3) {
      const std::uint32_t nibble = next();
      value |= (nibble & 7) << bits;
      if ((nibble & 8) == 0) return value;
    }
    throw OutOfBytes{};
  }

 private:
  std::uint32_t next() {
    if (left_ == 0) {
      word_ = in_.read<std::uint32_t>();
      left_ = 8;
    }
    --left_;
    const std::uint32_t nibble = word_ >> 28;
    word_ <<= 4;
    return nibble;
  }

  ByteReader in_;
  std::uint32_t word_ = 0;
  int left_ = 0;
};

Image16 decode_rvl(Bytes bytes, const std::string& what) {
  ByteReader head(bytes);
  const int width = read_image_side(head), height = read_image_side(head);
  expect_within_read_limit(2.0 * width * height, what + ": its pixels");
  Image16 depth(width, height);
  RvlReader in(head.take(head.left()));
  std::uint32_t before = 0;
  for (std::size_t at = 0; at < depth.data.size();) {
    const std::uint32_t zeros = in.number();
    if (zeros > depth.data.size() - at) throw OutOfBytes{};
    at += zeros;
    const std::uint32_t others = in.number();
    if (others > depth.data.size() - at) throw OutOfBytes{};
    for (std::uint32_t i = 0; i < others; ++i) {
      const std::uint32_t turned = in.number();  // zigzag: 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
      before += (turned >> 1) ^ (0u - (turned & 1));
      depth.data[at++] = static_cast<std::uint16_t>(before);
    }
  }
  return depth;
}

void take_depth(Bytes data, const std::string& encoding, const std::string& what, HeldImage& to) {
  constexpr std::size_t kConfig = 12;  // format, and quantization parameters of floats
  if (encoding.starts_with("32FC1"))
    throw Error(what +
                " contains floating-point depth (32FC1), which was rounded during compression; "
                "expected 16UC1");
  if (is_png(data)) return take_png(data, what, to);
  if (data.size() < kConfig) throw OutOfBytes{};
  const Bytes picture = data.subspan(kConfig);
  if (is_png(picture)) return take_png(picture, what, to);
  take_pixels(decode_rvl(picture, what), "16UC1", to);
}

void take_zstd(Bytes data, const std::string& what, HeldImage& to) {
  ByteReader in(data);
  to.image.height = read_image_side(in);
  to.image.width = read_image_side(in);
  to.image.big_endian = in.read<std::uint8_t>() != 0;
  to.image.step = in.read<std::uint32_t>();
  to.image.encoding = in.read_text();
  const std::uint64_t bytes = std::uint64_t{to.image.step} * to.image.height;
  expect_within_read_limit(static_cast<double>(bytes), what + ": its pixels");
  Unpacked unpacked = unpack_zstd(in.take(in.left()), bytes);
  if (!unpacked.whole || unpacked.bytes.size() < bytes) throw OutOfBytes{};
  to.held = std::make_shared<const std::vector<std::byte>>(std::move(unpacked.bytes));
  to.image.data = *to.held;
}

}  // namespace

HeldImage read_image(const Message& message, const std::string& type, const std::string& what) {
  if (type != kCompressed) return {parse_image(message), message.held};
  FieldReader reader(message);
  HeldImage result;
  result.image.header = read_header(reader);
  const std::string format(reader.text());
  const Bytes data = reader.bytes();
  if (format.find("compressedDepth") != std::string::npos)
    take_depth(data, format, what, result);
  else if (is_jpeg(data)) {
    take_pixels(decode_jpeg_rgb(as_chars(data), what), "rgb8", result);
    result.image.lossy = true;
  } else if (is_png(data))
    take_png(data, what, result);
  else if (format.find("zstd") != std::string::npos)
    take_zstd(data, what, result);
  else
    throw Error(what + " is compressed as \"" + format +
                "\"; expected compressedDepth, PNG, JPEG, or zstd");
  return result;
}

bool is_image_type(const std::string& type) {
  return type == "sensor_msgs/Image" || type == kCompressed;
}

std::string without_transport(const std::string& topic) {
  for (const char* transport : {"/compressedDepth", "/compressed", "/zstd"})
    if (topic.ends_with(transport)) return topic.substr(0, topic.rfind('/'));
  return topic;
}

}  // namespace planescope::io::ros
