// Review, checks and statistics of the label mode.

#include "app/desktop/labeling/label_review.hpp"

#include <fmt/format.h>

#include "core/model/error.hpp"
#include "label_desktop.hpp"

namespace planescope::desktop {
namespace {

struct LabelReview : LabelDesktop {
  /// The algorithm's labels but for a plane that was removed, under review.
  void SetUp() override {
    window.run("label.take");
    window.run("label.remove", "2");
    window.run("review.start");
  }
  const ReviewQueue& queue() const { return *state().results.label.review; }
  const labels::Disagreement& chosen() const {
    return queue().items[static_cast<std::size_t>(state().view.label.review_item)];
  }
};

TEST_F(LabelReview, BeginsAtTheLargestDisagreement) {
  ASSERT_NE(state().results.label.review, nullptr);
  ASSERT_GE(queue().undecided(), 1u);
  EXPECT_EQ(state().view.label.tab, "review");
  EXPECT_EQ(state().view.label.review_item, 0);
  EXPECT_EQ(chosen().kind, DisagreementKind::invented);
  EXPECT_TRUE(window.shows("review.0"));
}

TEST_F(LabelReview, TakingTheAlgorithmsSideEndsTheDisagreement) {
  const labels::PixelSet pixels = chosen().pixels;
  window.run("review.take");
  EXPECT_NE(labels().plane.data[pixels[pixels.size() / 2]], 0);
  for (const labels::Disagreement& item : queue().items) EXPECT_NE(item.pixels, pixels);
  ASSERT_EQ(labels().review.size(), 1u);
  EXPECT_EQ(labels().review[0].decision, ReviewDecision::take);
  EXPECT_EQ(labels().review[0].reviewer, window.store().annotator());
  EXPECT_TRUE(window.shows("review.decided.0"));
  window.run("label.undo");
  EXPECT_TRUE(labels().review.empty());
  EXPECT_FALSE(window.shows("review.decided.0"));
}

TEST_F(LabelReview, EnterKeepsTheLabelsAndGoesOn) {
  const FrameLabels before = labels();
  const std::size_t open = queue().undecided();
  play(R"({"key": "Enter"})");
  EXPECT_EQ(labels().plane.data, before.plane.data);
  EXPECT_EQ(queue().undecided(), open - 1);
}

TEST_F(LabelReview, EditingGoesThereWithTheBrush) {
  window.run("review.edit");
  EXPECT_EQ(state().view.label.tool, LabelTool::brush);
  EXPECT_EQ(labels().review.at(0).decision, ReviewDecision::edit);
  EXPECT_TRUE(state().view.camera.has_value());
}

TEST_F(LabelReview, DecisionsSurviveARestart) {
  while (queue().undecided() > 0) window.run("review.keep");
  const std::size_t notes = labels().review.size();
  window.run("review.done");
  EXPECT_EQ(labels().review_state, "reviewed");
  window.run("label.mode");
  const std::filesystem::path copy = dir / "copy";
  std::filesystem::copy(label_dir, copy, std::filesystem::copy_options::recursive);
  LabelWindow again(copy);
  again.run("review.start");
  EXPECT_EQ(again.state().results.label.review->undecided(), 0u);
  EXPECT_EQ(again.labels().review.size(), notes);
  EXPECT_EQ(again.labels().review_state, "reviewed");
}

TEST_F(LabelReview, IsNotDoneWhileRegionsAreOpen) {
  EXPECT_NE(window.refusal("review.done").find("not decided"), std::string::npos);
  EXPECT_NE(labels().review_state, "reviewed");
}

TEST_F(LabelReview, OfTwoAnnotatorsTellsHowMuchTheyAgree) {
  const std::filesystem::path other = dir / "other";
  labels::write_frame_labels(other, 0, labels());
  window.run("review.against", other.string());
  ASSERT_TRUE(queue().agreement.has_value());
  EXPECT_DOUBLE_EQ(queue().agreement->mean_iou, 1);
  EXPECT_DOUBLE_EQ(queue().agreement->adjusted_rand, 1);
  EXPECT_TRUE(queue().items.empty());
  EXPECT_TRUE(window.shows("review.agreement"));
  window.run("review.against");
  EXPECT_FALSE(queue().agreement.has_value());
  EXPECT_FALSE(queue().items.empty());
}

TEST_F(LabelReview, RefusesLabelsOfAnotherFrame) {
  FrameLabels strange = labels();
  strange.depth_sha256[0] = strange.depth_sha256[0] == '0' ? '1' : '0';
  labels::write_frame_labels(dir / "other", 0, strange);
  EXPECT_NE(window.refusal("review.against", (dir / "other").string()), "");
  EXPECT_NE(window.refusal("review.against", (dir / "none").string()).find("no labels"),
            std::string::npos);
  EXPECT_EQ(state().view.label.compare_with, "");
}

TEST_F(LabelReview, IsMadeAnewWhenLabelsChange) {
  const std::size_t before = queue().items.size();
  window.run("label.undo");
  EXPECT_LT(queue().items.size(), before);
}

TEST_F(LabelReview, DrawingMovesNoView) {
  window.run("review.edit");
  const Vec2d center = state().view.image_center;
  const render::Camera camera = *state().view.camera;
  const std::uint32_t pixel = chosen().pixel;
  const std::string place = fmt::format("{},{}", pixel % 640, pixel / 640);
  window.run("label.stroke", "image over 12 " + place);
  window.run("label.cancel");
  window.run("label.stroke", "image over 25 " + place);
  EXPECT_EQ(state().view.image_center, center);
  EXPECT_EQ(state().view.camera->eye, camera.eye);
}

TEST_F(LabelReview, ChecksLeadToTheirPlaces) {
  window.run("label.class.v", "1");  // a floor
  window.run("check.next");
  ASSERT_NE(state().results.label.audit, nullptr);
  const std::vector<labels::Finding>& findings = state().results.label.audit->findings;
  const auto contradicts =
      std::ranges::find(findings, labels::FindingKind::class_normal, &labels::Finding::kind);
  ASSERT_NE(contradicts, findings.end());
  EXPECT_EQ(state().view.label.tab, "checks");
  EXPECT_EQ(state().view.label.finding, 0);
  const auto index = std::to_string(contradicts - findings.begin());
  play(R"({"click": "checks.)" + index + R"("})");
  EXPECT_EQ(state().view.label.plane, contradicts->plane);
  EXPECT_EQ(std::to_string(state().view.label.finding), index);
}

TEST_F(LabelReview, StatisticsTellTimeAndGestures) {
  window.run("tab.label", "statistics");
  EXPECT_TRUE(window.shows("statistics.frame"));
  EXPECT_TRUE(window.shows("statistics.history"));
  ASSERT_EQ(state().results.label.work.size(), 1u);
  EXPECT_EQ(state().results.label.work[0].gestures, 2u);
}

}  // namespace
}  // namespace planescope::desktop
