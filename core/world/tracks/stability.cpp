#include "core/world/tracks/stability.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <unordered_map>

namespace planescope::world {
namespace {

constexpr double kStill_m = 0.006, kStill_deg = 0.7;  // from frame to frame

bool is_still(const Pose& a, const Pose& b) {
  const Pose motion = a.inverse() * b;
  return motion.translation().norm() < kStill_m && turn_deg(motion) < kStill_deg;
}

/// The frames that count, and where each stands among them.
struct Frames {
  std::vector<FrameStability> all;
  std::unordered_map<int, std::size_t> order;
  std::vector<std::set<int>> present;    // their tracks
  std::vector<const CameraPose*> poses;  // null: none

  Frames(const Tracker& tracker, std::span<const CameraPose> given) {
    for (const FrameOfTracks& frame : tracker.frames()) {
      if (!frame.is_in_map()) continue;
      order[frame.frame] = all.size();
      all.emplace_back().frame = frame.frame;
      std::set<int>& tracks = present.emplace_back();
      for (const int id : frame.track_of)
        if (id > 0) tracks.insert(final_track(tracker.tracks(), id));
      for (const int id : frame.covered) tracks.insert(final_track(tracker.tracks(), id));
    }
    if (!all.empty()) all.back().is_last = true;
    poses.assign(all.size(), nullptr);
    for (const CameraPose& pose : given)
      if (const std::size_t* at = find(pose.frame)) poses[*at] = &pose;
  }
  const std::size_t* find(int frame) const {
    const auto at = order.find(frame);
    return at == order.end() ? nullptr : &at->second;
  }
  bool are_still(std::size_t before, std::size_t now) const {
    return now == before + 1 && poses[before] && poses[now] &&
           is_still(poses[before]->T_world_camera, poses[now]->T_world_camera);
  }
};

/// How two sightings in a row differ.
void add_still(const Sighting& before, const Sighting& now, FrameStability& of) {
  const Vec3d n0 = before.normal.cast<double>(), n1 = now.normal.cast<double>();
  const Vec3d middle = (before.centroid + now.centroid).cast<double>() / 2;
  const double angle = std::atan2(n0.cross(n1).norm(), n0.dot(n1)) * 180 / std::numbers::pi;
  const double offset = n1.dot(middle - now.centroid.cast<double>()) -
                        n0.dot(middle - before.centroid.cast<double>());
  of.still.push_back(
      {static_cast<double>(std::min(before.pixels, now.pixels)), angle, std::abs(offset)});
}

void add_sightings(const Track& track, Frames& frames) {
  for (std::size_t i = 0; i < track.sightings.size(); ++i) {
    const Sighting& now = track.sightings[i];
    const std::size_t* at = frames.find(now.frame);
    if (!at) continue;
    FrameStability& frame = frames.all[*at];
    if (!frame.is_last) {
      frame.pixels += static_cast<double>(now.pixels);
      if (frames.present[*at + 1].contains(track.id)) frame.kept += static_cast<double>(now.pixels);
    }
    if (now.part || now.minor || i == 0) continue;
    if (track.sightings[i - 1].part || track.sightings[i - 1].minor) continue;
    const std::size_t* before = frames.find(track.sightings[i - 1].frame);
    if (before && frames.are_still(*before, *at)) add_still(track.sightings[i - 1], now, frame);
  }
}

/// Whether its plane was decided when it was last seen before the frame.
bool was_decided(const Track& track, int frame) {
  const auto after = std::ranges::lower_bound(track.sightings, frame, {}, &Sighting::frame);
  return after == track.sightings.begin() || !std::prev(after)->undecided;
}

void add_gaps(const Track& track, const Tracker& tracker, Frames& frames) {
  for (const Gap& gap : track.gaps) {
    if (gap.why != Absence::not_detected && gap.why != Absence::not_matched) continue;
    if (!was_decided(track, gap.first)) continue;
    const std::size_t* at = frames.find(gap.first);
    if (!at) continue;
    ++frames.all[*at].breaks;
    frames.all[*at].swaps +=
        gap.term.failed == Term::taken &&
        final_track(tracker.tracks(), static_cast<int>(gap.term.value)) != track.id;
  }
}

Frames measured(const Tracker& tracker, std::span<const CameraPose> poses) {
  Frames frames(tracker, poses);
  for (const Track& track : tracker.tracks()) {
    if (track.state == TrackState::merged) continue;
    add_sightings(track, frames);
    if (track.is_sure(tracker.options())) add_gaps(track, tracker, frames);
  }
  return frames;
}

/// The median by pixels: of means, specks would have all the say. Both frames err: each one's share
/// of the difference.
double jitter(std::vector<StillPlane> planes, double StillPlane::*value) {
  if (planes.empty()) return Stability::kNone;
  std::ranges::sort(planes, {}, value);
  double all = 0, below = 0;
  for (const StillPlane& plane : planes) all += plane.pixels;
  std::size_t i = 0;
  while (i + 1 < planes.size() && 2 * (below + planes[i].pixels) < all) below += planes[i++].pixels;
  return planes[i].*value / std::numbers::sqrt2;
}

}  // namespace

double FrameStability::kept_share() const { return pixels > 0 ? kept / pixels : Stability::kNone; }
double FrameStability::normal_jitter_deg() const { return jitter(still, &StillPlane::angle_deg); }
double FrameStability::offset_jitter_m() const { return jitter(still, &StillPlane::offset_m); }

std::vector<FrameStability> stability_by_frame(const Tracker& tracker,
                                               std::span<const CameraPose> poses) {
  return measured(tracker, poses).all;
}

Stability stability_of(const Tracker& tracker, std::span<const CameraPose> poses) {
  const Frames frames = measured(tracker, poses);
  FrameStability sum;
  for (const FrameStability& frame : frames.all) {
    sum.pixels += frame.pixels;
    sum.kept += frame.kept;
    sum.breaks += frame.breaks;
    sum.swaps += frame.swaps;
    sum.still.insert(sum.still.end(), frame.still.begin(), frame.still.end());
  }
  Stability s;
  s.frames = static_cast<int>(frames.all.size());
  s.kept_share = sum.kept_share();
  if (s.frames > 0) {
    s.breaks = 100.0 * sum.breaks / s.frames;
    s.swaps = 100.0 * sum.swaps / s.frames;
  }
  s.still_pairs = static_cast<int>(sum.still.size());
  s.normal_jitter_deg = sum.normal_jitter_deg();
  s.offset_jitter_m = sum.offset_jitter_m();
  double returned2 = 0;
  for (const Track& track : tracker.tracks()) {
    if (track.state == TrackState::merged) continue;
    for (std::size_t i = 1; i < track.sightings.size(); ++i) {
      const Sighting& now = track.sightings[i];
      const std::size_t* at = frames.find(now.frame);
      const std::size_t* before = frames.find(track.sightings[i - 1].frame);
      if (!at || !before || now.part || now.minor || now.undecided || std::isnan(now.offset_m) ||
          *at <= *before + Stability::kAway)
        continue;
      ++s.returns;
      returned2 += squared(static_cast<double>(now.offset_m));
    }
  }
  if (s.returns > 0) s.drift_m = std::sqrt(returned2 / s.returns);
  return s;
}

}  // namespace planescope::world
