#pragma once

#include <filesystem>
#include <string>

#include "core/io/bag/ros_messages.hpp"
#include "core/model/image.hpp"

namespace planescope::io::ros {

/// Throws Error naming bag and topic unless the image holds 16-bit depth counts.
void check_depth_encoding(const Image& image,
                          const std::filesystem::path& bag,
                          const std::string& topic);
/// Throws Error or OutOfBytes when the image is no whole 16-bit depth image.
Image16 to_depth(const Image& image, const std::filesystem::path& bag, const std::string& topic);
/// rgb8, bgr8, rgba8, bgra8, mono8, 8UC1. Throws Error on any other encoding.
Image8 to_rgb(const Image& image, const std::filesystem::path& bag, const std::string& topic);

/// A float as the decimal number that was meant: 0.001f becomes 0.001, not 0.0010000000475.
double decimal(float value);

}  // namespace planescope::io::ros
