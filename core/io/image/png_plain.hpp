#pragma once

// The PNG files that most recordings are made of, unpacked all at once: several times as quick as
// libpng, which goes row by row and inflates with zlib.

#include <span>

#include "core/io/image/png.hpp"

namespace planescope::io {

/// Unpacks a file that is whole and nothing but pixels: grey or RGB of 8 or 16 bits, not
/// interlaced, no chunk beside IHDR, IDAT and IEND. False for any other, and where anything is
/// wrong with it: libpng then reads it, or says what is wrong. pixels: [height x row], as in the
/// file: 16 bits with the high byte first.
bool unpack_plain_png(std::span<const unsigned char> file,
                      const PngInfo& info,
                      std::span<unsigned char> pixels);

}  // namespace planescope::io
