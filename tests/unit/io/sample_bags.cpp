#include "unit/io/sample_bags.hpp"

#include <random>

namespace planescope::testing_bags {

Image16 depth_of(std::uint32_t seq) {
  std::mt19937 random(seq);
  Image16 depth(kWidth, kHeight);
  for (auto& count : depth.data) count = static_cast<std::uint16_t>(random() % 4000);
  return depth;
}

ByteVector pixels_of(const Image16& image) {
  ByteVector bytes;
  for (const std::uint16_t count : image.data) {
    bytes.push_back(static_cast<unsigned char>(count & 255));
    bytes.push_back(static_cast<unsigned char>(count >> 8));
  }
  return bytes;
}

ByteVector plain_color(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  ByteVector bytes;
  for (int i = 0; i < kWidth * kHeight; ++i) bytes.insert(bytes.end(), {red, green, blue});
  return bytes;
}

ImageMessage depth_message(std::uint32_t seq, double stamp_s) {
  ImageMessage image;
  image.seq = seq;
  image.stamp_s = stamp_s;
  image.width = kWidth;
  image.height = kHeight;
  image.pixels = pixels_of(depth_of(seq));
  return image;
}

ImageMessage color_message(std::uint32_t seq, double stamp_s) {
  ImageMessage image = depth_message(seq, stamp_s);
  image.encoding = "rgb8";
  image.pixels = plain_color(static_cast<std::uint8_t>(seq), 20, 30);
  return image;
}

void add_sdk_statics(BagWriter& bag, const SdkBag& options) {
  bag.add("/device_0/info", "diagnostic_msgs/KeyValue", 1, key_value_message("Serial", "1"));
  bag.add("/device_0/info", "diagnostic_msgs/KeyValue", 1,
          key_value_message("Name", "Intel RealSense D435I"));
  bag.add(kSdkDepth + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(kWidth, kHeight, {20, 21, 12, 8}));
  bag.add(kSdkColor + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(kWidth, kHeight, {30, 31, 13, 9}));
  bag.add(std::string("/device_0/sensor_0/option/") +
              (options.sdk_2_49 ? "Depth_Units" : "Depth Units") + "/value",
          "std_msgs/Float32", 1, float_message(options.unit_m));
  Pose T_color_reference = Pose::Identity();
  T_color_reference.linear() = Eigen::AngleAxisd(0.1, Vec3d::UnitY()).toRotationMatrix();
  T_color_reference.translation() = Vec3d(0.015, 0.001, -0.002);
  bag.add(kSdkDepth + "/tf/0", "geometry_msgs/Transform", 1, transform_message(Pose::Identity()));
  // Some SDK versions wrote quaternions that are not of unit length.
  bag.add(kSdkColor + "/tf/0", "geometry_msgs/Transform", 1,
          transform_message(T_color_reference, 1.7));
}

BagWriter sdk_bag(const SdkBag& options) {
  BagWriter bag(options.format);
  add_sdk_statics(bag, options);
  for (int i = 0; i < options.frames; ++i) {
    const double time_s = 500 + i * kDepthPeriod_s;
    const auto time_ns = static_cast<std::uint64_t>(1e9 * (0.001 + i * kDepthPeriod_s));
    auto depth = depth_message(100 + i, time_s);
    auto color = color_message(10 + i, time_s + 0.004);
    if (options.sdk_2_49) {
      depth.frame_id = color.frame_id = std::string("1");
      depth.depth_unit_m = options.unit_m;
      color.depth_unit_m = 0;
    }
    bag.add(kSdkDepth + "/image/data", "sensor_msgs/Image", time_ns, image_message(depth));
    bag.add(kSdkColor + "/image/data", "sensor_msgs/Image", time_ns + 9, image_message(color));
  }
  return bag;
}

}  // namespace planescope::testing_bags
