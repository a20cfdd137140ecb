#pragma once

// How steady the planes of a recording are over time.

#include <limits>
#include <span>
#include <vector>

#include "core/world/poses/trajectory.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {

/// A plane that is seen in two frames in a row while the camera stands still: how it differs.
struct StillPlane {
  double pixels = 0, angle_deg = 0, offset_m = 0;
};

/// Of one frame that has a pose and was not set aside. Breaks and swaps begin in it; still planes
/// are seen in it and in the frame before.
struct FrameStability {
  int frame = 0;
  double pixels = 0, kept = 0;  // on planes; of these, of tracks that are in the next frame too
  bool is_last = false;         // there is no next frame
  int breaks = 0, swaps = 0;
  std::vector<StillPlane> still;

  double kept_share() const;         // NaN where nothing could be kept
  double normal_jitter_deg() const;  // NaN where there is no still plane
  double offset_jitter_m() const;
};
std::vector<FrameStability> stability_by_frame(const Tracker& tracker,
                                               std::span<const CameraPose> poses);

struct Stability {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  int frames = 0;             // with a pose, not set aside
  double kept_share = kNone;  // of the pixels on planes: their track is in the next frame too
  // Of tracks that the map holds, a frame in which one is in sight but missing, and was there
  // before, per 100 frames; of these, swaps: its place was taken for another track's.
  double breaks = kNone, swaps = kNone;
  // Over still stretches, of a track's planes from frame to frame, each frame's share: the median
  // by pixels.
  int still_pairs = 0;
  double normal_jitter_deg = kNone, offset_jitter_m = kNone;
  // Tracks that come back after kAway frames out of sight: how far from where they were (RMS).
  static constexpr int kAway = 10;
  int returns = 0;
  double drift_m = kNone;
};

Stability stability_of(const Tracker& tracker, std::span<const CameraPose> poses);

}  // namespace planescope::world
