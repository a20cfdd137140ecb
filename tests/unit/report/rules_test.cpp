// Tests of report rules, and of notes on undecided planes.

#include "core/report/compare/rules.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/empty_report.hpp"
#include "support/has.hpp"
#include "support/json_schema.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::report {
namespace {

using planes::PlaneSummary;

namespace fs = std::filesystem;

ReportFrame frame_with(int index, std::vector<double> heights_m, double mean_iou = 90) {
  ReportFrame frame;
  frame.index = index;
  frame.counts.kept = 100;
  frame.points_on_planes = 90;
  std::vector<int> plane_of(10);
  for (const double height : heights_m) {
    const int id = static_cast<int>(frame.planes.size()) + 1;
    frame.planes.push_back(level_plane(id, height));
    plane_of[frame.planes.size() - 1] = id;
  }
  frame.regions = {1, 10, 1, runs_of(plane_of)};
  frame.metrics = planes::Metrics{};
  frame.metrics->mean_iou = mean_iou;
  return frame;
}

const Report& baseline() {
  static const Report report = report_of_frames(
      {{"a", {frame_with(0, {0, 0.2}), frame_with(1, {0, 0.2})}}, {"b", {frame_with(0, {0})}}});
  return report;
}

std::vector<Breach> broken(const Report& now, const std::vector<Rule>& rules = built_in_rules()) {
  return broken_rules(rules, compare_reports(baseline(), now));
}

Rule rule(const std::string& metric, double at_least, double at_most, RuleScope scope) {
  Rule result;
  result.metric = metric;
  result.at_least = at_least;
  result.at_most = at_most;
  result.scope = scope;
  return result;
}

TEST(Rules, TheSameReportBreaksNone) { EXPECT_TRUE(broken(baseline()).empty()); }

TEST(Rules, AMoveOfSixMillimetersIsAnErrorOfItsFrame) {
  Report now = baseline();
  now.recordings[0].frames[1] = frame_with(1, {0, 0.206});
  const auto found = broken(now);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].recording, "a");
  EXPECT_EQ(found[0].frame, 1);
  EXPECT_EQ(found[0].rule.level, RuleLevel::error);
  EXPECT_EQ(found[0].text(), "a plane moved by 6 mm; the rule offset_mm allows at most 5 mm");
}

TEST(Rules, TheFrameThatBreaksMostComesFirstAndWarningsLast) {
  Report now = baseline();
  now.recordings[0].frames[0].planes[0].summary.area_m2 = 2;
  now.recordings[0].frames[1] = frame_with(1, {0, 0.206});
  now.recordings[1].frames[0] = frame_with(0, {0.1}, 80);
  const auto found = broken(now);
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].recording, "b");
  EXPECT_EQ(found[1].recording, "b");
  EXPECT_EQ(found[2].frame, 1);
  EXPECT_EQ(found[3].rule.metric, "planes_resized");
  EXPECT_EQ(found[3].rule.level, RuleLevel::warn);
}

TEST(Rules, AmongFramesWithEqualCountsTheWorstViolationComesFirst) {
  Report now = baseline();
  now.recordings[0].frames[0] = frame_with(0, {0, 0.206});
  now.recordings[0].frames[1] = frame_with(1, {0, 0.209});
  const auto found = broken(now);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].frame, 1);
  EXPECT_EQ(found[1].frame, 0);
}

TEST(Rules, AMissingOrFailedFrameIsAnError) {
  Report now = baseline();
  now.recordings[0].frames[0].refused = "no gravity";
  now.recordings[1].frames.clear();
  const auto found = broken(now);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].rule.metric, "frames_missing");
  EXPECT_EQ(found[0].recording, "b");
  EXPECT_EQ(found[1].rule.metric, "frames_refused");
}

TEST(Rules, AReportThatSharesNoFrameWithTheBaselineFails) {
  const auto of = [](const std::string& recording, const std::string& pixels) {
    Report report = report_of_frames({{recording, {frame_with(0, {0})}}});
    report.recordings[0].frames[0].sha256 = pixels;
    return report;
  };
  const Report before = of("a", "1");
  for (const char* set : {"strict", "default", "lenient"}) {
    const auto broken_by = [&](const Report& now) {
      return broken_rules(built_in_rules(set), compare_reports(before, now));
    };
    EXPECT_TRUE(broken_by(of("a", "1")).empty()) << set;
    for (const Report& now : {of("b", "1"), of("a", "2")}) {
      const std::vector<Breach> found = broken_by(now);
      ASSERT_FALSE(found.empty()) << set;
      EXPECT_TRUE(std::ranges::any_of(found, [](const Breach& breach) {
        return breach.rule.level == RuleLevel::error &&
               breach.text() ==
                   "0 frames are compared with the baseline; the rule "
                   "frames_compared requires at least 1 frame";
      })) << set;
    }
  }
}

TEST(Rules, AShareOfTheBaselinesPlanesMayBeLostOverARecording) {
  Report now = baseline();
  now.recordings[0].frames[1] = frame_with(1, {0});  // one of the four planes of "a" is lost
  Rule share;
  share.metric = "planes_lost";
  share.scope = RuleScope::recording;
  share.at_most_percent = 25;
  EXPECT_TRUE(broken(now, {share}).empty());
  share.at_most_percent = 2;
  const auto found = broken(now, {share});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].text(),
            "1 plane (25 %) of the baseline is gone; the rule planes_lost allows at most 2 %");
}

TEST(Rules, BuiltInSetsDifferInTheirLimitsAndCanBeStored) {
  EXPECT_EQ(read_rules("default"), built_in_rules());
  EXPECT_TRUE(built_in_rules("loose").empty());
  Report moved = baseline();
  moved.recordings[0].frames[1] = frame_with(1, {0, 0.206});
  EXPECT_EQ(broken(moved, read_rules("strict")).size(), 1u);
  EXPECT_TRUE(broken(moved, read_rules("lenient")).empty());
  const auto file = temp_dir() / "lenient.json";
  std::ofstream(file) << rules_json(built_in_rules("lenient"));
  EXPECT_EQ(read_rules(file), built_in_rules("lenient"));
}

// Changes of undecided planes are notes; changes of decided ones break rules.

/// Plane 2 of frame 1 of "a" is undecided.
Report with_undecided(Report report, double margin = 0.02) {
  PlaneSummary& plane = report.recordings[0].frames[1].planes[1].summary;
  plane.undecided = true;
  plane.margin = margin;
  return report;
}

/// `frame` becomes frame 1 of "a", with planes 1 and 2 changed.
Report with_frame(ReportFrame frame) {
  Report report = baseline();
  report.recordings[0].frames[1] = std::move(frame);
  return report;
}

struct Outcome {
  std::vector<Breach> broken, noted;
};
Outcome outcome_of(const Report& before,
                   const Report& now,
                   const std::vector<Rule>& rules = built_in_rules()) {
  const ReportComparison comparison = compare_reports(before, now);
  return {broken_rules(rules, comparison), noted_changes(rules, comparison)};
}

/// Expects an error or warning for decided planes, and the same text as a note if they are
/// undecided in `before` or `now`.
void expect_noted_if_undecided(const Report& now, const std::string& text, bool undecided_now) {
  const Outcome decided = outcome_of(baseline(), now);
  ASSERT_EQ(decided.broken.size(), 1u);
  EXPECT_TRUE(decided.noted.empty());
  EXPECT_EQ(decided.broken[0].text(), text);
  const Outcome undecided = undecided_now ? outcome_of(baseline(), with_undecided(now))
                                          : outcome_of(with_undecided(baseline()), now);
  EXPECT_TRUE(undecided.broken.empty());
  ASSERT_EQ(undecided.noted.size(), 1u);
  EXPECT_EQ(undecided.noted[0].recording, "a");
  EXPECT_EQ(undecided.noted[0].frame, 1);
  const char* plane = undecided_now ? "plane 2" : "plane 2 of the baseline";
  EXPECT_EQ(undecided.noted[0].text(),
            text + ": note only; undecided: " + plane + " (margin 0.02)");
}

TEST(UndecidedPlanes, ThatAreLostAreNoted) {
  expect_noted_if_undecided(with_frame(frame_with(1, {0})),
                            "1 plane of the baseline is gone; the rule planes_lost allows none",
                            false);
}

TEST(UndecidedPlanes, ThatAreNewAreNoted) {
  Report before = with_frame(frame_with(1, {0}));
  const Outcome decided = outcome_of(before, baseline());
  ASSERT_EQ(decided.broken.size(), 1u);
  EXPECT_EQ(decided.broken[0].rule.metric, "planes_gained");
  EXPECT_EQ(decided.broken[0].rule.level, RuleLevel::error);
  const Outcome undecided = outcome_of(before, with_undecided(baseline()));
  EXPECT_TRUE(undecided.broken.empty());
  ASSERT_EQ(undecided.noted.size(), 1u);
  EXPECT_TRUE(has(undecided.noted[0].text(), "plane 2 (margin 0.02)"));
}

TEST(UndecidedPlanes, OfEitherRunThatMovedTurnedOrGrewAreNoted) {
  Report turned = baseline();
  PlaneSummary& plane = turned.recordings[0].frames[1].planes[1].summary;
  plane.normal = Vec3d(0, std::sin(0.05), std::cos(0.05));
  plane.offset_m = plane.normal.dot(plane.centroid);
  Report grown = baseline();
  grown.recordings[0].frames[1].planes[1].summary.area_m2 = 2;
  for (const bool now : {false, true}) {
    expect_noted_if_undecided(with_frame(frame_with(1, {0, 0.206})),
                              "a plane moved by 6 mm; the rule offset_mm allows at most 5 mm", now);
    expect_noted_if_undecided(
        turned, "a plane turned by 2.86 degrees; the rule angle_deg allows at most 1 degree", now);
    expect_noted_if_undecided(grown,
                              "the area of 1 plane changed by a quarter or more; the "
                              "rule planes_resized allows none",
                              now);
  }
}

TEST(UndecidedPlanes, ThatSplitOrMergeAreNotedIfAnyPartIsUndecided) {
  ReportFrame one = frame_with(1, {0}), two = frame_with(1, {0, 0});
  one.regions.runs = {{1, 10}};
  two.regions.runs = {{1, 5}, {2, 5}};
  const Report whole = with_frame(one), parts = with_frame(two);
  EXPECT_EQ(outcome_of(whole, parts).broken.at(0).rule.metric, "planes_split");
  EXPECT_EQ(outcome_of(parts, whole).broken.at(0).rule.metric, "planes_merged");
  const Outcome split = outcome_of(whole, with_undecided(parts));
  EXPECT_TRUE(split.broken.empty());
  ASSERT_EQ(split.noted.size(), 1u);
  EXPECT_TRUE(has(split.noted[0].text(), "undecided: plane 2 ("));
  const Outcome merged = outcome_of(with_undecided(parts), whole);
  EXPECT_TRUE(merged.broken.empty());
  ASSERT_EQ(merged.noted.size(), 1u);
  EXPECT_EQ(merged.noted[0].value, 2);
  EXPECT_TRUE(has(merged.noted[0].text(), "undecided: plane 2 of the baseline ("));
}

TEST(UndecidedPlanes, DoNotHideADecidedOneBesideThem) {
  const Outcome found = outcome_of(with_undecided(baseline()), with_frame(frame_with(1, {})));
  ASSERT_EQ(found.broken.size(), 1u);
  EXPECT_EQ(found.broken[0].value, 1);
  ASSERT_EQ(found.noted.size(), 1u);
  EXPECT_EQ(found.noted[0].value, 2);
  const Outcome moved =
      outcome_of(with_undecided(baseline()), with_frame(frame_with(1, {0.007, 0.229})));
  ASSERT_EQ(moved.broken.size(), 1u);
  EXPECT_NEAR(moved.broken[0].value, 7, 1e-9);
  ASSERT_EQ(moved.noted.size(), 1u);
  EXPECT_NEAR(moved.noted[0].value, 29, 1e-9);
}

TEST(UndecidedPlanes, AreNotedByRulesOverAllFramesToo) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const std::vector<Rule> rules = {rule("planes_lost", -kAny, 0, RuleScope::recording)};
  const Report now = with_frame(frame_with(1, {0}));
  EXPECT_EQ(outcome_of(baseline(), now, rules).broken.size(), 1u);
  const Outcome found = outcome_of(with_undecided(baseline()), now, rules);
  EXPECT_TRUE(found.broken.empty());
  ASSERT_EQ(found.noted.size(), 1u);
  EXPECT_EQ(found.noted[0].frame, -1);
  EXPECT_EQ(found.noted[0].text(),
            "1 plane of the baseline is gone; the rule planes_lost allows none: note only; "
            "undecided planes make the difference");
}

TEST(UndecidedPlanes, ThatDidNotChangeAreNotNoted) {
  const Report report = with_undecided(baseline());
  EXPECT_TRUE(outcome_of(report, report).noted.empty());
  std::vector<Rule> off = built_in_rules();
  for (Rule& one : off) one.level = RuleLevel::off;
  EXPECT_TRUE(outcome_of(report, with_frame(frame_with(1, {0})), off).noted.empty());
}

TEST(Rules, ScopesAggregateFramesByMetric) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  Report now = baseline();
  now.recordings[0].frames[0] = frame_with(0, {0, 0.2, 0.5}, 80);
  now.recordings[0].frames[1] = frame_with(1, {0, 0.2, 0.5}, 100);
  const auto value_of = [&](const std::string& metric, RuleScope scope) {
    // A rule that any value breaks.
    const auto found = broken(now, {rule(metric, kAny, kAny, scope)});
    std::vector<double> values;
    for (const Breach& breach : found) values.push_back(breach.value);
    return values;
  };
  EXPECT_EQ(value_of("planes_gained", RuleScope::frame), (std::vector<double>{1, 1, 0}));
  EXPECT_EQ(value_of("planes_gained", RuleScope::recording), (std::vector<double>{2, 0}));
  EXPECT_EQ(value_of("planes_gained", RuleScope::all), (std::vector<double>{2}));
  EXPECT_EQ(value_of("mean_iou", RuleScope::recording), (std::vector<double>{90, 90}));
  EXPECT_EQ(value_of("mean_iou_change", RuleScope::frame), (std::vector<double>{-10, 10, 0}));
  EXPECT_EQ(value_of("offset_mm", RuleScope::all), (std::vector<double>{0}));
  EXPECT_EQ(value_of("pq", RuleScope::all).size(), 1u);
}

TEST(Rules, ARuleAppliesOnlyToItsRecordingAndFrame) {
  Rule one = rule("planes", 0, 1, RuleScope::frame);
  EXPECT_EQ(broken(baseline(), {one}).size(), 2u);
  one.frame = 1;
  EXPECT_EQ(broken(baseline(), {one}).size(), 1u);
  one.recording = "b";
  EXPECT_TRUE(broken(baseline(), {one}).empty());
  one = rule("planes", 0, 1, RuleScope::frame);
  one.level = RuleLevel::off;
  EXPECT_TRUE(broken(baseline(), {one}).empty());
}

TEST(Rules, WithoutABaselineOnlyIndependentRulesApply) {
  const ReportComparison alone = compare_reports({}, baseline());
  EXPECT_TRUE(broken_rules(built_in_rules(), alone).empty());
  EXPECT_EQ(broken_rules({rule("planes", 2, 100, RuleScope::frame)}, alone).size(), 1u);
}

/// One plane with 0.5 m2 for the foot's center, and a flight.
ReportFrame frame_to_climb(bool steppable, int steps, double rise_m) {
  ReportFrame frame = frame_with(0, {0});
  frame.planes[0].footing.emplace().foot = {steppable, steppable ? "" : "17.2 mm rough, limit 10",
                                            0.5, 2};
  Terrain& terrain = frame.terrain.emplace();
  terrain.steppable_area_m2 = steppable ? 0.5 : 0;
  if (steps > 0) terrain.flights = {{steps, planes::SeenFrom::below, rise_m, 0.29, 0.9, false, {}}};
  return frame;
}

std::vector<std::string> texts_of_broken(const Report& before,
                                         const ReportFrame& now,
                                         const Rule& one) {
  std::vector<std::string> texts;
  for (const Breach& breach :
       broken_rules({one}, compare_reports(before, report_of_frames({{"a", {now}}}))))
    texts.push_back(breach.text());
  return texts;
}

TEST(Rules, FootholdsAreComparedWithLimitsAndTheBaseline) {
  using Texts = std::vector<std::string>;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const Report before = report_of_frames({{"a", {frame_to_climb(true, 4, 0.17)}}});
  const auto broken_of = [&](const ReportFrame& now, const char* metric, double least,
                             double most) {
    return texts_of_broken(before, now, rule(metric, least, most, RuleScope::frame));
  };
  const ReportFrame same = frame_to_climb(true, 4, 0.17), worse = frame_to_climb(false, 2, 0.176);
  EXPECT_EQ(broken_of(same, "steppable_area_m2", 0.5, kAny), Texts{});
  EXPECT_EQ(
      broken_of(worse, "steppable_area_m2", 0.5, kAny),
      Texts{
          "the area for the center of a foot is 0 m\u00b2; the rule steppable_area_m2 requires at "
          "least 0.5 m\u00b2: 0 of 1 plane steppable"});
  EXPECT_EQ(broken_of(same, "steppable_area_change", 0, kAny), Texts{});
  EXPECT_EQ(broken_of(worse, "steppable_area_change", -0.1, kAny),
            Texts{"the area for the center of a foot changed by -0.5 m\u00b2; the rule "
                  "steppable_area_change "
                  "requires at least -0.1 m\u00b2: 0.50 m2 in the baseline, 0.00 m2 "
                  "now; plane 1 is no longer steppable: 17.2 mm rough, limit 10"});
  EXPECT_EQ(broken_of(same, "stairs_steps", 4, 4), Texts{});
  EXPECT_EQ(broken_of(frame_to_climb(true, 0, 0), "stairs_steps", 1, kAny),
            Texts{"0 steps of stairs are found; the rule stairs_steps requires at least 1 step: no "
                  "stairs are found"});
  EXPECT_EQ(broken_of(worse, "stairs_steps_change", 0, kAny),
            Texts{"the stairs changed by -2 steps; the rule stairs_steps_change requires at least "
                  "0 steps: 4 steps up, rise 170 mm, going 290 mm "
                  "in the baseline, 2 steps up, rise 176 mm, going 290 mm now"});
  EXPECT_EQ(broken_of(same, "rise_mm", 165, 175), Texts{});
  EXPECT_EQ(broken_of(worse, "rise_mm", 165, 175).size(), 1u);
  EXPECT_EQ(broken_of(same, "rise_change", -1, 1), Texts{});
  EXPECT_EQ(broken_of(worse, "rise_change", -5, 5).size(), 1u);
}

TEST(Rules, ThatLackAFootOrABaselineAreReported) {
  const auto idle = [](const char* metric, const ReportFrame& before, const ReportFrame& now) {
    const Report baseline = report_of_frames({{"a", {before}}}),
                 is = report_of_frames({{"a", {now}}});
    const auto found =
        idle_rules({rule(metric, 0, 9, RuleScope::all)}, compare_reports(baseline, is), true);
    return found.empty() ? "" : found[0].why;
  };
  const ReportFrame with = frame_to_climb(true, 4, 0.17);
  ReportFrame footless = with;
  footless.terrain->steppable_area_m2 = std::nan("");
  EXPECT_EQ(idle("steppable_area_change", with, with), "");
  EXPECT_EQ(idle("steppable_area_m2", with, footless), "no foot (use --foot 0.08)");
  EXPECT_EQ(idle("steppable_area_change", footless, with),
            "at least one of the runs has no foot (use --foot 0.08)");
  EXPECT_EQ(idle("rise_mm", with, frame_to_climb(true, 0, 0)), "these frames have no stairs");
}

TEST(Rules, FollowTheirSchemaWhichListsEveryMetric) {
  std::ifstream file(PLANESCOPE_SOURCE_DIR "/assets/schemas/rules.schema.json");
  const auto schema = nlohmann::json::parse(file);
  std::vector<Rule> rules = built_in_rules();
  for (const RuleMetric& metric : rule_metrics())
    rules.push_back(rule(std::string(metric.name), 0, 1, RuleScope::all));
  EXPECT_EQ(schema_error(schema, nlohmann::json::parse(rules_json(rules))), "");
  EXPECT_NE(
      schema_error(schema, nlohmann::json::parse(
                               R"({"schema": "planescope.rules/1", "rules": [{"metric": "x"}]})")),
      "");
}

TEST(Rules, TheDocumentListsEveryMetricWithItsUnit) {
  std::ifstream file(PLANESCOPE_SOURCE_DIR "/docs/report.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const RuleMetric& metric : rule_metrics()) {
    std::string row = "| `";
    row.append(metric.name).append("` | ").append(metric.unit).append(" | ");
    row.append(metric.meaning).append(" | ");
    EXPECT_TRUE(has(text, row)) << row;
  }
}

TEST(Rules, TimesOnlyCauseWarnings) {
  const fs::path file = temp_dir() / "time.rules.json";
  const auto written = [&](const char* level) {
    std::ofstream(file)
        << R"({"schema": "planescope.rules/1", "rules": [{"metric": "time_growth", "at_most": 1.1)"
        << level << "}]}";
    return file;
  };
  EXPECT_EQ(read_rules(written("")).at(0).level, RuleLevel::warn);
  EXPECT_TRUE(has(message_of([&] { read_rules(written(R"(, "level": "error")")); }),
                  "rules[0].level is \"error\"; expected warn or off"));
  Report now = baseline();
  Report before = baseline();
  for (Report* report : {&before, &now})
    for (ReportFrame& frame : report->recordings[0].frames) {
      frame.timings.t_s_ms = report == &now ? 9 : 3;
      frame.reference_ms = 1;
    }
  const auto found = broken_rules(built_in_rules(), compare_reports(before, now));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].text(),
            "the time from voxel grid to planes is 3 times the baseline's; the rule time_growth "
            "allows at most 2 times");
  EXPECT_EQ(found[0].rule.level, RuleLevel::warn);
}

TEST(Rules, AreReadBackFromAFile) {
  const fs::path file = temp_dir() / "planescope.rules.json";
  std::vector<Rule> rules = built_in_rules();
  rules.push_back(rule("mean_iou", 85, std::numeric_limits<double>::infinity(), RuleScope::all));
  rules.back().recording = "a";
  rules.back().frame = 3;
  std::ofstream(file) << rules_json(rules);
  EXPECT_EQ(rules_json(read_rules(file)), rules_json(rules));
}

TEST(Rules, AMistakeInTheFileIsReported) {
  const fs::path file = temp_dir() / "planescope.rules.json";
  const auto refusal_of = [&](const std::string& rule) {
    std::ofstream(file) << R"({"schema": "planescope.rules/1", "rules": [)" + rule + "]}";
    const std::string text = message_of([&] { read_rules(file); });
    EXPECT_EQ(text.rfind(file.string() + ": ", 0), 0u) << text;
    return text;
  };
  EXPECT_TRUE(has(refusal_of(R"({"metric": "planes_lsot", "at_most": 0})"), "planes_lost"));
  EXPECT_TRUE(
      has(refusal_of(R"({"metric": "planes", "atmost": 0})"), "has an unknown key, \"atmost\""));
  EXPECT_TRUE(has(refusal_of(R"({"metric": "planes"})"),
                  "\"at_least\", \"at_most\", or \"at_most_percent\""));
  EXPECT_TRUE(has(refusal_of(R"({"metric": "planes", "at_most": 0, "level": "fatal"})"),
                  "rules[0].level is \"fatal\"; expected one of off, warn, error"));
  EXPECT_TRUE(has(refusal_of(R"({"metric": "planes", "at_least": 5, "at_most": 4})"),
                  "has at_least 5 and at_most 4; expected at_least <= at_most"));
  EXPECT_TRUE(has(refusal_of(R"({"metric": "planes", "at_most": 4}], "rules": [)"),
                  "\"rules\" appears twice in one object"));
}

TEST(Rules, MissingLabelsAreAnErrorOfTheirFrame) {
  Report now = baseline();
  now.recordings[0].frames[1].metrics.reset();
  const auto found = broken(now);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].rule.metric, "labels_missing");
  EXPECT_EQ(found[0].frame, 1);
}

TEST(Rules, ThatApplyToNothingAreReportedWithTheReason) {
  const auto idle = [](Rule one, const Report& now, bool has_baseline = true) {
    const std::vector<IdleRule> found =
        idle_rules({one}, compare_reports(has_baseline ? baseline() : Report(), now), has_baseline);
    return found.empty() ? "" : found[0].text();
  };
  Rule one = rule("planes", 0, 9, RuleScope::frame);
  EXPECT_EQ(idle(one, baseline()), "");
  one.frame = 1;
  EXPECT_EQ(idle(one, baseline()), "");
  one.recording = "b";
  EXPECT_EQ(idle(one, baseline()), "planes of b frame 1: rule not applied: no such frame");
  one.recording = "bb";
  EXPECT_EQ(idle(one, baseline()),
            "planes of bb frame 1: rule not applied: no recording with this name");
  one.level = RuleLevel::off;
  EXPECT_EQ(idle(one, baseline()), "");
  EXPECT_EQ(idle(rule("planes_lost", 0, 0, RuleScope::all), baseline(), false),
            "planes_lost: rule not applied: no baseline");
  Report fewer = baseline();
  fewer.recordings[0].frames.pop_back();
  one = rule("planes", 0, 9, RuleScope::frame);
  one.frame = 1;
  EXPECT_EQ(idle(one, fewer), "planes frame 1: rule not applied: no such frame")
      << "only the baseline has it";
  Report unlabeled = report_of_frames({{"a", {frame_with(0, {0})}}});
  unlabeled.recordings[0].frames[0].metrics.reset();
  EXPECT_EQ(idle(rule("mean_iou", 80, 100, RuleScope::all), unlabeled),
            "mean_iou: rule not applied: these frames have no labels");
  one = rule("mean_iou_change", -1, 100, RuleScope::all);
  EXPECT_EQ(idle(one, unlabeled), "") << "of frames that may get labels";
  one.recording = "a";
  EXPECT_EQ(idle(one, unlabeled),
            "mean_iou_change of a: rule not applied: these frames have no labels");
}

}  // namespace
}  // namespace planescope::report
