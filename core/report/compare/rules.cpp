#include "core/report/compare/rules.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "core/model/json.hpp"
#include "core/report/data/json_place.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.rules/1";
constexpr std::uintmax_t kMostBytes = 1 << 20;

using FrameValue = std::optional<double> (*)(const FrameComparison&);

struct Metric {
  RuleMetric metric;
  FrameValue value;  // nullopt where the frame has none
};

template <PlaneFate kFate>
std::optional<double> planes_with(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  return frame.count(kFate);
}

template <FrameFate kFate>
std::optional<double> frames_with(const FrameComparison& frame) {
  if (!frame.baseline) return std::nullopt;
  return frame.fate == kFate ? 1 : 0;
}

/// The largest such value among planes that are in both runs.
std::optional<double> farthest(const FrameComparison& frame, double PlaneComparison::*value) {
  if (frame.fate != FrameFate::compared) return std::nullopt;
  double most = 0;
  for (const PlaneComparison& plane : frame.planes)
    if (plane.fate <= PlaneFate::moved) most = std::max(most, plane.*value);
  return most;
}

const ReportFrame* done(const ReportFrame* frame) {
  return frame && frame->refused.empty() ? frame : nullptr;
}

template <double planes::Metrics::*kValue>
std::optional<double> scored(const FrameComparison& frame) {
  const ReportFrame* now = done(frame.now);
  if (!now || !now->metrics) return std::nullopt;
  return now->metrics.value().*kValue;
}

template <double planes::Metrics::*kValue>
std::optional<double> score_change(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared || !frame.now->metrics || !frame.baseline->metrics)
    return std::nullopt;
  const double change = (*frame.now->metrics).*kValue - (*frame.baseline->metrics).*kValue;
  if (std::isnan(change)) return std::nullopt;
  return change;
}

std::optional<double> time_ratio(const ReportFrame* frame) {
  if (!done(frame) || frame->time_ratio() <= 0) return std::nullopt;
  return frame->time_ratio();
}

/// Labels that are gone: without them no metric that needs labels could fail.
std::optional<double> labels_missing(const FrameComparison& frame) {
  const ReportFrame *before = done(frame.baseline), *now = done(frame.now);
  if (!before || !now) return std::nullopt;
  return before->metrics && !now->metrics ? 1 : 0;
}

const std::vector<Metric>& metrics() {
  using enum RuleFold;
  static const std::vector<Metric> all = {
      {{"planes_lost", "planes", "planes of the baseline that are gone", true, false, sum},
       planes_with<PlaneFate::lost>},
      {{"planes_gained", "planes", "planes that the baseline has not", true, false, sum},
       planes_with<PlaneFate::gained>},
      {{"planes_merged", "planes", "planes of the baseline that are one now", true, false, sum},
       planes_with<PlaneFate::merged>},
      {{"planes_split", "planes", "planes of the baseline that are several now", true, false, sum},
       planes_with<PlaneFate::split>},
      {{"planes_moved", "planes", "planes moved by 5 mm or turned by 1 degree", true, false, sum},
       planes_with<PlaneFate::moved>},
      {{"planes_resized", "planes", "planes with a quarter more area, or less", true, false, sum},
       planes_with<PlaneFate::resized>},
      {{"offset_mm", "mm", "the farthest that a plane moved", true, false, largest},
       [](const FrameComparison& frame) {
         std::optional<double> offset = farthest(frame, &PlaneComparison::offset_m);
         if (offset) *offset *= 1000;
         return offset;
       }},
      {{"angle_deg", "degrees", "the farthest that a plane turned", true, false, largest},
       [](const FrameComparison& frame) { return farthest(frame, &PlaneComparison::angle_deg); }},
      {{"frames_refused", "frames", "frames that the baseline processed and this does not", true,
        false, sum},
       frames_with<FrameFate::refused>},
      {{"frames_missing", "frames", "frames that the baseline has alone", true, false, sum},
       frames_with<FrameFate::missing>},
      {{"inputs_changed", "frames", "frames whose pixels or points are not the baseline's", true,
        false, sum},
       frames_with<FrameFate::other_input>},
      {{"labels_missing", "frames", "frames that the baseline has labels for and this has not",
        true, false, sum},
       labels_missing},
      {{"planes", "planes", "planes found", false, false, sum},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (const ReportFrame* now = done(frame.now))
           return static_cast<double>(now->planes.size());
         return std::nullopt;
       }},
      {{"on_planes_percent", "%", "points on planes", false, false},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (const ReportFrame* now = done(frame.now)) return now->percent_on_planes();
         return std::nullopt;
       }},
      {{"on_planes_change", "% points", "points on planes, now less the baseline", true, false},
       [](const FrameComparison& frame) -> std::optional<double> {
         if (frame.fate != FrameFate::compared) return std::nullopt;
         return frame.now->percent_on_planes() - frame.baseline->percent_on_planes();
       }},
      {{"mean_iou", "%", "mean IoU with the true planes", false, true},
       scored<&planes::Metrics::mean_iou>},
      {{"pq", "%", "panoptic quality", false, true}, scored<&planes::Metrics::pq>},
      {{"alpha_deg", "degrees", "mean angle to the true normals", false, true},
       scored<&planes::Metrics::alpha_deg>},
      {{"r_p", "%", "planes found of true ones", false, true}, scored<&planes::Metrics::r_p>},
      {{"r_m", "%", "points in no plane", false, true}, scored<&planes::Metrics::r_m>},
      {{"point_accuracy", "%", "points on the right plane", false, true},
       scored<&planes::Metrics::point_accuracy>},
      {{"mean_iou_change", "% points", "mean IoU, now less the baseline", true, true},
       score_change<&planes::Metrics::mean_iou>},
      {{"pq_change", "% points", "panoptic quality, now less the baseline", true, true},
       score_change<&planes::Metrics::pq>},
      {{"alpha_change", "degrees", "alpha, now less the baseline", true, true},
       score_change<&planes::Metrics::alpha_deg>},
      {{"point_accuracy_change", "% points", "point accuracy, now less the baseline", true, true},
       score_change<&planes::Metrics::point_accuracy>},
      {{"time_ratio", "", "time from voxel grid to planes, of that of work timed beside it", false,
        false, mean, true},
       [](const FrameComparison& frame) { return time_ratio(frame.now); }},
      {{"time_growth", "times", "time_ratio, now of the baseline's", true, false, mean, true},
       [](const FrameComparison& frame) -> std::optional<double> {
         const auto now = time_ratio(frame.now), before = time_ratio(frame.baseline);
         if (!now || !before) return std::nullopt;
         return *now / *before;
       }},
  };
  return all;
}

/// `name` must be one of them.
const Metric& find_metric(std::string_view name) {
  return *std::ranges::find(metrics(), name, [](const Metric& m) { return m.metric.name; });
}

/// The values that are held to one limit together: of a frame, of a recording, or of all.
struct Group {
  std::string recording;
  int frame = -1;
  std::vector<double> values;  // of its frames

  double folded(RuleFold fold) const {
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    switch (fold) {
      case RuleFold::largest:
        return *std::ranges::max_element(values);
      case RuleFold::sum:
        return sum;
      case RuleFold::mean:
        break;
    }
    return sum / static_cast<double>(values.size());
  }
};

bool is_of(const Rule& rule, const FrameComparison& frame) {
  return (rule.recording.empty() || rule.recording == frame.recording) &&
         (rule.frame < 0 || rule.frame == frame.index);
}

void apply(const Rule& rule, const ReportComparison& comparison, std::vector<Breach>& breaches) {
  const Metric& metric = find_metric(rule.metric);
  std::vector<Group> groups;
  for (const FrameComparison& frame : comparison.frames) {
    const std::optional<double> value = is_of(rule, frame) ? metric.value(frame) : std::nullopt;
    if (!value) continue;
    const std::string recording = rule.scope == RuleScope::all ? "" : frame.recording;
    auto group = std::ranges::find(groups, recording, &Group::recording);
    if (rule.scope == RuleScope::frame || group == groups.end())
      group = groups.insert(groups.end(),
                            {recording, rule.scope == RuleScope::frame ? frame.index : -1, {}});
    group->values.push_back(*value);
  }
  for (const Group& group : groups)
    if (const double value = group.folded(metric.metric.fold);
        value < rule.at_least || value > rule.at_most)
      breaches.push_back({rule, group.recording, group.frame, value});
}

Rule rule_of(const JsonPlace& place) {
  place.has_only({"metric", "scope", "recording", "frame", "at_least", "at_most", "level"});
  Rule rule;
  rule.metric = place.at("metric").text();
  if (std::ranges::none_of(metrics(),
                           [&](const Metric& m) { return m.metric.name == rule.metric; })) {
    std::vector<std::string_view> names;
    for (const Metric& metric : metrics()) names.push_back(metric.metric.name);
    place.at("metric").fail_kind(fmt::format("one of {}", fmt::join(names, ", ")));
  }
  if (place.has("scope"))
    rule.scope = place.at("scope").choice({RuleScope::frame, RuleScope::recording, RuleScope::all},
                                          "one of frame, recording, all");
  if (place.has("recording")) rule.recording = place.at("recording").text();
  if (place.has("frame")) rule.frame = place.at("frame").whole(0);
  if (place.has("at_least")) rule.at_least = place.at("at_least").number();
  if (place.has("at_most")) rule.at_most = place.at("at_most").number();
  if (!place.has("at_least") && !place.has("at_most"))
    place.fail_kind("a rule with \"at_least\" or \"at_most\"");
  if (rule.at_least > rule.at_most)
    place.fail_kind(fmt::format("at_least {} not above at_most {}, which no value can be within",
                                rule.at_least, rule.at_most));
  if (place.has("level"))
    rule.level = place.at("level").choice({RuleLevel::off, RuleLevel::warn, RuleLevel::error},
                                          "one of off, warn, error");
  else if (find_metric(rule.metric).metric.is_timing)
    rule.level = RuleLevel::warn;
  if (find_metric(rule.metric).metric.is_timing && rule.level == RuleLevel::error)
    place.at("level").fail_kind("warn or off for " + rule.metric +
                                ", which depends on the machine");
  return rule;
}

/// How far the value is past its limit, as a share of the limit.
double excess_of(const Breach& breach) {
  const bool low = breach.value < breach.rule.at_least;
  const double limit = low ? breach.rule.at_least : breach.rule.at_most;
  const double excess = std::abs(breach.value - limit) / std::max(1.0, std::abs(limit));
  return std::isfinite(excess) ? excess : 0;
}

/// Why the rule holds nothing; empty: it holds something, or there is nothing yet that it is about.
std::string why_idle(const Rule& rule, const ReportComparison& comparison, bool has_baseline) {
  const Metric& metric = find_metric(rule.metric);
  if (metric.metric.needs_baseline && !has_baseline) return "it needs a baseline";
  bool has_recording = rule.recording.empty(), has_frame = false, has_value = false;
  for (const FrameComparison& frame : comparison.frames) {
    if (!frame.now && !metric.metric.needs_baseline) continue;
    has_recording |= frame.recording == rule.recording;
    if (!is_of(rule, frame)) continue;
    has_frame = true;
    has_value |= metric.value(frame).has_value();
  }
  if (!has_recording) return "there is no recording of this name";
  if (!has_frame) return "there is no such frame";
  // A rule on a change since the baseline may wait for a baseline, unless it names its frames.
  const bool by_name = !rule.recording.empty() || rule.frame >= 0;
  if (has_value || (metric.metric.needs_baseline && !by_name)) return "";
  return metric.metric.needs_truth ? "no such frame has labels" : "no such frame has a value of it";
}

}  // namespace

const char* to_string(RuleLevel level) {
  return level == RuleLevel::off ? "off" : level == RuleLevel::warn ? "warn" : "error";
}

const char* to_string(RuleScope scope) {
  return scope == RuleScope::frame ? "frame" : scope == RuleScope::recording ? "recording" : "all";
}

const std::vector<RuleMetric>& rule_metrics() {
  static const std::vector<RuleMetric> all = [] {
    std::vector<RuleMetric> result;
    for (const Metric& metric : metrics()) result.push_back(metric.metric);
    return result;
  }();
  return all;
}

std::vector<Rule> built_in_rules() {
  std::vector<Rule> rules;
  const auto at_most = [&rules](const char* metric, double limit, RuleLevel level) {
    rules.emplace_back();
    rules.back().metric = metric;
    rules.back().at_most = limit;
    rules.back().level = level;
  };
  for (const char* metric : {"frames_missing", "frames_refused", "labels_missing", "planes_lost",
                             "planes_gained", "planes_merged", "planes_split"})
    at_most(metric, 0, RuleLevel::error);
  at_most("offset_mm", 5, RuleLevel::error);
  at_most("angle_deg", 1, RuleLevel::error);
  at_most("planes_resized", 0, RuleLevel::warn);
  at_most("inputs_changed", 0, RuleLevel::warn);
  rules.emplace_back();
  rules.back().metric = "mean_iou_change";
  rules.back().at_least = -1;
  at_most("time_growth", 2, RuleLevel::warn);
  rules.back().scope = RuleScope::all;
  return rules;
}

std::vector<Rule> read_rules(const std::filesystem::path& file) {
  return read_place(
      file, read_json<nlohmann::ordered_json>(file, kMostBytes), [](const JsonPlace& place) {
        if (place.at("schema").text() != kSchema) place.at("schema").fail_kind(kSchema);
        place.has_only({"schema", "rules"});
        std::vector<Rule> rules;
        place.at("rules").each([&](const JsonPlace& rule) { rules.push_back(rule_of(rule)); });
        return rules;
      });
}

std::string rules_json(const std::vector<Rule>& rules) {
  Json json = {{"schema", kSchema}, {"rules", Json::array()}};
  for (const Rule& rule : rules) {
    Json one = {{"metric", rule.metric}, {"scope", to_string(rule.scope)}};
    if (!rule.recording.empty()) one["recording"] = rule.recording;
    if (rule.frame >= 0) one["frame"] = rule.frame;
    if (!std::isinf(rule.at_least)) one["at_least"] = rule.at_least;
    if (!std::isinf(rule.at_most)) one["at_most"] = rule.at_most;
    one["level"] = to_string(rule.level);
    json["rules"].push_back(one);
  }
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string Breach::text() const {
  const RuleMetric& metric = find_metric(rule.metric).metric;
  const bool low = value < rule.at_least;
  return fmt::format("{} is {:.6g}, {} {:.6g} {}", metric.name, value, low ? "at least" : "at most",
                     low ? rule.at_least : rule.at_most, metric.unit);
}

std::vector<Breach> broken_rules(const std::vector<Rule>& rules,
                                 const ReportComparison& comparison) {
  std::vector<Breach> breaches;
  for (const Rule& rule : rules)
    if (rule.level != RuleLevel::off) apply(rule, comparison, breaches);
  // Frames that break most rules first; of those that break as many, the one that breaks them most.
  std::map<std::pair<std::string, int>, std::pair<int, double>> weights;
  for (const Breach& breach : breaches) {
    auto& [errors, excess] = weights[{breach.recording, breach.frame}];
    if (breach.rule.level != RuleLevel::error) continue;
    ++errors;
    excess += excess_of(breach);
  }
  std::ranges::stable_sort(breaches, [&](const Breach& a, const Breach& b) {
    if (a.rule.level != b.rule.level) return a.rule.level > b.rule.level;
    return weights[{a.recording, a.frame}] > weights[{b.recording, b.frame}];
  });
  return breaches;
}

std::vector<IdleRule> idle_rules(const std::vector<Rule>& rules,
                                 const ReportComparison& comparison,
                                 bool has_baseline) {
  std::vector<IdleRule> idle;
  for (const Rule& rule : rules) {
    if (rule.level == RuleLevel::off) continue;
    if (std::string why = why_idle(rule, comparison, has_baseline); !why.empty())
      idle.push_back({rule, std::move(why)});
  }
  return idle;
}

std::string IdleRule::text() const {
  std::string text = rule.metric;
  if (!rule.recording.empty()) text.append(" of ").append(rule.recording);
  if (rule.frame >= 0) text += fmt::format(" frame {}", rule.frame);
  return text + ": this rule holds nothing, " + why;
}

}  // namespace planescope::report
