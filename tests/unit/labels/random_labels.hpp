#pragma once

// Random labels, as any gestures may produce them, for property tests.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/labels/edit/edit.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/random.hpp"
#include "support/temp_dir.hpp"

namespace planescope::labels {

inline FrameLabels blank_labels(int width, int height, char hash = 'a') {
  FrameLabels labels;
  labels.depth_sha256 = std::string(64, hash);
  labels.depth_unit_m = 0.001;
  labels.intrinsics = {width, height, 385.25, 384.75, width / 2.0, height / 2.0};
  labels.plane = Image16(width, height);
  labels.hv = Image8(width, height);
  labels.review_state = "unreviewed";
  return labels;
}

/// Paints a rectangle with a new or existing plane, no label, or "do not score"; sometimes changes
/// a plane, removes one with its pixels, or writes notes.
inline FrameLabels after_random_gesture(FrameLabels labels, Random& random) {
  const int width = labels.plane.width, height = labels.plane.height;
  const auto plane_at = [&](int id) {
    auto& planes = labels.planes;
    auto at = planes.begin();
    while (at != planes.end() && at->id < id) ++at;
    if (at == planes.end() || at->id != id) at = planes.insert(at, LabelPlane{.id = id});
    return at;
  };
  const int choice = random.integer(0, 9);
  if (choice == 0 && !labels.planes.empty()) {
    const int id = labels.planes.front().id;
    labels.planes.erase(labels.planes.begin());
    for (std::size_t i = 0; i < labels.plane.data.size(); ++i) {
      if (labels.plane.data[i] == id) labels.plane.data[i] = labels.hv.data[i] = 0;
    }
  } else if (choice == 1) {
    labels.review_state = random.integer(0, 1) ? "reviewed" : "unreviewed";
    labels.annotator = random.integer(0, 1) ? "ann" : "J\xc3\xbcrgen \"J\"\n";
    labels.gravity.note = "note " + std::to_string(random.integer(0, 99));
    labels.gravity.direction = Vec3d(random.normal(), random.normal(), random.normal());
    ReviewNote note;
    note.kind = static_cast<DisagreementKind>(random.integer(0, 5));
    note.decision = static_cast<ReviewDecision>(random.integer(0, 3));
    note.pixel = random.integer(0, width * height - 1);
    note.pixels = random.integer(0, width * height);
    note.label_plane = random.integer(0, 9);
    note.reviewer = "bob";
    note.time_s = random.integer(0, 1 << 30);
    labels.review.push_back(note);
  } else {
    const int kind = random.integer(0, 9);
    const int id = kind == 0 ? 0 : kind == 1 ? kPlaneIgnore : random.integer(1, 12);
    if (kind > 1) {
      LabelPlane& plane = *plane_at(id);
      plane.label = static_cast<Label>(random.integer(0, 2));
      plane.normal = Vec3d(random.normal(), random.normal(), random.normal());
      plane.offset_m = random.normal();
      plane.rms_m = random.uniform();
      plane.origin = static_cast<LabelOrigin>(random.integer(0, 4));
      plane.confidence = random.uniform();
      plane.locked = random.integer(0, 4) == 0;
      plane.hidden = random.integer(0, 4) == 0;
    }
    const int x1 = random.integer(0, width - 1), x2 = random.integer(x1, width - 1);
    const int y1 = random.integer(0, height - 1), y2 = random.integer(y1, height - 1);
    const auto hv = kind == 1 ? kHvIgnore : static_cast<std::uint8_t>(random.integer(0, 2));
    for (int y = y1; y <= y2; ++y) {
      for (int x = x1; x <= x2; ++x) {
        labels.plane.at(x, y) = static_cast<std::uint16_t>(id);
        labels.hv.at(x, y) = hv;
      }
    }
  }
  return labels;
}

/// Expects equality in every field.
inline void expect_same(const FrameLabels& a, const FrameLabels& b) {
  ASSERT_EQ(a.plane.data, b.plane.data);
  ASSERT_EQ(a.hv.data, b.hv.data);
  ASSERT_EQ(a.planes, b.planes);
  EXPECT_EQ(a.depth_sha256, b.depth_sha256);
  EXPECT_TRUE(a.intrinsics == b.intrinsics);
  EXPECT_EQ(a.depth_unit_m, b.depth_unit_m);
  EXPECT_EQ(a.gravity, b.gravity);
  EXPECT_EQ(a.annotator, b.annotator);
  EXPECT_EQ(a.review_state, b.review_state);
  EXPECT_EQ(a.review, b.review);
}

// Stores of random labels, each in its own folder.

inline std::filesystem::path fresh_dir(const std::string& name) {
  const auto dir = temp_dir() / ("label_store_" + name);
  std::filesystem::remove_all(dir);
  return dir;
}

inline FrameLabels blank(int frame) {
  FrameLabels labels = blank_labels(23, 17, static_cast<char>('a' + frame));
  labels.annotator = "ann";
  return labels;
}

inline LabelStoreOptions by(const std::string& annotator) { return {annotator, {}}; }

/// A store with frame 0 open.
struct OpenStore : LabelStore {
  explicit OpenStore(const std::filesystem::path& dir, const std::string& annotator = "ann")
      : LabelStore(dir, by(annotator)) {
    open(0, blank(0));
  }
};

/// Commits a random gesture that changes something on an open frame.
inline void gesture(LabelStore& store, int frame, Random& random) {
  const auto before = store.labels(frame);
  LabelEdit edit;
  while (edit.empty()) {
    edit = make_edit(frame, "gesture", *before, after_random_gesture(*before, random));
  }
  store.commit(edit);
}

struct LabelStores : testing::Test {
  const std::filesystem::path dir =
      fresh_dir(testing::UnitTest::GetInstance()->current_test_info()->name());
  Random random{1};
};

}  // namespace planescope::labels
