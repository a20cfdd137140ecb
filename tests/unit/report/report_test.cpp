// Tests of the files of a report: JSON, CSV, JUnit, page and frame records.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/io/image/photo.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_data.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/data/report_json.hpp"
#include "core/report/page/pictures.hpp"
#include "support/empty_report.hpp"
#include "support/has.hpp"
#include "support/json_schema.hpp"
#include "support/temp_dir.hpp"

namespace planescope::report {
namespace {

using planes::PlaneSummary;

using Json = nlohmann::json;

ReportFrame numbered_frame(int index) {
  ReportFrame frame;
  frame.index = index;
  frame.name = "00000" + std::to_string(index);
  frame.sha256 = std::string(64, 'a');
  frame.gravity = {Vec3d(0, 1, 0), GravitySource::estimate, 0.87, "floor and two walls"};
  frame.counts = {1000, 100, 5, 200, 1, 694};
  frame.voxels = 300;
  frame.points_on_planes = 600;
  frame.planes_h = 1;
  frame.segment.nodes_visited = 9;
  frame.segment.nodes_per_case[1] = 1;
  frame.segment.nodes_per_case[4] = 8;
  frame.segment.nodes_per_case_depth[1][0] = 1;
  frame.segment.nodes_per_case_depth[4][1] = 8;
  PlaneSummary plane;
  plane.id = 1;
  plane.label = Label::h;
  plane.points = 600;
  plane.rms_m = 0.004;
  frame.planes.push_back({plane, "#0072b2"});
  frame.planes[0].footing = Footing{};
  frame.planes[0].footing->outline_area_m2 = 1.25;
  frame.planes[0].footing->tilt_sigma_deg[1] = 0.375;
  frame.planes[0].footing->foot = {false, "17.2 mm rough, limit 10", 0.5, 3};
  frame.terrain = Terrain{};
  frame.terrain->floor = 1;
  frame.terrain->steppable_area_m2 = 0;
  frame.terrain->flights = {
      {4, planes::SeenFrom::below, 0.17, 0.289, 0.9, false, std::vector<int>{1}}};
  frame.terrain->kerbs = {{0.12, 1.5, {1}}};
  frame.terrain->ramps = {{1, 12.5, 0.25, 1.125, 0.75}};
  frame.regions = {8, 3, 2, {{-1, 1}, {1, 3}, {0, 2}}};
  ReportPicture picture;
  picture.name = "planes";
  picture.title = "Final planes";
  picture.alt = "One plane.";
  picture.file = "frames/000000/pictures/planes.png";
  picture.width = picture.height = 8;
  picture.pixels_sha256 = std::string(64, 'b');
  frame.pictures.push_back(picture);
  frame.timings = {1, 2, 3, 4, 5, 6};
  return frame;
}

planes::WeightsRecord make_weights_record() {
  return {"n<e>t.safetensors", std::string(64, 'f'), "compact, 27714 parameters",
          R"({"recipe":"planes<cope>","seed":7,"losses":[3,2,1]})"};
}

Report make_report() {
  Report report = empty_report();
  report.renderer = "llvmpipe";
  ReportRecording recording;
  recording.info.path = "dir/a<b>.bag";
  recording.info.format = "RealSense SDK bag";
  recording.info.width = 640;
  recording.info.height = 480;
  recording.info.depth_unit_m = 0.001;
  recording.info.warnings = {"2 frames were lost <at the end>"};
  recording.name = "a<b>.bag";
  recording.sha256 = std::string(64, 'd');
  recording.frame_count = 3;
  recording.frames_asked = 2;
  recording.frames.push_back(numbered_frame(0));
  ReportFrame refused;
  refused.index = 1;
  refused.sha256 = std::string(64, 'e');
  refused.refused = "gravity is not known, give --gravity";
  recording.frames.push_back(refused);
  report.recordings.push_back(recording);
  return report;
}

/// The page, with a gray copy of every picture.
std::string report_html(const Report& report) {
  const std::filesystem::path dir = temp_dir() / "report_page";
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      for (const ReportPicture& picture : frame.pictures)
        for (const std::string& copy : {copy_of(picture), thumbnail_of(picture)}) {
          std::filesystem::create_directories((dir / copy).parent_path());
          write_file_bytes(dir / copy, io::encode_webp(Image8(8, 8, 3, 200), 80));
        }
  std::ostringstream page;
  write_report_page(page, report, dir);
  return page.str();
}

Json schema() {
  std::ifstream file(PLANESCOPE_SOURCE_DIR "/assets/schemas/report.schema.json");
  return Json::parse(file);
}

/// A report with a frame of unknown gravity.
Report without_gravity() {
  Report report = make_report();
  ReportFrame& frame = report.recordings[0].frames[0];
  frame.gravity = {Vec3d(0, 1, 0), GravitySource::none, 0, "left open by --gravity none"};
  frame.planes_h = 0;
  frame.planes[0].summary.label = Label::unknown;
  frame.planes[0].summary.tilt_deg = std::nan("");
  frame.metrics.emplace();
  frame.metrics->label_accuracy_edge = frame.metrics->label_accuracy_inner = std::nan("");
  return report;
}

TEST(ReportJson, WithoutGravityHasNoDirectionTiltOrLabelAccuracy) {
  const Json json = Json::parse(report_json(without_gravity()));
  EXPECT_EQ(schema_error(schema(), json), "");
  const Json& frame = json["recordings"][0]["frames"][0];
  EXPECT_TRUE(frame["gravity"]["direction"].is_null());
  EXPECT_EQ(frame["gravity"]["source"], "none");
  EXPECT_EQ(frame["planes"][0]["label"], "unknown");
  EXPECT_TRUE(frame["planes"][0]["tilt_deg"].is_null());
  EXPECT_TRUE(frame["metrics"]["label_accuracy_edge"].is_null());
  EXPECT_TRUE(json["totals"]["metrics"]["label_accuracy_edge"].is_null());
}

TEST(ReportPage, ReportsUnknownGravityAndHowToSetIt) {
  const std::string page = report_html(without_gravity());
  EXPECT_TRUE(has(page, "Gravity was <em>unknown</em>"));
  EXPECT_TRUE(has(page, "Gravity is <em>unknown</em>: left open by --gravity none"));
  EXPECT_TRUE(has(page, "--gravity X,Y,Z"));
  EXPECT_TRUE(has(page, "without h and v"));
  EXPECT_FALSE(has(page, "h / v right</")) << "no figure of labels";
  EXPECT_FALSE(has(page, "nan"));
}

TEST(FramesCsv, LeavesUnknownFieldsEmpty) {
  std::istringstream csv(frames_csv(without_gravity()));
  std::string head, line;
  std::getline(csv, head);
  std::getline(csv, line);
  EXPECT_TRUE(has(line, ",none,,,,1000,100,5,200,1,694,300,,,600,"));
  EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(head, ','));
}

TEST(ReportJson, FollowsItsSchema) {
  Report report = make_report();
  EXPECT_EQ(schema_error(schema(), Json::parse(report_json(report))), "");
  report.recordings[0].frames[0].metrics = planes::Metrics{};
  report.recordings[0].info.width = 0;  // a cloud
  report.recordings[0].info.has_color = true;
  report.weights = make_weights_record();
  EXPECT_EQ(schema_error(schema(), Json::parse(report_json(report))), "");
}

TEST(ReportJson, SchemaRejectsMissingAndUnknownFields) {
  Json json = Json::parse(report_json(make_report()));
  json["recordings"][0].erase("sha256");
  EXPECT_NE(schema_error(schema(), json), "");
  json = Json::parse(report_json(make_report()));
  json["recordings"][0]["frames"][0]["planes"][0]["extra"] = 1;
  EXPECT_NE(schema_error(schema(), json), "");
}

TEST(ReportJson, OnlyTheDateAndTheTimingsDependOnTime) {
  Report now = make_report(), later = make_report();
  later.created_utc = "2025-01-02T03:04:05Z";
  later.recordings[0].frames[0].timings = {6, 5, 4, 3, 2, 1};
  Json a = Json::parse(report_json(now)), b = Json::parse(report_json(later));
  EXPECT_NE(a["timings"], b["timings"]);
  for (const char* key : {"created_utc", "timings"}) {
    a.erase(key);
    b.erase(key);
  }
  EXPECT_EQ(a, b);
}

TEST(ReportJson, APartialReportIsValidAndMarkedAsSuch) {
  Report report = make_report();
  report.partial = true;
  const Json json = Json::parse(report_json(report));
  EXPECT_EQ(schema_error(schema(), json), "");
  EXPECT_TRUE(json["partial"]);
  EXPECT_TRUE(has(report_html(report), "This report is partial"));

  report.recordings[0].frames.clear();  // stopped before the first frame
  EXPECT_EQ(schema_error(schema(), Json::parse(report_json(report))), "");
  EXPECT_TRUE(has(report_html(report), "</html>"));
}

TEST(ReportJson, CountsAddUpAndTotalsExcludeFailedFrames) {
  const Json json = Json::parse(report_json(make_report()));
  const Json& counts = json["recordings"][0]["frames"][0]["counts"];
  EXPECT_EQ(counts["pixels"].get<int>(),
            counts["no_measurement"].get<int>() + counts["invalid"].get<int>() +
                counts["beyond_range"].get<int>() + counts["outside_cube"].get<int>() +
                counts["n_m"].get<int>());
  EXPECT_EQ(json["totals"]["frames_done"], 1);
  EXPECT_EQ(json["totals"]["frames_refused"], 1);
  EXPECT_EQ(json["totals"]["planes"], 1);
  EXPECT_EQ(json["timings"].size(), 1u);
}

TEST(ReportHtml, ShowsEstimatedGravityAndFailedFrames) {
  const std::string page = report_html(make_report());
  EXPECT_TRUE(has(page, "<em>estimated</em>"));
  EXPECT_TRUE(has(page, "gravity is not known, give --gravity"));
  EXPECT_TRUE(has(page, "alt=\"One plane.\""));
}

TEST(ReportHtml, ShowsTheNetworkAtTheTopAndItsTrainingInTheRecord) {
  Report report = make_report();
  EXPECT_TRUE(has(report_html(report), "distinguished by PCA normals"));
  report.classifier = "gcn";
  report.weights = make_weights_record();
  const std::string page = report_html(report);
  const std::string top = page.substr(0, page.find("class=\"tiles\""));
  EXPECT_TRUE(has(top, "n&lt;e&gt;t.safetensors</code> (compact, 27714 parameters)"));
  EXPECT_TRUE(has(page, std::string(64, 'f')));
  EXPECT_TRUE(has(page, "trained with recipe planes&lt;cope&gt;, seed 7<"));
}

TEST(FramesCsv, EveryLineHasAsManyFieldsAsTheHeader) {
  Report report = make_report();
  report.recordings[0].frames.push_back(numbered_frame(2));
  report.recordings[0].frames[2].metrics = planes::Metrics{};
  EXPECT_TRUE(has(frames_csv(report), "\"gravity is not known, give --gravity\"")) << "quoted";
  report.recordings[0].frames[1].refused = "no gravity";
  std::istringstream csv(frames_csv(report));
  std::string line;
  std::vector<std::ptrdiff_t> commas;
  while (std::getline(csv, line)) commas.push_back(std::count(line.begin(), line.end(), ','));
  ASSERT_EQ(commas.size(), 4u);
  for (const std::ptrdiff_t count : commas) EXPECT_EQ(count, commas[0]);
}

TEST(ReportOptions, MarkDifferencesFromTheProfile) {
  planes::PipelineOptions options;
  options.segment = planes::profile_options(planes::Profile::paper);
  for (const ReportOption& option : make_report_options(options)) {
    EXPECT_FALSE(option.changed) << option.name;
  }
  options.segment.theta_n_in = 9;
  int changed = 0;
  for (const ReportOption& option : make_report_options(options)) {
    EXPECT_EQ(option.changed, option.name == "theta_n_in") << option.name;
    changed += option.changed;
  }
  EXPECT_EQ(changed, 1);
}

TEST(ReportFiles, AreWrittenCompletely) {
  const auto dir = temp_dir() / "report_files";
  std::filesystem::create_directories(dir);
  write_report_files(dir, make_report());
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(dir)) {
    EXPECT_NE(entry.path().extension(), ".part");
    ++files;
  }
  EXPECT_EQ(files, 4);
}

TEST(FrameRecord, AReportMadeOfRecordsEqualsTheOriginal) {
  const auto dir = temp_dir() / "frame_record";
  Report report = make_report(), again = report;
  report.recordings[0].frames[0].metrics = planes::Metrics{};
  report.recordings[0].frames[0].planes[0].color_id = 7;
  for (ReportFrame& frame : again.recordings[0].frames) {
    const auto place = dir / std::to_string(frame.index);
    std::filesystem::create_directories(place);
    write_frame_record(place, report.recordings[0].frames[static_cast<std::size_t>(frame.index)],
                       true, "key");
    frame = read_frame_record(place);
  }
  EXPECT_EQ(report_json(again), report_json(report));
  EXPECT_EQ(frames_csv(again), frames_csv(report));
  EXPECT_EQ(again.recordings[0].frames[0].planes[0].color_id, 7);
}

TEST(FrameRecord, IsFoundOnlyByItsKey) {
  const auto dir = temp_dir() / "frame_record_key";
  std::filesystem::create_directories(dir);
  EXPECT_FALSE(find_frame_record(dir / "nowhere", "a"));
  write_frame_record(dir, numbered_frame(3), true, "a");
  EXPECT_FALSE(find_frame_record(dir, "b"));
  ASSERT_TRUE(find_frame_record(dir, "a"));
  EXPECT_EQ(find_frame_record(dir, "a")->index, 3);
  write_file_text(dir / "frame.json",
                  "{\"schema\": \"planescope.report-frame/3\", \"key\": \"a\"}");
  try {
    find_frame_record(dir, "a");
    FAIL() << "a damaged record was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), (dir / "frame.json").string() + ": the file has no \"frame\"");
  }
}

TEST(ReportHead, IsTheReportWithoutFrames) {
  Report report = make_report();
  report.weights = make_weights_record();
  report.shard = "2/3";
  report.recordings[0].info.intrinsics.distortion = Distortion::brown_conrady;
  report.recordings[0].info.intrinsics.coefficients[1] = 0.125;
  const auto file = temp_dir() / "head.json";
  write_file_text(file, report_json(report));
  ReportHead head = read_report_head(file);
  ASSERT_EQ(head.frames.size(), 2u);
  EXPECT_EQ(head.frames[1], (std::pair<std::size_t, int>(0, 1)));
  head.report.recordings[0].frames = report.recordings[0].frames;
  EXPECT_EQ(report_json(head.report), report_json(report));
}

/// A report compared with itself, with one more plane.
Report make_report_with_result() {
  const auto file = temp_dir() / "judged.json";
  Report report = make_report();
  write_file_text(file, report_json(report));
  ReportFrame& frame = report.recordings[0].frames[0];
  frame.planes.push_back(frame.planes[0]);
  frame.planes[1].summary.id = 2;
  frame.regions.runs = {{-1, 1}, {1, 3}, {2, 2}};
  report.judgement = ReportGuard(file, "").judge(report);
  return report;
}

TEST(Judgement, IsInTheReportWorstFirst) {
  const Report report = make_report_with_result();
  const Json json = Json::parse(report_json(report));
  EXPECT_EQ(schema_error(schema(), json), "");
  EXPECT_EQ(json["verdict"]["errors"], 1);
  EXPECT_EQ(json["verdict"]["breaches"][0]["metric"], "planes_gained");
  EXPECT_EQ(json["verdict"]["breaches"][0]["frame"], 0);
  EXPECT_TRUE(has(report.judgement->text(),
                  "error  a<b>.bag frame 0: 1 plane is not in the "
                  "baseline; the rule planes_gained allows none"));
}

TEST(Junit, ListsFramesThatBreakRulesAndFailedFrames) {
  Report report = make_report_with_result();
  const std::string xml = junit_xml(report);
  EXPECT_TRUE(has(xml, "tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"1\""));
  EXPECT_TRUE(has(xml,
                  "<failure message=\"1 plane is not in the baseline; the rule planes_gained "
                  "allows none\""));
  EXPECT_TRUE(has(xml, "frames/000000/pictures/planes.png"));
  EXPECT_TRUE(has(xml, "<skipped message=\"gravity is not known, give --gravity\""))
      << "as in the baseline";
  for (ReportFrame& frame : report.recordings[0].frames) frame.unreadable = !frame.refused.empty();
  EXPECT_TRUE(has(junit_xml(report), "<error message=\"gravity is not known, give --gravity\""));
}

/// The additional plane is undecided.
Report make_noted_report() {
  Report report = make_report_with_result();
  PlaneSummary& plane = report.recordings[0].frames[0].planes[1].summary;
  plane.undecided = true;
  plane.margin = 0.04;
  report.recordings[0].frames[0].planes_undecided = 1;
  report.judgement = ReportGuard(temp_dir() / "judged.json", "").judge(report);
  return report;
}

TEST(Judgement, NotesChangesOfUndecidedPlanesWithoutAnError) {
  const Report report = make_noted_report();
  EXPECT_EQ(report.judgement->errors(), 0);
  EXPECT_EQ(report.judgement->warnings(), 0);
  const std::string text = report.judgement->text();
  EXPECT_TRUE(has(text,
                  "note   a<b>.bag frame 0: 1 plane is not in the baseline; the rule "
                  "planes_gained allows none: note only"));
  EXPECT_TRUE(has(text, "0 errors, 0 warnings, 1 note against "));
  const Json json = Json::parse(report_json(report));
  EXPECT_EQ(schema_error(schema(), json), "");
  EXPECT_TRUE(json["verdict"]["breaches"].empty());
  EXPECT_EQ(json["verdict"]["notes"][0]["metric"], "planes_gained");
  EXPECT_EQ(json["totals"]["planes_undecided"], 1);
}

TEST(Junit, ContainsNotesWithoutAFailure) {
  const std::string xml = junit_xml(make_noted_report());
  EXPECT_TRUE(has(xml, "failures=\"0\""));
  EXPECT_TRUE(has(xml, "<system-out>note: frame 0: 1 plane is not in the baseline"));
  EXPECT_FALSE(has(junit_xml(make_report_with_result()), "<system-out>"));
}

TEST(FramesCsv, CountsUndecidedPlanes) {
  const std::string csv = frames_csv(make_noted_report());
  EXPECT_TRUE(has(csv, ",planes_undecided\n"));
  EXPECT_TRUE(has(csv, ",1\n"));
}

TEST(Thumbnail, ShrinksToTheMeanAndNeverEnlarges) {
  Image8 image(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = x < 2 ? 0 : 200;
  const Image8 small = shrink(image, 1);
  ASSERT_EQ(small.width, 1);
  EXPECT_EQ(small.at(0, 0, 1), 100);
  EXPECT_EQ(shrink(image, 100).width, 4);
}

TEST(Thumbnail, Base64FollowsItsStandard) {
  const auto encode = [](const std::string& text) { return base64({text.begin(), text.end()}); };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace planescope::report
