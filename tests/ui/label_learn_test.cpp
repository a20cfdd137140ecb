// A classifier that learns from the frames that were reviewed, and the order of doubt.

#include <algorithm>

#include "app/desktop/labeling/learning.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

struct Learner : testing::Test {
  const fs::path dir = scratch_dir();
  LabelWindow window{dir / "labels", sample_path()};
  const State& state() const { return window.state(); }
  const Learning& learning() const { return state().results.label.learning; }

  /// Its planes are what the algorithm finds; that is how a user begins, too.
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
            "no frame is reviewed: Shift+D marks a frame to learn from");
  EXPECT_EQ(window.refusal("label.learn", "0"),
            "action label.learn: 0 is out of range, expected 1 to 1000000");
  EXPECT_EQ(window.refusal("label.learn", "1 2 3"),
            "action label.learn: '1 2 3', expected [STEPS [CLOUDS]]");
}

TEST_F(Learner, LearnsFromWhatWasReviewedAndIsTakenForWhatComesNext) {
  review_frame(0);
  window.run("label.learn", "2 1");
  const fs::path file = learnt_weights(dir / "labels");
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
  EXPECT_EQ(state().view.label.tab, "learning");
  window.run("frame.show", "1");
  window.run("tab.label", "review");
  while (state().results.label.review->undecided() > 0) window.run("review.ignore");
  window.run("review.done");
  window.run("label.save");
  window.run("tab.label", "learning");
  ASSERT_TRUE(learning().learnt);
  EXPECT_EQ(learning().learnt->since.frames, 0u);
}

TEST_F(Learner, ATrainingThatIsStoppedLeavesTheClassifierAsItWas) {
  review_frame(0);
  window.shell.perform({"label.learn", "1000000 1"}, true);
  window.run("label.learn.stop");
  EXPECT_FALSE(fs::exists(learnt_weights(dir / "labels")));
  EXPECT_EQ(state().document.options.classifier, "pca");
}

TEST_F(Learner, GoesThroughTheFramesThatAreNotReviewedTheMostDoubtfulFirst) {
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

}  // namespace
}  // namespace planescope::desktop
