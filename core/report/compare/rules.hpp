#pragma once

// Rules for a report, relative to its baseline or absolute: planescope.rules.json.

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/report/compare/compare_reports.hpp"

namespace planescope::report {

enum class RuleLevel : std::uint8_t { off, warn, error };
constexpr std::array<const char*, 3> names_of(RuleLevel) { return {"off", "warn", "error"}; }
inline const char* to_string(RuleLevel level) {
  return names_of(level)[static_cast<std::size_t>(level)];
}

/// Value to compare with the limit: each frame's, or the sum or mean over a recording's frames or
/// over all frames.
enum class RuleScope : std::uint8_t { frame, recording, all };
constexpr std::array<const char*, 3> names_of(RuleScope) { return {"frame", "recording", "all"}; }
inline const char* to_string(RuleScope scope) {
  return names_of(scope)[static_cast<std::size_t>(scope)];
}

/// `recording` and `frame` restrict it to some frames; empty and -1 mean any.
struct Rule {
  std::string metric;  // of rule_metrics()
  RuleScope scope = RuleScope::frame;
  std::string recording = {};
  int frame = -1;
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
  /// Instead of `at_most`, for counts: percent of the baseline's planes, or of its frames.
  double at_most_percent = std::numeric_limits<double>::infinity();
  RuleLevel level = RuleLevel::error;
  bool operator==(const Rule&) const = default;
};

/// How to combine the values of several frames.
enum class RuleFold : std::uint8_t { mean, sum, largest };

/// Requirement for a frame to have a value. `timing` depends on the machine, and only ever warns.
enum class RuleNeed : std::uint8_t { nothing, truth, foot, stairs, tracks, timing };

/// Details about the value of a frame.
using FrameWords = std::string (*)(const FrameComparison&);

/// A figure of a frame. Rules, frames.csv and the page's charts and tables all use this table.
struct FrameMetric {
  const char *name, *unit;
  const char* sentence;  // about a value: {n} is the value with its unit, {are}, {have} agree
  const char* meaning;
  double (*value)(const ReportFrame&);  // of a processed frame; NaN: none
  RuleNeed need = RuleNeed::nothing;
  RuleFold fold = RuleFold::mean;
  /// The rule for its change since the baseline: "WHAT changed by {n}"; no name: no rule.
  struct Change {
    const char *name = nullptr, *what = nullptr, *meaning = nullptr;
    FrameWords why = nullptr;
  } change = {};
  /// By frame, below `heading`; no heading: no chart.
  struct Chart {
    const char *heading = nullptr, *name = nullptr;
    bool from_zero = false, unless_zero = false;  // omitted if all frames have 0
  } chart = {};
  const char* column = nullptr;  // of the page's table of frames; null: none
  FrameWords why = nullptr;
};
const std::vector<FrameMetric>& frame_metrics();
/// `name` must exist.
const FrameMetric& find_frame_metric(std::string_view name);

using FrameValue = std::function<std::optional<double>(const FrameComparison&)>;

/// A metric that rules can check.
struct RuleMetric {
  std::string name, unit, sentence, meaning;  // as in FrameMetric
  bool needs_baseline = false;
  RuleFold fold = RuleFold::mean;
  RuleNeed need = RuleNeed::nothing;
  FrameValue value;  // nullopt if the frame has none
  FrameWords why = nullptr;
  /// For a count: the planes or frames that its percentage refers to. Null: not a count.
  double (*total)(const FrameComparison&) = nullptr;
  // `value` excludes changes of undecided planes. This is the value with them (empty: no such
  // difference), and the list of the undecided planes that changed: "plane 3 (margin 0.02)".
  FrameValue with_undecided = {};
  std::function<std::string(const FrameComparison&)> undecided = {};
};
/// "planes_lost", "offset_mm", "mean_iou_change", ...
const std::vector<RuleMetric>& rule_metrics();
/// `name` must exist.
const RuleMetric& find_metric(std::string_view name);

/// The built-in rule sets: `strict`, `default` and `lenient`. The default fails on planes that are
/// lost, gained, merged, split, or moved by 5 mm or 1 degree, on a drop in IoU, and on refused
/// frames. `lenient` allows 2 % of a recording's planes and twice the movement; `strict` allows
/// half the movement and turns warnings into errors. Empty: no such set.
std::vector<Rule> built_in_rules(std::string_view set = "default");

/// The rules of a built-in set or a file. Throws Error naming the file, the rule and the problem.
std::vector<Rule> read_rules(const std::filesystem::path& file);
/// The file for read_rules(), schema "planescope.rules/1".
std::string rules_json(const std::vector<Rule>& rules);

/// A value that exceeds a rule's limits.
struct Breach {
  Rule rule;
  std::string recording;  // empty: of all
  int frame = -1;         // -1: of the whole recording, or of all
  double value = 0;
  std::string why;          // details of the frame; may be empty
  std::string name;         // of the frame; may be empty
  bool is_missing = false;  // the frame is only in the baseline, which has this number
  double percent = 0;       // for a rule with at_most_percent
  /// "2 planes of the baseline are gone; the rule planes_lost allows none", ": " and the details.
  std::string text() const;
};

/// Worst first: errors before warnings, then frames by severity. Frames that are not in both
/// reports are checked only against rules that need no baseline. Changes of undecided planes break
/// no rule.
std::vector<Breach> broken_rules(const std::vector<Rule>& rules,
                                 const ReportComparison& comparison);

/// Rules that would be broken if undecided planes counted, in the order of the rules: `why` names
/// these planes.
std::vector<Breach> noted_changes(const std::vector<Rule>& rules,
                                  const ReportComparison& comparison);

/// A rule that cannot be broken: its recording, frame or labels, or the baseline, are missing.
struct IdleRule {
  Rule rule;
  std::string why;
  /// "planes of rec frame 7: this rule holds nothing, there is no such frame"
  std::string text() const;
};
/// Skips rules that are off.
std::vector<IdleRule> idle_rules(const std::vector<Rule>& rules,
                                 const ReportComparison& comparison,
                                 bool has_baseline);

}  // namespace planescope::report
