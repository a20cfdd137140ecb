// Tests of reading report.json, recorded options and links to frames and planes.

#include "core/report/data/report_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/planes/pipeline/options_table.hpp"
#include "core/report/compare/rules.hpp"
#include "support/empty_report.hpp"
#include "support/has.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::report {
namespace {

using planes::PlaneSummary;

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path written(const std::string& text) {
  const fs::path file = temp_dir() / "planescope_recorded_report.json";
  std::ofstream(file) << text;
  return file;
}

Report make_compared_report() {
  Report report = empty_report();
  report.classifier = "gcn";
  ReportRecording recording;
  recording.name = "rec";
  ReportFrame frame;
  frame.index = 7;
  frame.name = "000007";
  frame.sha256 = std::string(64, 'a');
  frame.counts.kept = 50;
  frame.points_on_planes = 40;
  for (int id = 1; id <= 2; ++id) {
    PlaneSummary plane;
    plane.id = id;
    plane.label = id == 1 ? Label::h : Label::v;
    plane.normal = {0, id - 1.0, 2.0 - id};
    plane.centroid = {0.25, -0.5, 1.0 * id};
    plane.offset_m = 0.125 * id;
    plane.area_m2 = 0.5;
    plane.points = 20;
    frame.planes.push_back({plane, "#0072b2"});
  }
  frame.regions = {8, 3, 2, {{-1, 1}, {1, 2}, {2, 1}, {0, 2}}};
  frame.metrics = planes::Metrics{};
  frame.metrics->mean_iou = 87.5;
  frame.metrics->pq = 75;
  recording.frames.push_back(frame);
  ReportFrame refused;
  refused.index = 8;
  refused.refused = "no gravity";
  recording.frames.push_back(refused);
  report.recordings.push_back(recording);
  return report;
}

TEST(ReadReport, ReadsBackWrittenReports) {
  const Report now = make_compared_report(), read = read_report(written(report_json(now)));
  EXPECT_EQ(read.commit, now.commit);
  EXPECT_EQ(read.method, "ours");
  ASSERT_EQ(read.options.size(), now.options.size());
  EXPECT_EQ(read.options.back().value, now.options.back().value);
  ASSERT_EQ(read.recordings.size(), 1u);
  ASSERT_EQ(read.recordings[0].frames.size(), 2u);
  const ReportFrame& a = now.recordings[0].frames[0];
  const ReportFrame& b = read.recordings[0].frames[0];
  EXPECT_EQ(b.index, 7);
  EXPECT_EQ(b.sha256, a.sha256);
  EXPECT_EQ(b.points_on_planes, 40u);
  EXPECT_EQ(b.regions, a.regions);
  ASSERT_EQ(b.planes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(b.planes[k].summary.id, a.planes[k].summary.id);
    EXPECT_EQ(b.planes[k].summary.label, a.planes[k].summary.label);
    EXPECT_EQ(b.planes[k].summary.normal, a.planes[k].summary.normal);
    EXPECT_EQ(b.planes[k].summary.centroid, a.planes[k].summary.centroid);
    EXPECT_EQ(b.planes[k].summary.offset_m, a.planes[k].summary.offset_m);
  }
  ASSERT_TRUE(b.metrics);
  EXPECT_EQ(b.metrics->mean_iou, 87.5);
  EXPECT_EQ(b.metrics->pq, 75);
  EXPECT_EQ(read.recordings[0].frames[1].refused, "no gravity");
}

TEST(ReadReport, UndecidedPlanesAreReadBackWithTheirMargin) {
  Report report = make_compared_report();
  PlaneSummary& plane = report.recordings[0].frames[0].planes[1].summary;
  plane.undecided = true;
  plane.margin = 0.03125;
  const Report read = read_report(written(report_json(report)));
  const ReportFrame& frame = read.recordings[0].frames[0];
  EXPECT_EQ(frame.planes_undecided, 1);
  EXPECT_TRUE(frame.planes[1].summary.undecided);
  EXPECT_EQ(frame.planes[1].summary.margin, 0.03125);
  EXPECT_FALSE(frame.planes[0].summary.undecided);
  EXPECT_TRUE(std::isinf(frame.planes[0].summary.margin)) << "null in the file";
}

TEST(ReadReport, AllPlanesOfAnEarlierVersionAreDecided) {
  Report now = make_compared_report();
  now.recordings[0].frames[0].planes[1].summary.undecided = true;
  Json json = Json::parse(report_json(now));
  json["schema"] = "planescope.report/3";
  json["totals"].erase("planes_undecided");
  for (Json& plane : json["recordings"][0]["frames"][0]["planes"]) {
    plane.erase("margin");
    plane.erase("undecided");
  }
  const Report old = read_report(written(json.dump()));
  for (const ReportPlane& plane : old.recordings[0].frames[0].planes) {
    EXPECT_FALSE(plane.summary.undecided);
    EXPECT_TRUE(std::isinf(plane.summary.margin));
  }
  Report lost = make_compared_report();
  lost.recordings[0].frames[0].planes.pop_back();
  lost.recordings[0].frames[0].regions.runs = {{-1, 1}, {1, 2}, {0, 3}};
  const ReportComparison comparison = compare_reports(old, lost);
  EXPECT_EQ(broken_rules(built_in_rules(), comparison).at(0).rule.metric, "planes_lost");
  EXPECT_TRUE(noted_changes(built_in_rules(), comparison).empty());
}

TEST(ReadReport, ErrorsAreReportedWithTheirLocation) {
  const Json good = Json::parse(report_json(make_compared_report()));
  const auto refusal_of = [](const Json& json) {
    const fs::path file = written(json.dump());
    const std::string text = message_of([&] { read_report(file); });
    EXPECT_EQ(text.rfind(file.string() + ": ", 0), 0u) << text;
    return text.substr(std::min(text.size(), file.string().size() + 2));
  };
  Json json = good;
  json["schema"] = "planescope.report/5";
  EXPECT_EQ(
      refusal_of(json),
      "schema is \"planescope.report/5\"; expected planescope.report/3 or planescope.report/4");
  json["schema"] = "planescope.report/2";
  EXPECT_EQ(refusal_of(json),
            "planescope.report/2 is no longer supported; expected planescope.report/3 or "
            "planescope.report/4");
  json = good;
  json["recordings"][0]["frames"][0]["planes"][1]["normal"] = {1, "x", 3};
  EXPECT_EQ(refusal_of(json),
            "recordings[0].frames[0].planes[1].normal[1] is \"x\"; expected a number");
  json = good;
  json["recordings"][0]["frames"][0].erase("planes");
  EXPECT_EQ(refusal_of(json), "recordings[0].frames[0] has no \"planes\"");
  json = good;
  json["recordings"][0]["frames"][0]["planes"][0]["id"] = 5;
  EXPECT_EQ(refusal_of(json),
            "recordings[0].frames[0].planes[0].id is 5; expected a whole number from 1 to 1");
  for (const char* runs : {"[1,7]", "[1,5]", "[1]", "[3,6]", "[1,-1,1,7]", "[0,9e18]", "6"}) {
    json = good;
    json["recordings"][0]["frames"][0]["regions"]["runs"] = Json::parse(runs);
    EXPECT_EQ(refusal_of(json).rfind("recordings[0].frames[0].regions.runs", 0), 0u) << runs;
  }
  json = good;
  json["recordings"][0]["frames"][0]["regions"]["rows"] = 2000000000;
  EXPECT_TRUE(has(refusal_of(json), "regions.rows"));
  EXPECT_EQ(refusal_of(Json::array()), "the file is []; expected an object");
  EXPECT_TRUE(has(message_of([] { read_report(written("{\"schema\": ")); }), "not valid JSON"));
}

Report through_a_file(const Report& report) { return read_report(written(report_json(report))); }

/// Sets an option to another value.
void change(planes::PipelineOptions& options, const planes::OptionInfo& info) {
  const std::string before = info.get(options);
  if (info.kind == planes::OptionKind::on_off) {
    info.set(options, before == "on" ? "off" : "on");
  } else if (info.kind == planes::OptionKind::choice) {
    info.set(options, info.choices[0] == before ? info.choices.back() : info.choices[0]);
  } else if (info.is_number()) {
    info.set(options, planes::number_text(info, planes::number_of(info, options) + 1));
    if (info.get(options) == before)
      info.set(options, planes::number_text(info, info.range.min + 1.0 / 3));
    if (info.kind == planes::OptionKind::number && info.range.max > 3)
      info.set(options, planes::number_text(info, 2 + 1.0 / 3));
  } else if (info.name == "gravity") {
    info.set(options, "0.1,0.9000000000000001,-0.33333333333333331");
  } else if (info.name == "classifier") {
    info.set(options, "my/weights.safetensors");
  }
}

TEST(RecordedOptions, MatchTheReportsRunToTheLastDigit) {
  for (const planes::Method method : planes::built_methods()) {
    planes::PipelineOptions options;
    options.method = method;
    options.segment = planes::profile_options(planes::Profile::paper);
    for (const planes::OptionInfo& info : planes::option_table())
      if (info.name != "profile" && info.name != "method") change(options, info);
    Report report;
    report.method = planes::to_string(method);
    report.options = make_report_options(options);
    std::vector<std::string> unknown;
    const planes::PipelineOptions again = options_of(through_a_file(report), unknown);
    EXPECT_TRUE(unknown.empty());
    for (const planes::OptionInfo& info : planes::option_table()) {
      if (!info.matters(options)) continue;
      EXPECT_EQ(info.get(again), info.get(options))
          << planes::to_string(method) << " " << info.name;
    }
    EXPECT_EQ(again.gravity.direction, options.gravity.direction);
  }
}

TEST(RecordedOptions, OfAnotherVersionAreUsedIfKnown) {
  Report report;
  const auto set = [&](const std::string& name, const std::string& value) {
    report.options.emplace_back().name = name;
    report.options.back().value = value;
  };
  set("theta_of_old", "3");
  set("theta_n_in", "9");
  set("profile", "paper");
  std::vector<std::string> unknown;
  const planes::PipelineOptions options = options_of(report, unknown);
  EXPECT_EQ(unknown, std::vector<std::string>{"theta_of_old"});
  EXPECT_EQ(options.segment.theta_n_in, 9) << "the profile must not undo it";
  EXPECT_EQ(options.segment.profile, planes::Profile::paper);
  report.options.clear();
  set("theta_n_in", "many");
  expect_refused([&] { options_of(report, unknown); }, "theta_n_in");
}

TEST(RecordedOptions, CameraOptionsOfTheCommandLineAreReadFromTheRecording) {
  Report report;
  ReportRecording& typed = report.recordings.emplace_back();
  typed.info.path = "dir/rec";
  typed.info.width = 640;
  typed.info.intrinsics.fx = 601.12345678901234;
  typed.info.intrinsics.fy = 602;
  typed.info.intrinsics_source = "option --intrinsics";
  typed.info.depth_unit_m = 0.0005;
  typed.info.depth_unit_source = "option --depth-unit";
  ReportRecording& own = report.recordings.emplace_back(typed);
  own.info.intrinsics_source = "camera.json";
  own.info.depth_unit_source = "assumed";
  const Report read = through_a_file(report);
  EXPECT_EQ(read.recordings[0].info.path, "dir/rec");
  const io::RecordingOptions options = options_of(read.recordings[0]);
  ASSERT_TRUE(options.intrinsics);
  EXPECT_EQ((*options.intrinsics)[0], 601.12345678901234);
  EXPECT_EQ(options.depth_unit_m, 0.0005);
  EXPECT_FALSE(options_of(read.recordings[1]).intrinsics);
  EXPECT_FALSE(options_of(read.recordings[1]).depth_unit_m);
}

TEST(ReportTarget, IdentifiesAFrameOrAPlaneOfAReport) {
  const ReportTarget file = parse_report_target("out/report.json");
  EXPECT_EQ(file.file, "out/report.json");
  EXPECT_EQ(file.recording, 1);
  EXPECT_EQ(file.frame, -1);
  EXPECT_EQ(file.plane, 0);

  const ReportTarget frame = parse_report_target("out/report.json#f012");
  EXPECT_EQ(frame.file, "out/report.json");
  EXPECT_EQ(frame.frame, 12);
  EXPECT_EQ(frame.plane, 0);

  const ReportTarget plane = parse_report_target("a#b/report.json#r2/f0/p3");
  EXPECT_EQ(plane.file, "a#b/report.json") << "the last # counts";
  EXPECT_EQ(plane.recording, 2);
  EXPECT_EQ(plane.frame, 0);
  EXPECT_EQ(plane.plane, 3);
  EXPECT_FALSE(plane.of_baseline);

  const ReportTarget lost = parse_report_target("report.json#f7/was14");
  EXPECT_EQ(lost.plane, 14);
  EXPECT_TRUE(lost.of_baseline);
}

TEST(ReportTarget, InvalidTargetsAreRejectedWithTheirText) {
  for (const char* place :
       {"",      "/",     "f",       "f-1",    "fx",           "12",   "f1/",
        "f1/p",  "f1/p0", "f1/was0", "f1/q3",  "f1/p3/p4",     "f1p3", "r1",
        "r0/f1", "r/f1",  "r1/p3",   "f1/p3 ", "f99999999999", "F1",   "f1/r1"}) {
    const std::string text =
        message_of([&] { parse_report_target(std::string("a.json#") + place); });
    EXPECT_TRUE(text.starts_with(std::string("a.json: '") + place + "' is not a location")) << text;
    EXPECT_TRUE(has(text, "expected f<frame>"));
    EXPECT_FALSE(has(text, "\n"));
  }
}

}  // namespace
}  // namespace planescope::report
