#pragma once

// NumPy's array files (numpy.lib.format), versions 1.0 and 2.0.

#include <string>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/io/cloud_files/cloud_file.hpp"

namespace planescope::labels {

/// An array as it lies in its file, in C order.
struct NpyArray {
  std::vector<std::uint64_t> shape;
  io::Scalar type = io::Scalar::u8;
  bool big_endian = false;
  io::Bytes data;  // as many values as the shape says

  std::size_t size() const { return data.size() / io::size_of(type); }
  std::vector<double> values() const;
};

/// Throws Error naming `where`: the header is checked against the file's size.
NpyArray parse_npy(io::Bytes file, const std::string& where);

/// Version 1.0, little-endian. `type`: "<i4", "|u1", "<f4" as the values at `data` are.
std::vector<unsigned char> npy_bytes(const std::string& type,
                                     const std::vector<std::uint64_t>& shape,
                                     io::Bytes data);

}  // namespace planescope::labels
