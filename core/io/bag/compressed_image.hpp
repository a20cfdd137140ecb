#pragma once

#include <memory>

#include "core/io/bag/ros_messages.hpp"

namespace planescope::io::ros {

/// An image, and its pixels where they do not lie in the message.
struct HeldImage {
  Image image;
  std::shared_ptr<const std::vector<std::byte>> held;
};

/// An image of any type that is_image_type() knows. sensor_msgs/CompressedImage is unpacked:
/// `compressedDepth` (PNG or RVL) and PNG of 16 bits to "16UC1", PNG and JPEG to "rgb8", `zstd` to
/// what it packs; a JPEG has `lossy` set. `what` names the message in errors. Throws Error where a
/// picture in it is damaged, OutOfBytes where the message is.
HeldImage read_image(const Message& message, const std::string& type, const std::string& what);

bool is_image_type(const std::string& type);
/// A topic without the transport that image_transport puts behind it:
/// "/camera/depth/image_rect_raw" for ".../image_rect_raw/compressedDepth".
std::string without_transport(const std::string& topic);

}  // namespace planescope::io::ros
