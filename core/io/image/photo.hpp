#pragma once

// Lossy images: JPEG, in recordings, and WebP, in reports.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"

namespace planescope::io {

/// Reads a JPEG as RGB. Throws Error naming the file if it is truncated or not a JPEG.
Image8 read_jpeg_rgb(const std::filesystem::path& path);
/// The same for a JPEG in memory; `name` identifies it in messages.
Image8 decode_jpeg_rgb(std::span<const unsigned char> bytes, const std::string& name);

/// Encodes an RGB image as lossy WebP: half the size of a JPEG of the same visual quality.
/// `quality`: 0 to 100. Throws Error for more than 16383 pixels per side, WebP's limit.
std::vector<unsigned char> encode_webp(const Image8& image, float quality);

/// Throws Error naming the file if it is truncated or not a WebP.
Image8 read_webp_rgb(const std::filesystem::path& path);

}  // namespace planescope::io
