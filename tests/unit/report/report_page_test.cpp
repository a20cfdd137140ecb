// Tests of the report page: content, links, escaping and overviews.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>

#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/data/report_json.hpp"
#include "core/report/page/pictures.hpp"
#include "support/empty_report.hpp"
#include "support/has.hpp"
#include "support/temp_dir.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHostile = "\"><script>alert(1)</script>";

ReportPicture make_picture(const std::string& name, int index) {
  ReportPicture picture;
  picture.name = name;
  picture.title = "Picture " + name;
  picture.alt = "What " + name + " shows.";
  picture.file = "frames/00000" + std::to_string(index) + "/pictures/" + name + ".png";
  picture.width = picture.height = 8;
  return picture;
}

/// Two planes, on the left and right half of the measured area.
ReportFrame make_frame(int index) {
  ReportFrame frame;
  frame.index = index;
  frame.name = "name" + std::to_string(index);
  frame.sha256 = std::string(64, 'a');
  frame.gravity = {Vec3d(0, 1, 0), GravitySource::estimate, 0.87, "floor and two walls"};
  frame.counts = {1000, 100, 5, 200, 1, 694};
  frame.points_on_planes = 600;
  frame.planes_h = 2;
  frame.planes = {level_plane(1, 1, "#0072b2"), level_plane(2, 2, "#d55e00")};
  for (ReportPlane& plane : frame.planes) plane.summary.points = 300;
  frame.regions = {8, 4, 2, {{1, 2}, {2, 2}, {1, 2}, {2, 2}}};
  for (const char* name : {"overlay", "cases"}) frame.pictures.push_back(make_picture(name, index));
  return frame;
}

Report make_report(int frames) {
  Report report = empty_report();
  ReportRecording recording;
  recording.info.path = "dir/a.bag";
  recording.info.width = 640;
  recording.info.height = 480;
  recording.name = "a.bag";
  recording.frame_count = recording.frames_asked = frames;
  for (int i = 0; i < frames; ++i) recording.frames.push_back(make_frame(i));
  report.recordings.push_back(recording);
  return report;
}

fs::path fresh_dir() {
  const fs::path dir = temp_dir() / testing::UnitTest::GetInstance()->current_test_info()->name();
  fs::remove_all(dir);
  fs::create_directories(dir);
  return dir;
}

/// Writes the image copies that a page embeds.
void write_copies(const fs::path& dir, const Report& report) {
  const std::vector<unsigned char> copy_bytes = io::encode_webp(Image8(8, 8, 3, 200), 80);
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      for (const ReportPicture& picture : frame.pictures)
        for (const std::string& copy : {copy_of(picture), thumbnail_of(picture)}) {
          fs::create_directories((dir / copy).parent_path());
          write_file_bytes(dir / copy, copy_bytes);
        }
}

std::string page_of(const Report& report, const fs::path& dir) {
  std::ostringstream out;
  write_report_page(out, report, dir);
  return out.str();
}
std::string page_of(const Report& report) {
  const fs::path dir = fresh_dir();
  write_copies(dir, report);
  return page_of(report, dir);
}

/// Compares with an earlier report, like --baseline.
void judge(Report& report, const Report& baseline) {
  const fs::path file = temp_dir() / "page_baseline.json";
  write_file_text(file, report_json(baseline));
  report.judgement = ReportGuard(file, "").judge(report);
}

/// A report in which frame 1 of three has lost its second plane.
Report make_failing_report() {
  Report report = make_report(3);
  ReportFrame& frame = report.recordings[0].frames[1];
  frame.planes.pop_back();
  frame.regions.runs = {{1, 2}, {0, 2}, {1, 2}, {0, 2}};
  report.options[0].value += "9";
  judge(report, make_report(3));
  return report;
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST(ReportPage, IsSelfContained) {
  const std::string page = page_of(make_report(3));
  for (const char* reference : {"http://", "https://", "src=\"/", "src=\"frames", "url(",
                                "<script src", "<link rel=\"stylesheet", "@import"})
    EXPECT_FALSE(has(page, reference)) << reference;
  EXPECT_TRUE(has(page, "src=\"data:image/webp;base64,"));
  EXPECT_TRUE(has(page, "default-src 'none'"));
}

/// Returns the text between each `start` and the next quotation mark.
std::vector<std::string> values_after(const std::string& page, const std::string& start) {
  std::vector<std::string> values;
  for (std::size_t at = page.find(start); at != std::string::npos; at = page.find(start, at + 1)) {
    const std::size_t begin = at + start.size();
    values.push_back(page.substr(begin, page.find('"', begin) - begin));
  }
  return values;
}

TEST(ReportPage, EveryLinkHasATargetAndEveryIdIsUnique) {
  const std::string page = page_of(make_failing_report());
  std::set<std::string> ids;
  for (const std::string& id : values_after(page, " id=\""))
    EXPECT_TRUE(ids.insert(id).second) << id;
  const std::vector<std::string> links = values_after(page, "href=\"#");
  for (const std::string& link : links) EXPECT_TRUE(ids.contains(link)) << link;
  EXPECT_GT(links.size(), 10u);
}

TEST(ReportPage, LongPagesBeginWithLinksToFailedFramesAndSections) {
  Report report = make_report(13);
  ReportFrame& frame = report.recordings[0].frames[7];
  frame.planes.pop_back();
  frame.regions.runs = {{1, 2}, {0, 2}, {1, 2}, {0, 2}};
  judge(report, make_report(14));
  const std::string page = page_of(report);
  const std::string contents =
      page.substr(page.find("<nav"), page.find("</nav>") - page.find("<nav"));
  EXPECT_EQ(
      values_after(contents, "href=\"#"),
      (std::vector<std::string>{"missing1", "f007", "worst", "totals", "frames", "r1", "record"}));
  const std::vector<std::string> ids = values_after(page, " id=\"");
  for (const std::string& link : values_after(contents, "href=\"#"))
    EXPECT_EQ(std::ranges::count(ids, link), 1) << link;
  EXPECT_FALSE(has(page_of(make_report(12)), "<nav"));
}

TEST(ReportPage, HasOneFirstLevelHeadingAndLandmarks) {
  const std::string page = page_of(make_failing_report());
  EXPECT_EQ(count_of(page, "<h1"), 1u);
  EXPECT_EQ(count_of(page, "<main"), 1u);
  EXPECT_EQ(count_of(page, "<header"), 1u);
  EXPECT_EQ(count_of(page, "<footer"), 1u);
  EXPECT_TRUE(has(page, "<html lang=\"en\">"));
}

TEST(ReportPage, ReportsThatThereIsNoBaseline) {
  EXPECT_TRUE(has(page_of(make_report(1)), "Nothing to compare against"));
}

TEST(ReportPage, PassesIfNothingChanged) {
  Report report = make_report(3);
  judge(report, make_report(3));
  const std::string page = page_of(report);
  EXPECT_TRUE(has(page, "<h2 id=\"verdict-title\">Passed</h2>"));
  EXPECT_FALSE(has(page, "id=\"worst\""));
  EXPECT_TRUE(has(page, "Same as the baseline: 2 planes, none changed."));
}

TEST(ReportPage, MarksUndecidedPlanesAndNotesWhatTheyChange) {
  const Report before = make_report(1);
  const std::string decided = page_of(before);
  EXPECT_FALSE(has(decided, "class=\"undecided\""));
  EXPECT_FALSE(has(decided, "~ undecided"));
  Report now = make_report(1);
  ReportFrame& frame = now.recordings[0].frames[0];
  frame.planes[1].summary.offset_m += 0.02;
  frame.planes[1].summary.centroid.z() += 0.02;
  frame.planes[1].summary.undecided = true;
  frame.planes[1].summary.margin = 0.04;
  frame.planes_undecided = 1;
  judge(now, before);
  const std::string page = page_of(now);
  EXPECT_TRUE(has(page, "<tr id=\"f000/p2\" class=\"undecided\">"));
  EXPECT_TRUE(has(page, "<abbr title=\"undecided, margin 0.04\">~</abbr>"));
  EXPECT_FALSE(has(page, "<tr id=\"f000/p1\" class"));
  EXPECT_TRUE(has(page, "~ undecided: ")) << "the legend";
  EXPECT_TRUE(has(page, ">Passed<"));
  EXPECT_TRUE(has(page, "0 errors, 0 warnings, and 1 note on undecided planes"));
  EXPECT_TRUE(has(page, "<ul class=\"reasons notes\"><li>a plane moved by 20 mm"));
  EXPECT_TRUE(has(page, "<span class=\"fate\">moved</span> <small>undecided</small>"));
}

TEST(ReportPage, ShowsVerdictDifferencesWorstFrameAndFiguresInOrder) {
  const std::string page = page_of(make_failing_report());
  std::size_t before = 0;
  for (const char* part : {"<h2 id=\"verdict-title\">Failed</h2>", "1 error and 0 warnings",
                           "The setup differs from the baseline", "id=\"worst\"",
                           "1 plane of the baseline is gone; the rule planes_lost allows none",
                           "id=\"totals\"", "id=\"frames\""}) {
    const std::size_t at = page.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    EXPECT_GT(at, before) << part;
    before = at;
  }
}

TEST(ReportPage, ShowsTheCommandThatOpensALostPlane) {
  const std::string page = page_of(make_failing_report());
  EXPECT_TRUE(has(page, "planescope view --open report.json#f001/was2"));
  EXPECT_TRUE(has(page, "id=\"f001/was2\""));
  EXPECT_FALSE(has(page, "report.json#f001/p1"));  // the same plane
  EXPECT_FALSE(has(page, "report.json#f000"));     // a passed frame
}

TEST(ReportPage, AnchorsContainTheRecordingIfThereAreSeveral) {
  Report report = make_report(1);
  report.recordings.push_back(report.recordings[0]);
  const std::string page = page_of(report);
  EXPECT_TRUE(has(page, "id=\"r1/f000\""));
  EXPECT_TRUE(has(page, "id=\"r2/f000/p2\""));
}

TEST(ReportPage, ShowsBothSetsOfPlanesWithoutTheBaselinesPictures) {
  EXPECT_EQ(count_of(page_of(make_failing_report()), "class=\"compare\""), 1u);
}

TEST(ReportPage, ListsFramesThatOnlyTheBaselineHas) {
  Report report = make_report(2);
  judge(report, make_report(3));
  const std::string page = page_of(report);
  EXPECT_TRUE(has(page, "<span class=\"badge failed\">missing</span>"));
  EXPECT_TRUE(has(page, "id=\"missing1\""));
}

TEST(ReportPage, EmbedsFewFramesAndLinksThePicturesOfTheOthers) {
  const Report report = make_report(9);
  Report many = make_report(0);
  for (int i = 0; i < 40; ++i) {
    many.recordings[0].frames.push_back(
        report.recordings[0].frames[static_cast<std::size_t>(i % 9)]);
    many.recordings[0].frames.back().index = i;
    many.recordings[0].frames.back().points_on_planes = static_cast<std::uint64_t>(i);
  }
  const std::string page = page_of(many);
  EXPECT_EQ(count_of(page, "<figure id="), 2 * 12u);  // the worst frames are the first ones here
  EXPECT_EQ(count_of(page, "data-copy="), 2 * 28u);
  EXPECT_EQ(count_of(page, "<tr data-frame="), 40u);
}

TEST(ReportPage, LinksAPictureWhoseCopyIsMissing) {
  const Report report = make_report(1);
  const fs::path dir = fresh_dir();  // empty
  const std::string page = page_of(report, dir);
  EXPECT_FALSE(has(page, "src=\"data:image/webp"));
  EXPECT_TRUE(has(page, "<a href=\"frames/000000/pictures/overlay.png\""));
}

ReportPlane plane_with(int id, double height_m, double support, double clearance_m) {
  ReportPlane plane;
  plane.summary.id = id;
  plane.footing.emplace();
  plane.footing->height_m = height_m;
  plane.footing->support = support;
  plane.footing->clearance_m = clearance_m;
  return plane;
}

TEST(ReportPage, WithoutRulesAndLabelsSuspiciousFramesComeFirst) {
  Report report = make_report(5);
  for (ReportFrame& frame : report.recordings[0].frames) {
    frame.metrics.reset();
    frame.terrain.emplace().floor = 1;
    frame.counts.kept = frame.points_on_planes = 100;
    frame.planes = {plane_with(1, 0, 1, 0.5), plane_with(2, std::nan(""), 0.95, 0.2)};
  }
  report.recordings[0].frames[1].points_on_planes = 10;
  report.recordings[0].frames[2].planes.push_back(plane_with(3, 0.3, 1, 0.02));
  report.recordings[0].frames[4].planes.push_back(plane_with(3, 0.01, 0.5, 0.2));
  const fs::path dir = fresh_dir();
  const std::string page = page_of(report, dir);
  const auto at = [&](const char* text) { return page.find(text); };
  const std::size_t first = at("the floor in 2 pieces, 1 plane with low support; 100.0 % of");
  const std::size_t second = at("1 sliver; 100.0 % of"), third = at("<li>10.0 % of the points");
  EXPECT_LT(first, second);
  EXPECT_LT(second, third);
  EXPECT_NE(third, std::string::npos);
}

TEST(ReportPage, AnUnreadableCopyIsAnError) {
  const Report report = make_report(1);
  const fs::path dir = fresh_dir();
  write_copies(dir, report);
  const fs::path copy = dir / copy_of(report.recordings[0].frames[0].pictures[0]);
  fs::remove(copy);
  fs::create_directory(copy);
  EXPECT_THROW(page_of(report, dir), Error);
}

TEST(ReportPage, TextFromInputsIsEscaped) {
  Report report = make_failing_report();
  ReportRecording& recording = report.recordings[0];
  recording.name = recording.info.device = recording.info.format = kHostile;
  recording.info.path = std::string("dir/") + kHostile;
  recording.info.warnings = {kHostile};
  report.command = report.renderer = report.renderer_error = report.commit = kHostile;
  report.options[0].value = kHostile;
  report.case_colors[1] = "red;background:url(//evil)";
  ReportFrame& frame = recording.frames[0];
  frame.name = frame.gravity.note = frame.sha256 = kHostile;
  frame.planes[0].color = "\"><b>";
  frame.pictures[0].title = frame.pictures[0].alt = kHostile;
  frame.pictures[0].file = std::string("javascript:alert(1)/") + kHostile;
  recording.frames[2].refused = kHostile;
  const std::string page = page_of(report, fresh_dir());
  EXPECT_EQ(count_of(page, "<script"), 1u);
  EXPECT_FALSE(has(page, "\"><b>"));
  EXPECT_FALSE(has(page, "url("));
  EXPECT_FALSE(has(page, "javascript:"));
  EXPECT_TRUE(has(page, "href=\"javascript%3Aalert%281%29/%22%3E%3Cscript%3E"));
  EXPECT_TRUE(has(page, "&lt;script&gt;alert(1)&lt;/script&gt;"));
}

TEST(ReportPage, InvalidUtf8IsReplaced) {
  Report report = make_report(1);
  report.recordings[0].name = "a\xff\xc3";
  report.recordings[0].frames[0].name = "ok \xc3\xa4 \xed\xa0\x80";
  const std::string page = page_of(report);
  EXPECT_TRUE(has(page, "<h1>a\uFFFD\uFFFD</h1>"));
  EXPECT_TRUE(has(page, "ok \u00e4 \uFFFD\uFFFD\uFFFD"));
}

TEST(ReportPage, LeavesNoTemplateTagUnfilled) {
  Report report = make_failing_report();
  report.recordings[0].frames[0].metrics = planes::Metrics{};
  report.recordings[0].info.warnings = {"a warning"};
  EXPECT_FALSE(has(page_of(report), "{{"));
}

TEST(ReportPage, DrawsASequenceBesideItsBaseline) {
  const std::string page = page_of(make_failing_report());
  EXPECT_TRUE(has(page, "aria-label=\"Planes by frame\""));
  EXPECT_TRUE(has(page, ">baseline</text>"));
  EXPECT_FALSE(has(page_of(make_report(2)), "Frame by frame"));
}

TEST(ReportPage, RecordsTheRulesAndTheCommand) {
  const std::string page = page_of(make_failing_report());
  EXPECT_TRUE(has(page, "planescope report a.bag -o DIR"));
  EXPECT_TRUE(has(page, "<span class=\"badge failed\">1 time</span>"));
}

TEST(ReportOverviews, AreWrittenForSequences) {
  const fs::path dir = fresh_dir();
  Report report = make_report(3);
  write_copies(dir, report);
  write_overviews(dir, report);
  EXPECT_EQ(io::png_info(dir / "overview.png").width, 8);
  EXPECT_TRUE(has(page_of(report, dir), "<a class=\"overview\" href=\"overview.png\">"));

  const fs::path other = dir / "one";
  report.recordings[0].frames.resize(1);
  write_copies(other, report);
  write_overviews(other, report);
  EXPECT_FALSE(fs::exists(other / "overview.png"));
}

TEST(ReportOverviews, SkipADamagedFrame) {
  const fs::path dir = fresh_dir();
  const Report report = make_report(3);
  write_copies(dir, report);
  write_file_text(dir / copy_of(report.recordings[0].frames[1].pictures[0]), "no WebP");
  write_overviews(dir, report);
  EXPECT_EQ(io::png_info(dir / "overview.png").height, 8);
}

TEST(PlaneMap, KeepsColorsAndMarksLostAndGainedPlanes) {
  const auto become = [](PlaneFate fate, int baseline, int now) {
    PlaneComparison plane;
    plane.fate = fate;
    plane.baseline = baseline;
    plane.now = now;
    return plane;
  };
  const PlaneComparison lost = become(PlaneFate::lost, 1, 0), same = become(PlaneFate::same, 2, 1);
  const PlaneComparison gained = become(PlaneFate::gained, 0, 2);
  const ComparedInks inks = compared_inks({lost, same, gained}, 2, {"#0072b2", "#d55e00"});
  EXPECT_EQ(inks.baseline[1].color, "#0072b2");
  EXPECT_FALSE(inks.baseline[1].marked);
  EXPECT_TRUE(inks.baseline[0].marked);
  EXPECT_FALSE(inks.now[0].marked);
  EXPECT_TRUE(inks.now[1].marked);
}

TEST(PlaneMap, IsEmptyForUnmeasuredAreasAndForClouds) {
  const Image8 map = draw_plane_map({8, 2, 2, {{-1, 1}, {1, 1}, {0, 2}}}, {{"#0072b2", false}});
  ASSERT_EQ(map.channels, 4);
  EXPECT_EQ(map.at(0, 0, 3), 0);
  EXPECT_EQ(map.at(map.width * 3 / 4, map.height / 4, 2), 0xb2);
  EXPECT_TRUE(draw_plane_map({1, 5, 1, {{1, 5}}}, {{"#0072b2", false}}).empty());
}

}  // namespace
}  // namespace planescope::report
