// Report rules: built-in ones, rules from a file, and checking them.

#include "core/report/compare/rules.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "core/model/json_fields.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.rules/1";
constexpr std::uintmax_t kMostBytes = 1 << 20;

double folded(const std::vector<double>& values, RuleFold fold) {
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

/// Values compared together with one limit: of a frame, of a recording, or of all.
struct Group {
  std::string recording;
  int frame = -1;
  const FrameComparison* first = nullptr;  // of its frames
  std::vector<double> values;              // of its frames
  std::vector<double> with_undecided;      // the same; empty: not about planes
  double total = 0;                        // reference of a percentage of its values
};

bool is_of(const Rule& rule, const FrameComparison& frame) {
  return (rule.recording.empty() || rule.recording == frame.recording) &&
         (rule.frame < 0 || rule.frame == frame.index);
}

std::vector<Group> groups_of(const Rule& rule,
                             const RuleMetric& metric,
                             const ReportComparison& comparison) {
  std::vector<Group> groups;
  for (const FrameComparison& frame : comparison.frames) {
    const std::optional<double> value = is_of(rule, frame) ? metric.value(frame) : std::nullopt;
    if (!value) continue;
    const std::string recording = rule.scope == RuleScope::all ? "" : frame.recording;
    auto group = std::ranges::find(groups, recording, &Group::recording);
    if (rule.scope == RuleScope::frame || group == groups.end())
      group = groups.insert(
          groups.end(),
          {recording, rule.scope == RuleScope::frame ? frame.index : -1, &frame, {}, {}});
    group->values.push_back(*value);
    if (metric.total) group->total += metric.total(frame);
    if (metric.with_undecided)
      group->with_undecided.push_back(metric.with_undecided(frame).value_or(*value));
  }
  return groups;
}

bool is_percentage(const Rule& rule) { return rule.at_most_percent != Rule().at_most_percent; }

double percent_of(double value, const Group& group) {
  return group.total > 0 ? 100 * value / group.total : 0;
}

bool breaks(double value, const Group& group, const Rule& rule) {
  if (is_percentage(rule)) return percent_of(value, group) > rule.at_most_percent;
  return value < rule.at_least || value > rule.at_most;
}

Breach breach_of(const Rule& rule, const Group& group, double value, std::string why) {
  const bool of_frame = rule.scope == RuleScope::frame;
  return {rule,
          group.recording,
          group.frame,
          value,
          std::move(why),
          of_frame ? group.first->name : "",
          of_frame && group.first->fate == FrameFate::missing,
          percent_of(value, group)};
}

/// A rule is not broken if only undecided planes exceed the limit.
void add_breaches(const Rule& rule,
                  const ReportComparison& comparison,
                  std::vector<Breach>& breaches) {
  const RuleMetric& metric = find_metric(rule.metric);
  for (const Group& group : groups_of(rule, metric, comparison)) {
    const double value = folded(group.values, metric.fold);
    if (!breaks(value, group, rule)) continue;
    if (metric.with_undecided && !breaks(folded(group.with_undecided, metric.fold), group, rule))
      continue;
    const bool has_details = rule.scope == RuleScope::frame && metric.why;
    breaches.push_back(
        breach_of(rule, group, value, has_details ? metric.why(*group.first) : std::string()));
  }
}

void add_notes(const Rule& rule, const ReportComparison& comparison, std::vector<Breach>& notes) {
  const RuleMetric& metric = find_metric(rule.metric);
  if (!metric.with_undecided) return;
  for (const Group& group : groups_of(rule, metric, comparison)) {
    const double decided = folded(group.values, metric.fold);
    const double all = folded(group.with_undecided, metric.fold);
    const bool all_break = breaks(all, group, rule);
    if (decided == all || (!breaks(decided, group, rule) && !all_break)) continue;
    const std::string planes = rule.scope == RuleScope::frame
                                   ? ": " + metric.undecided(*group.first)
                                   : " planes make the difference";
    notes.push_back(
        breach_of(rule, group, all_break ? all : decided, "note only; undecided" + planes));
  }
}

}  // namespace

void visit_fields(auto& fields, Same<Rule> auto& rule) {
  fields("metric", rule.metric);
  fields("scope", rule.scope, kOptional);
  fields.with_default("recording", rule.recording, "");
  fields.with_default("frame", rule.frame, -1);
  fields.with_default("at_least", rule.at_least, Rule().at_least);
  fields.with_default("at_most", rule.at_most, Rule().at_most);
  fields.with_default("at_most_percent", rule.at_most_percent, Rule().at_most_percent);
  fields("level", rule.level, kOptional);
}

namespace {

Rule rule_of(const JsonPlace& place) {
  place.has_only(
      {"metric", "scope", "recording", "frame", "at_least", "at_most", "at_most_percent", "level"});
  Rule rule;
  read_fields(place, rule);
  if (!std::ranges::count(rule_metrics(), rule.metric, &RuleMetric::name)) {
    std::vector<std::string_view> names;
    for (const RuleMetric& metric : rule_metrics()) names.push_back(metric.name);
    place.at("metric").fail_kind(fmt::format("one of {}", fmt::join(names, ", ")));
  }
  if (!place.has("at_least") && !place.has("at_most") && !place.has("at_most_percent"))
    place.fail_kind("a rule with \"at_least\", \"at_most\", or \"at_most_percent\"");
  if (place.has("at_most_percent")) {
    if (place.has("at_least") || place.has("at_most"))
      place.at("at_most_percent").fail_kind("only one limit");
    if (!find_metric(rule.metric).total)
      place.at("at_most_percent")
          .fail_kind("at_most, because percentages do not apply to the metric " + rule.metric);
  }
  if (rule.at_least > rule.at_most)
    place.fail(fmt::format("has at_least {} and at_most {}; expected at_least <= at_most",
                           rule.at_least, rule.at_most));
  if (find_metric(rule.metric).need != RuleNeed::timing) return rule;
  if (!place.has("level")) rule.level = RuleLevel::warn;
  if (rule.level == RuleLevel::error)
    place.at("level").fail_kind("warn or off for " + rule.metric +
                                ", which depends on the machine");
  return rule;
}

/// How far the value exceeds its limit, as a share of the limit.
double excess_of(const Breach& breach) {
  const bool low = breach.value < breach.rule.at_least;
  const bool percent = is_percentage(breach.rule);
  const double value = percent ? breach.percent : breach.value;
  const double limit = percent ? breach.rule.at_most_percent
                       : low   ? breach.rule.at_least
                               : breach.rule.at_most;
  const double excess = std::abs(value - limit) / std::max(1.0, std::abs(limit));
  return std::isfinite(excess) ? excess : 0;
}

/// Why no frame has a value; empty: a later run may have one.
std::string why_no_value(const RuleMetric& metric, bool by_name, bool compared) {
  if (metric.needs_baseline && compared) {
    if (metric.need == RuleNeed::tracks)
      return "at least one of the runs does not track planes (use --tracks)";
    if (metric.need == RuleNeed::foot)
      return "at least one of the runs has no foot (use --foot 0.08)";
  }
  // A rule about changes may wait for a baseline, unless it names its frames.
  if (metric.needs_baseline && !by_name) return "";
  if (metric.need == RuleNeed::truth) return "these frames have no labels";
  if (metric.need == RuleNeed::foot) return "no foot (use --foot 0.08)";
  if (metric.need == RuleNeed::stairs) return "these frames have no stairs";
  if (metric.need == RuleNeed::tracks) return "planes are not tracked (use --tracks)";
  return "these frames have no value";
}

/// Why the rule checks nothing; empty: it does, or has nothing to check yet.
std::string why_idle(const Rule& rule, const ReportComparison& comparison, bool has_baseline) {
  const RuleMetric& metric = find_metric(rule.metric);
  const bool needs_baseline = metric.needs_baseline;
  if (needs_baseline && !has_baseline) return "no baseline";
  bool has_recording = rule.recording.empty(), has_frame = false, has_value = false;
  bool compared = false;
  for (const FrameComparison& frame : comparison.frames) {
    if (!frame.now && !needs_baseline) continue;
    has_recording |= frame.recording == rule.recording;
    if (!is_of(rule, frame)) continue;
    has_frame = true;
    has_value |= metric.value(frame).has_value();
    compared |= frame.fate == FrameFate::compared;
  }
  if (!has_recording) return "no recording with this name";
  if (!has_frame) return "no such frame";
  if (has_value) return "";
  const bool by_name = !rule.recording.empty() || rule.frame >= 0;
  return why_no_value(metric, by_name, compared);
}

}  // namespace

std::vector<Rule> built_in_rules(std::string_view set) {
  using enum RuleLevel;
  if (set != "strict" && set != "default" && set != "lenient") return {};
  std::vector<Rule> rules = {
      {.metric = "frames_compared", .scope = RuleScope::all, .at_least = 1},
      {.metric = "frames_missing", .at_most = 0},
      {.metric = "frames_refused", .at_most = 0},
      {.metric = "labels_missing", .at_most = 0},
      {.metric = "planes_lost", .at_most = 0},
      {.metric = "planes_gained", .at_most = 0},
      {.metric = "planes_merged", .at_most = 0},
      {.metric = "planes_split", .at_most = 0},
      {.metric = "offset_mm", .at_most = 5},
      {.metric = "angle_deg", .at_most = 1},
      {.metric = "planes_resized", .at_most = 0, .level = warn},
      {.metric = "inputs_changed", .at_most = 0, .level = warn},
      {.metric = "mean_iou_change", .at_least = -1},
      {.metric = "time_growth", .scope = RuleScope::all, .at_most = 2, .level = warn}};
  if (set == "default") return rules;
  const bool strict = set == "strict";
  for (Rule& rule : rules) {
    const bool is_movement = rule.metric == "offset_mm" || rule.metric == "angle_deg";
    if (is_movement) rule.at_most *= strict ? 0.5 : 2;
    if (rule.metric == "mean_iou_change") rule.at_least *= strict ? 0.5 : 2;
    if (strict && find_metric(rule.metric).need != RuleNeed::timing) rule.level = error;
    if (!strict && rule.metric.starts_with("planes_") && rule.level == error) {
      rule.scope = RuleScope::recording;
      rule.at_most = Rule().at_most;
      rule.at_most_percent = 2;
    }
  }
  return rules;
}

std::vector<Rule> read_rules(const std::filesystem::path& file) {
  if (std::vector<Rule> ready = built_in_rules(file.string()); !ready.empty()) return ready;
  if (!std::filesystem::exists(file))
    throw Error(file.string() +
                ": no such file; expected strict, default, lenient, or a rules file");
  return read_place(
      file, read_json<nlohmann::ordered_json>(file, kMostBytes), [](const JsonPlace& place) {
        place.schema({kSchema});
        place.has_only({"schema", "rules"});
        std::vector<Rule> rules;
        place.at("rules").each([&](const JsonPlace& rule) { rules.push_back(rule_of(rule)); });
        return rules;
      });
}

std::string rules_json(const std::vector<Rule>& rules) {
  Json json = {{"schema", kSchema}, {"rules", Json::array()}};
  for (const Rule& rule : rules) json["rules"].push_back(json_of(rule));
  return json_text(json);
}

namespace {

/// Rounded to significant digits; whole numbers in full.
std::string digits_of(double value, int digits) {
  const bool is_whole = value == std::round(value) && std::abs(value) < 1e9;
  const double size = std::abs(value);
  if (is_whole || size >= std::pow(10, digits)) return fmt::format("{:.0f}", value + 0.0);
  return fmt::format("{:.{}g}", value, digits);
}

/// "1 plane", "2 planes", "5 mm", "1.2 % points", "1.5 times".
std::string with_unit(const std::string& number, const RuleMetric& metric) {
  if (metric.unit.empty()) return number;
  std::string_view unit = metric.unit == "m2" ? "m\u00b2" : std::string_view(metric.unit);
  if (number == "1" &&
      (unit == "planes" || unit == "frames" || unit == "steps" || unit == "degrees"))
    unit.remove_suffix(1);
  return fmt::format("{} {}", number, unit);
}

}  // namespace

std::string Breach::text() const {
  const RuleMetric& metric = find_metric(rule.metric);
  const bool low = value < rule.at_least;
  const bool as_percent = is_percentage(rule);
  const double limit = as_percent ? rule.at_most_percent : low ? rule.at_least : rule.at_most;
  int digits = 3;
  std::string is, may_be;
  do {  // until the two differ
    is = digits_of(as_percent ? percent : value, digits);
    may_be = digits_of(limit, digits);
  } while (is == may_be && ++digits < 17);
  const std::string share = as_percent ? fmt::format(" ({} %)", is) : "";
  if (as_percent) is = digits_of(value, 3);
  const bool is_one = is == "1";
  std::string text = fmt::format(
      fmt::runtime(metric.sentence), fmt::arg("n", with_unit(is, metric) + share),
      fmt::arg("are", is_one ? "is" : "are"), fmt::arg("have", is_one ? "has" : "have"));
  text += fmt::format("; the rule {} ", metric.name);
  if (low)
    text += "requires at least " + with_unit(may_be, metric);
  else if (as_percent)
    text += fmt::format("allows at most {} %", may_be);
  else
    text += limit == 0 ? "allows none" : "allows at most " + with_unit(may_be, metric);
  return why.empty() ? text : text + ": " + why;
}

std::vector<Breach> broken_rules(const std::vector<Rule>& rules,
                                 const ReportComparison& comparison) {
  // Each frame of a baseline is in the comparison, or left out of it.
  const bool has_baseline =
      !comparison.left_out.empty() ||
      std::ranges::any_of(comparison.frames, [](const auto& frame) { return frame.baseline; });
  std::vector<Breach> breaches;
  for (const Rule& rule : rules)
    if (rule.level != RuleLevel::off && (has_baseline || !find_metric(rule.metric).needs_baseline))
      add_breaches(rule, comparison, breaches);
  // Frames that break the most rules first; for equal numbers, the one that breaks them most.
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

std::vector<Breach> noted_changes(const std::vector<Rule>& rules,
                                  const ReportComparison& comparison) {
  std::vector<Breach> notes;
  for (const Rule& rule : rules)
    if (rule.level != RuleLevel::off) add_notes(rule, comparison, notes);
  return notes;
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
  return text + ": rule not applied: " + why;
}

}  // namespace planescope::report
