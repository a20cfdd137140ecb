// Compares two reports: matches frames and planes, and describes the changes.

#include "core/report/compare/compare_reports.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "core/model/frame_match.hpp"
#include "core/model/text.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::report {
namespace {

constexpr double kLeastIou = 0.3;                           // of two planes to match
constexpr double kMostOfPart = 0.5;                         // a part is mostly inside the whole
constexpr double kLeastOfWhole = 0.1;                       // and covers at least this much of it
constexpr double kSameCentroidM = 0.1, kSameAngleDeg = 20;  // without samples

double angle_deg(const planes::PlaneSummary& a, const planes::PlaneSummary& b) {
  return std::acos(std::min(1.0, std::abs(a.normal.dot(b.normal)))) * 180 / std::numbers::pi;
}

class PlaneComparer {
 public:
  PlaneComparer(const ReportFrame& baseline, const ReportFrame& now, const FateLimits& limits)
      : baseline_(baseline.planes), now_(now.planes), limits_(limits) {
    std::vector<int> before, after;
    const RegionSample &b = baseline.regions, &n = now.regions;
    if (b.step == n.step && b.columns == n.columns && b.rows == n.rows) {
      before = b.plane_of();
      after = n.plane_of();
    }
    overlap_ = planes::count_truth_overlap(before, after, planes_before(), planes_now());
    taken_.assign(now_.size() + 1, 0);
  }

  std::vector<PlaneComparison> run() {
    result_.resize(baseline_.size());
    for (std::size_t k = 0; k < baseline_.size(); ++k) {
      result_[k].fate = PlaneFate::lost;
      result_[k].baseline = static_cast<int>(k) + 1;
    }
    find_splits();
    find_merges();
    match();
    match_small();
    for (int f = 1; f <= planes_now(); ++f)
      if (!taken_[f]) {
        result_.emplace_back();
        result_.back().fate = PlaneFate::gained;
        result_.back().now = f;
      }
    for (PlaneComparison& plane : result_) plane.undecided = is_undecided(plane);
    return std::move(result_);
  }

 private:
  int planes_before() const { return static_cast<int>(baseline_.size()); }
  int planes_now() const { return static_cast<int>(now_.size()); }
  PlaneComparison& of(int baseline) { return result_[static_cast<std::size_t>(baseline) - 1]; }
  bool is_open(int baseline) { return of(baseline).fate == PlaneFate::lost; }
  double shared(int t, int f) const { return static_cast<double>(overlap_.at(t, f)); }

  bool is_part(double common, std::uint64_t part, std::uint64_t whole) const {
    return common > 0 && common >= kMostOfPart * static_cast<double>(part) &&
           common >= kLeastOfWhole * static_cast<double>(whole);
  }

  bool is_undecided(const PlaneComparison& plane) const {
    const auto in = [](const std::vector<ReportPlane>& planes, int id) {
      return id > 0 && planes[static_cast<std::size_t>(id) - 1].summary.undecided;
    };
    const std::vector<ReportPlane>& of_others = plane.fate == PlaneFate::split ? now_ : baseline_;
    return in(baseline_, plane.baseline) || in(now_, plane.now) ||
           std::ranges::any_of(plane.others, [&](int id) { return in(of_others, id); });
  }

  void find_splits() {
    for (int t = 1; t <= planes_before(); ++t) {
      std::vector<int> parts;
      for (int f = 1; f <= planes_now(); ++f)
        if (is_part(shared(t, f), overlap_.found_size[f], overlap_.truth_size[t]))
          parts.push_back(f);
      if (parts.size() < 2) continue;
      std::stable_sort(parts.begin(), parts.end(),
                       [&](int a, int b) { return shared(t, a) > shared(t, b); });
      pair(t, parts[0], PlaneFate::split);
      of(t).others.assign(parts.begin() + 1, parts.end());
      for (const int f : parts) taken_[f] = 1;
    }
  }

  void find_merges() {
    for (int f = 1; f <= planes_now(); ++f) {
      std::vector<int> parts;
      for (int t = 1; t <= planes_before(); ++t)
        if (is_open(t) && is_part(shared(t, f), overlap_.truth_size[t], overlap_.found_size[f]))
          parts.push_back(t);
      if (taken_[f] || parts.size() < 2) continue;
      for (const int t : parts) {
        pair(t, f, PlaneFate::merged);
        for (const int other : parts)
          if (other != t) of(t).others.push_back(other);
      }
    }
  }

  void match() {
    const std::vector<int> partner = planes::found_of_truth(overlap_);
    for (int t = 1; t <= planes_before(); ++t) {
      const int f = partner[static_cast<std::size_t>(t) - 1];
      if (f > 0 && is_open(t) && !taken_[f] && overlap_.iou(t, f) >= kLeastIou) pair_compared(t, f);
    }
  }

  void match_small() {
    for (int t = 1; t <= planes_before(); ++t) {
      if (!is_open(t) || overlap_.truth_size[t] > 0) continue;
      const planes::PlaneSummary& plane = baseline_[static_cast<std::size_t>(t) - 1].summary;
      int nearest = 0;
      double least = kSameCentroidM;
      for (int f = 1; f <= planes_now(); ++f) {
        const planes::PlaneSummary& other = now_[static_cast<std::size_t>(f) - 1].summary;
        const double distance = (other.centroid - plane.centroid).norm();
        if (taken_[f] || other.label != plane.label || distance > least ||
            angle_deg(plane, other) > kSameAngleDeg)
          continue;
        nearest = f;
        least = distance;
      }
      if (nearest > 0) pair_compared(t, nearest);
    }
  }

  void pair_compared(int t, int f) {
    pair(t, f, PlaneFate::same);
    PlaneComparison& pair = of(t);
    if (pair.offset_m > limits_.offset_m || pair.angle_deg > limits_.angle_deg)
      pair.fate = PlaneFate::moved;
    else if (std::max(pair.area_ratio, 1 / pair.area_ratio) > limits_.area_ratio)
      pair.fate = PlaneFate::resized;
  }

  void pair(int t, int f, PlaneFate fate) {
    const planes::PlaneSummary& before = baseline_[static_cast<std::size_t>(t) - 1].summary;
    const planes::PlaneSummary& after = now_[static_cast<std::size_t>(f) - 1].summary;
    PlaneComparison& pair = of(t);
    pair.fate = fate;
    pair.now = f;
    pair.iou = overlap_.iou(t, f);
    pair.offset_m = std::max(std::abs(after.normal.dot(before.centroid) - after.offset_m),
                             std::abs(before.normal.dot(after.centroid) - before.offset_m));
    pair.angle_deg = angle_deg(before, after);
    pair.area_ratio = before.area_m2 > 0 ? after.area_m2 / before.area_m2 : 1;
    taken_[f] = 1;
  }

  const std::vector<ReportPlane>& baseline_;
  const std::vector<ReportPlane>& now_;
  const FateLimits& limits_;
  planes::TruthOverlap overlap_;
  std::vector<std::uint8_t> taken_;  // by new id
  std::vector<PlaneComparison> result_;
};

void add_difference(std::vector<std::string>& differences,
                    const std::string& what,
                    const std::string& before,
                    const std::string& after) {
  const auto shown = [](const std::string& value) { return value.empty() ? "none" : value; };
  if (before != after)
    differences.push_back(fmt::format("{}: {} -> {}", what, shown(before), shown(after)));
}

std::vector<std::string> differences_of(const Report& baseline, const Report& now) {
  std::vector<std::string> differences;
  add_difference(differences, "version", baseline.version, now.version);
  add_difference(differences, "method", baseline.method, now.method);
  add_difference(differences, "classifier", baseline.classifier, now.classifier);
  add_difference(differences, "weights", baseline.weights_sha256(), now.weights_sha256());
  std::map<std::string, std::string> before;
  for (const ReportOption& option : baseline.options) before.emplace(option.name, option.value);
  std::map<std::string, std::string> left = before;
  for (const ReportOption& option : now.options) {
    const auto was = before.find(option.name);
    add_difference(differences, "option " + option.name, was == before.end() ? "" : was->second,
                   option.value);
    left.erase(option.name);
  }
  for (const auto& [name, value] : left) add_difference(differences, "option " + name, value, "");
  // The number of threads never changes results.
  std::erase_if(differences,
                [](const std::string& d) { return d.rfind("option threads:", 0) == 0; });
  return differences;
}

FrameFate fate_of(const ReportFrame* before, const ReportFrame* after) {
  if (!before) return FrameFate::added;
  if (!after) return FrameFate::missing;
  // An unreadable frame has no hash.
  if (before->refused.empty() && !after->refused.empty() && after->sha256.empty())
    return FrameFate::refused;
  if (before->sha256 != after->sha256) return FrameFate::other_input;
  if (!before->refused.empty())
    return after->refused.empty() ? FrameFate::mended : FrameFate::both_refused;
  return after->refused.empty() ? FrameFate::compared : FrameFate::refused;
}

/// The baseline's recording of the same name; if several have this name, the one with the same
/// index among them. Null: none.
const ReportRecording* partner_of(const ReportRecording& recording,
                                  const Report& among,
                                  const Report& in) {
  const auto same_name = [&](const ReportRecording& other) { return other.name == recording.name; };
  auto nth = std::count_if(among.recordings.data(), &recording, same_name);
  for (const ReportRecording& other : in.recordings)
    if (same_name(other) && nth-- == 0) return &other;
  return nullptr;
}

/// For each frame of `now` the same frame of the baseline, or null.
std::vector<const ReportFrame*> match_frames(const std::vector<ReportFrame>& baseline,
                                             const std::vector<ReportFrame>& now) {
  const auto identities = [](const std::vector<ReportFrame>& frames) {
    std::vector<FrameIdentity> all;
    for (const ReportFrame& f : frames) all.push_back({f.index, f.sha256, f.name, f.timestamp_s});
    return all;
  };
  std::vector<const ReportFrame*> partners;
  for (const int at : planescope::match_frames(identities(baseline), identities(now)))
    partners.push_back(at < 0 ? nullptr : &baseline[static_cast<std::size_t>(at)]);
  return partners;
}

/// Whether only a part of the recording was requested and the recording is no shorter than before:
/// the baseline's other frames were then left out on purpose.
bool is_part(const ReportRecording& baseline, const ReportRecording& now) {
  return now.frames_asked < now.frame_count && now.frame_count >= baseline.frame_count;
}

}  // namespace

const char* to_string(PlaneFate fate) {
  constexpr const char* kNames[] = {"same",   "resized", "moved", "lost",
                                    "merged", "split",   "gained"};
  return kNames[static_cast<std::size_t>(fate)];
}

const char* to_string(FrameFate fate) {
  constexpr const char* kNames[] = {"compared",         "other input", "rejected", "mended",
                                    "rejected in both", "added",       "missing"};
  return kNames[static_cast<std::size_t>(fate)];
}

std::vector<PlaneComparison> compare_planes(const ReportFrame& baseline,
                                            const ReportFrame& now,
                                            const FateLimits& limits) {
  return PlaneComparer(baseline, now, limits).run();
}

int FrameComparison::count(PlaneFate fate_of_plane) const {
  return static_cast<int>(std::ranges::count(planes, fate_of_plane, &PlaneComparison::fate));
}

ReportComparison compare_reports(const Report& baseline,
                                 const Report& now,
                                 const FateLimits& limits) {
  ReportComparison comparison;
  comparison.differences = differences_of(baseline, now);
  const auto add = [&](const std::string& name, const ReportFrame* old, const ReportFrame* frame) {
    FrameComparison& added = comparison.frames.emplace_back();
    added.recording = name;
    added.index = (frame ? frame : old)->index;
    added.name = (frame && !frame->name.empty()) || !old ? frame->name : old->name;
    added.baseline = old;
    added.now = frame;
    added.fate = fate_of(old, frame);
    if (added.fate == FrameFate::compared) added.planes = compare_planes(*old, *frame, limits);
  };
  std::set<const ReportFrame*> matched;
  for (const ReportRecording& recording : now.recordings) {
    const ReportRecording* before = partner_of(recording, now, baseline);
    std::vector<const ReportFrame*> partners(recording.frames.size(), nullptr);
    if (before) partners = match_frames(before->frames, recording.frames);
    for (std::size_t k = 0; k < partners.size(); ++k)
      add(recording.name, partners[k], &recording.frames[k]);
    matched.insert(partners.begin(), partners.end());
  }
  for (const ReportRecording& recording : baseline.recordings) {
    const ReportRecording* after = partner_of(recording, baseline, now);
    std::size_t left_out = 0;
    for (const ReportFrame& frame : recording.frames)
      if (matched.contains(&frame))
        continue;
      else if (after && !is_part(recording, *after))
        add(recording.name, &frame, nullptr);
      else
        ++left_out;
    if (!after)
      comparison.left_out.push_back(recording.name);
    else if (left_out > 0)
      comparison.left_out.push_back(
          fmt::format("{}: {} of {}", recording.name, left_out,
                      planescope::counted(recording.frames.size(), "frame")));
  }
  return comparison;
}

// ---- Terrain ----

namespace {

/// Null: unknown.
const Terrain* terrain_of(const ReportFrame* frame) {
  return frame && frame->terrain ? &*frame->terrain : nullptr;
}

/// By plane id; null if there is no such plane, or no foot was given.
const FootRoom* foot_of(const ReportFrame& frame, int id) {
  if (id < 1) return nullptr;
  const std::optional<Footing>& footing = frame.planes.at(static_cast<std::size_t>(id) - 1).footing;
  return footing && footing->foot ? &*footing->foot : nullptr;
}

/// Empty: unchanged.
std::string steppable_change(const FrameComparison& frame, const PlaneComparison& plane) {
  const FootRoom* was = foot_of(*frame.baseline, plane.baseline);
  const FootRoom* is = foot_of(*frame.now, plane.now);
  const bool then = was && was->steppable, now = is && is->steppable;
  if (then == now) return "";
  if (now) return fmt::format("plane {} is now steppable", plane.now);
  if (!is)
    return fmt::format("the baseline's plane {}, which was steppable, is gone", plane.baseline);
  return fmt::format("plane {} is no longer steppable: {}", plane.now, is->why_not);
}

template <typename Thing>
std::string texts_of(const std::vector<Thing>& things) {
  std::vector<std::string> texts;
  for (const Thing& thing : things) texts.push_back(text_of(thing));
  return fmt::format("{}", fmt::join(texts, " and "));
}

/// "1 kerb: 100 mm in the baseline, none now".
std::string then_and_now(const std::string& was, const std::string& is) {
  if (was == is) return "";
  return fmt::format("{} in the baseline, {} now", was.empty() ? "none" : was,
                     is.empty() ? "none" : is);
}

std::string sentence(const std::string& start, const std::string& text) {
  std::string all = start + text + ".";
  all.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(all.front())));
  return all;
}

std::string without_gravity(const ReportFrame& frame) {
  return frame.gravity.known() ? "" : ": gravity is unknown";
}

}  // namespace

std::string flights_change(const FrameComparison& frame) {
  const Terrain *was = terrain_of(frame.baseline), *is = terrain_of(frame.now);
  if (!was || !is) return "";
  return then_and_now(texts_of(was->flights), texts_of(is->flights));
}

std::vector<std::string> steppable_changes(const FrameComparison& frame) {
  const Terrain *was = terrain_of(frame.baseline), *is = terrain_of(frame.now);
  if (!was || !is || std::isnan(was->steppable_area_m2) || std::isnan(is->steppable_area_m2))
    return {};
  const auto area = [](const Terrain* of) {
    return fmt::format("{:.2f} m2", of->steppable_area_m2);
  };
  std::vector<std::string> changes;
  if (std::string text = then_and_now(area(was), area(is)); !text.empty())
    changes.push_back(std::move(text));
  for (const PlaneComparison& plane : frame.planes)
    if (std::string text = steppable_change(frame, plane); !text.empty())
      changes.push_back(std::move(text));
  return changes;
}

std::vector<std::string> terrain_changes(const FrameComparison& frame) {
  std::vector<std::string> sentences;
  for (const std::string& change : steppable_changes(frame))
    sentences.push_back(
        sentence(std::isdigit(static_cast<unsigned char>(change.front())) ? "steppable area: " : "",
                 change));
  if (const std::string change = flights_change(frame); !change.empty())
    sentences.push_back(sentence("stairs: ", change));
  const Terrain *was = terrain_of(frame.baseline), *is = terrain_of(frame.now);
  if (!was || !is) return sentences;
  const auto add = [&](const char* start, const auto& then, const auto& now) {
    if (const std::string change = then_and_now(texts_of(then), texts_of(now)); !change.empty())
      sentences.push_back(sentence(start, change));
  };
  add("kerbs: ", was->kerbs, is->kerbs);
  add("ramps: ", was->ramps, is->ramps);
  return sentences;
}

std::string steppable_text(const ReportFrame& frame) {
  const auto steppable = std::ranges::count_if(frame.planes, [](const ReportPlane& plane) {
    return plane.footing && plane.footing->foot && plane.footing->foot->steppable;
  });
  return fmt::format("{} of {} steppable{}", steppable, counted(frame.planes.size(), "plane"),
                     without_gravity(frame));
}

std::string flights_text(const ReportFrame& frame) {
  return frame.terrain->flights.empty() ? "no stairs are found" + without_gravity(frame)
                                        : texts_of(frame.terrain->flights);
}

}  // namespace planescope::report
