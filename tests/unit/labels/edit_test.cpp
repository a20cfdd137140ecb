#include "core/labels/edit/edit.hpp"

#include <gtest/gtest.h>

#include "random_labels.hpp"

namespace planescope::labels {
namespace {

TEST(LabelEdits, ApplyingGivesTheNewLabelsAndRevertingTheOldOnes) {
  Random random(1);
  FrameLabels labels = blank_labels(23, 17);
  for (int step = 0; step < 500; ++step) {
    const FrameLabels before = labels;
    const FrameLabels after = after_random_gesture(before, random);
    const LabelEdit edit = make_edit(3, "gesture", before, after);
    apply_edit(labels, edit);
    ASSERT_NO_FATAL_FAILURE(expect_same(labels, after)) << step;
    revert_edit(labels, edit);
    ASSERT_NO_FATAL_FAILURE(expect_same(labels, before)) << step;
    apply_edit(labels, edit);
  }
}

TEST(LabelEdits, NothingChangedIsAnEmptyEdit) {
  Random random(2);
  const FrameLabels labels = after_random_gesture(blank_labels(8, 6), random);
  EXPECT_TRUE(make_edit(0, "nothing", labels, labels).empty());
}

TEST(LabelEdits, RunsJoinWhereTheLabelsBeforeAndAfterAreTheSame) {
  const FrameLabels before = blank_labels(8, 6);
  FrameLabels after = before;
  after.planes = {LabelPlane{.id = 4}};
  for (int i = 5; i < 20; ++i) after.plane.data[i] = 4;
  for (int i = 12; i < 20; ++i) after.hv.data[i] = 1;
  const LabelEdit edit = make_edit(0, "Brush P4", before, after);
  const std::vector<LabelRun> expected = {{5, 7, 0, 4, 0, 0}, {12, 8, 0, 4, 0, 1}};
  EXPECT_EQ(edit.runs, expected);
  EXPECT_EQ(edit.changed_pixels(), 15u);
  ASSERT_EQ(edit.planes.size(), 1u);
  EXPECT_FALSE(edit.planes[0].before);
  EXPECT_EQ(edit.planes[0].after->id, 4);
  EXPECT_FALSE(edit.notes);
}

TEST(LabelEdits, TheOrderInWhichPlanesWereListedIsNoChange) {
  FrameLabels before = blank_labels(8, 6);
  before.planes = {LabelPlane{.id = 9}, LabelPlane{.id = 2}};
  FrameLabels after = before;
  std::swap(after.planes[0], after.planes[1]);
  EXPECT_TRUE(make_edit(0, "sorted", before, after).empty());
}

}  // namespace
}  // namespace planescope::labels
