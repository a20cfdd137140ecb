#include "core/labels/model/label_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

FrameLabels two_planes() {
  FrameLabels labels;
  labels.depth_sha256 = std::string(64, 'a');
  labels.intrinsics = {8, 6, 385.25, 384.75, 3.5, 2.5, Distortion::brown_conrady, {}};
  labels.intrinsics.coefficients = {0.1, -0.2, 1e-3, 1.0 / 3, 0};
  labels.gravity = {Vec3d(0.1, 0.7, 0.7).normalized(), GravitySource::picked, 0.75, "floor click"};
  labels.plane = Image16(8, 6, 1, 0);
  labels.hv = Image8(8, 6, 1, 0);
  for (int x = 0; x < 8; ++x) {
    labels.plane.at(x, 1) = 7;
    labels.hv.at(x, 1) = 1;
    labels.plane.at(x, 3) = 65534;
    labels.hv.at(x, 3) = 2;
    labels.plane.at(x, 5) = kPlaneIgnore;
    labels.hv.at(x, 5) = kHvIgnore;
  }
  labels.planes = {{7, Label::h, Vec3d(0, -0.6, -0.8), -1.0 / 3, 0.0021, 0.01, 1},
                   {65534, Label::v, Vec3d(0, 0.8, -0.6), 0.25, 0, 0, 2}};
  labels.annotator = "J\xc3\xbcrgen \"J\"";
  labels.review_state = "reviewed";
  return labels;
}

fs::path fresh_dir(const std::string& name) {
  const fs::path dir = temp_dir() / ("labels_" + name);
  fs::remove_all(dir);
  return dir;
}

TEST(LabelFiles, KeepTheDepthUnitAndOlderOnesAreReadWithoutIt) {
  const fs::path dir = fresh_dir("depth_unit");
  FrameLabels labels = two_planes();
  write_frame_labels(dir, 0, labels);  // as older files are
  EXPECT_EQ(read_frame_labels(dir, 0, "")->depth_unit_m, 0);
  labels.depth_unit_m = 0.0002;
  write_frame_labels(dir, 0, labels);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->depth_unit_m, 0.0002);
}

TEST(LabelFiles, WithoutGravityHaveNoDirection) {
  const fs::path dir = fresh_dir("no_gravity");
  FrameLabels labels = two_planes();
  labels.gravity = {Vec3d::UnitY(), GravitySource::none, 0, "nobody knows"};
  write_frame_labels(dir, 0, labels);
  const auto bytes = read_file_bytes(dir / "000000.json");
  EXPECT_NE(std::string(bytes.begin(), bytes.end()).find(R"("direction": null)"),
            std::string::npos);
  const auto read = read_frame_labels(dir, 0, labels.depth_sha256);
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->gravity.known());
  EXPECT_EQ(read->gravity.note, "nobody knows");
}

TEST(LabelFiles, WhatIsWrittenIsReadBackExactly) {
  const fs::path dir = fresh_dir("round_trip");
  const FrameLabels written = two_planes();
  write_frame_labels(dir, 123, written);
  EXPECT_TRUE(fs::exists(dir / "000123.plane.png"));
  EXPECT_TRUE(fs::exists(dir / "000123.hv.png"));
  EXPECT_TRUE(fs::exists(dir / "000123.json"));
  const auto read = read_frame_labels(dir, 123, written.depth_sha256);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->depth_sha256, written.depth_sha256);
  EXPECT_EQ(read->intrinsics.width, 8);
  EXPECT_EQ(read->intrinsics.height, 6);
  EXPECT_EQ(read->intrinsics.fx, written.intrinsics.fx);
  EXPECT_EQ(read->intrinsics.fy, written.intrinsics.fy);
  EXPECT_EQ(read->intrinsics.cx, written.intrinsics.cx);
  EXPECT_EQ(read->intrinsics.cy, written.intrinsics.cy);
  EXPECT_EQ(read->intrinsics.distortion, Distortion::brown_conrady);
  EXPECT_EQ(read->intrinsics.coefficients, written.intrinsics.coefficients);
  EXPECT_EQ(read->gravity, written.gravity);
  EXPECT_EQ(read->plane.data, written.plane.data);
  EXPECT_EQ(read->hv.data, written.hv.data);
  EXPECT_EQ(read->planes, written.planes);
  EXPECT_EQ(read->annotator, written.annotator);
  EXPECT_EQ(read->review_state, "reviewed");
}

TEST(LabelFiles, OriginConfidenceFlagsAndReviewNotesAreReadBack) {
  const fs::path dir = fresh_dir("details");
  FrameLabels written = two_planes();
  written.planes[1].origin = LabelOrigin::carried;
  written.planes[1].confidence = 1.0 / 3;
  written.planes[0].locked = written.planes[1].hidden = true;
  written.review = {{DisagreementKind::class_flip, 47, 12, 7, 3, ReviewDecision::ignore, "bob", 5},
                    {DisagreementKind::missed, 0, 1, 0, 9, ReviewDecision::take, "", 1763750000}};
  write_frame_labels(dir, 0, written);
  const auto read = read_frame_labels(dir, 0, "");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->planes, written.planes);
  EXPECT_EQ(read->review, written.review);
}

TEST(LabelFiles, WhatIsAsUsualIsNotWritten) {
  const fs::path dir = fresh_dir("usual");
  write_frame_labels(dir, 0, two_planes());
  const auto bytes = read_file_bytes(dir / "000000.json");
  const std::string text(bytes.begin(), bytes.end());
  for (const char* key : {"origin", "locked", "hidden", "\"review\""}) {
    EXPECT_EQ(text.find(key), std::string::npos) << key;
  }
}

TEST(LabelFiles, TheSameLabelsGiveTheSameBytes) {
  const fs::path dir = fresh_dir("same_bytes");
  const FrameLabels labels = two_planes();
  write_frame_labels(dir, 0, labels);
  write_frame_labels(dir / "again", 0, *read_frame_labels(dir, 0, ""));
  for (const char* name : {"000000.plane.png", "000000.hv.png", "000000.json"}) {
    EXPECT_EQ(read_file_bytes(dir / name), read_file_bytes(dir / "again" / name)) << name;
  }
}

TEST(LabelFiles, AFrameWithoutLabelsIsNoError) {
  const fs::path dir = fresh_dir("absent");
  EXPECT_FALSE(read_frame_labels(dir, 0, ""));
  write_frame_labels(dir, 1, two_planes());
  EXPECT_FALSE(read_frame_labels(dir, 0, ""));
}

TEST(LabelFiles, LabelsAreReplacedAndLeaveNoTemporaryFiles) {
  const fs::path dir = fresh_dir("replace");
  FrameLabels labels = two_planes();
  write_frame_labels(dir, 0, labels);
  labels.annotator = "second";
  write_frame_labels(dir, 0, labels);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->annotator, "second");
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), fs::directory_iterator()), 3);
}

TEST(LabelFiles, LabelsOfAnotherDepthImageAreRefused) {
  const fs::path dir = fresh_dir("hash");
  write_frame_labels(dir, 0, two_planes());
  EXPECT_TRUE(read_frame_labels(dir, 0, std::string(64, 'a')));
  expect_refused([&] { read_frame_labels(dir, 0, std::string(64, 'b')); }, "bbbbbbbbbbbb");
}

TEST(LabelFiles, ImagesOfAnotherSizeAreRefusedNotResized) {
  const fs::path dir = fresh_dir("size");
  write_frame_labels(dir, 0, two_planes());
  io::write_png(dir / "000000.hv.png", Image8(6, 8, 1, 0));
  expect_refused([&] { read_frame_labels(dir, 0, ""); }, "6x8");
}

TEST(LabelFiles, AMissingFileOfTheThreeIsNamed) {
  for (const char* name : {"000000.plane.png", "000000.hv.png", "000000.json"}) {
    const fs::path dir = fresh_dir("missing");
    write_frame_labels(dir, 0, two_planes());
    fs::remove(dir / name);
    expect_refused([&] { read_frame_labels(dir, 0, ""); }, name);
  }
}

TEST(LabelFiles, EveryCutOfTheJsonIsRefused) {
  const fs::path dir = fresh_dir("cut");
  write_frame_labels(dir, 0, two_planes());
  const auto whole = read_file_bytes(dir / "000000.json");
  for (std::size_t size = 0; size + 2 < whole.size(); size += 7) {
    write_file_bytes(dir / "000000.json", std::span(whole).first(size));
    expect_refused([&] { read_frame_labels(dir, 0, ""); }, "000000.json");
  }
}

TEST(LabelFiles, AnUnknownSchemaAndAnotherFramesFileAreRefused) {
  const fs::path dir = fresh_dir("schema");
  write_frame_labels(dir, 0, two_planes());
  for (const char* suffix : {".plane.png", ".hv.png", ".json"}) {
    fs::copy_file(dir / ("000000" + std::string(suffix)), dir / ("000005" + std::string(suffix)));
  }
  expect_refused([&] { read_frame_labels(dir, 5, ""); }, "expected frame 5");
  std::ofstream(dir / "000000.json") << R"({"schema": "planescope.labels/2"})";
  expect_refused([&] { read_frame_labels(dir, 0, ""); }, "planescope.labels/2");
}

TEST(LabelFiles, InconsistentLabelsAreNotWritten) {
  const fs::path dir = fresh_dir("inconsistent");
  const std::pair<const char*, std::function<void(FrameLabels&)>> cases[] = {
      {"65534", [](FrameLabels& labels) { labels.planes.pop_back(); }},
      {"twice", [](FrameLabels& labels) { labels.planes[1].id = 7; }},
      {"expected 1..65534", [](FrameLabels& labels) { labels.planes[0].id = 65535; }},
      {"h/v value 3", [](FrameLabels& labels) { labels.hv.at(0, 0) = 3; }},
      {"finite", [](FrameLabels& labels) { labels.planes[0].offset_m = std::nan(""); }},
      {"9x6", [](FrameLabels& labels) { labels.intrinsics.width = 9; }},
      {"expected 0..1", [](FrameLabels& labels) { labels.planes[0].confidence = 1.5; }},
      {"review note", [](FrameLabels& labels) { labels.review.emplace_back().pixel = 48; }},
      // The journal keeps counts as whole numbers from 0 on.
      {"-1 fragments", [](FrameLabels& labels) { labels.planes[1].fragments = -1; }},
      {"planes -1 and 0",
       [](FrameLabels& labels) { labels.review.emplace_back().label_plane = -1; }}};
  for (const auto& [message, damage] : cases) {
    FrameLabels labels = two_planes();
    damage(labels);
    expect_refused([&] { write_frame_labels(dir, 0, labels); }, message);
  }
  EXPECT_FALSE(fs::exists(dir));
}

TEST(LabelFiles, AFolderThatCannotBeMadeIsNamed) {
  const fs::path file = fresh_dir("blocked");
  std::ofstream(file) << "a file where the folder should be";
  expect_refused([&] { write_frame_labels(file / "sub", 0, two_planes()); }, file.string());
}

TEST(LabelFiles, TheDefaultFolderStandsBesideTheRecording) {
  EXPECT_EQ(default_label_dir("data/walk.bag"), "data/walk.bag.labels");
  EXPECT_EQ(default_label_dir("data/walk/"), "data/walk.labels");
  EXPECT_EQ(default_label_dir("walk"), "walk.labels");
  const fs::path here = fs::current_path();
  EXPECT_EQ(default_label_dir("."), here.parent_path() / (here.filename().string() + ".labels"));
}

}  // namespace
}  // namespace planescope::labels
