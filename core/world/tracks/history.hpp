#pragma once

// What a track was in a frame, and which tracks are asked for.

#include <functional>
#include <string>

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

}  // namespace planescope::world
