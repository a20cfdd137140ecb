// Tests of the label store: undo history, restarts, saving and work times.

#include "core/labels/store/store.hpp"

#include <gtest/gtest.h>

#include "core/labels/model/label_files.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

TEST_F(LabelStores, NothingIsWrittenBeforeTheFirstGesture) {
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

TEST_F(LabelStores, AnUntouchedFrameAdoptsGravityKnownLater) {
  LabelStore store(dir, by("ann"));
  FrameLabels unknown = blank(0), known = blank(0);
  unknown.gravity.source = GravitySource::none;
  known.gravity = {Vec3d(0, 0.6, 0.8), GravitySource::picked, 1, "picked"};
  store.open(0, unknown);
  const auto version = store.version(0);
  EXPECT_EQ(store.open(0, known)->gravity.direction, known.gravity.direction);
  EXPECT_GT(store.version(0), version);
  gesture(store, 0, random);
  const auto drawn = store.labels(0);
  EXPECT_EQ(store.open(0, unknown), drawn) << "what was drawn keeps the gravity it was drawn with";
}

TEST_F(LabelStores, UndoAndRedoCoverAllFramesAndRestarts) {
  auto store = std::make_unique<LabelStore>(dir, by("ann"));
  // per gesture: its frame, and the previous labels
  std::vector<std::pair<int, FrameLabels>> before;
  for (int i = 0; i < 120; ++i) {
    const int frame = random.integer(0, 2);
    store->open(frame, blank(frame));
    const FrameLabels labels = *store->labels(frame);
    gesture(*store, frame, random);
    before.emplace_back(frame, labels);
    if (i % 17 == 0) store->save_all();
  }
  std::vector<std::pair<int, FrameLabels>> after;
  while (store->undo_count() > 0) {
    const int frame = store->undo_frames().front();
    store->open(frame, blank(frame));
    after.emplace_back(frame, *store->labels(frame));
    store->undo();
    ASSERT_EQ(before.back().first, frame);
    expect_same(*store->labels(frame), before.back().second);
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
  while (store->redo_count() > 0) {
    const int frame = store->redo_frames().front();
    store->open(frame, blank(frame));
    store->redo();
    ASSERT_EQ(after.back().first, frame);
    expect_same(*store->labels(frame), after.back().second);
    after.pop_back();
  }
  EXPECT_TRUE(after.empty());
}

TEST_F(LabelStores, ReturnedLabelsDoNotChange) {
  LabelStore store(dir, by("ann"));
  const auto first = store.open(0, blank(0));
  const auto version = store.version(0);
  gesture(store, 0, random);
  expect_same(*first, blank(0));
  EXPECT_GT(store.version(0), version);
  EXPECT_NE(store.labels(0), first);
}

TEST_F(LabelStores, EditsOfSeveralFramesAreOneStep) {
  const auto drawn = [](int frame, std::size_t pixel) {
    FrameLabels labels = blank(frame);
    labels.hv.data[pixel] = 1;
    return labels;
  };
  const auto open_all = [](LabelStore& store) {
    for (int frame = 0; frame < 4; ++frame) store.open(frame, blank(frame));
  };
  auto store = std::make_unique<LabelStore>(dir, LabelStoreOptions{"ann", [] { return 1000; }});
  open_all(*store);
  store->commit(make_edit(0, "Brush h", blank(0), drawn(0, 5)));
  std::vector<LabelEdit> edits;
  for (int frame = 1; frame < 4; ++frame)
    edits.push_back(make_edit(frame, "Propose", blank(frame), drawn(frame, 7)));
  edits.push_back(make_edit(0, "Nothing", blank(0), blank(0)));
  store->commit(edits);
  EXPECT_EQ(store->undo_frames(), (std::vector{3, 2, 1}));
  store.reset();

  store = std::make_unique<LabelStore>(dir, LabelStoreOptions{"ann", [] { return 1000; }});
  open_all(*store);
  store->undo();
  for (int frame = 1; frame < 4; ++frame) expect_same(*store->labels(frame), blank(frame));
  expect_same(*store->labels(0), drawn(0, 5));
  EXPECT_EQ(store->redo_frames(), (std::vector{1, 2, 3}));
  store->redo();
  expect_same(*store->labels(2), drawn(2, 7));
  // An edit of another frame at the same moment is a separate step.
  store->commit(make_edit(0, "Brush h", drawn(0, 5), drawn(0, 6)));
  EXPECT_EQ(store->undo_frames(), std::vector{0});
  store->undo();
  expect_same(*store->labels(3), drawn(3, 7));
}

TEST_F(LabelStores, TheHistoryListsAuthorActionAndTimeLatestFirst) {
  std::int64_t now_ms = 1000;
  LabelStore store(dir, {"ann", [&] { return now_ms; }});
  store.open(3, blank(3));
  FrameLabels labels = blank(3);
  labels.hv.data[5] = labels.hv.data[6] = 1;
  store.commit(make_edit(3, "Brush h", *store.labels(3), labels));
  store.set_annotator("bob");
  now_ms = 2000;
  labels.hv.data[9] = kHvIgnore;
  store.commit(make_edit(3, "Ignore", *store.labels(3), labels));
  store.commit(make_edit(3, "Nothing", *store.labels(3), labels));
  const auto history = store.history(10);
  ASSERT_EQ(history.size(), 2u);
  EXPECT_EQ(history[0].title, "Ignore");
  EXPECT_EQ(history[0].annotator, "bob");
  EXPECT_EQ(history[0].time_ms, 2000);
  EXPECT_EQ(history[1].title, "Brush h");
  EXPECT_EQ(history[1].annotator, "ann");
  EXPECT_EQ(history[1].frame, 3);
  EXPECT_EQ(history[1].pixels, 2u);
  EXPECT_EQ(store.history(1).size(), 1u);
}

TEST_F(LabelStores, SaveAllIncludesFramesNotOpenedSinceTheRestart) {
  FrameLabels labels;
  {
    OpenStore store(dir);
    gesture(store, 0, random);
    labels = *store.labels(0);
  }
  LabelStore store(dir, by("ann"));
  store.save_all();
  EXPECT_FALSE(store.any_unsaved());
  const auto files = read_frame_labels(dir, 0, blank(0).depth_sha256);
  ASSERT_TRUE(files);
  EXPECT_EQ(files->plane.data, labels.plane.data);
}

TEST_F(LabelStores, NewLabelsRecordTheirAnnotator) {
  LabelStore store(dir, by("ann"));
  FrameLabels labels = *store.open(0, blank_labels(23, 17));
  labels.hv.data[0] = 1;
  store.commit(make_edit(0, "Brush h", *store.labels(0), labels));
  store.save(0);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->annotator, "ann");
}

TEST_F(LabelStores, WorkTimesCountGapsOfMoreThanAMinuteAsAMinute) {
  EXPECT_TRUE(work_times(dir).empty());
  std::int64_t now_s = 100;
  LabelStore store(dir, {"ann", [&] { return now_s * 1000; }});
  store.open(0, blank(0));
  store.open(4, blank(4));
  const auto at = [&](std::int64_t time_s, int frame) {
    now_s = time_s;
    gesture(store, frame, random);
  };
  at(100, 4);
  at(110, 4);
  at(5000, 0);
  store.set_annotator("bob");
  at(5005, 4);
  at(5020, 4);
  now_s = 5030;
  store.undo();
  store.save_all();
  const auto times = work_times(dir);
  ASSERT_EQ(times.size(), 3u);
  EXPECT_EQ(times[0].frame, 0);
  EXPECT_EQ(times[0].seconds, 60);
  EXPECT_EQ(times[0].gestures, 1u);
  EXPECT_EQ(times[1].annotator, "ann");
  EXPECT_EQ(times[1].seconds, 10);
  EXPECT_EQ(times[1].gestures, 2u);
  EXPECT_EQ(times[2].annotator, "bob");
  EXPECT_EQ(times[2].frame, 4);
  EXPECT_EQ(times[2].seconds, 25);
  EXPECT_EQ(times[2].gestures, 3u);
}

}  // namespace
}  // namespace planescope::labels
