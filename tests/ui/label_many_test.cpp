// Labeling many frames: carrying labels, chains of planes, learning from reviewed frames, saving.

#include <algorithm>
#include <fstream>

#include "app/desktop/labeling/learning.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/state/session.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

/// The camera is at rest for four frames, then shows another scene.
fs::path still_recording(const fs::path& dir) {
  fs::copy(sample_path(), dir / "still", fs::copy_options::recursive);
  for (const char* folder : {"depth", "color"}) {
    const fs::path images = dir / "still" / folder;
    fs::rename(images / "000002.png", images / "000004.png");
    for (const char* name : {"000001.png", "000002.png", "000003.png"})
      fs::copy(images / "000000.png", images / name, fs::copy_options::overwrite_existing);
  }
  return dir / "still";
}

struct ManyFrames : LabelDesktop {
  ManyFrames() : LabelDesktop(still_recording) {}

  void SetUp() override {
    window.run("label.wand", "320,330");
    window.run("label.accept");
  }
  bool has(int frame, int plane) const {
    const auto labels = store().labels(frame);
    return labels && labels::find_plane(*labels, plane);
  }
};

TEST_F(ManyFrames, AreCarriedOverTheRequestedNumber) {
  ASSERT_EQ(state().document.current()->recording->frame_count(), 5);
  window.run("label.carry", "2");
  EXPECT_EQ(state().document.frame, 2);
  EXPECT_TRUE(has(1, 1));
  EXPECT_TRUE(has(2, 1));
  EXPECT_FALSE(has(3, 1));
  EXPECT_EQ(state().view.message, "carried over 2 frames");
  EXPECT_EQ(store().undo_count(), 3u);  // one step per frame
}

TEST_F(ManyFrames, AreCarriedOverUntilTheSceneChanges) {
  window.run("label.carry.doubt");
  EXPECT_EQ(state().document.frame, 4);
  EXPECT_TRUE(has(3, 1));
  EXPECT_FALSE(has(4, 1));
  EXPECT_FALSE(state().results.label.carry.running);
}

TEST_F(ManyFrames, ADoubtfulPlaneEndsIt) {
  // across the edge of the wall: not a plane
  window.run("label.stroke", "image over 12 60,60 90,90");
  window.run("label.carry", "3 doubt 1");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_NE(state().view.message.find("doubtful: P"), std::string::npos) << state().view.message;
  EXPECT_EQ(window.refusal("label.carry", "3 until"),
            "action label.carry: invalid argument '3 until'; expected [FRAMES] [doubt [SHARE]]");
}

TEST_F(ManyFrames, AClassOrARemovalAppliesToTheChainWithOneUndoStepPerFrame) {
  window.run("label.carry", "3");
  window.run("frame.show", "1");
  window.run("label.plane", "1");
  const std::size_t steps = store().undo_count();
  window.run("label.chain.v");
  for (int frame = 0; frame < 4; ++frame)
    EXPECT_EQ(labels::find_plane(*store().labels(frame), 1)->label, Label::v) << frame;
  EXPECT_EQ(store().undo_count(), steps + 4);
  EXPECT_EQ(state().view.message, "Make P1 v on 4 frames; undo reverts one frame at a time");
  window.run("label.undo");
  EXPECT_EQ(find(1)->label, Label::h);
  window.run("label.chain.remove");
  for (int frame = 0; frame < 4; ++frame) EXPECT_FALSE(has(frame, 1)) << frame;
}

TEST_F(ManyFrames, TheNextUnlabeledOneIsFoundAndProgressIsShown) {
  window.run("label.carry");
  EXPECT_EQ(progress_of(state()).labeled, 2);
  EXPECT_EQ(progress_of(state()).frames, 5);
  EXPECT_TRUE(window.shows("planes.progress"));
  window.run("label.next.unlabelled");
  EXPECT_EQ(state().document.frame, 2);
  window.run("label.next.unreviewed");
  EXPECT_EQ(state().document.frame, 0);
}

TEST_F(ManyFrames, TheStripHasPicturesWithoutRunningTheMethod) {
  settle(window.shell, window.stage, {});
  ASSERT_EQ(state().results.strip.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(state().results.strip[i].ready);
    EXPECT_FALSE(state().results.strip[i].image.empty());
    // its run may have finished already
    if (static_cast<int>(i) == state().document.frame) continue;
    EXPECT_EQ(state().results.strip[i].planes, -1) << i;
  }
  window.run("label.mode");  // the debugger runs them
  settle(window.shell, window.stage, {});
  for (const Thumbnail& thumbnail : state().results.strip) EXPECT_GT(thumbnail.planes, 0);
}

TEST_F(ManyFrames, AStepWithoutEffectSaysSo) {
  testing::internal::CaptureStderr();
  play_actions(window.shell, window.stage, dir,
               R"({"do": "label.fill", "with": "P1"}, "label.cancel", "label.accept")");
  const std::string reported = testing::internal::GetCapturedStderr();
  EXPECT_NE(reported.find("action 3"), std::string::npos) << reported;
  EXPECT_NE(reported.find("had no effect: nothing to accept"), std::string::npos) << reported;
}

struct CarriedPlanes : LabelDesktop {
  CarriedPlanes() : LabelDesktop(still_recording) {}
  void SetUp() override { window.run("label.take"); }
};

TEST_F(CarriedPlanes, AreCarriedToTheNextFrameAsOneGesture) {
  const std::size_t planes = labels().planes.size();
  window.run("label.carry");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_EQ(labels().planes.size(), planes);
  for (const LabelPlane& plane : labels().planes) {
    EXPECT_EQ(plane.origin, LabelOrigin::carried);
    EXPECT_GT(plane.confidence, 0.5);
  }
  ASSERT_NE(state().results.label.carry.done, nullptr);
  EXPECT_TRUE(window.shows("planes.doubt"));
  window.run("label.cancel");
  EXPECT_EQ(state().results.label.carry.done, nullptr);
  window.run("label.undo");
  EXPECT_TRUE(labels().planes.empty());
}

TEST_F(CarriedPlanes, DoNotChangeIfItIsCanceled) {
  window.shell.perform({"label.carry", ""}, true);
  window.run("label.cancel");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_TRUE(labels().planes.empty());
}

TEST_F(CarriedPlanes, AreRejectedIfTheNextFrameShowsAnotherScene) {
  window.run("frame.show", "3");
  window.run("label.take");
  EXPECT_NE(window.refusal("label.carry").find("overlap too little"), std::string::npos);
  EXPECT_EQ(state().document.frame, 4);
  EXPECT_TRUE(labels().planes.empty());
  window.run("label.take");
  EXPECT_NE(window.refusal("label.carry").find("last"), std::string::npos);
}

// A classifier that learns from reviewed frames, and the order of doubt.

struct Learner : LabelDesktop {
  const Learning& learning() const { return state().results.label.learning; }

  /// Its planes are those found by the algorithm, as for a new user.
  void review_frame(int frame) {
    window.run("frame.show", std::to_string(frame));
    window.run("label.take");
    window.run("tab.label", "review");
    window.run("review.done");
    window.run("label.save");
  }
};

TEST_F(Learner, WithoutAReviewedFrameThereIsNothingToLearn) {
  EXPECT_EQ(window.refusal("label.learn"),
            "no frame is marked as reviewed; press Shift+D to mark one");
  EXPECT_EQ(window.refusal("label.learn", "0"),
            "action label.learn: 0 is out of range; expected 1 to 1000000");
  EXPECT_EQ(window.refusal("label.learn", "1 2 3"),
            "action label.learn: invalid argument '1 2 3'; expected [STEPS [CLOUDS]]");
}

TEST_F(Learner, LearnsFromReviewedFramesAndIsUsedForTheNext) {
  review_frame(0);
  window.run("label.learn", "2 1");
  const fs::path file = learnt_weights(label_dir);
  ASSERT_TRUE(fs::exists(file));
  EXPECT_EQ(state().document.options.classifier, file.string());
  EXPECT_EQ(state().run()->options.classifier, file.string()) << "the frame is found anew with it";
  EXPECT_FALSE(learning().training.running);

  window.run("tab.label", "learning");
  ASSERT_TRUE(learning().learnt);
  EXPECT_EQ(learning().learnt->steps, 2);
  EXPECT_EQ(learning().learnt->frames, 1u);
  EXPECT_EQ(learning().learnt->since.frames, 0u) << "what was learnt from measures nothing";

  const auto run = state().results.current;
  window.run("label.learn", "3 1");
  EXPECT_NE(state().results.current, run) << "the file has the same name, and other weights";
  EXPECT_EQ(learning().learnt->steps, 3);

  review_frame(1);
  window.run("tab.label", "learning");
  ASSERT_EQ(learning().learnt->since.frames, 1u);
  EXPECT_GT(learning().learnt->since.before.percent(), 90);
  EXPECT_GT(learning().learnt->since.after.percent(), 90);
}

TEST_F(Learner, AReviewedFrameWithoutALabelMeasuresNothing) {
  review_frame(0);
  window.run("label.learn", "2 1");
  EXPECT_EQ(view().tab, "learning");
  window.run("frame.show", "1");
  window.run("tab.label", "review");
  while (state().results.label.review->undecided() > 0) window.run("review.ignore");
  window.run("review.done");
  window.run("label.save");
  window.run("tab.label", "learning");
  ASSERT_TRUE(learning().learnt);
  EXPECT_EQ(learning().learnt->since.frames, 0u);
}

TEST_F(Learner, AStoppedTrainingKeepsTheOldClassifier) {
  review_frame(0);
  window.shell.perform({"label.learn", "1000000 1"}, true);
  window.run("label.learn.stop");
  EXPECT_FALSE(fs::exists(learnt_weights(label_dir)));
  EXPECT_EQ(state().document.options.classifier, "pca");
}

TEST_F(Learner, VisitsUnreviewedFramesInOrderOfDoubt) {
  review_frame(0);
  window.run("label.next.doubtful");
  const std::vector<int> order = by_doubt(state());
  const auto frames =
      static_cast<std::size_t>(state().document.current()->recording->frame_count());
  ASSERT_EQ(order.size(), frames - 1);
  EXPECT_EQ(std::ranges::count(order, 0), 0) << "is reviewed";
  const auto& doubt = learning().doubt.of_frame;
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_GE(*doubt[static_cast<std::size_t>(order[i - 1])],
              *doubt[static_cast<std::size_t>(order[i])]);
  EXPECT_EQ(state().document.frame, order.front());
  window.run("label.next.doubtful");
  EXPECT_EQ(state().document.frame, order[1]);

  window.run("option.set", "classifier=gcn");
  EXPECT_TRUE(learning().doubt.of_frame.empty()) << "another classifier has other doubts";
}

// Labels are written, or reported as unwritten.

using LabelSafety = LabelDesktop;

TEST_F(LabelSafety, LeavingTheFrameSavesAndMarksIt) {
  window.run("label.take");
  EXPECT_TRUE(window.shows("frame.0.labels"));
  EXPECT_FALSE(fs::exists(label_dir / "000000.json"));
  window.run("frame.next");
  EXPECT_TRUE(fs::exists(label_dir / "000000.json"));
  EXPECT_TRUE(window.shows("frame.0.labels"));
  EXPECT_FALSE(window.shows("frame.1.labels"));
}

TEST_F(LabelSafety, ClosingTheWindowSaves) {
  const fs::path other = dir / "other";
  {
    LabelWindow closed(other);
    closed.run("label.take");
    EXPECT_FALSE(fs::exists(other / "000000.json"));
  }
  EXPECT_TRUE(fs::exists(other / "000000.json"));
}

TEST_F(LabelSafety, AFailedSaveIsReportedKeepsTheLabelsAndBlocksNothing) {
  window.run("label.take");
  const std::size_t planes = labels().planes.size();
  fs::create_directories(label_dir / "000000.plane.png.part" / "in the way");
  EXPECT_NE(window.refusal("label.save").find("000000.plane.png"), std::string::npos);
  EXPECT_NE(state().results.label.save_problem, "");
  window.run("frame.next");
  EXPECT_EQ(state().document.frame, 1);
  window.run("frame.previous");
  EXPECT_EQ(labels().planes.size(), planes);
  fs::remove_all(label_dir / "000000.plane.png.part");
  window.run("label.save");
  EXPECT_EQ(state().results.label.save_problem, "");
  EXPECT_TRUE(fs::exists(label_dir / "000000.plane.png"));
}

TEST_F(LabelSafety, ASecondWindowIsReadOnlyAndNamesTheFirst) {
  window.run("label.take");
  LabelWindow second(label_dir);
  EXPECT_NE(second.store().read_only().find("held by"), std::string::npos);
  EXPECT_EQ(second.labels().planes.size(), labels().planes.size());
  const std::pair<const char*, const char*> refused[] = {
      {"label.remove", "1"}, {"label.stroke", "image over 20 300,330"}, {"label.save", ""}};
  for (const auto& [action, argument] : refused)
    EXPECT_NE(second.refusal(action, argument).find("held by"), std::string::npos) << action;
  EXPECT_EQ(second.labels().planes.size(), labels().planes.size());
  EXPECT_TRUE(second.shows("status.right"));
}

TEST_F(LabelSafety, ASessionDoesNotChangeTheModeOrTheLabelFolder) {
  window.run("label.take");
  window.run("session.save", (dir / "a.session").string());
  window.run("session.open", (dir / "a.session").string());
  EXPECT_EQ(state().view.mode, Mode::debugger);
  EXPECT_TRUE(fs::exists(label_dir / "000000.json"));
  EXPECT_EQ(state().document.current()->label_dir, label_dir);
  window.run("label.mode");
  EXPECT_FALSE(labels().planes.empty());
}

TEST_F(LabelSafety, FramesLabeledEarlierAreMarkedInLabelMode) {
  window.run("frame.show", "1");
  window.run("label.take");
  window.run("label.save");
  LabelWindow again(copy_of_labels());
  EXPECT_TRUE(again.shows("frame.1.labels"));
  EXPECT_FALSE(again.shows("frame.2.labels"));
}

TEST_F(LabelSafety, ChangesByOthersAreReported) {
  window.run("label.take");
  window.run("label.save");
  const fs::path copy = copy_of_labels();
  FrameLabels others = labels();
  others.annotator = "other tool";
  labels::write_frame_labels(copy, 0, others);
  LabelWindow again(copy);
  EXPECT_NE(again.state().view.message.find("changed outside"), std::string::npos);
}

}  // namespace
}  // namespace planescope::desktop
