#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/image/png.hpp"
#include "core/recording/cloud_file.hpp"
#include "support/json_schema.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

namespace {

std::vector<std::string> report_args(const std::vector<std::filesystem::path>& inputs,
                                     const std::filesystem::path& out,
                                     const std::vector<std::string>& more) {
  std::vector<std::string> args{"report"};
  for (const auto& input : inputs) args.push_back(input.string());
  args.insert(args.end(), {"-o", out.string()});
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

// report.json, after it was held against its schema.
Json read_report(const std::filesystem::path& out) {
  const Json json = Json::parse(read_text(out / "report.json"));
  std::ifstream schema(PLANESCOPE_SOURCE_DIR "/assets/schemas/report.schema.json");
  EXPECT_EQ(schema_error(Json::parse(schema), json), "");
  return json;
}

// A variable of the environment while this object lives.
struct Environment {
  explicit Environment(const char* variable, const char* value) : name(variable) {
    setenv(name, value, 1);
  }
  ~Environment() { unsetenv(name); }
  const char* name;
};

}  // namespace

TEST(Report, SeveralInputsGiveOnePageWithAPictureOfEveryStage) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  write_ply(dir / "cloud.ply", floor_and_wall_cloud());
  const Ran ran =
      run(report_args({dir / "rec", dir / "cloud.ply"}, dir / "out", {"--max-range", "1.4"}));
  ASSERT_EQ(ran.code, 0) << ran.err;
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
      const auto info = png_info(dir / "out" / picture["file"].get<std::string>());
      EXPECT_EQ(info.width, picture["width"]);
      EXPECT_EQ(info.channels, 3);
    }
  }
  EXPECT_FALSE(report["recordings"][1]["frames"][0]["metrics"].is_null())
      << "the cloud carries its truth";
  const std::string page = read_text(dir / "out" / "index.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
}

TEST(Report, LabelledFramesShowWhereLabelsAndResultDiffer) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  FrameLabels labels = floor_and_wall_labels(*open_recording(dir / "rec"));
  for (int i = 0; i < 160 * 30; ++i) labels.plane.data[i] = labels.hv.data[i] = 0;
  write_frame_labels(dir / "rec.labels", 0, labels);
  ASSERT_EQ(run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"})).code, 0);
  const Json frames = read_report(dir / "out")["recordings"][0]["frames"];
  const auto truth_of = [](const Json& frame) {
    for (const Json& picture : frame["pictures"])
      if (picture["name"] == "truth") return picture;
    return Json();
  };
  const Json picture = truth_of(frames[0]);
  ASSERT_FALSE(picture.is_null());
  EXPECT_NE(read_text(dir / "out/index.html").find("where they differ: invented 25"),
            std::string::npos);
  const auto info = png_info(dir / "out" / picture["file"].get<std::string>());
  EXPECT_GT(info.width, 3 * info.height / 2) << "three pictures in a row";
  EXPECT_TRUE(truth_of(frames[1]).is_null()) << "the second frame has no labels";
}

TEST(Report, PixelsAndFiguresAreTheSameForAnyNumberOfThreads) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  Json first;
  for (const char* threads : {"1", "2", "8"}) {
    ASSERT_EQ(
        run(report_args({dir / "rec"}, dir / threads, {"--gravity", "0,1,0", "--threads", threads}))
            .code,
        0);
    const Json recordings = read_report(dir / threads)["recordings"];
    if (first.is_null()) first = recordings;
    EXPECT_EQ(recordings, first) << threads;  // with the hashes of all pixels
  }
}

TEST(Report, AnInterruptedRunLeavesAValidPartialReport) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 60);
  const Ran ran = run_and_signal(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"}),
                                 SIGINT, dir / "out");
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
  EXPECT_NE(read_text(dir / "out" / "index.html").find("This report is partial"),
            std::string::npos);
  for (const std::string& file : files_below(dir / "out"))
    EXPECT_EQ(file.find(".partial"), std::string::npos) << file;
}

TEST(Report, AFrameWithoutGravityIsToldAndTheOthersGoOn) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  write_png(dir / "rec" / "depth" / "000001.png", Image16(160, 120));  // nothing was measured
  const Ran ran = run(report_args({dir / "rec"}, dir / "out", {}));
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json frames = read_report(dir / "out")["recordings"][0]["frames"];
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0]["status"], "done");
  EXPECT_EQ(frames[0]["gravity"]["source"], "estimate");
  EXPECT_EQ(frames[1]["status"], "refused");
  EXPECT_NE(frames[1]["message"].get<std::string>().find("gravity"), std::string::npos);
  EXPECT_EQ(frames[2]["status"], "done");
}

TEST(Report, WhereEveryFrameIsRefusedNothingIsWritten) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", Image16(160, 120));
  const Ran ran = run(report_args({dir / "rec"}, dir / "out", {}));
  EXPECT_EQ(ran.code, 2);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST(Report, AFrameWithNothingInItStillGivesAReport) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", Image16(160, 120));
  const Ran ran = run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"}));
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(read_report(dir / "out")["totals"]["planes"], 0);
}

TEST(Report, ADamagedFrameIsFoundBeforeAnythingIsWritten) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  std::filesystem::resize_file(dir / "rec" / "depth" / "000002.png", 200);
  const Ran ran = run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0"}));
  EXPECT_EQ(ran.code, 2);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_NE(ran.err.find("000002.png"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST(Report, WithoutARendererTheDataAreWrittenAndTheExitCodeIs3) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
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

TEST(Report, LeavesOtherFilesOfAFrameAlone) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const std::string out = (dir / "out").string();
  ASSERT_EQ(run({"segment", (dir / "rec").string(), "-o", out, "--gravity", "0,1,0"}).code, 0);
  ASSERT_EQ(run(report_args({dir / "rec"}, out, {"--gravity", "0,1,0"})).code, 0);
  EXPECT_TRUE(std::filesystem::exists(dir / "out" / "frames" / "000000" / "planes.json"));
  EXPECT_TRUE(
      std::filesystem::exists(dir / "out" / "frames" / "000000" / "pictures" / "planes.png"));
}

TEST(Report, TheRecordHoldsTheCommandAndWhatWasChanged) {
  const auto dir = scratch();
  write_depth_folder(dir / "my rec", floor_and_wall());
  const Ran ran = run(report_args({dir / "my rec"}, dir / "out",
                                  {"--gravity", "0,1,0", "--set", "theta_n_in=7", "--json"}));
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(Json::parse(ran.out)["frames_done"], 1);
  const Json record = read_report(dir / "out")["record"];
  EXPECT_NE(record["command"].get<std::string>().find("my rec' -o"), std::string::npos)
      << record["command"];
  EXPECT_EQ(record["classifier"], "gcn");
  EXPECT_EQ(record["weights"]["file"], "classifier.safetensors");
  for (const Json& option : record["options"]) {
    if (option["name"] == "theta_n_in") {
      EXPECT_EQ(option["value"], "7");
      EXPECT_EQ(option["changed"], true);
    }
  }
}

TEST(Report, OfARivalShowsItsPlanesAndNoStepsThatItHasNot) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const Ran ran =
      run(report_args({dir / "rec"}, dir / "out", {"--gravity", "0,1,0", "--method", "ransac"}));
  ASSERT_EQ(ran.code, 0) << ran.err;
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
  EXPECT_NE(page.find("<dt>Method</dt><dd>ransac</dd>"), std::string::npos);
  EXPECT_EQ(page.find("Octree nodes by case"), std::string::npos);
}
