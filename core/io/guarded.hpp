#pragma once

namespace planescope::io {

/// What `read`, which looks at a mapped file, returns or throws. Throws Error where the file was
/// cut by somebody else meanwhile: whatever came of zeros is not told.
template <typename File, typename Read>
auto guarded_by(const File& file, const Read& read) {
  try {
    auto result = read();
    file.expect_whole();
    return result;
  } catch (...) {
    file.expect_whole();
    throw;
  }
}

}  // namespace planescope::io
