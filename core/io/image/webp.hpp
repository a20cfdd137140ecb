#pragma once

#include <filesystem>
#include <vector>

#include "core/model/image.hpp"

namespace planescope::io {

/// Lossy WebP of an RGB image: half the bytes of a JPEG that looks as well. `quality`: 0 to 100.
/// Throws Error where the image is larger than WebP allows, 16383 pixels a side.
std::vector<unsigned char> encode_webp(const Image8& image, float quality);

/// Throws Error naming the file when it is cut short or is no WebP.
Image8 read_webp_rgb(const std::filesystem::path& path);

}  // namespace planescope::io
