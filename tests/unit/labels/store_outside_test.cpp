#include <gtest/gtest.h>

#include <array>

#include "core/labels/model/label_files.hpp"
#include "core/model/file_bytes.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFiles[] = {"000000.plane.png", "000000.hv.png", "000000.json"};

/// Frame 0 after three gestures, saved after the second.
struct Outside : testing::Test {
  fs::path dir;
  FrameLabels saved, latest, others;

  void SetUp() override {
    dir = fresh_dir(testing::UnitTest::GetInstance()->current_test_info()->name());
    Random random(21);
    LabelStore store(dir, by("ann"));
    store.open(0, blank(0));
    gesture(store, 0, random);
    gesture(store, 0, random);
    store.save(0);
    saved = *store.labels(0);
    latest = saved;
    latest.planes.push_back(LabelPlane{.id = 100});  // which changes all three files
    latest.plane.data[40] = 100;
    latest.hv.data[40] = kHvIgnore;
    store.commit(make_edit(0, "Brush P100", saved, latest));
    others = latest;
    while (others.plane.data == latest.plane.data) others = after_random_gesture(others, random);
    others.annotator = "other tool";
  }
};

TEST_F(Outside, LabelsThatOthersWroteAreTakenOverAndCanBeUndone) {
  write_frame_labels(dir, 0, others);
  LabelStore store(dir, by("ann"));
  expect_same(*store.open(0, blank(0)), others);
  ASSERT_EQ(store.notices().size(), 1u);
  EXPECT_NE(store.notices()[0].find("changed outside planescope"), std::string::npos);
  EXPECT_EQ(store.history(1)[0].title, "changed outside planescope");
  EXPECT_FALSE(store.unsaved(0));
  store.undo();
  expect_same(*store.labels(0), latest);
  EXPECT_TRUE(store.unsaved(0));
}

TEST_F(Outside, TheyAreTakenOverOnlyOnce) {
  write_frame_labels(dir, 0, others);
  LabelStore(dir, by("ann")).open(0, blank(0));
  LabelStore store(dir, by("ann"));
  expect_same(*store.open(0, blank(0)), others);
  EXPECT_TRUE(store.notices().empty());
  EXPECT_EQ(store.undo_count(), 4u);
}

TEST_F(Outside, FilesThatWerePackedAnewAreNoChange) {
  LabelStore(dir, by("ann")).save_all();
  auto bytes = read_file_bytes(dir / kFiles[2]);
  bytes.push_back('\n');
  write_file_bytes(dir / kFiles[2], bytes);
  LabelStore store(dir, by("ann"));
  store.open(0, blank(0));
  EXPECT_TRUE(store.notices().empty());
  EXPECT_EQ(store.undo_count(), 3u);
}

TEST_F(Outside, FilesThatAreGoneAreWrittenAnew) {
  for (const char* file : kFiles) fs::remove(dir / file);
  LabelStore store(dir, by("ann"));
  expect_same(*store.open(0, blank(0)), latest);
  EXPECT_TRUE(store.notices().empty());
  store.undo();
  EXPECT_TRUE(store.unsaved(0));
  store.save(0);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, saved.plane.data);
}

TEST_F(Outside, ASaveThatACrashEndedBetweenTwoFilesIsNoChangeByOthers) {
  std::array<std::vector<unsigned char>, 3> old_files;
  for (int i = 0; i < 3; ++i) old_files[i] = read_file_bytes(dir / kFiles[i]);
  LabelStore(dir, by("ann")).save_all();
  for (int replaced = 0; replaced < 3; ++replaced) {
    for (int i = replaced; i < 3; ++i) write_file_bytes(dir / kFiles[i], old_files[i]);
    LabelStore store(dir, by("ann"));
    expect_same(*store.open(0, blank(0)), latest);
    EXPECT_TRUE(store.notices().empty()) << store.notices()[0];
    EXPECT_TRUE(store.unsaved(0));
    EXPECT_EQ(store.undo_count(), 3u);
    store.save(0);
    EXPECT_FALSE(store.unsaved(0));
  }
}

TEST_F(Outside, SavingOverWhatOthersWroteMeanwhileKeepsBothInTheHistory) {
  LabelStore store(dir, by("ann"));
  store.open(0, blank(0));
  write_frame_labels(dir, 0, others);
  store.save(0);
  expect_same(*store.labels(0), latest);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, latest.plane.data);
  EXPECT_EQ(store.notices().size(), 1u);
  store.undo();
  expect_same(*store.labels(0), others);
  store.undo();
  expect_same(*store.labels(0), latest);
}

TEST_F(Outside, SavingWithoutNewsTakesOverWhatOthersWroteMeanwhile) {
  LabelStore store(dir, by("ann"));
  store.open(0, blank(0));
  store.save(0);
  write_frame_labels(dir, 0, others);
  store.save(0);
  expect_same(*store.labels(0), others);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, others.plane.data);
}

TEST_F(Outside, DamagedFilesLeaveTheJournalsLabels) {
  write_file_bytes(dir / kFiles[0], std::vector<unsigned char>{1, 2, 3});
  LabelStore store(dir, by("ann"));
  expect_same(*store.open(0, blank(0)), latest);
  ASSERT_EQ(store.notices().size(), 1u);
  EXPECT_NE(store.notices()[0].find(kFiles[0]), std::string::npos);
  store.save(0);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, latest.plane.data);
  EXPECT_EQ(read_file_bytes(dir / (kFiles[0] + std::string(".outside-1"))).size(), 3u);
}

TEST_F(Outside, LabelsOfAnotherDepthImageAreRefusedAndLeftAlone) {
  const auto journal = read_file_bytes(dir / "journal");
  LabelStore store(dir, by("ann"));
  expect_refused([&] { store.open(0, blank(1)); }, "bbbbbbbbbbbb");
  expect_refused([&] { store.open(0, blank_labels(17, 23)); }, "23x17");
  EXPECT_FALSE(store.labels(0));
  FrameLabels another = others;
  another.depth_sha256 = std::string(64, 'f');
  write_frame_labels(dir, 0, another);
  expect_refused([&] { store.open(0, blank(0)); }, "ffffffffffff");
  EXPECT_EQ(read_file_bytes(dir / "journal"), journal);
}

TEST(LabelStores, LabelFilesWithoutAJournalAreWhereTheHistoryBegins) {
  const fs::path dir = fresh_dir("files_only");
  Random random(22);
  FrameLabels files = blank(0);
  for (int i = 0; i < 5; ++i) files = after_random_gesture(files, random);
  std::reverse(files.planes.begin(), files.planes.end());
  write_frame_labels(dir, 0, files);
  {
    LabelStore store(dir, by("ann"));
    EXPECT_EQ(store.open(0, blank(0))->plane.data, files.plane.data);
    EXPECT_FALSE(store.any_unsaved());
    gesture(store, 0, random);
    EXPECT_TRUE(store.unsaved(0));
  }
  LabelStore store(dir, by("ann"));
  store.open(0, blank(0));
  EXPECT_TRUE(store.notices().empty());
  EXPECT_TRUE(store.unsaved(0));
  store.undo();
  EXPECT_EQ(store.labels(0)->plane.data, files.plane.data);
  EXPECT_FALSE(store.unsaved(0));
  EXPECT_EQ(store.undo_count(), 0u);
}

TEST(LabelStores, FilesThatWerePackedAnewBeforeThereWasAJournalDoItNoHarm) {
  const fs::path dir = fresh_dir("packed_anew");
  Random random(23);
  write_frame_labels(dir, 0, blank(0));
  {
    LabelStore store(dir, by("ann"));
    store.open(0, blank(0));
    auto bytes = read_file_bytes(dir / kFiles[2]);
    bytes.push_back('\n');
    write_file_bytes(dir / kFiles[2], bytes);
    store.save(0);
    gesture(store, 0, random);
  }
  LabelStore store(dir, by("ann"));
  EXPECT_TRUE(store.notices().empty());
  EXPECT_EQ(store.undo_count(), 1u);
}

TEST(LabelStores, FilesOfAnotherSizeAreRefused) {
  const fs::path dir = fresh_dir("other_size");
  write_frame_labels(dir, 0, blank_labels(8, 6, 'a'));
  LabelStore store(dir, by("ann"));
  expect_refused([&] { store.open(0, blank(0)); }, "8x6");
}

TEST_F(Outside, AFrameThatCannotBeSavedKeepsNoOtherFromBeingSaved) {
  LabelStore store(dir, by("ann"));
  store.open(0, blank(0));
  store.open(1, blank(1));
  Random random(5);
  gesture(store, 1, random);
  others.depth_sha256[0] = 'f';
  write_frame_labels(dir, 0, others);
  expect_refused([&] { store.save_all(); }, "000000.json");
  EXPECT_TRUE(store.unsaved(0));
  EXPECT_FALSE(store.unsaved(1));
}

}  // namespace
}  // namespace planescope::labels
