#include "core/report/compare/compare_reports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace planescope::report {
namespace {

void add_difference(std::vector<std::string>& differences,
                    const std::string& what,
                    const std::string& before,
                    const std::string& after) {
  const auto shown = [](const std::string& value) { return value.empty() ? "none" : value; };
  if (before != after)
    differences.push_back(fmt::format("{}: {} -> {}", what, shown(before), shown(after)));
}

std::vector<std::string> differences_of(const RecordedReport& baseline, const RecordedReport& now) {
  std::vector<std::string> differences;
  add_difference(differences, "version", baseline.version, now.version);
  add_difference(differences, "method", baseline.method, now.method);
  add_difference(differences, "classifier", baseline.classifier, now.classifier);
  add_difference(differences, "weights", baseline.weights_sha256, now.weights_sha256);
  const std::map<std::string, std::string> before(baseline.options.begin(), baseline.options.end());
  std::map<std::string, std::string> left = before;
  for (const auto& [name, value] : now.options) {
    const auto was = before.find(name);
    add_difference(differences, "option " + name, was == before.end() ? "" : was->second, value);
    left.erase(name);
  }
  for (const auto& [name, value] : left) add_difference(differences, "option " + name, value, "");
  // How many threads it ran on changes nothing.
  std::erase_if(differences,
                [](const std::string& d) { return d.rfind("option threads:", 0) == 0; });
  return differences;
}

FrameFate fate_of(const RecordedFrame* before, const RecordedFrame* after) {
  if (!before) return FrameFate::added;
  if (!after) return FrameFate::missing;
  // A frame that cannot be read has no hash.
  if (before->refused.empty() && !after->refused.empty() && after->sha256.empty())
    return FrameFate::refused;
  if (before->sha256 != after->sha256) return FrameFate::other_input;
  if (!before->refused.empty())
    return after->refused.empty() ? FrameFate::mended : FrameFate::both_refused;
  return after->refused.empty() ? FrameFate::compared : FrameFate::refused;
}

/// A recording's name, which of those of this name it is, and a frame's number.
using FrameKey = std::tuple<std::string, int, int>;

std::vector<std::pair<FrameKey, const RecordedFrame*>> frames_of(const RecordedReport& report) {
  std::vector<std::pair<FrameKey, const RecordedFrame*>> frames;
  std::map<std::string, int> of_name;
  for (const RecordedRecording& recording : report.recordings) {
    const int nth = of_name[recording.name]++;
    for (const RecordedFrame& frame : recording.frames)
      frames.push_back({{recording.name, nth, frame.index}, &frame});
  }
  return frames;
}

}  // namespace

const char* to_string(FrameFate fate) {
  switch (fate) {
    case FrameFate::compared:
      return "compared";
    case FrameFate::other_input:
      return "other input";
    case FrameFate::refused:
      return "refused";
    case FrameFate::mended:
      return "mended";
    case FrameFate::both_refused:
      return "refused in both";
    case FrameFate::added:
      return "added";
    case FrameFate::missing:
      return "missing";
  }
  return "?";
}

int FrameComparison::count(PlaneFate fate_of_plane) const {
  return static_cast<int>(
      std::count_if(planes.begin(), planes.end(),
                    [&](const PlaneComparison& plane) { return plane.fate == fate_of_plane; }));
}

ReportComparison compare_reports(const RecordedReport& baseline,
                                 const RecordedReport& now,
                                 const FateLimits& limits) {
  ReportComparison comparison;
  comparison.differences = differences_of(baseline, now);
  const auto before = frames_of(baseline), after = frames_of(now);
  std::map<FrameKey, const RecordedFrame*> left(before.begin(), before.end());
  const auto add = [&](const FrameKey& key, const RecordedFrame* old, const RecordedFrame* frame) {
    FrameComparison& added = comparison.frames.emplace_back();
    added.recording = std::get<0>(key);
    added.index = std::get<2>(key);
    added.baseline = old;
    added.now = frame;
    added.fate = fate_of(old, frame);
    if (added.fate == FrameFate::compared)
      added.planes =
          compare_planes({old->planes, old->regions}, {frame->planes, frame->regions}, limits);
  };
  for (const auto& [key, frame] : after) {
    const auto old = left.find(key);
    add(key, old == left.end() ? nullptr : old->second, frame);
    if (old != left.end()) left.erase(old);
  }
  for (const auto& [key, frame] : before)
    if (left.contains(key)) add(key, frame, nullptr);
  return comparison;
}

}  // namespace planescope::report
