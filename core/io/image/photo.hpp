#pragma once

// Pictures that lose a little: JPEG, which recordings have, and WebP, which reports have.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::io {

/// Reads a JPEG as RGB. Throws Error naming the file when it is cut short or is no JPEG.
Image8 read_jpeg_rgb(const std::filesystem::path& path);
/// Likewise of a JPEG in memory; `name` is what messages call it.
Image8 decode_jpeg_rgb(std::span<const unsigned char> bytes, const std::string& name);

/// Lossy WebP of an RGB image: half the bytes of a JPEG that looks as well. `quality`: 0 to 100.
/// Throws Error where the image is larger than WebP allows, 16383 pixels a side.
std::vector<unsigned char> encode_webp(const Image8& image, float quality);

/// Throws Error naming the file when it is cut short or is no WebP.
Image8 read_webp_rgb(const std::filesystem::path& path);

}  // namespace planescope::io
