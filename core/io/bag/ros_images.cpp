#include "core/io/bag/ros_images.hpp"

#include <charconv>

#include "core/model/error.hpp"

namespace planescope::io::ros {
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

}  // namespace planescope::io::ros
