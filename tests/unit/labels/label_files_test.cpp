// Tests of reading and writing label files, and of their checks.

#include "core/labels/model/label_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

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

struct LabelFiles : testing::Test {
  const fs::path dir = fresh_dir("files");
  FrameLabels labels = two_planes();

  std::string json_text() const {
    const auto bytes = read_file_bytes(dir / "000000.json");
    return {bytes.begin(), bytes.end()};
  }
};

TEST_F(LabelFiles, KeepTheDepthUnitAndOlderOnesAreReadWithoutIt) {
  write_frame_labels(dir, 0, labels);  // as in older files
  EXPECT_EQ(read_frame_labels(dir, 0, "")->depth_unit_m, 0);
  labels.depth_unit_m = 0.0002;
  write_frame_labels(dir, 0, labels);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->depth_unit_m, 0.0002);
}

TEST_F(LabelFiles, HaveNoDirectionWithoutGravity) {
  labels.gravity = {Vec3d::UnitY(), GravitySource::none, 0, "nobody knows"};
  write_frame_labels(dir, 0, labels);
  EXPECT_NE(json_text().find(R"("direction": null)"), std::string::npos);
  const auto read = read_frame_labels(dir, 0, labels.depth_sha256);
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->gravity.known());
  EXPECT_EQ(read->gravity.note, "nobody knows");
}

TEST_F(LabelFiles, WhatIsWrittenIsReadBackExactly) {
  for (const bool details : {false, true}) {
    if (details) {
      labels.planes[1].origin = LabelOrigin::carried;
      labels.planes[1].confidence = 1.0 / 3;
      labels.planes[0].locked = labels.planes[1].hidden = true;
      labels.review = {
          {DisagreementKind::class_flip, 47, 12, 7, 3, ReviewDecision::ignore, "bob", 5},
          {DisagreementKind::missed, 0, 1, 0, 9, ReviewDecision::take, "", 1763750000}};
    }
    write_frame_labels(dir, 123, labels);
    for (const char* name : {"000123.plane.png", "000123.hv.png", "000123.json"})
      EXPECT_TRUE(fs::exists(dir / name));
    const auto read = read_frame_labels(dir, 123, labels.depth_sha256);
    ASSERT_TRUE(read);
    expect_same(*read, labels);
  }
}

TEST_F(LabelFiles, DefaultsAreNotWritten) {
  write_frame_labels(dir, 0, labels);
  const std::string text = json_text();
  for (const char* key : {"origin", "locked", "hidden", "\"review\""}) {
    EXPECT_EQ(text.find(key), std::string::npos) << key;
  }
}

TEST_F(LabelFiles, TheSameLabelsGiveTheSameBytes) {
  write_frame_labels(dir, 0, labels);
  write_frame_labels(dir / "again", 0, *read_frame_labels(dir, 0, ""));
  for (const char* name : {"000000.plane.png", "000000.hv.png", "000000.json"}) {
    EXPECT_EQ(read_file_bytes(dir / name), read_file_bytes(dir / "again" / name)) << name;
  }
}

TEST_F(LabelFiles, AFrameWithoutLabelsIsNotAnError) {
  EXPECT_FALSE(read_frame_labels(dir, 0, ""));
  write_frame_labels(dir, 1, labels);
  EXPECT_FALSE(read_frame_labels(dir, 0, ""));
}

TEST_F(LabelFiles, LabelsAreReplacedAndLeaveNoTemporaryFiles) {
  write_frame_labels(dir, 0, labels);
  labels.annotator = "second";
  write_frame_labels(dir, 0, labels);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->annotator, "second");
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), fs::directory_iterator()), 3);
}

TEST_F(LabelFiles, LabelsOfAnotherDepthImageAreRejected) {
  write_frame_labels(dir, 0, labels);
  EXPECT_TRUE(read_frame_labels(dir, 0, std::string(64, 'a')));
  expect_refused([&] { read_frame_labels(dir, 0, std::string(64, 'b')); }, "bbbbbbbbbbbb");
}

TEST_F(LabelFiles, ImagesOfAnotherSizeAreRejectedNotResized) {
  write_frame_labels(dir, 0, labels);
  io::write_png(dir / "000000.hv.png", Image8(6, 8, 1, 0));
  expect_refused([&] { read_frame_labels(dir, 0, ""); }, "6x8");
}

TEST_F(LabelFiles, AMissingFileIsReported) {
  for (const char* name : {"000000.plane.png", "000000.hv.png", "000000.json"}) {
    write_frame_labels(dir, 0, labels);
    fs::remove(dir / name);
    expect_refused([&] { read_frame_labels(dir, 0, ""); }, name);
  }
}

TEST_F(LabelFiles, EveryTruncationOfTheJsonIsRejected) {
  write_frame_labels(dir, 0, labels);
  const auto whole = read_file_bytes(dir / "000000.json");
  for (std::size_t size = 0; size + 2 < whole.size(); size += 7) {
    write_file_bytes(dir / "000000.json", std::span(whole).first(size));
    expect_refused([&] { read_frame_labels(dir, 0, ""); }, "000000.json");
  }
}

TEST_F(LabelFiles, AnUnknownSchemaAndAnotherFramesFileAreRejected) {
  write_frame_labels(dir, 0, labels);
  for (const char* suffix : {".plane.png", ".hv.png", ".json"}) {
    fs::copy_file(dir / ("000000" + std::string(suffix)), dir / ("000005" + std::string(suffix)));
  }
  expect_refused([&] { read_frame_labels(dir, 5, ""); }, "expected labels for frame 5");
  std::ofstream(dir / "000000.json") << R"({"schema": "planescope.labels/2"})";
  expect_refused([&] { read_frame_labels(dir, 0, ""); }, "planescope.labels/2");
}

TEST_F(LabelFiles, InconsistentLabelsAreNotWritten) {
  const std::pair<const char*, std::function<void(FrameLabels&)>> cases[] = {
      {"65534", [](FrameLabels& l) { l.planes.pop_back(); }},
      {"twice", [](FrameLabels& l) { l.planes[1].id = 7; }},
      {"expected 1 to 65534", [](FrameLabels& l) { l.planes[0].id = 65535; }},
      {"h/v value 3", [](FrameLabels& l) { l.hv.at(0, 0) = 3; }},
      {"finite", [](FrameLabels& l) { l.planes[0].offset_m = std::nan(""); }},
      {"9x6", [](FrameLabels& l) { l.intrinsics.width = 9; }},
      {"expected 0 to 1", [](FrameLabels& l) { l.planes[0].confidence = 1.5; }},
      {"review note", [](FrameLabels& l) { l.review.emplace_back().pixel = 48; }},
      // The journal stores counts as unsigned integers.
      {"-1 fragments", [](FrameLabels& l) { l.planes[1].fragments = -1; }},
      {"planes -1 and 0", [](FrameLabels& l) { l.review.emplace_back().label_plane = -1; }}};
  for (const auto& [message, change] : cases) {
    FrameLabels changed = labels;
    change(changed);
    expect_refused([&] { write_frame_labels(dir, 0, changed); }, message);
  }
  EXPECT_FALSE(fs::exists(dir));
}

TEST_F(LabelFiles, TheDefaultFolderIsBesideTheRecording) {
  EXPECT_EQ(default_label_dir("data/walk.bag"), "data/walk.bag.labels");
  EXPECT_EQ(default_label_dir("data/walk/"), "data/walk.labels");
  EXPECT_EQ(default_label_dir("walk"), "walk.labels");
  const fs::path here = fs::current_path();
  EXPECT_EQ(default_label_dir("."), here.parent_path() / (here.filename().string() + ".labels"));
}

}  // namespace
}  // namespace planescope::labels
