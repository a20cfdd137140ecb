#pragma once

// The history of tracks: what one was in a frame, which ones a filter selects, how steady they are.

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/world/poses/trajectory.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {

struct Moment {
  enum class Kind : std::uint8_t {
    unborn,
    seen,
    absent,
    ended,
    unknown  // a frame without a pose, or one that nobody asked about
  };
  Kind kind = Kind::unknown;
  const Sighting* sighting = nullptr;  // where it is seen
  const Gap* gap = nullptr;            // where it is absent

  /// No plane of the frame is listed for it, though it is in sight.
  bool is_unlisted() const { return gap ? world::is_miss(gap->why) : sighting && sighting->minor; }
};
Moment moment_of(const Track& track, int frame);

/// "T12 is not in frame 37: not matched, its place is on P4, angle_deg 7.2 > 5.1". One line.
std::string moment_text(const Tracker& tracker, const Track& track, int frame);

/// "length<5", "gap", "merged", "track==12 && frame==37": conditions joined by &&, each a flag, a
/// flag with ! before it, or a number compared with a value. docs/map.md lists the words.
class TrackFilter {
 public:
  TrackFilter() = default;
  /// Throws Error that names the word it stumbles over.
  explicit TrackFilter(const std::string& text);
  bool matches(const Tracker& tracker, const Track& track) const;

 private:
  using Condition = std::function<bool(const Tracker&, const Track&)>;
  std::vector<Condition> conditions_;
};

// ---- How steady the planes of a recording are over time ----

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
