// History of tracks: state of a track in each frame, track filters and stability.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <string_view>
#include <unordered_map>

#include "core/model/error.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {

namespace {

std::string term_text(const Tracker& tracker, const TermResult& term) {
  if (term.failed == Term::taken) {
    const int id = final_track(tracker.tracks(), static_cast<int>(term.value));
    return id > 0 ? fmt::format("matched with T{}", id) : "which also matches";
  }
  return fmt::format("{} {:.4g} > {:.4g}", to_string(term.failed), term.value, term.threshold);
}

std::string absent_text(const Tracker& tracker, const Gap& gap, int frame) {
  std::string text = to_string(gap.why);
  if (gap.why == Absence::not_matched && frame == gap.first)
    text += fmt::format(", its region is on P{}, {}", gap.plane, term_text(tracker, gap.term));
  if (gap.why == Absence::not_matched && frame != gap.first)
    text += fmt::format(", since frame {}", gap.first);
  if (gap.why == Absence::not_detected) text += ", most of its region is on no plane";
  return text;
}

// ---- Filters ----

int misses_of(const Track& track) {
  return static_cast<int>(
      std::ranges::count_if(track.gaps, [](const Gap& gap) { return is_miss(gap.why); }));
}

bool is_merged(const Tracker& tracker, const Track& track) {
  return std::ranges::any_of(tracker.tracks(),
                             [&](const Track& other) { return other.merged_into == track.id; });
}

struct NumberWord {
  std::string_view name;
  double (*value)(const Track&);
};
constexpr NumberWord kNumbers[] = {
    {"track", [](const Track& t) -> double { return t.id; }},
    {"length", [](const Track& t) -> double { return t.frames_seen; }},
    {"missed", [](const Track& t) -> double { return t.frames_missed; }},
    {"gaps", [](const Track& t) -> double { return misses_of(t); }},
    {"born", [](const Track& t) -> double { return t.born; }},
    {"segment", [](const Track& t) -> double { return t.segment; }},
    {"area_m2", [](const Track& t) { return t.sure_area_m2(); }},
    {"rms_mm", [](const Track& t) { return 1000 * t.fit.rms_m(); }}};

struct FlagWord {
  std::string_view name;
  bool (*holds)(const Tracker&, const Track&);
};
constexpr FlagWord kFlags[] = {
    {"h", [](const Tracker&, const Track& t) { return t.label == Label::h; }},
    {"v", [](const Tracker&, const Track& t) { return t.label == Label::v; }},
    {"map", [](const Tracker& all, const Track& t) { return t.is_sure(all.options()); }},
    {"gap", [](const Tracker&, const Track& t) { return misses_of(t) > 0; }},
    {"gone", [](const Tracker&, const Track& t) { return t.state == TrackState::gone; }},
    {"merged", is_merged}};

struct Comparison {
  std::string_view sign;
  bool (*holds)(double, double);
};
constexpr Comparison kComparisons[] = {{"==", [](double a, double b) { return a == b; }},
                                       {"!=", [](double a, double b) { return a != b; }},
                                       {"<=", [](double a, double b) { return a <= b; }},
                                       {">=", [](double a, double b) { return a >= b; }},
                                       {"<", [](double a, double b) { return a < b; }},
                                       {">", [](double a, double b) { return a > b; }}};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

template <typename Word, std::size_t kCount>
const Word* find_word(const Word (&words)[kCount], std::string_view name) {
  const Word* at = std::ranges::find(words, name, &Word::name);
  return at == std::end(words) ? nullptr : at;
}

[[noreturn]] void fail(std::string_view what, const char* expected) {
  throw Error(fmt::format("track filter: cannot parse '{}'; expected {}", what, expected));
}

double number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) fail(text, "a number");
  return value;
}

}  // namespace

Moment moment_of(const Track& track, int frame) {
  const auto sighting = std::ranges::lower_bound(track.sightings, frame, {}, &Sighting::frame);
  if (sighting != track.sightings.end() && sighting->frame == frame)
    return {Moment::Kind::seen, &*sighting, nullptr};
  if (frame < track.born) return {Moment::Kind::unborn, nullptr, nullptr};
  if (track.ended >= 0 && frame > track.ended) return {Moment::Kind::ended, nullptr, nullptr};
  for (const Gap& gap : track.gaps)
    if (gap.first <= frame && frame <= gap.last) return {Moment::Kind::absent, nullptr, &gap};
  return {};
}

std::string moment_text(const Tracker& tracker, const Track& track, int frame) {
  const Moment moment = moment_of(track, frame);
  switch (moment.kind) {
    case Moment::Kind::unborn:
      return fmt::format("T{} is not in frame {}: first seen in frame {}", track.id, frame,
                         track.born);
    case Moment::Kind::ended:
      return fmt::format("T{} is not in frame {}: {} in frame {}", track.id, frame,
                         track.state == TrackState::left ? "left the window" : "was found gone",
                         track.ended);
    case Moment::Kind::absent:
      return fmt::format("T{} is not in frame {}: {}", track.id, frame,
                         absent_text(tracker, *moment.gap, frame));
    case Moment::Kind::unknown:
      return fmt::format("T{}: frame {} is not part of the map", track.id, frame);
    case Moment::Kind::seen:
      break;
  }
  const Sighting& seen = *moment.sighting;
  if (seen.minor)
    return fmt::format("T{} is a minor plane of frame {}, {:.0f} px, below the listing threshold",
                       track.id, frame, seen.pixels);
  const std::string name = fmt::format("T{} is P{} of frame {}, {:.0f} px{}", track.id, seen.plane,
                                       frame, seen.pixels, seen.undecided ? ", undecided" : "");
  if (seen.founding) return name + ": seen for the first time";
  return fmt::format("{}, {:.2f}\u00b0 and {:.1f} mm from the track", name, seen.angle_deg,
                     1000 * seen.offset_m);
}

TrackFilter::TrackFilter(const std::string& text) {
  std::string_view rest = trimmed(text);
  while (!rest.empty()) {
    const std::size_t joint = rest.find("&&");
    std::string_view part = trimmed(rest.substr(0, joint));
    rest = joint == std::string_view::npos ? std::string_view() : rest.substr(joint + 2);
    if (joint != std::string_view::npos && trimmed(rest).empty())
      fail(text, "a condition after &&");
    const std::size_t sign_at = part.find_first_of("=<>!", 1);
    if (sign_at == std::string_view::npos) {
      const bool wanted = !part.starts_with('!');
      if (!wanted) part = trimmed(part.substr(1));
      const FlagWord* flag = find_word(kFlags, part);
      if (!flag) fail(part, "h, v, map, gap, gone, merged, or a comparison");
      conditions_.push_back([=](const Tracker& tracker, const Track& track) {
        return flag->holds(tracker, track) == wanted;
      });
      continue;
    }
    const std::string_view name = trimmed(part.substr(0, sign_at));
    const Comparison* comparison = nullptr;
    for (const Comparison& candidate : kComparisons)
      if (!comparison && part.substr(sign_at).starts_with(candidate.sign)) comparison = &candidate;
    if (!comparison) fail(part, "==, !=, <, <=, >, or >=");
    const double value = number_of(trimmed(part.substr(sign_at + comparison->sign.size())));
    if (name == "frame") {
      if (comparison->sign != "==") fail(part, "frame==N");
      conditions_.push_back([frame = static_cast<int>(value)](const Tracker&, const Track& track) {
        const Moment moment = moment_of(track, frame);
        return moment.kind == Moment::Kind::seen || moment.kind == Moment::Kind::absent;
      });
      continue;
    }
    const NumberWord* number = find_word(kNumbers, name);
    if (!number)
      fail(name,
           "track, frame, length, missed, gaps, born, segment, area_m2, or rms_mm (h, v, map, gap, "
           "gone, and merged take no comparison)");
    conditions_.push_back([=](const Tracker&, const Track& track) {
      return comparison->holds(number->value(track), value);
    });
  }
}

bool TrackFilter::matches(const Tracker& tracker, const Track& track) const {
  return std::ranges::all_of(conditions_,
                             [&](const Condition& condition) { return condition(tracker, track); });
}

// ---- Stability ----

namespace {

constexpr double kStill_m = 0.006, kStill_deg = 0.7;  // between frames

bool is_still(const Pose& a, const Pose& b) {
  const Pose motion = a.inverse() * b;
  return motion.translation().norm() < kStill_m && turn_deg(motion) < kStill_deg;
}

/// The frames to evaluate, and their order.
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

/// Differences between two successive sightings.
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

/// Whether the plane was decided at its last sighting before the frame.
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

/// Pixel-weighted median, because specks would dominate a mean. Each of the two frames contributes
/// its share of the difference.
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
