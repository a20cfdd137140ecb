#include "core/report/data/recorded_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/report/data/report_files.hpp"
#include "support/empty_report.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path written(const std::string& text) {
  const fs::path file = temp_dir() / "planescope_recorded_report.json";
  std::ofstream(file) << text;
  return file;
}

Report make_report() {
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

TEST(RecordedReport, WhatIsReadIsWhatWasWritten) {
  const Report report = make_report();
  const RecordedReport now = recorded(report), read = read_report(written(report_json(report)));
  EXPECT_EQ(read.schema, 2);
  EXPECT_EQ(read.commit, now.commit);
  EXPECT_EQ(read.method, "ours");
  EXPECT_EQ(read.options, now.options);
  ASSERT_EQ(read.recordings.size(), 1u);
  ASSERT_EQ(read.recordings[0].frames.size(), 2u);
  const RecordedFrame& a = now.recordings[0].frames[0];
  const RecordedFrame& b = read.recordings[0].frames[0];
  EXPECT_EQ(b.index, 7);
  EXPECT_EQ(b.sha256, a.sha256);
  EXPECT_EQ(b.points_on_planes, 40u);
  EXPECT_EQ(b.regions, a.regions);
  ASSERT_EQ(b.planes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(b.planes[k].id, a.planes[k].id);
    EXPECT_EQ(b.planes[k].label, a.planes[k].label);
    EXPECT_EQ(b.planes[k].normal, a.planes[k].normal);
    EXPECT_EQ(b.planes[k].centroid, a.planes[k].centroid);
    EXPECT_EQ(b.planes[k].offset_m, a.planes[k].offset_m);
  }
  ASSERT_TRUE(b.metrics);
  EXPECT_EQ(b.metrics->mean_iou, 87.5);
  EXPECT_EQ(b.metrics->pq, 75);
  EXPECT_EQ(read.recordings[0].frames[1].refused, "no gravity");
}

TEST(RecordedReport, AFileOfTheFirstSchemaIsStillRead) {
  // As the version that wrote it left it: no regions, no pq, no method.
  const RecordedReport read =
      read_report(PLANESCOPE_SOURCE_DIR "/tests/unit/report/report_v1.json");
  EXPECT_EQ(read.schema, 1);
  EXPECT_EQ(read.method, "ours");
  EXPECT_EQ(read.classifier, "pca");
  ASSERT_EQ(read.recordings.size(), 1u);
  const RecordedFrame& frame = read.recordings[0].frames.at(0);
  EXPECT_EQ(frame.planes.size(), 14u);
  EXPECT_TRUE(frame.regions.runs.empty());
  ASSERT_TRUE(frame.metrics);
  EXPECT_TRUE(std::isnan(frame.metrics->pq));
}

TEST(RecordedReport, WhatIsWrongIsNamedWithItsPlace) {
  const Json good = Json::parse(report_json(make_report()));
  const auto refusal_of = [](const Json& json) {
    const fs::path file = written(json.dump());
    const std::string text = message_of([&] { read_report(file); });
    EXPECT_EQ(text.rfind(file.string() + ": ", 0), 0u) << text;
    return text.substr(std::min(text.size(), file.string().size() + 2));
  };
  Json json = good;
  json["schema"] = "planescope.report/3";
  EXPECT_EQ(
      refusal_of(json),
      "schema is \"planescope.report/3\", expected planescope.report/1 or planescope.report/2");
  json = good;
  json["recordings"][0]["frames"][0]["planes"][1]["normal"] = {1, "x", 3};
  EXPECT_EQ(refusal_of(json),
            "recordings[0].frames[0].planes[1].normal[1] is \"x\", expected a number");
  json = good;
  json["recordings"][0]["frames"][0].erase("planes");
  EXPECT_EQ(refusal_of(json), "recordings[0].frames[0] has no \"planes\"");
  json = good;
  json["recordings"][0]["frames"][0]["planes"][0]["id"] = 5;
  EXPECT_EQ(refusal_of(json),
            "recordings[0].frames[0].planes[0].id is 5, expected a whole number from 1 to 1");
  for (const char* runs : {"[1,7]", "[1,5]", "[1]", "[3,6]", "[1,-1,1,7]", "[0,9e18]", "6"}) {
    json = good;
    json["recordings"][0]["frames"][0]["regions"]["runs"] = Json::parse(runs);
    EXPECT_EQ(refusal_of(json).rfind("recordings[0].frames[0].regions.runs", 0), 0u) << runs;
  }
  json = good;
  json["recordings"][0]["frames"][0]["regions"]["rows"] = 2000000000;
  EXPECT_NE(refusal_of(json).find("regions.rows"), std::string::npos);
  EXPECT_EQ(refusal_of(Json::array()), "the file is [], expected an object");
  EXPECT_NE(message_of([] { read_report(written("{\"schema\": ")); }).find("not valid JSON"),
            std::string::npos);
}

}  // namespace
}  // namespace planescope::report
