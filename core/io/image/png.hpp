#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/image.hpp"

namespace planescope::io {

/// What a PNG holds, read from its header without decoding it.
struct PngInfo {
  int width = 0;
  int height = 0;
  int channels = 0;
  int bit_depth = 0;
};

/// All readers throw Error naming the file, what was found and what was expected: not a PNG, cut
/// short, wrong number of channels or bits. Sizes are checked before anything is allocated.
PngInfo png_info(const std::filesystem::path& path);
/// Whether the chunk that ends every PNG is missing; looks at the end of the file only.
bool png_is_cut(const std::filesystem::path& path);
Image16 read_png_16(const std::filesystem::path& path);   // exactly one channel of 16 bits
Image8 read_png_grey(const std::filesystem::path& path);  // exactly one channel of 8 bits
Image8 read_png_rgb(const std::filesystem::path& path);   // anything 8- or 16-bit, turned into RGB

/// Likewise of a PNG in memory; `name` is what messages call it.
PngInfo png_info(std::span<const unsigned char> bytes, const std::string& name);
Image16 decode_png_16(std::span<const unsigned char> bytes, const std::string& name);
Image8 decode_png_rgb(std::span<const unsigned char> bytes, const std::string& name);

/// Writers: 16-bit grey; or 8-bit with 1, 3 or 4 channels. The same image gives the same bytes.
void write_png(const std::filesystem::path& path, const Image16& image);
void write_png(const std::filesystem::path& path, const Image8& image);
std::vector<unsigned char> encode_png(const Image8& image);
std::vector<unsigned char> encode_png(const Image16& image);

}  // namespace planescope::io
