// Tests of planescope report: output files, failures, resumed runs and shards.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/report_run.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "support/needs_open3d.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

namespace {

/// The file that marks the first finished frame while the report is written.
std::filesystem::path first_record(const std::filesystem::path& out) {
  return out / ".report-work" / "frames" / "000000" / "report" / "frame.json";
}

/// Compares all files of two reports, except for times.
void expect_same_but_for_times(const std::filesystem::path& a, const std::filesystem::path& b) {
  EXPECT_EQ(files_below(a), files_below(b));
  for (const std::string& file : files_below(a)) {
    if (file.ends_with("timings.json") || file == "index.html" || file == "junit.xml") continue;
    if (file != "report.json") {
      EXPECT_EQ(read_text(a / file), read_text(b / file)) << file;
      continue;
    }
    Json left = Json::parse(read_text(a / file)), right = Json::parse(read_text(b / file));
    for (Json* json : {&left, &right}) {
      json->erase("created_utc");
      json->erase("timings");
    }
    EXPECT_EQ(left, right);
  }
}

}  // namespace

TEST(Report, SeveralInputsGiveOnePageWithAPictureOfEveryStage) {
  const auto dir = scratch_with_rec();
  io::write_ply(dir / "cloud.ply", floor_and_wall_cloud());
  well(run(report_args({dir / "rec", dir / "cloud.ply"}, dir / "out", {"--max-range", "1.4"})));
  const Json report = read_report(dir / "out");
  EXPECT_EQ(report["partial"], false);
  EXPECT_FALSE(report["record"]["renderer"].is_null());
  ASSERT_EQ(report["recordings"].size(), 2u);
  EXPECT_TRUE(report["recordings"][0]["sha256"].is_null()) << "a folder's frames have their own";
  EXPECT_EQ(report["recordings"][1]["sha256"].get<std::string>().size(), 64u);
  for (const Json& recording : report["recordings"]) {
    const Json& frame = recording["frames"][0];
    EXPECT_EQ(frame["planes"].size(), 2u);
    const bool has_truth = recording["name"] == "cloud.ply";
    EXPECT_EQ(frame["pictures"].size(), has_truth ? 8u : 7u);
    for (const Json& picture : frame["pictures"]) {
      const auto info = io::png_info(dir / "out" / picture["file"].get<std::string>());
      EXPECT_EQ(info.width, picture["width"]);
      EXPECT_EQ(info.channels, 3);
    }
  }
  EXPECT_FALSE(report["recordings"][1]["frames"][0]["metrics"].is_null())
      << "the cloud carries its truth";
  const std::string page = read_text(dir / "out" / "index.html");
  EXPECT_TRUE(has(page, "</html>"));
}

TEST(Report, LabeledFramesShowDifferencesFromTheLabels) {
  const auto dir = scratch_with_rec(2);
  FrameLabels labels = floor_and_wall_labels(*io::open_recording(dir / "rec"));
  for (int i = 0; i < 160 * 30; ++i) labels.plane.data[i] = labels.hv.data[i] = 0;
  labels::write_frame_labels(dir / "rec.labels", 0, labels);
  well(run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"})));
  const Json frames = read_report(dir / "out")["recordings"][0]["frames"];
  const auto truth_of = [](const Json& frame) {
    for (const Json& picture : frame["pictures"])
      if (picture["name"] == "truth") return picture;
    return Json();
  };
  const Json picture = truth_of(frames[0]);
  ASSERT_FALSE(picture.is_null());
  EXPECT_TRUE(has(read_text(dir / "out/index.html"), "where they differ: invented 25"));
  const auto info = io::png_info(dir / "out" / picture["file"].get<std::string>());
  EXPECT_GT(info.width, 3 * info.height / 2) << "three pictures in a row";
  EXPECT_TRUE(truth_of(frames[1]).is_null()) << "the second frame has no labels";
}

TEST(Report, PixelsAndFiguresAreTheSameForAnyNumberOfThreads) {
  const auto dir = scratch();
  // Planes appear and disappear, so that colors depend on earlier frames.
  write_depth_folder(dir / "rec", floor_and_wall(), 6);
  for (const char* name : {"000001.png", "000004.png"}) {
    Image16 floor_alone = floor_and_wall();
    for (std::uint16_t& depth : floor_alone.data) depth = depth > 1000 ? 0 : depth;
    io::write_png(dir / "rec" / "depth" / name, floor_alone);
  }
  Json first;
  for (const char* threads : {"1", "2", "8"}) {
    well(run(
        report_args({dir / "rec"}, dir / threads, {"--gravity", "0,1,0", "--threads", threads})));
    const Json recordings = read_report(dir / threads)["recordings"];
    if (first.is_null()) first = recordings;
    EXPECT_EQ(recordings, first) << threads;  // includes hashes of all pixels
  }
}

TEST(Report, AnInterruptedRunLeavesAValidPartialReport) {
  const auto dir = scratch_with_rec(60);
  const Ran ran = run_and_signal(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"}),
                                 SIGINT, first_record(dir / "out"));
  EXPECT_EQ(ran.code, 130);
  const Json report = read_report(dir / "out");
  EXPECT_EQ(report["partial"], true);
  const Json& recording = report["recordings"][0];
  EXPECT_EQ(recording["frames_asked"], 60);
  EXPECT_GE(recording["frames"].size(), 1u);
  EXPECT_LT(recording["frames"].size(), 60u);
  for (const Json& frame : recording["frames"])
    for (const Json& picture : frame["pictures"])
      EXPECT_TRUE(std::filesystem::exists(dir / "out" / picture["file"].get<std::string>()));
  EXPECT_TRUE(has(read_text(dir / "out" / "index.html"), "This report is partial"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out" / ".report-work"));
}

TEST(Report, AFrameWithoutDepthIsReportedAndSkipped) {
  const auto dir = scratch_with_rec(3);
  io::write_png(dir / "rec" / "depth" / "000001.png", Image16(160, 120));  // nothing was measured
  well(run(report_args({dir / "rec"}, dir / "out", {})));
  const Json frames = read_report(dir / "out")["recordings"][0]["frames"];
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0]["status"], "done");
  EXPECT_EQ(frames[0]["gravity"]["source"], "estimate");
  EXPECT_EQ(frames[1]["status"], "refused");
  EXPECT_TRUE(has(frames[1]["message"].get<std::string>(), "contains no depth"));
  EXPECT_EQ(frames[2]["status"], "done");
}

TEST(Report, NothingIsWrittenIfEveryFrameFails) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", Image16(160, 120));
  expect_refused(run(report_args({dir / "rec"}, dir / "out", {})));
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST(Report, AnEmptyFrameStillGivesAReport) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", Image16(160, 120));
  well(run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"})));
  EXPECT_EQ(read_report(dir / "out")["totals"]["planes"], 0);
}

TEST(Report, ADamagedFrameIsReportedAndSkipped) {
  const auto dir = scratch_with_rec(3);
  std::filesystem::resize_file(dir / "rec" / "depth" / "000001.png", 200);
  expect_refused(run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"})),
                 "000001.png");
  const Json frames = read_report(dir / "out")["recordings"][0]["frames"];
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0]["status"], "done");
  EXPECT_EQ(frames[1]["status"], "unreadable");
  EXPECT_EQ(frames[2]["status"], "done");
  EXPECT_TRUE(has(read_text(dir / "out" / "junit.xml"), "<error message="));
}

TEST(Report, WithoutARendererDataIsWrittenAndTheExitCodeIs3) {
  const auto dir = scratch_with_rec();
  const Environment no_driver("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent");
  const Ran ran = run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"}));
  EXPECT_EQ(ran.code, 3);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  const Json report = read_report(dir / "out");
  EXPECT_TRUE(report["record"]["renderer"].is_null());
  EXPECT_TRUE(report["record"]["renderer_error"].is_string());
  EXPECT_EQ(report["recordings"][0]["frames"][0]["planes"].size(), 2u);
  EXPECT_EQ(report["recordings"][0]["frames"][0]["pictures"].size(), 2u) << "overlay and depth";
}

TEST(Report, FramesThatAreNoLongerSelectedAreRemoved) {
  const auto dir = scratch_with_rec(3);
  const auto out = dir / "out";
  well(run(report_args({dir / "rec"}, out, {"--no-pictures"})));
  write_text(out / "frames" / "000001" / "mine.txt", "mine");
  well(run(report_args({dir / "rec"}, out, {"--no-pictures", "--frames", "0"})));
  EXPECT_TRUE(std::filesystem::exists(out / "frames" / "000000" / "report"));
  EXPECT_FALSE(std::filesystem::exists(out / "frames" / "000001" / "report"));
  EXPECT_EQ(read_text(out / "frames" / "000001" / "mine.txt"), "mine");
  EXPECT_FALSE(std::filesystem::exists(out / "frames" / "000002"));
}

TEST(Report, OtherReportsInItsFolderAreKept) {
  const auto dir = scratch_with_rec(2);
  const auto out = dir / "out";
  for (const std::string name : {"old", "01-old", "s/1", "s/2"}) {
    std::vector<std::string> more{"--no-pictures"};
    if (name.starts_with("s/")) more.insert(more.end(), {"--shard", name.substr(2) + "/2"});
    well(run(report_args({dir / "rec"}, out / name, more)));
  }
  std::filesystem::create_directory_symlink(".", out / "02-here");
  const auto before = files_below(out);
  well(run({"report", "merge", out / "s/1", out / "s/2", "-o", out / "s"}));
  well(run(report_args({dir / "rec"}, out, {"--no-pictures"})));
  const auto after = files_below(out);
  for (const std::string& file : before) EXPECT_EQ(std::ranges::count(after, file), 1) << file;
  EXPECT_TRUE(std::filesystem::exists(out / "frames/000001/report/frame.json"));
}

TEST(Report, WithoutPicturesSaysSoAndMakesNoFolderForThem) {
  const auto dir = scratch_with_rec();
  const Ran ran = well(run(report_args({dir / "rec"}, dir / "out", {"--no-pictures", "--json"})));
  EXPECT_EQ(Json::parse(ran.out)["rendered"], false);
  EXPECT_FALSE(std::filesystem::exists(dir / "out" / "frames" / "000000" / "pictures"));
  const Ran again =
      run(report_args({dir / "rec"}, dir / "out", {"--no-pictures", "--resume", "--json"}));
  EXPECT_TRUE(has(again.err, "1 of 1 frames were already finished"));
}

TEST(Report, PicturesThatGlFailsToDrawAreOmitted) {
  const auto dir = scratch_with_rec(3);
  const Environment fails("LD_PRELOAD", PLANESCOPE_GL_FAILS_LATE);
  if (run({"--version"}).code != 0) GTEST_SKIP() << "nothing can be preloaded in this build";
  const Ran ran =
      run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0", "--threads", "1"}));
  EXPECT_EQ(ran.code, 3);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  const Json report = read_report(dir / "out");
  EXPECT_TRUE(report["record"]["renderer_error"].is_string());
  const Json& frames = report["recordings"][0]["frames"];
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_GT(frames[0]["pictures"].size(), 2u);
  EXPECT_EQ(frames[2]["pictures"].size(), 2u) << "overlay and depth";
  EXPECT_EQ(frames[2]["planes"].size(), 2u);
}

TEST(Report, ResumingAfterADamagedFrameGivesTheColorsOfACompleteRun) {
  const auto dir = scratch_with_rec(2);
  // The wall comes first, without the floor: in the second frame it keeps its color.
  Image16 wall_alone = floor_and_wall();
  for (std::uint16_t& depth : wall_alone.data) depth = depth < 1200 ? 0 : depth;
  const auto first = dir / "rec" / "depth" / "000000.png";
  io::write_png(first, wall_alone);
  const std::vector<std::string> options = {"--gravity", "0,1,0", "--no-pictures", "--resume"};
  well(run(report_args({dir / "rec"}, dir / "whole", options)));
  const std::string png = read_text(first);
  write_text(first, png.substr(0, png.size() / 2));
  EXPECT_EQ(run(report_args({dir / "rec"}, dir / "out", options)).code, 2);
  write_text(first, png);
  well(run(report_args({dir / "rec"}, dir / "out", options)));
  EXPECT_EQ(read_report(dir / "out")["recordings"], read_report(dir / "whole")["recordings"]);
}

TEST(Report, AFullDiskIsReportedInOneLineAndTheNextRunResumes) {
  const auto dir = scratch_with_rec(2);
  const auto args = report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0", "--resume"});
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{20'000, before.rlim_max};  // enough for figures, too small for pictures
  const auto ignored = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const Ran full = run(args);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, ignored);
  expect_refused(full);
  EXPECT_FALSE(std::filesystem::exists(dir / "out" / "report.json"));
  well(run(args));
  EXPECT_EQ(read_report(dir / "out")["recordings"][0]["frames"].size(), 2u);
}

TEST(Report, ResumesAKilledRun) {
  const auto dir = scratch_with_rec(12);
  const auto args = [&](const char* out) {
    return report_args({dir / "rec"}, dir / out, {"--gravity", "0,1,0", "--resume"});
  };
  auto slow = args("out");
  slow.insert(slow.end(), {"--threads", "1"});
  const Ran killed = run_and_signal(slow, SIGKILL, first_record(dir / "out"));
  EXPECT_EQ(killed.code, 128 + SIGKILL);
  const auto written = std::filesystem::last_write_time(first_record(dir / "out"));
  well(run(args("out")));
  const auto record = dir / "out" / "frames" / "000000" / "report" / "frame.json";
  EXPECT_EQ(std::filesystem::last_write_time(record), written) << "it was made again";
  well(run(args("whole")));
  expect_same_but_for_times(dir / "out", dir / "whole");

  // Another input with the same name is a different frame.
  io::write_png(dir / "rec" / "depth" / "000000.png", Image16(160, 120, 1, 900));
  well(run(args("out")));
  EXPECT_NE(read_report(dir / "out")["recordings"][0]["frames"][0]["sha256"],
            read_report(dir / "whole")["recordings"][0]["frames"][0]["sha256"]);
}

TEST(Report, DoesNotOverwriteItsBaseline) {
  const auto dir = scratch_with_rec();
  const auto args =
      report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0", "--no-pictures"});
  well(run(args));
  auto against = args;
  against.insert(against.end(), {"--baseline", dir / "out" / "report.json"});
  expect_refused(run(against));
}

TEST(Report, RecordingsWithTheSameNameAreDistinguished) {
  const auto dir = scratch();
  write_depth_folder(dir / "a" / "depths", floor_and_wall());
  write_depth_folder(dir / "b" / "depths", floor_and_wall());
  well(run(report_args({dir / "a/depths", dir / "b/depths/."}, dir / "out",
                       {"--gravity", "0,1,0", "--no-pictures"})));
  const Json recordings = read_report(dir / "out")["recordings"];
  EXPECT_EQ(recordings[0]["name"], "a-depths");
  EXPECT_EQ(recordings[1]["name"], "b-depths");
}

TEST(Report, ShardsJoinToTheReportOfOneRun) {
  const auto dir = scratch();
  write_depth_folder(dir / "a", floor_and_wall(), 4);
  write_depth_folder(dir / "b", floor_and_wall(), 3);
  const std::vector<std::filesystem::path> inputs{dir / "a", dir / "b"};
  well(run(report_args(inputs, dir / "whole", {"--gravity", "0,1,0"})));
  std::vector<std::string> merge{"report", "merge", "-o", dir / "joined"};
  for (const char* shard : {"3", "1", "2"}) {
    const std::string of = std::string(shard) + "/3";
    well(run(report_args(inputs, dir / shard, {"--gravity", "0,1,0", "--shard", of})));
    merge.push_back((dir / shard).string());
  }
  well(run(merge));
  read_report(dir / "joined");
  expect_same_but_for_times(dir / "whole", dir / "joined");

  merge.pop_back();
  const Ran missing = run(merge);
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(has(missing.err, "shard 2/3 is missing"));
  well(run(report_args(inputs, dir / "2",
                       {"--gravity", "0,1,0", "--shard", "2/3", "--set", "theta_n_in=7"})));
  merge.push_back((dir / "2").string());
  expect_refused(run(merge), "belongs to a different report");
}

TEST(Report, NamesFromInputsAreEscapedEverywhere) {
  const auto dir = scratch();
  const std::string name = "\"><script>alert(1)<\\..&\xff%2e%2e";
  write_depth_folder(dir / name, floor_and_wall(), 1);
  write_depth_folder(dir / "b", floor_and_wall(), 1);
  well(run(report_args({dir / name, dir / "b"}, dir / "out", {"--gravity", "0,1,0"})));
  for (const char* file : {"index.html", "junit.xml"})
    EXPECT_FALSE(has(read_text(dir / "out" / file), "<script>alert")) << file;
  read_report(dir / "out");
  for (const std::string& file : files_below(dir)) {
    const bool expected =
        file.starts_with("out/") || file.starts_with("b/") || file.starts_with(name);
    EXPECT_TRUE(expected) << file;
  }
}

TEST(Report, TheReportContainsTheCommandAndChangedOptions) {
  const auto dir = scratch();
  write_depth_folder(dir / "my rec", floor_and_wall());
  const Ran ran = well(run(report_args({dir / "my rec"}, dir / "out",
                                       {"--gravity", "0,1,0", "--set", "theta_n_in=7", "--json"})));
  EXPECT_EQ(Json::parse(ran.out)["frames_done"], 1);
  const Json record = read_report(dir / "out")["record"];
  EXPECT_EQ(
      record["command"].get<std::string>(),
      "planescope report '" + (dir / "my rec").string() + "' --gravity 0,1,0 --set theta_n_in=7");
  EXPECT_EQ(record["classifier"], "gcn");
  EXPECT_EQ(record["weights"]["file"], "classifier.safetensors");
  for (const Json& option : record["options"]) {
    if (option["name"] == "theta_n_in") {
      EXPECT_EQ(option["value"], "7");
      EXPECT_EQ(option["changed"], true);
    }
  }
}

TEST(Report, OfARivalShowsItsPlanesWithoutOurSteps) {
  PLANESCOPE_NEEDS_OPEN3D();
  const auto dir = scratch_with_rec();
  well(run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0", "--method", "ransac"})));
  const Json report = read_report(dir / "out");
  EXPECT_EQ(report["record"]["method"], "ransac");
  EXPECT_TRUE(report["record"]["classifier"].is_null());
  EXPECT_TRUE(report["record"]["weights"].is_null());
  const Json& frame = report["recordings"][0]["frames"][0];
  EXPECT_EQ(frame["planes"].size(), 2u);
  EXPECT_TRUE(frame["nodes"].is_null());
  EXPECT_TRUE(frame["segmentation"].is_null());
  for (const Json& picture : frame["pictures"])
    EXPECT_TRUE(picture["name"] != "cases" && picture["name"] != "labels" &&
                picture["name"] != "margins")
        << picture["name"];
  const std::string page = read_text(dir / "out/index.html");
  EXPECT_TRUE(has(page, "<dt>Method</dt><dd>ransac</dd>"));
  EXPECT_FALSE(has(page, "Octree nodes by case"));
}
