// Commands with unknown gravity and with picked gravity.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/report_run.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "support/needs_open3d.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

Json planes_json(const fs::path& out) {
  return Json::parse(read_text(out / "frames/000000/planes.json"));
}

/// Stores gravity like a click on the floor of frame 0: for all frames, or only for that frame.
void pick(const fs::path& recording, const Vec3d& down, bool all = true) {
  const auto opened = io::open_recording(recording);
  const io::PickedDirection direction{
      down, {}, 0, opened->frame_hash(0), "picked: a floor (1.00 m2)"};
  io::PickedGravity picked;
  if (all)
    picked.recording = direction;
  else
    picked.frames[0] = direction;
  io::write_picked_gravity(labels::default_label_dir(recording), picked);
}

}  // namespace

TEST(GravityNone, SegmentFindsThePlanesAndReportsWhatIsMissing) {
  const auto dir = scratch_with_rec();
  const Ran ran = well(run({"segment", dir / "rec", "-o", dir / "out", "--gravity", "none"}));
  EXPECT_TRUE(has(ran.out, "gravity none: planes are neither h nor v"));
  for (const char* way : {"--gravity X,Y,Z", "planescope view"}) EXPECT_TRUE(has(ran.err, way));
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;

  const Json json = planes_json(dir / "out");
  EXPECT_EQ(json["gravity"]["source"], "none");
  EXPECT_TRUE(json["gravity"]["direction"].is_null()) << "no reader may take it for a direction";
  EXPECT_EQ(json["T_world_camera"][0], (Json{0, 0, 1, 0})) << "x looks ahead";
  EXPECT_EQ(json["T_world_camera"][2], (Json{0, -1, 0, 0})) << "z points to the image's top";
  EXPECT_FALSE(json["options"].contains("classifier")) << "none ran";
  ASSERT_EQ(json["planes"].size(), 2u);
  for (const Json& plane : json["planes"]) {
    EXPECT_EQ(plane["label"], "unknown");
    EXPECT_LT(plane["offset_m"].get<double>(), 0) << "normals face the camera";
  }
  const PointSet cloud = io::read_cloud_file(dir / "out/frames/000000/cloud.ply");
  EXPECT_EQ(std::ranges::count(cloud.label, 0), static_cast<std::ptrdiff_t>(cloud.label.size()));
  EXPECT_GT(std::ranges::count(cloud.instance, 2), 100);
}

TEST(GravityNone, WorksForCloudsAndRivals) {
  PLANESCOPE_NEEDS_OPEN3D();
  const auto dir = scratch();
  io::write_ply(dir / "cloud.ply", floor_and_wall_cloud());
  for (const char* method : {"ours", "ransac"}) {
    const auto out = dir / method;
    well(run({"segment", dir / "cloud.ply", "-o", out, "--gravity", "none", "--method", method}));
    const Json json = planes_json(out);
    ASSERT_EQ(json["planes"].size(), 2u) << method;
    for (const Json& plane : json["planes"]) EXPECT_EQ(plane["label"], "unknown") << method;
    EXPECT_EQ(json["T_world_camera"][2], (Json{0, 0, 1, 0})) << "the file's own axes";
  }
}

TEST(GravityNone, RescuesARejectedFrame) {
  const auto dir = scratch();
  Image16 depth(160, 120);
  depth.data[100] = 900;  // almost nothing was measured
  write_depth_folder(dir / "rec", depth);
  const std::vector<std::string> args = {"segment", dir / "rec", "-o", dir / "out"};
  const Ran refused = run(args);
  expect_refused(refused);
  EXPECT_TRUE(has(refused.err, "--gravity none"));
  std::vector<std::string> without = args;
  without.insert(without.end(), {"--gravity", "none"});
  well(run(without));
  EXPECT_EQ(planes_json(dir / "out")["planes"].size(), 0u);
}

TEST(GravityNone, AReportFollowsItsSchemaAndHasNoPictureOfClasses) {
  const auto dir = scratch_with_rec();
  write_true_labels(dir / "rec", dir / "rec.labels");
  well(run(report_args({dir / "rec"}, dir / "out", {"--gravity", "none"})));
  const Json report = read_report(dir / "out");
  EXPECT_TRUE(report["record"]["classifier"].is_null());
  EXPECT_TRUE(report["record"]["weights"].is_null());
  const Json& frame = report["recordings"][0]["frames"][0];
  EXPECT_EQ(frame["planes"].size(), 2u);
  EXPECT_GT(frame["metrics"]["mean_iou"].get<double>(), 90);
  EXPECT_TRUE(frame["metrics"]["label_accuracy_inner"].is_null());
  for (const Json& picture : frame["pictures"]) {
    EXPECT_NE(picture["name"], "labels");
    EXPECT_NE(picture["name"], "margins");
  }
  const std::string page = read_text(dir / "out/index.html");
  EXPECT_TRUE(has(page, "<em>unknown</em>"));
  EXPECT_TRUE(has(page, "--gravity X,Y,Z"));

  // The same again, resumed after its end and compared with itself.
  std::filesystem::copy(dir / "out/report.json", dir / "before.json");
  const std::vector<std::string> held = {"--gravity", "none", "--resume", "--baseline",
                                         dir / "before.json"};
  well(run(report_args({dir / "rec"}, dir / "out", held)));
}

TEST(GravityNone, EvalScoresPlanesButNotLabels) {
  const auto dir = scratch_with_rec();
  write_true_labels(dir / "rec", dir / "rec.labels");
  const Ran ran = well(run({"eval", dir / "rec", "--gravity", "none", "--json"}));
  const Json json = Json::parse(ran.out);
  EXPECT_GT(json["mean"]["mean_iou"].get<double>(), 90);
  EXPECT_TRUE(json["mean"]["label_accuracy_edge"].is_null());
  const Ran table = run({"eval", dir / "rec", "--gravity", "none"});
  EXPECT_FALSE(has(table.out, "nan"));
}

TEST(GravityNone, InfoExplainsHowToSetIt) {
  const auto dir = scratch_with_rec();
  const Ran text = well(run({"info", dir / "rec", "--gravity", "none"}));
  EXPECT_TRUE(has(text.out, "none, "));
  EXPECT_TRUE(has(text.out, "--gravity X,Y,Z"));
  const Ran json = run({"info", dir / "rec", "--gravity", "none", "--json"});
  const Json gravity = Json::parse(json.out)["recordings"][0]["gravity"];
  EXPECT_EQ(gravity["source"], "none");
  EXPECT_TRUE(gravity["direction"].is_null());
}

TEST(GravityNone, ImportedAndExportedLabelsHaveNoClass) {
  const auto dir = scratch_with_rec();
  write_true_labels(dir / "rec", dir / "true");
  const std::string rec = (dir / "rec").string();
  well(run(
      {"labels", "export", rec, "--labels", dir / "true", "--format", "evops", "-o", dir / "npy"}));
  well(run(
      {"labels", "import", rec, "--format", "evops", "--from", dir / "npy", "--gravity", "none"}));
  const auto labels = labels::read_frame_labels(dir / "rec.labels", 0, "");
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels->gravity.source, GravitySource::none);
  ASSERT_EQ(labels->planes.size(), 2u);
  for (const LabelPlane& plane : labels->planes) EXPECT_EQ(plane.label, Label::unknown);
  well(run({"labels", "export", rec, "--format", "ply", "-o", dir / "ply"}));
  const PointSet cloud = io::read_cloud_file(dir / "ply/000000.ply");
  EXPECT_EQ(std::ranges::count(cloud.label, 0), static_cast<std::ptrdiff_t>(cloud.label.size()));
  well(run({"labels", "check", rec, "--strict"}));
}

TEST(GravityNone, ClassDependentRequestsAreRejectedInOneLine) {
  const auto dir = scratch_with_rec();
  const std::string rec = (dir / "rec").string(), out = (dir / "out").string();
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"segment", rec, "-o", out, "--classifier", "pca"},
        std::vector<std::string>{"train", rec, "--recipe", "recordings", "-o",
                                 dir / "w.safetensors"},
        std::vector<std::string>{"planescope-lab", "bench", "classifier", rec, "-o", out}}) {
    std::vector<std::string> none = args;
    none.insert(none.end(), {"--gravity", "none"});
    const Ran ran = run(none);
    expect_refused(ran);
    EXPECT_TRUE(has(ran.err, "--gravity none"));
  }
}

TEST(GravityPicked, IsUsedByEveryCommand) {
  const auto dir = scratch_with_rec(2);
  const std::string rec = (dir / "rec").string();
  pick(dir / "rec", Vec3d(0, 0.8, 0.6));
  const Ran info = run({"info", rec, "--json"});
  EXPECT_EQ(Json::parse(info.out)["recordings"][0]["gravity"]["source"], "picked") << info.err;
  well(run({"segment", rec, "-o", dir / "out"}));
  const Json gravity = planes_json(dir / "out")["gravity"];
  EXPECT_EQ(gravity["source"], "picked");
  EXPECT_EQ(gravity["direction"], (Json{0, 0.8, 0.6}));
  EXPECT_EQ(gravity["note"], "picked: a floor (1.00 m2)");
  well(run(report_args({dir / "rec"}, dir / "report", {"--no-pictures"})));
  const Json report = read_report(dir / "report");
  for (const Json& frame : report["recordings"][0]["frames"])
    EXPECT_EQ(frame["gravity"]["source"], "picked");

  // The command line overrides it.
  well(run({"segment", rec, "-o", dir / "given", "--gravity", "0,1,0"}));
  EXPECT_EQ(planes_json(dir / "given")["gravity"]["source"], "option");
  well(run({"segment", rec, "-o", dir / "est", "--gravity", "estimate"}));
  EXPECT_EQ(planes_json(dir / "est")["gravity"]["source"], "estimate");
  write_text(dir / "rec/gravity.json", R"({"gravity": [0, 1, 0]})");
  well(run({"segment", rec, "-o", dir / "sidecar"}));
  EXPECT_EQ(planes_json(dir / "sidecar")["gravity"]["source"], "sidecar");
}

TEST(GravityPicked, OnOneFrameIsTransferredToTheOthersByCameraMotion) {
  const auto dir = scratch_with_rec(2);
  pick(dir / "rec", Vec3d(0, 0.8, 0.6), false);
  well(run({"segment", dir / "rec", "-o", dir / "out"}));
  EXPECT_EQ(planes_json(dir / "out")["gravity"]["source"], "picked");
  const Json second = Json::parse(read_text(dir / "out/frames/000001/planes.json"))["gravity"];
  EXPECT_EQ(second["source"], "carried");
  EXPECT_EQ(
      second["note"],
      "carried from frame 0, where it was picked: a floor (1.00 m2), by odometry over 1 frame");
  EXPECT_NEAR(second["direction"][1].get<double>(), 0.8, 1e-3);
  well(run({"segment", dir / "rec", "-o", dir / "alone", "--frames", "1"}));
  EXPECT_EQ(Json::parse(read_text(dir / "alone/frames/000001/planes.json"))["gravity"], second)
      << "whatever frames are asked for";
}

TEST(GravityPicked, AResumedReportNoticesAChangedPick) {
  const auto dir = scratch_with_rec();
  pick(dir / "rec", Vec3d(0, 0.8, 0.6));
  const auto args = report_args({dir / "rec"}, dir / "out", {"--no-pictures", "--resume"});
  well(run(args));
  pick(dir / "rec", Vec3d(0, 1, 0));
  well(run(args));
  EXPECT_EQ(read_report(dir / "out")["recordings"][0]["frames"][0]["gravity"]["direction"],
            (Json{0, 1, 0}));
}

TEST(GravityPicked, ADamagedOrForeignFileIsRejectedInOneLine) {
  const auto dir = scratch_with_rec();
  Image16 other = floor_and_wall();
  other.data[5] = 1111;
  write_depth_folder(dir / "other", other);
  pick(dir / "rec", Vec3d(0, 1, 0));
  const Ran mixed = run({"info", dir / "other", "--labels", dir / "rec.labels"});
  expect_refused(mixed);
  EXPECT_TRUE(has(mixed.err, "a different recording"));
  write_text(dir / "rec.labels/gravity.json", "{\"schema\": 3}");
  const Ran damaged = run({"segment", dir / "rec", "-o", dir / "out"});
  expect_refused(damaged);
  EXPECT_TRUE(has(damaged.err, "gravity.json"));
  // With a direction on the command line, the file is not needed.
  well(run({"segment", dir / "rec", "--gravity", "0,1,0", "-o", dir / "out"}));
}
