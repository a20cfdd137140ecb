#pragma once

#include "core/model/types.hpp"
#include "unit/io/bag_writer.hpp"

namespace planescope::testing_bags {

inline constexpr int kWidth = 24;
inline constexpr int kHeight = 16;
inline constexpr double kDepthPeriod_s = 1.0 / 30;

/// What depth frame `seq` holds: noise, so that it is different in each and packs badly.
Image16 depth_of(std::uint32_t seq);
ByteVector pixels_of(const Image16& image);
/// Colour of one value everywhere, by its number.
ByteVector plain_color(std::uint8_t red, std::uint8_t green, std::uint8_t blue);

ImageMessage depth_message(std::uint32_t seq, double stamp_s);
ImageMessage color_message(std::uint32_t seq, double stamp_s);

struct SdkBag {
  int frames = 6;
  BagFormat format;
  bool sdk_2_49 = false;  // unit behind the pixels, frame_id "1", Depth_Units
  float unit_m = 0.001f;
};

inline const std::string kSdkDepth = "/device_0/sensor_0/Depth_0";
inline const std::string kSdkColor = "/device_0/sensor_1/Color_0";
inline const std::string kSdkAccel = "/device_0/sensor_2/Accel_0";

/// What the SDK writes before the first frame, at time 1 ns.
void add_sdk_statics(BagWriter& bag, const SdkBag& options);
/// A bag as the RealSense SDK records it, depth frames 100, 101, ... with a colour image each.
BagWriter sdk_bag(const SdkBag& options);

}  // namespace planescope::testing_bags
