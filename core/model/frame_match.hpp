#pragma once

// Recognizes frames in another copy of their recording, where frames may have been added or
// removed.

#include <span>
#include <string>
#include <vector>

namespace planescope {

/// The facts by which a frame is recognized.
struct FrameIdentity {
  int index = 0;
  std::string sha256;  // Recording::frame_hash; empty: unknown
  std::string name;
  double timestamp_s = 0;  // 0: unknown
};

/// For each frame of `now`, the position of the same frame in `before`; -1: none. Matches by
/// pixels, by name and by time, in this order. Frame numbers decide only where names are unknown:
/// they shift when a frame is removed.
std::vector<int> match_frames(std::span<const FrameIdentity> before,
                              std::span<const FrameIdentity> now);

}  // namespace planescope
