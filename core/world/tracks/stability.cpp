#include "core/world/tracks/stability.hpp"

#include <cmath>
#include <numbers>
#include <set>
#include <unordered_map>

namespace planescope::world {
namespace {

constexpr double kStill_m = 0.003, kStill_deg = 0.15;  // from frame to frame

bool is_still(const Pose& a, const Pose& b) {
  const Pose motion = a.inverse() * b;
  return motion.translation().norm() < kStill_m && turn_deg(motion) < kStill_deg;
}

/// A mean of squares, as it comes together.
struct Squares {
  int count = 0;
  double sum = 0;
  void add(double value) { ++count, sum += value * value; }
  double rms(double none) const { return count > 0 ? std::sqrt(sum / count) : none; }
};

}  // namespace

Stability stability_of(const Tracker& tracker, std::span<const CameraPose> poses) {
  Stability s;
  std::unordered_map<int, int> order;  // of frames that count
  std::vector<std::set<int>> present;  // their tracks
  for (const FrameOfTracks& frame : tracker.frames()) {
    if (!frame.has_pose || frame.set_aside) continue;
    order[frame.frame] = s.frames++;
    std::set<int>& tracks = present.emplace_back();
    for (const int id : frame.track_of)
      if (id > 0) tracks.insert(final_track(tracker.tracks(), id));
  }
  std::vector<const CameraPose*> pose_of(s.frames, nullptr);
  for (const CameraPose& pose : poses)
    if (const auto at = order.find(pose.frame); at != order.end()) pose_of[at->second] = &pose;

  double pixels = 0, kept = 0;
  int breaks = 0, swaps = 0;
  Squares angles, offsets, returns;
  for (const Track& track : tracker.tracks()) {
    if (track.state == TrackState::merged) continue;
    for (std::size_t i = 0; i < track.sightings.size(); ++i) {
      const Sighting& now = track.sightings[i];
      const auto at = order.find(now.frame);
      if (at == order.end()) continue;
      if (at->second + 1 < s.frames) {
        pixels += static_cast<double>(now.pixels);
        if (present[at->second + 1].contains(track.id)) kept += static_cast<double>(now.pixels);
      }
      if (now.part || i == 0) continue;
      const Sighting& before = track.sightings[i - 1];
      const auto last = order.find(before.frame);
      if (last == order.end()) continue;
      const int gap = at->second - last->second;
      if (gap > Stability::kAway && !now.founding) returns.add(static_cast<double>(now.offset_m));
      const CameraPose *a = pose_of[last->second], *b = pose_of[at->second];
      if (gap != 1 || before.part || !a || !b || !is_still(a->T_world_camera, b->T_world_camera))
        continue;
      const Vec3d n0 = before.normal.cast<double>(), n1 = now.normal.cast<double>();
      const Vec3d middle = (before.centroid + now.centroid).cast<double>() / 2;
      angles.add(std::atan2(n0.cross(n1).norm(), n0.dot(n1)) * 180 / std::numbers::pi);
      offsets.add(n1.dot(middle - now.centroid.cast<double>()) -
                  n0.dot(middle - before.centroid.cast<double>()));
    }
    if (!track.is_sure(tracker.options())) continue;
    for (const Gap& gap : track.gaps) {
      if (gap.why != Absence::not_detected && gap.why != Absence::not_matched) continue;
      ++breaks;
      swaps += gap.term.failed == Term::taken &&
               final_track(tracker.tracks(), static_cast<int>(gap.term.value)) != track.id;
    }
  }
  if (pixels > 0) s.kept_share = kept / pixels;
  if (s.frames > 0) {
    s.breaks = 100.0 * breaks / s.frames;
    s.swaps = 100.0 * swaps / s.frames;
  }
  s.still_pairs = angles.count;
  // Both frames err: each one's share of the difference.
  s.normal_jitter_deg = angles.rms(Stability::kNone) / std::numbers::sqrt2;
  s.offset_jitter_m = offsets.rms(Stability::kNone) / std::numbers::sqrt2;
  s.returns = returns.count;
  s.drift_m = returns.rms(Stability::kNone);
  return s;
}

}  // namespace planescope::world
