// Labeling many frames: carrying on over several, what is done to a plane's whole chain, what is
// next.

#include <algorithm>

#include "app/desktop/labeling/work.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

/// The camera stands still over four frames, then shows something else.
struct ManyFrames : testing::Test {
  const std::filesystem::path dir = scratch_dir();
  std::filesystem::path still() const {
    namespace fs = std::filesystem;
    fs::copy(sample_path(), dir / "still", fs::copy_options::recursive);
    for (const char* folder : {"depth", "color"}) {
      const fs::path images = dir / "still" / folder;
      fs::copy(images / "000001.png", images / "000004.png", fs::copy_options::overwrite_existing);
      for (const char* name : {"000001.png", "000002.png", "000003.png"})
        fs::copy(images / "000000.png", images / name, fs::copy_options::overwrite_existing);
    }
    return dir / "still";
  }
  LabelWindow window{dir / "labels", still()};
  const State& state() const { return window.state(); }
  const labels::LabelStore& store() const { return window.store(); }

  void SetUp() override {
    window.run("label.wand", "320,330");
    window.run("label.accept");
  }
  bool has(int frame, int plane) const {
    const auto labels = store().labels(frame);
    return labels && labels::find_plane(*labels, plane);
  }
};

TEST_F(ManyFrames, AreCarriedOverAsManyAsAreAskedFor) {
  ASSERT_EQ(state().document.current()->recording->frame_count(), 5);
  window.run("label.carry", "2");
  EXPECT_EQ(state().document.frame, 2);
  EXPECT_TRUE(has(1, 1));
  EXPECT_TRUE(has(2, 1));
  EXPECT_FALSE(has(3, 1));
  EXPECT_EQ(state().view.message, "carried over 2 frames");
  EXPECT_EQ(store().undo_count(), 3u);  // one step a frame
}

TEST_F(ManyFrames, AreCarriedOverUntilTheyShowSomethingElse) {
  window.run("label.carry.doubt");
  EXPECT_EQ(state().document.frame, 4);
  EXPECT_TRUE(has(3, 1));
  EXPECT_FALSE(has(4, 1));
  EXPECT_FALSE(state().results.label.carry.running);
}

TEST_F(ManyFrames, APlaneInDoubtEndsIt) {
  window.run("label.stroke", "image over 12 60,60 90,90");  // over the edge of the wall: no plane
  window.run("label.carry", "3 doubt 1");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_NE(state().view.message.find("doubtful: P"), std::string::npos) << state().view.message;
  EXPECT_EQ(window.refusal("label.carry", "3 until"),
            "action label.carry: '3 until', expected [FRAMES] [doubt [SHARE]]");
}

TEST_F(ManyFrames, AClassOrARemovalGoesAlongTheChainOneStepOfUndoAFrame) {
  window.run("label.carry", "3");
  window.run("frame.show", "1");
  window.run("label.plane", "1");
  const std::size_t steps = store().undo_count();
  window.run("label.chain.v");
  for (int frame = 0; frame < 4; ++frame)
    EXPECT_EQ(labels::find_plane(*store().labels(frame), 1)->label, Label::v) << frame;
  EXPECT_EQ(store().undo_count(), steps + 4);
  EXPECT_EQ(state().view.message, "Make P1 v on 4 frames; undo reverts them one by one");
  window.run("label.undo");
  EXPECT_EQ(labels::find_plane(window.labels(), 1)->label, Label::h);
  window.run("label.chain.remove");
  for (int frame = 0; frame < 4; ++frame) EXPECT_FALSE(has(frame, 1)) << frame;
}

TEST_F(ManyFrames, TheNextOneWithoutLabelsIsFoundAndProgressIsTold) {
  window.run("label.carry");
  EXPECT_EQ(progress_of(state()).labelled, 2);
  EXPECT_EQ(progress_of(state()).frames, 5);
  EXPECT_TRUE(window.shows("planes.progress"));
  window.run("label.next.unlabelled");
  EXPECT_EQ(state().document.frame, 2);
  window.run("label.next.unreviewed");
  EXPECT_EQ(state().document.frame, 0);
}

TEST_F(ManyFrames, ThePicturesOfTheStripAreThereWithoutRunningTheMethod) {
  settle(window.shell, window.stage, {});
  ASSERT_EQ(state().results.strip.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(state().results.strip[i].ready);
    EXPECT_FALSE(state().results.strip[i].image.empty());
    if (static_cast<int>(i) == state().document.frame) continue;  // its run may have come already
    EXPECT_EQ(state().results.strip[i].planes, -1) << i;
  }
  window.run("label.mode");  // in the debugger they are run
  settle(window.shell, window.stage, {});
  for (const Thumbnail& thumbnail : state().results.strip) EXPECT_GT(thumbnail.planes, 0);
}

TEST_F(ManyFrames, RegionsBelowTheSmallestSizeAreNotAskedAbout) {
  window.run("review.smallest", "0");
  window.run("review.start");
  const std::size_t all = state().results.label.review->items.size();
  window.run("review.smallest", "100");
  const std::vector<labels::Disagreement>& items = state().results.label.review->items;
  EXPECT_LT(items.size(), all);
  for (const labels::Disagreement& item : items) EXPECT_GE(item.area_m2, 0.01);
}

TEST_F(ManyFrames, AStepThatDoesNothingSaysSo) {
  testing::internal::CaptureStderr();
  play_actions(window.shell, window.stage, dir,
               R"({"do": "label.fill", "with": "P1"}, "label.cancel", "label.accept")");
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_NE(told.find("action 3"), std::string::npos) << told;
  EXPECT_NE(told.find("nothing was done: nothing to accept"), std::string::npos) << told;
}

}  // namespace
}  // namespace planescope::desktop
