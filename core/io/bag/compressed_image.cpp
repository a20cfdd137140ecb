#include <algorithm>

#include "core/io/bag/compression.hpp"
#include "core/io/bag/ros_messages.hpp"
#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

// What image_transport_plugins write: compressed_image_transport, compressed_depth_image_transport
// and zstd_image_transport.

namespace planescope::io::ros {
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

int read_side(ByteReader& in) {
  const auto side = in.read<std::uint32_t>();
  if (side == 0 || side > kMaxSide) throw OutOfBytes{};
  return static_cast<int>(side);
}

/// Takes the pixels of `decoded`.
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

/// Wilson, Fast Lossless Depth Image Compression, 2017: runs of zeros and of others in turn, each
/// other as its difference to the one before; all numbers in nibbles of three bits and a sign that
/// more follow, eight nibbles in a word, the first in its highest bits.
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
  const int width = read_side(head), height = read_side(head);
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
      const std::uint32_t turned = in.number();  // 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
      before += (turned >> 1) ^ (0u - (turned & 1));
      depth.data[at++] = static_cast<std::uint16_t>(before);
    }
  }
  return depth;
}

void take_depth(Bytes data, const std::string& encoding, const std::string& what, HeldImage& to) {
  constexpr std::size_t kConfig = 12;  // a format, and how floats were turned into counts
  if (encoding.starts_with("32FC1"))
    throw Error(what +
                " is depth of floats (32FC1), which were rounded when they were compressed; "
                "expected 16UC1");
  if (is_png(data)) return take_png(data, what, to);
  if (data.size() < kConfig) throw OutOfBytes{};
  const Bytes picture = data.subspan(kConfig);
  if (is_png(picture)) return take_png(picture, what, to);
  take_pixels(decode_rvl(picture, what), "16UC1", to);
}

void take_zstd(Bytes data, const std::string& what, HeldImage& to) {
  ByteReader in(data);
  to.image.height = read_side(in);
  to.image.width = read_side(in);
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
                "\", expected compressedDepth, PNG, JPEG or zstd");
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
