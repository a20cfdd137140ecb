#pragma once

#include <filesystem>

#include "core/model/image.hpp"

namespace planescope::io {

/// Reads a JPEG as RGB. Throws Error naming the file when it is cut short or is no JPEG.
Image8 read_jpeg_rgb(const std::filesystem::path& path);

}  // namespace planescope::io
