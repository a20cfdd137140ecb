#include "core/labels/store.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.hpp"
#include "core/base/file_bytes.hpp"
#include "random_labels.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;

fs::path fresh_dir(const std::string& name) {
  const fs::path dir = fs::path(testing::TempDir()) / ("label_store_" + name);
  fs::remove_all(dir);
  return dir;
}

FrameLabels blank(int frame) { return blank_labels(23, 17, static_cast<char>('a' + frame)); }

LabelStoreOptions by(const std::string& annotator) { return {annotator, {}}; }

/// A random gesture on a frame of the store, kept.
void gesture(LabelStore& store, int frame, Random& random, const std::string& title = "gesture") {
  const auto before = store.labels(frame);
  const FrameLabels after = after_random_gesture(*before, random);
  store.commit(make_edit(frame, title, *before, after));
}

TEST(LabelStores, NothingIsMadeBeforeTheFirstGesture) {
  const fs::path dir = fresh_dir("nothing");
  Random random(1);
  LabelStore store(dir, by("ann"));
  EXPECT_EQ(store.read_only(), "");
  expect_same(*store.open(0, blank(0)), blank(0));
  store.save_all();
  store.sync();
  store.undo();
  EXPECT_FALSE(store.any_unsaved());
  EXPECT_FALSE(fs::exists(dir));
  gesture(store, 0, random);
  EXPECT_TRUE(fs::exists(dir / "journal"));
  EXPECT_TRUE(store.unsaved(0));
  EXPECT_TRUE(store.any_unsaved());
}

TEST(LabelStores, UndoAndRedoGoThroughAllFramesAndRestartsWithoutEnd) {
  const fs::path dir = fresh_dir("undo");
  Random random(2);
  auto store = std::make_unique<LabelStore>(dir, by("ann"));
  std::vector<std::pair<int, FrameLabels>> before;  // of each gesture: its frame, and that before
  for (int i = 0; i < 120; ++i) {
    const int frame = random.integer(0, 2);
    store->open(frame, blank(frame));
    const FrameLabels labels = *store->labels(frame);
    gesture(*store, frame, random);
    if (store->undo_count() > before.size()) before.emplace_back(frame, labels);
    if (i % 17 == 0) store->save_all();
  }
  std::vector<std::pair<int, FrameLabels>> after;
  while (const auto frame = store->undo_frame()) {
    store->open(*frame, blank(*frame));
    after.emplace_back(*frame, *store->labels(*frame));
    store->undo();
    ASSERT_EQ(before.back().first, *frame);
    expect_same(*store->labels(*frame), before.back().second);
    before.pop_back();
    if (before.size() % 13 == 0) {
      store.reset();
      store = std::make_unique<LabelStore>(dir, by("ann"));
    }
  }
  EXPECT_TRUE(before.empty());
  for (int frame = 0; frame < 3; ++frame) {
    expect_same(*store->open(frame, blank(frame)), blank(frame));
  }
  while (const auto frame = store->redo_frame()) {
    store->open(*frame, blank(*frame));
    store->redo();
    ASSERT_EQ(after.back().first, *frame);
    expect_same(*store->labels(*frame), after.back().second);
    after.pop_back();
  }
  EXPECT_TRUE(after.empty());
}

TEST(LabelStores, AGestureAfterAnUndoDropsWhatCouldBeRedone) {
  Random random(3);
  LabelStore store(fresh_dir("redo"), by("ann"));
  store.open(0, blank(0));
  store.open(1, blank(1));
  gesture(store, 0, random);
  gesture(store, 0, random);
  store.undo();
  EXPECT_EQ(store.redo_count(), 1u);
  gesture(store, 1, random);
  EXPECT_EQ(store.redo_count(), 0u);
  EXPECT_EQ(store.undo_count(), 2u);
  EXPECT_FALSE(store.redo_frame());
}

TEST(LabelStores, WhatIsNotSavedIsThereAfterARestart) {
  const fs::path dir = fresh_dir("restart");
  Random random(4);
  FrameLabels saved, unsaved;
  {
    LabelStore store(dir, by("ann"));
    store.open(7, blank(7));
    gesture(store, 7, random);
    store.save(7);
    EXPECT_FALSE(store.unsaved(7));
    saved = *store.labels(7);
    gesture(store, 7, random);
    unsaved = *store.labels(7);
  }
  const auto files = read_frame_labels(dir, 7, blank(7).depth_sha256);
  EXPECT_EQ(files->plane.data, saved.plane.data);
  LabelStore store(dir, by("bob"));
  EXPECT_TRUE(store.notices().empty());
  EXPECT_TRUE(store.any_unsaved());
  expect_same(*store.open(7, blank(7)), unsaved);
  EXPECT_TRUE(store.unsaved(7));
  store.undo();
  expect_same(*store.labels(7), saved);
  EXPECT_FALSE(store.unsaved(7));
}

}  // namespace
}  // namespace planescope
