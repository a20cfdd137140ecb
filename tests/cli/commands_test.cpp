// Tests of info, eval, sample and synth through the command line.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "support/needs_open3d.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

TEST(Info, ADepthFolderIsDescribed) {
  const auto dir = scratch_with_rec(3);
  const Ran ran = well(run({"info", "--json", dir / "rec", "--gravity", "0,2,0"}));
  const Json info = Json::parse(ran.out)["recordings"][0];
  EXPECT_EQ(info["frames"], 3);
  EXPECT_EQ(info["depth"]["width"], 160);
  EXPECT_EQ(info["depth"]["height"], 120);
  EXPECT_EQ(info["depth"]["unit_m"], 0.001);
  EXPECT_EQ(info["intrinsics"]["fx"], 120);
  EXPECT_EQ(info["color"], nullptr);
  EXPECT_EQ(info["gravity"]["direction"], Json::array({0.0, 1.0, 0.0}));
  EXPECT_EQ(info["gravity"]["source"], "option");
  EXPECT_EQ(info["first_frame"]["measured_percent"], 100);
  EXPECT_NEAR(info["first_frame"]["depth_m"]["max"].get<double>(), 1.2, 1e-9);

  const Ran text = well(run({"info", dir / "rec"}));
  EXPECT_TRUE(has(text.out, "1 unit = 1 mm"));
  EXPECT_TRUE(has(text.out, "160x120"));
}

TEST(Info, TheCommandLineOverridesTheFiles) {
  const auto dir = scratch_with_rec();
  const Ran ran = well(run({"info", "--json", dir / "rec", "--depth-unit", "0.0002", "--intrinsics",
                            "100,101,79.5,59.5"}));
  const Json info = Json::parse(ran.out)["recordings"][0];
  EXPECT_EQ(info["depth"]["unit_m"], 0.0002);
  EXPECT_EQ(info["intrinsics"]["fy"], 101);
  EXPECT_EQ(info["intrinsics"]["cx"], 79.5);
}

TEST(Info, ShowsAllItCanWithoutIntrinsics) {
  const auto dir = scratch_with_rec(2);
  for (const auto& file : std::filesystem::directory_iterator(dir / "rec"))
    if (file.is_regular_file()) std::filesystem::remove(file);  // the intrinsics
  const Ran ran = well(run({"info", "--json", dir / "rec"}));
  const Json info = Json::parse(ran.out)["recordings"][0];
  EXPECT_EQ(info["frames"], 2);
  EXPECT_EQ(info["depth"]["width"], 160);
  EXPECT_EQ(info["intrinsics"], nullptr);
  EXPECT_EQ(info["gravity"], nullptr);
  const Ran text = run({"info", dir / "rec"});
  EXPECT_TRUE(has(text.out, "them with --intrinsics"));
  EXPECT_EQ(run({"segment", dir / "rec", "-o", dir / "out"}).code, 2);
}

TEST(Info, WarnsIfGravityContradictsTheScene) {
  const auto dir = scratch_with_rec();
  const std::string rec = (dir / "rec").string();
  EXPECT_EQ(run({"info", rec, "--gravity", "0,1,0.1"}).err, "");
  const Ran ran = well(run({"info", rec, "--gravity", "0.6,0.8,0"}));
  EXPECT_TRUE(has(ran.err, "disagrees with the scene by 37\u00b0"));
}

TEST(Eval, TrueLabelsBesideARecordingAreFound) {
  const auto dir = scratch();
  const Image16 depth = floor_and_wall();
  write_depth_folder(dir / "rec", depth, 2);
  write_true_labels(dir / "rec", dir / "rec.labels");
  for (const char* classifier : {"gcn", "pca", "truth"}) {
    const Ran ran = well(run({"eval", "--json", dir / "rec", "--gravity", "0,1,0", "--classifier",
                              classifier, "--frames", "0"}));
    const Json json = Json::parse(ran.out);
    ASSERT_EQ(json["frames"].size(), 1u);
    EXPECT_EQ(json["mean"]["planes_truth"], 2);
    EXPECT_EQ(json["mean"]["planes_found"], 2);
    EXPECT_LT(json["mean"]["alpha_deg"].get<double>(), 0.2);
    EXPECT_GT(json["mean"]["point_accuracy"].get<double>(), 98);
  }
  const Ran both = run({"eval", "--json", dir / "rec", "--gravity", "0,1,0"});
  EXPECT_EQ(Json::parse(both.out)["frames_without_truth"], 1);
  const Ran table = run({"eval", dir / "rec", "--gravity", "0,1,0"});
  EXPECT_TRUE(has(table.out, "alpha"));
  EXPECT_TRUE(has(table.out, "mean"));
}

TEST(Eval, ARivalIsScoredLikeOurs) {
  PLANESCOPE_NEEDS_OPEN3D();
  const auto dir = scratch_with_rec();
  write_true_labels(dir / "rec", dir / "rec.labels");
  const Ran ran =
      well(run({"eval", "--json", dir / "rec", "--gravity", "0,1,0", "--method", "ransac"}));
  const Json json = Json::parse(ran.out);
  EXPECT_EQ(json["method"], "ransac");
  EXPECT_EQ(json["mean"]["planes_truth"], 2);
  EXPECT_EQ(json["mean"]["planes_found"], 2);
  EXPECT_GT(json["mean"]["mean_iou"].get<double>(), 90);
}

TEST(Eval, WithoutTruthReportsTheSearchedFolders) {
  const auto dir = scratch_with_rec();
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--classifier", "truth"}}) {
    std::vector<std::string> args = {"eval", dir / "rec", "--gravity", "0,1,0"};
    args.insert(args.end(), more.begin(), more.end());
    expect_refused(run(args), "rec.labels");
  }
}

TEST(SynthStairs, TheSetIsReproducibleAndScoresItself) {
  const auto dir = scratch();
  for (const char* name : {"a", "b"})
    well(run({"planescope-lab", "synth", "stairs", "-o", dir / name, "--count", "3", "--points",
              "2048", "--noise", "0.001", "--threads", name[0] == 'a' ? "1" : "3"}));
  ASSERT_EQ(files_below(dir / "a"),
            (std::vector<std::string>{"stairs_000.ply", "stairs_001.ply", "stairs_002.ply"}));
  for (const std::string& file : files_below(dir / "a"))
    EXPECT_TRUE(read_text(dir / "a" / file) == read_text(dir / "b" / file)) << file;
  const PointSet stairs = io::read_cloud_file(dir / "a/stairs_000.ply");
  EXPECT_EQ(stairs.points.size(), 2048u);
  EXPECT_EQ(stairs.label.size(), 2048u);
  EXPECT_EQ(stairs.instance.size(), 2048u);

  // Clouds contain their truth.
  const Ran eval = well(run({"eval", "--json", "--classifier", "truth", "--voxel", "0",
                             dir / "a/stairs_000.ply", dir / "a/stairs_001.ply"}));
  const Json json = Json::parse(eval.out);
  EXPECT_EQ(json["frames"].size(), 2u);
  EXPECT_EQ(json["mean"]["r_p"], 100);
  EXPECT_EQ(json["mean"]["label_accuracy_edge"], 100);
}

TEST(InstanceField, IsReadByNameInsteadOfInstance) {
  const auto dir = scratch();
  std::ofstream file(dir / "tops.pcd");
  file << "VERSION 0.7\nFIELDS x y z segment half\nSIZE 4 4 4 4 4\nTYPE F F F F F\n"
          "COUNT 1 1 1 1 1\nWIDTH 3200\nHEIGHT 1\nPOINTS 3200\nDATA ascii\n";
  for (int i = 0; i < 1600; ++i)
    for (const double z : {0.0, 0.3})
      file << 0.02 * (i % 40) << ' ' << 0.02 * (i / 40) << ' ' << z << ' ' << (z > 0 ? 2 : 1)
           << " 0.5\n";
  file.close();
  const auto eval = [&](const std::string& field) {
    return run(
        {"eval", "--json", "--classifier", "pca", "--instance-field", field, dir / "tops.pcd"});
  };
  const Ran ran = well(eval("segment"));
  EXPECT_EQ(Json::parse(ran.out)["mean"]["planes_truth"], 2);
  EXPECT_GT(Json::parse(ran.out)["mean"]["mean_iou"].get<double>(), 99);
  EXPECT_TRUE(Json::parse(ran.out)["mean"]["label_accuracy_edge"].is_null()) << "it has no h and v";
  const Ran by_truth =
      run({"eval", "--classifier", "truth", "--instance-field", "segment", dir / "tops.pcd"});
  EXPECT_EQ(by_truth.code, 2);
  EXPECT_TRUE(has(by_truth.err, "requires ground truth labels"));
  for (const auto& [field, problem] : {std::pair{"nothing", "points have no 'nothing' field"},
                                       {"half", "field 'half' contains 0.5"}}) {
    expect_refused(eval(field), problem);
  }
}

// The truth is from others (SynPEB: Schaefer et al. 2019).
TEST(InstanceField, ASimulatedLaserScanKeepsItsAccuracy) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Ran ran =
      well(run({"eval", "--json", "--instance-field", "intensity", "--gravity", "0,0,-1", "--voxel",
                "0", std::filesystem::path(data) / "NOT_REAL_synpeb_ppe/test_500.pcd"}));
  const Json mean = Json::parse(ran.out)["mean"];
  EXPECT_GE(mean["mean_iou"].get<double>(), 94);
  EXPECT_GE(mean["pq"].get<double>(), 89);
  EXPECT_GE(mean["detected_iou80"], 37);
}

TEST(SynthSet, DepthIsWrittenWithItsTruthAndGravity) {
  const auto dir = scratch();
  const std::string rec = (dir / "rec").string();
  well(run({"planescope-lab", "synth", "set", "depth_stairs", "-o", rec, "--count", "2", "--errors",
            "noise", "--seed", "3"}));
  const Json sidecar = Json::parse(read_text(dir / "rec/planescope.json"));
  EXPECT_EQ(sidecar["made_by"], "planescope-lab synth set depth_stairs --errors noise");
  EXPECT_EQ(sidecar["seed"], 3);
  EXPECT_EQ(sidecar["frames"][1]["scene"], "depth_stairs_001");

  const Ran info = well(run({"info", "--json", rec}));
  const Json facts = Json::parse(info.out)["recordings"][0];
  EXPECT_EQ(facts["gravity"]["source"], "sidecar");
  EXPECT_EQ(facts["labels"]["frames"], 2);
  const Ran eval = well(run({"eval", "--json", "--classifier", "truth", rec}));
  EXPECT_GT(Json::parse(eval.out)["mean"]["point_accuracy"].get<double>(), 80);
}

TEST(SynthSet, StairsHaveTruthAndAreFoundBySegment) {
  const auto dir = scratch();
  const std::string rec = (dir / "rec").string();
  well(run({"planescope-lab", "synth", "set", "depth_descent", "-o", rec, "--count", "1"}));
  const Json truth = Json::parse(read_text(dir / "rec.stairs.json"));
  EXPECT_EQ(truth["schema"], "planescope.true_stairs/1");
  const Json& stairs = truth["frames"][0];
  EXPECT_EQ(stairs["direction"], "down");
  const int seen = stairs["seen"];
  ASSERT_GE(seen, 2);

  const Ran ran = well(run({"segment", rec, "-o", dir / "out"}));
  EXPECT_TRUE(has(ran.out, "\n  1 flight: " + std::to_string(seen) + " steps down, rise "));
  const Json json = Json::parse(read_text(dir / "out/frames/000000/planes.json"));
  ASSERT_EQ(json["flights"].size(), 1u);
  const Json& flight = json["flights"][0];
  EXPECT_EQ(flight["direction"], "down");
  EXPECT_EQ(flight["count"], seen);
  EXPECT_NEAR(flight["rise_m"].get<double>(), stairs["rise_m"].get<double>(), 0.005);
  EXPECT_NEAR(flight["going_m"].get<double>(), stairs["going_m"].get<double>(), 0.015);
  const auto height_of = [&](const Json& planes) {
    return json["planes"][planes[0].get<int>() - 1]["height_m"].get<double>();
  };
  EXPECT_NEAR(height_of(flight["steps"][seen - 1]["tread"]) - height_of(flight["foot"]),
              seen * stairs["rise_m"].get<double>(), 0.01);
}

TEST(SynthTraining, CloudsOfEveryKindAreReproducible) {
  const auto dir = scratch();
  for (const char* name : {"a", "b"})
    well(run({"planescope-lab", "synth", "training", "-o", dir / name, "--count", "1", "--seed",
              "7", "--threads", name[0] == 'a' ? "1" : "3"}));
  ASSERT_EQ(files_below(dir / "a"),
            (std::vector<std::string>{"box_000.ply", "plane_000.ply", "scan_000.ply",
                                      "stairs_000.ply", "training.json"}));
  for (const std::string& file : files_below(dir / "a"))
    EXPECT_TRUE(read_text(dir / "a" / file) == read_text(dir / "b" / file)) << file;

  const Json json = Json::parse(read_text(dir / "a/training.json"));
  EXPECT_EQ(json["schema"], "planescope.training_set/1");
  EXPECT_EQ(json["recipe"], "planescope");
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["options"]["scans"], 1);
  EXPECT_EQ(json["augmented"], nullptr);
  ASSERT_EQ(json["clouds"].size(), 4u);
  for (const Json& entry : json["clouds"]) {
    const PointSet cloud = io::read_cloud_file(dir / "a" / entry["file"].get<std::string>());
    EXPECT_EQ(cloud.points.size(), entry["points"]);
    EXPECT_EQ(std::count(cloud.label.begin(), cloud.label.end(), 1), entry["h"]);
    EXPECT_EQ(std::count(cloud.label.begin(), cloud.label.end(), 2), entry["v"]);
  }

  well(run({"report", dir / "a/stairs_000.ply", dir / "a/scan_000.ply", "-o", dir / "report"}));
}

TEST(SynthTraining, ThePapersRecipeHasNoScansAndCanBeAugmented) {
  const auto dir = scratch();
  well(run({"planescope-lab", "synth", "training", "-o", dir, "--recipe", "paper", "--count", "1",
            "--augmented"}));
  EXPECT_EQ(files_below(dir), (std::vector<std::string>{"box_000.ply", "plane_000.ply",
                                                        "stairs_000.ply", "training.json"}));
  const Json json = Json::parse(read_text(dir / "training.json"));
  EXPECT_EQ(json["augmented"]["objects"]["uniform_noise_m"], 0.01);
  EXPECT_EQ(io::read_cloud_file(dir / "stairs_000.ply").points.size(), 2048u);
}

TEST(SynthSample, EveryCommandReadsTheRecording) {
  const auto dir = scratch();
  const std::string rec = (dir / "rec").string();
  well(run({"synth", "sample", "-o", rec, "--scenes", "stairs,corner", "--size", "160x120",
            "--with-gravity"}));

  const Ran info = well(run({"info", "--json", rec}));
  const Json facts = Json::parse(info.out)["recordings"][0];
  EXPECT_EQ(facts["frames"], 2);
  EXPECT_EQ(facts["depth"]["width"], 160);
  EXPECT_EQ(facts["gravity"]["source"], "sidecar");
  EXPECT_EQ(facts["labels"]["frames"], 2);

  const Ran eval = well(run({"eval", "--json", "--classifier", "truth", rec}));
  EXPECT_GT(Json::parse(eval.out)["mean"]["point_accuracy"].get<double>(), 70);

  well(run({"segment", rec, "-o", dir / "out"}));
  EXPECT_EQ(files_below(dir / "out").size(), 8u);
}

TEST(Synth, ImpossibleSettingsAreRejected) {
  const auto dir = scratch();
  using Words = std::vector<std::string>;
  const Words stairs = {"planescope-lab", "synth", "stairs"}, sample = {"synth", "sample"};
  for (const auto& [command, bad] :
       std::vector<std::pair<Words, Words>>{{stairs, {"--count", "0"}},
                                            {stairs, {"--points", "-5"}},
                                            {stairs, {"--noise", "-0.1"}},
                                            {stairs, {"--seed", "x"}},
                                            {sample, {"--scenes", "castle"}},
                                            {sample, {"--size", "640"}},
                                            {sample, {"--size", "0x480"}},
                                            {sample, {"--size", "900000x900000"}}}) {
    Words args = command;
    args.insert(args.end(), {"-o", dir / "out"});
    args.insert(args.end(), bad.begin(), bad.end());
    expect_refused(run(args));
  }
  expect_refused(
      run({"planescope-lab", "synth", "training", "-o", dir / "out", "--recipe", "cookies"}),
      "one of planescope, real-camera, paper");
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST(Sample, CommandsWithoutARecordingUseTheSample) {
  const Ran info = well(run({"info", "--json"}));
  const Json facts = Json::parse(info.out)["recordings"][0];
  EXPECT_EQ(facts["frames"], 3);
  EXPECT_EQ(facts["labels"]["frames"], 3);
  EXPECT_TRUE(is_one_line(info.err)) << "it says which recording it took: " << info.err;

  const auto dir = scratch();
  well(run({"segment", "-o", dir / "out", "--frames", "0"}));
  EXPECT_EQ(files_below(dir / "out").size(), 4u);
}

TEST(Sample, GravityIsEstimatedWithinTwoDegreesOnEveryFrame) {
  const std::filesystem::path labels =
      std::filesystem::path(PLANESCOPE_SOURCE_DIR) / "assets/sample.labels";
  for (int i = 0; i < 3; ++i) {
    const Ran info = well(run({"info", "--json", "--frames", std::to_string(i)}));
    const Json gravity = Json::parse(info.out)["recordings"][0]["gravity"];
    EXPECT_EQ(gravity["source"], "estimate");
    const auto d = gravity["direction"].get<std::array<double, 3>>();
    const Vec3d truth = labels::read_frame_labels(labels, i, "")->gravity.direction;
    EXPECT_GT(Vec3d(d[0], d[1], d[2]).dot(truth), std::cos(2 * std::numbers::pi / 180)) << i;
  }
}
