#pragma once

#include <string>
#include <vector>

#include "core/model/image.hpp"

namespace planescope::report {

/// The image shrunk to at most `max_width` pixels, each the mean of what it covers (never
/// enlarged).
Image8 shrink(const Image8& image, int max_width);

/// Baseline JPEG of an RGB image, colour at full resolution: thin lines keep their hue.
std::vector<unsigned char> encode_jpeg(const Image8& image, int quality);

std::string base64(const std::vector<unsigned char>& bytes);

}  // namespace planescope::report
