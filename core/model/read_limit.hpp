#pragma once

#include <cstdint>
#include <string>

namespace planescope {

/// What one image, chunk or table of a file may take in memory, unpacked: a small file may promise
/// any size. For the whole process; 512 MiB unless set.
std::uint64_t read_limit_bytes();
void set_read_limit_bytes(std::uint64_t bytes);

/// Throws Error "WHAT would take ... MiB in memory, expected at most ..." where it is more.
void expect_within_read_limit(double bytes, const std::string& what);

}  // namespace planescope
