// Tests of planescope labels: check, import, export, compare and stats.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/labels/store/store.hpp"
#include "support/label_drafts.hpp"
#include "support/small_clouds.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

Ran labels_of(const std::string& command, std::vector<std::string> args) {
  args.insert(args.begin(), {"labels", command});
  return run(args);
}

/// Three frames of a floor and a wall; the first two are labeled.
class Labels : public testing::Test {
 protected:
  void SetUp() override {
    write_depth_folder(rec, floor_and_wall(), 3);
    for (const int frame : {0, 1}) write_labels(rec.string() + ".labels", frame);
  }

  void write_labels(const fs::path& to, int frame) { write_true_labels(rec, to, frame); }
  /// Label files with all pixels in plane 5.
  fs::path five() {
    labels::LabeledPoints points;
    points.instance.assign(160 * 120, 5);
    labels::write_labeled(dir / "five", labels::LabelFormat::evops, points);
    return dir / "five.npy";
  }
  std::vector<std::uint16_t> planes_in(const fs::path& folder, int frame) {
    return labels::read_frame_labels(folder, frame, "")->plane.data;
  }

  const fs::path dir = scratch(), rec = dir / "rec", own = dir / "rec.labels";
};

}  // namespace

TEST_F(Labels, CheckFindsNothingInGoodLabels) {
  for (const fs::path& what : {rec, own}) {
    const Ran ran = well(labels_of("check", {what}));
    EXPECT_TRUE(has(ran.out, "2 labeled frames, 0 damaged, 0 findings"));
  }
}

TEST_F(Labels, CheckReportsFileFramePlaneValueAndLimit) {
  FrameLabels wrong = floor_and_wall_labels(*io::open_recording(rec), 1);
  wrong.planes[0].label = Label::v;
  labels::write_frame_labels(own, 1, wrong);
  const Ran ran = labels_of("check", {own});
  EXPECT_EQ(ran.code, 1);
  EXPECT_TRUE(has(ran.out,
                  "000001.json: frame 1: class_normal: P1: labeled v and tilted 0 degrees; "
                  "expected at least 60"));
  const Json json = Json::parse(labels_of("check", {own, "--json"}).out);
  EXPECT_EQ(json["findings"], 1);
  EXPECT_EQ(json["frames"][1]["findings"][0]["kind"], "class_normal");
  EXPECT_EQ(json["frames"][1]["findings"][0]["plane"], 1);
  EXPECT_EQ(json["frames"][1]["findings"][0]["limit"], 60);
}

TEST_F(Labels, CheckDistinguishesDamagedFilesFromFindings) {
  fs::resize_file(own / "000000.plane.png", 60);
  fs::remove(own / "000001.hv.png");
  write_labels(own, 2);
  fs::rename(own / "000002.json", own / "000007.json");
  const Ran ran = labels_of("check", {own});
  EXPECT_EQ(ran.code, 2);
  for (const char* part : {"000000.plane.png", "000001.hv.png", "000002.json",
                           "labels for frame 2; expected labels for frame 7", "4 damaged"})
    EXPECT_TRUE(has(ran.out, part)) << part << "\n" << ran.out;
}

TEST_F(Labels, CheckReportsADifferentCamera) {
  const Ran ran = labels_of("check", {own, "--intrinsics", "240,240,80,60"});
  EXPECT_EQ(ran.code, 1);
  EXPECT_TRUE(has(ran.out, "camera: drawn with fx 120, but the frame has 240"));
}

TEST_F(Labels, CheckAndExportUseTheLabelsCameraIfTheRecordingHasNone) {
  const fs::path known = dir / "known", unknown = dir / "unknown";
  well(labels_of("export", {rec, "--format", "ply", "-o", known}));
  fs::remove(rec / "camera_intrinsic.json");
  ASSERT_EQ(run({"eval", rec}).code, 2) << "the recording does not say it";
  const Ran ran = well(labels_of("check", {own}));
  EXPECT_TRUE(has(ran.out, "2 labeled frames, 0 damaged, 0 findings"));
  well(labels_of("export", {rec, "--format", "ply", "-o", unknown}));
  EXPECT_EQ(read_text(unknown / "000001.ply"), read_text(known / "000001.ply"));
}

TEST_F(Labels, CheckWithoutTheRecordingReportsSkippedChecks) {
  fs::rename(own, dir / "alone.labels");
  const Ran ran = well(labels_of("check", {dir / "alone.labels"}));
  EXPECT_TRUE(has(ran.out, "no recording found; use --recording"));
}

TEST_F(Labels, ExportedLabelsCanBeImported) {
  for (const char* format : {"evops", "ply", "pcd", "kitti", "npz", "coco"}) {
    SCOPED_TRACE(format);
    const std::string out = (dir / format).string(), back = out + ".labels";
    const Ran exported = well(labels_of("export", {rec, "--format", format, "-o", out}));
    EXPECT_TRUE(has(exported.out, "000001"));
    const Ran imported = well(labels_of("import", {rec, "--format", format, "--from", out,
                                                   "--labels", back, "--gravity", "0,1,0"}));
    EXPECT_TRUE(has(imported.out, "frame 1: "));
    for (const int frame : {0, 1}) {
      const auto before = labels::read_frame_labels(own, frame, ""),
                 after = labels::read_frame_labels(back, frame, "");
      ASSERT_TRUE(after);
      EXPECT_EQ(after->plane.data, before->plane.data);
      EXPECT_EQ(after->hv.data, before->hv.data);
      EXPECT_EQ(after->depth_sha256, before->depth_sha256);
    }
    EXPECT_FALSE(fs::exists(fs::path(back) / "000002.json"));
  }
  EXPECT_EQ(files_below(rec).size(), 4u);  // nothing was written to the recording
}

TEST_F(Labels, CocoIsOneFileWithAnImagePerFrame) {
  const fs::path out = dir / "coco";
  well(labels_of("export", {rec, "--format", "coco", "-o", out}));
  const Json coco = Json::parse(read_text(out / "annotations.json"));
  std::map<int, Json> images, annotations;
  std::set<int> categories;
  for (const Json& category : coco["categories"]) categories.insert(category["id"].get<int>());
  EXPECT_EQ(categories.size(), coco["categories"].size());
  for (const Json& image : coco["images"]) {
    images[image["id"]] = image;
    const io::PngInfo png = io::png_info(out / image["file_name"].get<std::string>());
    EXPECT_EQ(png.width, image["width"]);
    EXPECT_EQ(png.height, image["height"]);
  }
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[1]["file_name"], "images/000000.png");
  EXPECT_EQ(images[2]["file_name"], "images/000001.png");
  std::map<int, int> of_image;
  for (const Json& annotation : coco["annotations"]) {
    annotations[annotation["id"]] = annotation;
    ++of_image[annotation["image_id"].get<int>()];
    EXPECT_TRUE(categories.contains(annotation["category_id"].get<int>()));
    std::int64_t inside = 0, all = 0;
    bool is_inside = false;
    for (const Json& count : annotation["segmentation"]["counts"]) {
      all += count.get<std::int64_t>();
      if (is_inside) inside += count.get<std::int64_t>();
      is_inside = !is_inside;
    }
    const Json& image = images[annotation["image_id"]];
    EXPECT_EQ(all, image["width"].get<int>() * image["height"].get<int>());
    EXPECT_EQ(inside, annotation["area"]);
    EXPECT_EQ(annotation["iscrowd"], 0);
  }
  EXPECT_EQ(annotations.size(), coco["annotations"].size()) << "ids are unique";
  EXPECT_EQ(of_image, (std::map<int, int>{{1, 2}, {2, 2}}));
}

TEST_F(Labels, CocoIsReadFromOneFileOrFromAFilePerFrame) {
  const fs::path out = dir / "coco", old = dir / "old";
  well(labels_of("export", {rec, "--format", "coco", "-o", out}));
  // The format of earlier versions: 000000.json and 000001.json with one image each.
  const Json all = Json::parse(read_text(out / "annotations.json"));
  fs::create_directories(old);
  for (const int frame : {0, 1}) {
    Json one = all;
    one["images"] = Json::array({all["images"][frame]});
    one["images"][0]["id"] = 1;
    one["images"][0]["file_name"] = "00000" + std::to_string(frame) + ".png";
    one["annotations"] = Json::array();
    for (Json annotation : all["annotations"]) {
      if (annotation["image_id"] != frame + 1) continue;
      annotation["image_id"] = 1;
      one["annotations"].push_back(annotation);
    }
    write_text(old / ("00000" + std::to_string(frame) + ".json"), one.dump());
  }
  int number = 0;
  for (const fs::path& from : {out, out / "annotations.json", old}) {
    SCOPED_TRACE(from);
    const std::string back = (dir / ("back" + std::to_string(number++))).string();
    well(labels_of("import", {rec, "--format", "coco", "--from", from, "--labels", back,
                              "--gravity", "0,1,0"}));
    for (const int frame : {0, 1}) EXPECT_EQ(planes_in(back, frame), planes_in(own, frame));
  }
  const Ran scored = well(run({"eval", rec, "--frames", "0:2", "--json", "--prediction", out}));
  EXPECT_EQ(Json::parse(scored.out)["mean"]["mean_iou"], 100);
  expect_refused(labels_of("import", {rec, "--format", "coco", "--from", out, "--frames", "2",
                                      "--labels", dir / "none", "--gravity", "0,1,0"}),
                 "no image matches a frame; expected names such as 000002.png");
}

TEST_F(Labels, AnImportCanBeUndone) {
  const auto before = planes_in(own, 1);
  well(labels_of("import", {rec, "--from", five(), "--frames", "1", "--gravity", "0,1,0"}));
  EXPECT_EQ(planes_in(own, 1), std::vector<std::uint16_t>(160 * 120, 5));
  labels::LabelStore store(own);
  const auto recording = io::open_recording(rec);
  store.open(1, floor_and_wall_labels(*recording, 1));
  ASSERT_EQ(store.undo_frames(), std::vector{1});
  EXPECT_EQ(store.history(1).at(0).title, "Import five.npy");
  store.undo();
  EXPECT_EQ(store.labels(1)->plane.data, before);
}

TEST_F(Labels, InvalidFilesChangeNothing) {
  labels::LabeledPoints points;
  points.instance.assign(100, 5);
  fs::create_directories(dir / "in");
  labels::write_labeled(dir / "in/000001", labels::LabelFormat::evops, points);
  points.instance.assign(160 * 120, 5);
  labels::write_labeled(dir / "in/000000", labels::LabelFormat::evops, points);
  const auto import = [&](std::vector<std::string> args) {
    args.insert(args.begin(), {rec, "--gravity", "0,1,0", "--from"});
    return labels_of("import", args);
  };
  const std::string in = (dir / "in").string();
  expect_refused(import({in, "--format", "evops"}),
                 "000001.npy: labels for 100 points; expected 19200");
  expect_refused(import({in}), "--format");
  expect_refused(import({in, "--format", "evop"}), "expected one of evops");
  expect_refused(import({in, "--format", "npz"}), "expected names such as 000000.npz");
  expect_refused(import({in + "/000000.npy"}), "--frames N");
  expect_refused(import({in + "/nothing.npy"}), "nothing.npy: no such file");
  expect_refused(import({rec / "camera_intrinsic.json", "--frames", "0"}), "has no \"images\"");
  EXPECT_EQ(planes_in(own, 0), floor_and_wall_labels(*io::open_recording(rec)).plane.data);
  expect_refused(import({in + "/000000.npy", "--frames", "0", "--labels", rec / "l"}),
                 "in the recording");
  EXPECT_FALSE(fs::exists(own / "journal"));
}

TEST_F(Labels, NothingIsImportedWhileAnotherInstanceIsOpen) {
  labels::LabelStore held(own, {"ann", {}});
  const auto before = held.open(0, floor_and_wall_labels(*io::open_recording(rec)));
  FrameLabels after = *before;
  after.planes[0].locked = true;
  held.commit(labels::make_edit(0, "Lock P1", *before, after));
  expect_refused(
      labels_of("import", {rec, "--from", five(), "--frames", "0", "--gravity", "0,1,0"}),
      "read-only: held by ann");
}

TEST_F(Labels, ExportsStayOutOfTheRecordingAndOfTheLabels) {
  const auto export_to = [&](const fs::path& out, const std::string& frames = "0:") {
    return labels_of("export", {rec, "--format", "coco", "-o", out, "--frames", frames});
  };
  expect_refused(export_to(rec / "out"), "in the recording");
  expect_refused(export_to(own), "is the label folder itself");
  expect_refused(export_to(dir / "out", "2"), "no labels for the requested frames");
  expect_refused(labels_of("export", {rec, "--format", "coco"}), "-o DIR");
  EXPECT_FALSE(fs::exists(dir / "out"));
  well(labels_of("export", {rec, "--format", "voxels", "-o", dir / "out", "--voxel", "0.05"}));
  EXPECT_TRUE(fs::exists(dir / "out/000001.voxels.ply"));
}

TEST_F(Labels, PointFormatsConvertToEachOther) {
  well(labels_of("export", {rec, "--format", "npz", "-o", dir}));
  const auto convert = [&](const char* in, const char* out) {
    return labels_of("convert", {dir / in, "-o", dir / out});
  };
  for (const auto& [in, out] : {std::pair{"000000.npz", "a.ply"},
                                {"a.ply", "b.pcd"},
                                {"b.pcd", "c.label"},
                                {"c.bin", "d.npy"},
                                {"000000.npz", "e.json"}}) {
    well(convert(in, out));
  }
  const labels::LabeledPoints first =
      labels::read_labeled(dir / "000000.npz", labels::LabelFormat::npz);
  EXPECT_EQ(labels::read_labeled(dir / "b.pcd", labels::LabelFormat::pcd).pixel, first.pixel);
  EXPECT_EQ(labels::read_labeled(dir / "c.bin", labels::LabelFormat::kitti).label, first.label);
  EXPECT_EQ(labels::read_labeled(dir / "d.npy", labels::LabelFormat::evops).instance,
            first.instance);
  expect_refused(convert("d.npy", "f.ply"), "ply requires coordinates");
  expect_refused(convert("d.npy", "f.txt"),
                 "f.txt: unknown extension; expected a name that ends in");
}

TEST_F(Labels, CompareReportsTheAgreementOfTwoAnnotators) {
  const fs::path ann = dir / "ann.labels";
  write_labels(ann, 1);
  const auto compare = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {own, ann});
    return labels_of("compare", more);
  };
  Json json = Json::parse(compare({"--json"}).out);
  EXPECT_EQ(json["frames"].size(), 1u);
  EXPECT_EQ(json["frames"][0]["frame"], 1);
  EXPECT_EQ(json["mean"]["mean_iou"], 1);
  EXPECT_EQ(json["frames_in_one_only"], Json::array({0}));

  FrameLabels other = floor_and_wall_labels(*io::open_recording(rec), 1);
  for (int i = 0; i < 4000; ++i) other.plane.data[i] = 1;
  labels::write_frame_labels(ann, 1, other);
  json = Json::parse(compare({"--json"}).out);
  EXPECT_LT(json["mean"]["mean_iou"], 0.9);
  const Ran text = well(compare({"--recording", rec}));
  EXPECT_TRUE(has(text.out, "mean"));

  other.depth_sha256 = std::string(64, 'f');
  labels::write_frame_labels(ann, 1, other);
  expect_refused(compare({}), "created for different depth images");
  expect_refused(labels_of("compare", {own}), "expected two");
}

TEST_F(Labels, StatsCountAreaPlanesAndTime) {
  FrameLabels second = floor_and_wall_labels(*io::open_recording(rec), 1);
  second.review_state = "unreviewed";
  labels::write_frame_labels(own, 1, second);
  const Json json = Json::parse(labels_of("stats", {rec, "--json"}).out);
  ASSERT_EQ(json["frames"].size(), 2u);
  const Json& frame = json["frames"][0];
  EXPECT_EQ(frame["planes"], 2);
  EXPECT_EQ(frame["h"], 1);
  EXPECT_EQ(frame["labelled"], 160 * 120);
  EXPECT_EQ(frame["measured"], 160 * 120);
  // The wall has 1.2 m / 120 per pixel, in the rows above its foot at 60 + 120 * 0.5 / 1.2.
  EXPECT_GT(frame["labelled_m2"], 1.6 * 1.1);
  EXPECT_LT(frame["labelled_m2"], 1.6 * 1.1 + 0.4);
  EXPECT_EQ(json["left"]["unlabelled"], Json::parse("[2]"));
  EXPECT_EQ(json["left"]["unreviewed"], Json::parse("[1]"));
  const Ran text = well(labels_of("stats", {own}));
  EXPECT_TRUE(has(text.out, "without labels: 1: 2\n  not reviewed: 1: 1\n"));
  EXPECT_TRUE(has(text.out, "sum"));
  expect_refused(labels_of("stats", {dir / "rec/depth", "--labels", dir}), "contains no labels");
}

TEST(RealLabels, PlaneTruthOfIclNuimIsImportedAndScored) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const fs::path dir = scratch(), rec = dir / "icl";
  fs::copy(fs::path(data) / "NOT_REAL_icl_nuim_with_plane_gt", rec);
  const auto command = [&](std::vector<std::string> args) {
    args.insert(args.end(), {rec, "--depth-unit", "0.0002"});
    return run(args);
  };
  const Ran imported = well(command({"labels", "import", "--from", rec / "gt_0.npy"}));
  EXPECT_TRUE(has(imported.out, "17 planes, 272893 pixels labeled"));
  const Ran scored = well(command({"eval", "--json", "--max-range", "8"}));
  const Json mean = Json::parse(scored.out)["mean"];
  EXPECT_EQ(mean["planes_truth"], 17);
  EXPECT_GT(mean["point_accuracy"], 80);
}

TEST_F(Labels, ScoreAStoredSegmentationLikeANewOne) {
  const fs::path made = dir / "made";
  const std::vector<std::string> options = {"--frames",     "0",  "--gravity", "0,1,0",
                                            "--classifier", "pca"};
  const auto with = [&](std::vector<std::string> args) {
    args.insert(args.end(), options.begin(), options.end());
    return run(args);
  };
  well(with({"segment", rec, "-o", made}));
  const Ran now = with({"eval", rec, "--json"});
  const Ran before = well(with({"eval", rec, "--json", "--prediction", made}));
  const Json a = Json::parse(now.out)["mean"], b = Json::parse(before.out)["mean"];
  for (const char* figure : {"planes_found", "r_m", "point_accuracy", "mean_iou", "points"})
    EXPECT_EQ(a[figure], b[figure]) << figure;
  EXPECT_GT(a["point_accuracy"], 90);
}

TEST_F(Labels, ScoreOtherLabelsInAnyFormatAndReportMissingFrames) {
  const Ran own_labels = well(run({"eval", rec, "--frames", "0:2", "--json", "--prediction", own}));
  EXPECT_EQ(Json::parse(own_labels.out)["mean"]["mean_iou"], 100);
  well(labels_of("export", {rec, "--format", "kitti", "-o", dir / "kitti", "--frames", "0"}));
  const std::string kitti = (dir / "kitti").string();
  const Ran exported = well(run({"eval", rec, "--frames", "0", "--json", "--prediction", kitti}));
  EXPECT_EQ(Json::parse(exported.out)["mean"]["point_accuracy"], 100);
  expect_refused(run({"eval", rec, "--frames", "1", "--prediction", kitti}),
                 "no planes for frame 1");
}

TEST_F(Labels, OfAKilledWindowAreReportedAsUnsaved) {
  const fs::path killed = dir / "killed";
  {
    labels::LabelStore store(killed);
    const FrameLabels all = floor_and_wall_labels(*io::open_recording(rec), 0);
    FrameLabels none = all;
    std::fill(none.plane.data.begin(), none.plane.data.end(), 0);
    std::fill(none.hv.data.begin(), none.hv.data.end(), 0);
    none.planes.clear();
    store.open(0, none);
    store.commit(labels::make_edit(0, "all", none, all));
  }
  expect_refused(labels_of("stats", {killed}), "only a journal");
}

TEST_F(Labels, CheckFailsForHintsOnlyOnRequest) {
  FrameLabels labels_0 = floor_and_wall_labels(*io::open_recording(rec), 0);
  for (std::size_t i = 0; i < labels_0.plane.data.size(); ++i)
    if (labels_0.plane.data[i] == 2) labels_0.plane.data[i] = labels_0.hv.data[i] = 0;
  std::erase_if(labels_0.planes, [](const LabelPlane& plane) { return plane.id == 2; });
  labels_0.review_state = "unreviewed";
  labels::write_frame_labels(own, 0, labels_0);
  const Ran lax = labels_of("check", {own});
  EXPECT_EQ(lax.code, 0) << lax.out;
  EXPECT_TRUE(has(lax.out, "frame 0: hint: unlabelled"));
  EXPECT_EQ(labels_of("check", {own, "--strict"}).code, 1);
}

// Labels of clouds.

namespace {

/// Two steps behind a floor, with labels for all planes.
class CloudLabels : public testing::Test {
 protected:
  void SetUp() override {
    io::write_ply(rec, *cloud.frame.cloud);
    write(rec, own);
  }
  void write(const fs::path& recording, const fs::path& to) {
    const auto opened = io::open_recording(recording);
    FrameLabels labels = labels::empty_labels(cloud.grid, opened->frame_hash(0));
    for (const int plane : {1, 2, 3, 4, 5})
      labels = labels::painted(labels, cloud.grid, cloud.on(plane), {.plane = plane},
                               labels::PaintMode::over);
    labels::write_frame_labels(to, 0, labels);
  }

  const test::TrueCloud cloud = test::stair_cloud();
  const fs::path dir = scratch(), rec = dir / "stairs.ply", own = dir / "stairs.ply.labels";
};

}  // namespace

TEST_F(CloudLabels, AreCheckedCountedAndComparedLikeThoseOfImages) {
  const Ran checked = well(labels_of("check", {rec}));
  EXPECT_TRUE(has(checked.out, "1 labeled frame, 0 damaged, 0 findings, 0 hints"));
  const Json stats = Json::parse(labels_of("stats", {rec, "--json"}).out);
  EXPECT_EQ(stats["frames"][0]["labelled"], cloud.grid.pixels());
  EXPECT_EQ(stats["frames"][0]["h"], 3);
  EXPECT_EQ(stats["frames"][0]["v"], 2);
  EXPECT_NEAR(stats["frames"][0]["labelled_m2"].get<double>(), 2, 0.2);
  const Json same = Json::parse(labels_of("compare", {own, own, "--json"}).out);
  EXPECT_EQ(same["mean"]["mean_iou"], 1);
}

TEST_F(CloudLabels, ScoreTheMethodAndOtherSegmentations) {
  const Json scored = Json::parse(run({"eval", rec, "--classifier", "pca", "--json"}).out);
  EXPECT_EQ(scored["frames"][0]["planes_truth"], 5);
  EXPECT_GT(scored["frames"][0]["mean_iou"].get<double>(), 80);
  const std::string out = (dir / "kitti").string();
  well(labels_of("export", {rec, "--format", "kitti", "-o", out}));
  const Json others = Json::parse(run({"eval", rec, "--prediction", out, "--json"}).out);
  EXPECT_EQ(others["frames"][0]["mean_iou"], 100);
}

TEST_F(CloudLabels, ImageFormatsAreRejectedAndNothingIsWritten) {
  const fs::path out = dir / "coco";
  expect_refused(
      labels_of("export", {rec, "--format", "coco", "-o", out}),
      "stairs.ply, frame 0: format coco is for images, but this is a cloud; expected --format");
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(CloudLabels, EveryCommandRejectsLabelsOfAnotherCloud) {
  PointSet fewer = *cloud.frame.cloud;
  fewer.points.pop_back();
  const std::string other = (dir / "other.ply").string();
  io::write_ply(other, fewer);
  const std::string part =
      "000000.json: created for a cloud with " + std::to_string(cloud.grid.pixels()) +
      " points, but this recording's frame has " + std::to_string(cloud.grid.pixels() - 1);
  const Ran checked = labels_of("check", {own, "--recording", other});
  EXPECT_EQ(checked.code, 2);
  EXPECT_TRUE(has(checked.out, part));
  expect_refused(labels_of("stats", {own, "--recording", other}), part);
  expect_refused(
      labels_of("export", {other, "--labels", own, "--format", "ply", "-o", dir / "out"}), part);
  expect_refused(run({"eval", other, "--labels", own, "--classifier", "pca"}), part);
}
