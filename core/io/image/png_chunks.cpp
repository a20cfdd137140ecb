#include "core/io/image/png_chunks.hpp"

#include <libdeflate.h>

#include <memory>
#include <new>

namespace planescope::io {

using PngBytes = std::vector<unsigned char>;

void append_32(PngBytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<unsigned char>(value >> shift));
}

void append_16(PngBytes& bytes, int value) {
  bytes.push_back(static_cast<unsigned char>(value >> 8));
  bytes.push_back(static_cast<unsigned char>(value));
}

PngBytes png_start(int width, int height, int bits, PngColor color) {
  PngBytes header;
  append_32(header, static_cast<std::uint32_t>(width));
  append_32(header, static_cast<std::uint32_t>(height));
  header.push_back(static_cast<unsigned char>(bits));
  header.push_back(static_cast<unsigned char>(color));
  header.insert(header.end(), {0, 0, 0});  // the only compression and filters, no Adam7
  PngBytes out = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(out, "IHDR", header);
  return out;
}

void append_chunk(PngBytes& out, std::string_view type, std::span<const unsigned char> content) {
  append_32(out, static_cast<std::uint32_t>(content.size()));
  const std::size_t checked = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), content.begin(), content.end());
  append_32(out, libdeflate_crc32(0, out.data() + checked, out.size() - checked));
}

PngBytes deflated(std::span<const unsigned char> bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  PngBytes out(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  out.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.data(),
                                      out.size()));
  return out;
}

}  // namespace planescope::io
