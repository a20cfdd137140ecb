#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/model/image.hpp"

namespace planescope::io {

/// Reads a JPEG as RGB. Throws Error naming the file when it is cut short or is no JPEG.
Image8 read_jpeg_rgb(const std::filesystem::path& path);
/// Likewise of a JPEG in memory; `name` is what messages call it.
Image8 decode_jpeg_rgb(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace planescope::io
