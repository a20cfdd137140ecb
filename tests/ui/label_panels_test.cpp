// Panels and actions of label mode: planes, carrying labels to the next frame, review, checks,
// statistics.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/labeling/review.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct LabelPlanes : LabelDesktop {
  void SetUp() override { window.run("label.take"); }
};

TEST_F(LabelPlanes, CanStartFromTheAlgorithmInOneUndoStep) {
  const planes::Segmentation& found = state().run()->segmentation;
  ASSERT_GE(found.planes.size(), 3u);
  EXPECT_EQ(labels().planes.size(), found.planes.size());
  for (const LabelPlane& plane : labels().planes) {
    EXPECT_EQ(plane.origin, LabelOrigin::algorithm);
    EXPECT_EQ(plane.label, found.planes[static_cast<std::size_t>(plane.id - 1)].label);
  }
  EXPECT_EQ(store().history(1).front().title, "Start from the algorithm (refined)");
  window.run("label.undo");
  EXPECT_TRUE(labels().planes.empty());
}

TEST_F(LabelPlanes, JoinAndSplitKeepEveryPixel) {
  const auto labeled = [&] {
    return std::ranges::count_if(labels().plane.data, [](std::uint16_t id) { return id > 0; });
  };
  const auto before = labeled();
  const std::size_t one = pixels_of(1), two = pixels_of(2);
  const auto under = labels::pixels_of_plane(labels(), 2)[0];
  choose(1);
  window.shell.perform({"label.hover", fmt::format("{},{}", under % 640, under / 640)}, true);
  window.run("label.join");
  EXPECT_EQ(pixels_of(1), one + two);
  EXPECT_EQ(find(2), nullptr);
  EXPECT_EQ(store().history(1).front().title, "Join P2 into P1");
  EXPECT_NE(window.refusal("label.join").find("under the mouse"), std::string::npos);
  window.run("label.split");
  EXPECT_EQ(labeled(), before);
}

TEST_F(LabelPlanes, ThatAreLockedRejectGesturesInOneLine) {
  window.run("label.lock", "2");
  const std::uint64_t version = store().version(0);
  EXPECT_NE(window.refusal("label.remove", "2").find("P2 is locked"), std::string::npos);
  choose(2);
  EXPECT_EQ(window.refusal("label.stroke", "image over 20 300,330"), "P2 is locked");
  EXPECT_FALSE(window.refusal("label.cut", "image 330,0 330,479").empty());
  EXPECT_EQ(store().version(0), version);
  EXPECT_NE(window.refusal("label.lock", "77").find("no plane P77"), std::string::npos);
}

TEST_F(LabelPlanes, HiddenOnesAreCountedUntilAllAreShown) {
  EXPECT_FALSE(window.shows("planes.hidden"));
  window.run("label.hide", "1");
  EXPECT_TRUE(window.shows("planes.hidden"));
  EXPECT_TRUE(find(1)->hidden);
  EXPECT_GT(pixels_of(1), 0u);
  window.run("label.show_all");
  EXPECT_FALSE(window.shows("planes.hidden"));
}

TEST_F(LabelPlanes, AreSelectedLockedAndCenteredInTheList) {
  play(R"({"click": "planes.2"})");
  EXPECT_EQ(view().plane, 2);
  play(R"({"click": "planes.2.lock"}, {"click": "planes.3.hide"})");
  EXPECT_TRUE(find(2)->locked);
  EXPECT_TRUE(find(3)->hidden);
  ASSERT_FALSE(state().view.camera.has_value());
  play(R"({"click": "planes.1", "double": true})");
  EXPECT_EQ(view().plane, 1);
  EXPECT_TRUE(state().view.camera.has_value());
}

TEST_F(LabelPlanes, WithoutOneTheKeySetsTheClassOfTheNext) {
  choose(0);
  window.run("label.class.h");
  EXPECT_EQ(view().paints, Paints::h_only);
  window.run("label.class.h");
  EXPECT_EQ(view().paints, Paints::plane);
}

struct LabelReview : LabelDesktop {
  /// Reviews the algorithm's labels without one plane, which was removed.
  void SetUp() override {
    window.run("label.take");
    window.run("label.remove", "2");
    window.run("review.start");
  }
  const ReviewQueue& queue() const { return *state().results.label.review; }
  const labels::Disagreement& chosen() const {
    return queue().items[static_cast<std::size_t>(view().review_item)];
  }
};

TEST_F(LabelReview, BeginsAtTheLargestDisagreement) {
  ASSERT_NE(state().results.label.review, nullptr);
  ASSERT_GE(queue().undecided(), 1u);
  EXPECT_EQ(view().tab, "review");
  EXPECT_EQ(view().review_item, 0);
  EXPECT_EQ(chosen().kind, DisagreementKind::invented);
  EXPECT_TRUE(window.shows("review.0"));
}

TEST_F(LabelReview, AcceptingTheAlgorithmEndsTheDisagreement) {
  const labels::PixelSet pixels = chosen().pixels;
  window.run("review.take");
  EXPECT_NE(labels().plane.data[pixels[pixels.size() / 2]], 0);
  for (const labels::Disagreement& item : queue().items) EXPECT_NE(item.pixels, pixels);
  ASSERT_EQ(labels().review.size(), 1u);
  EXPECT_EQ(labels().review[0].decision, ReviewDecision::take);
  EXPECT_EQ(labels().review[0].reviewer, store().annotator());
  EXPECT_TRUE(window.shows("review.decided.0"));
  window.run("label.undo");
  EXPECT_TRUE(labels().review.empty());
  EXPECT_FALSE(window.shows("review.decided.0"));
}

TEST_F(LabelReview, EnterKeepsTheLabelsAndContinues) {
  const FrameLabels before = labels();
  const std::size_t open = queue().undecided();
  play(R"({"key": "Enter"})");
  EXPECT_EQ(labels().plane.data, before.plane.data);
  EXPECT_EQ(queue().undecided(), open - 1);
}

TEST_F(LabelReview, EditingMovesThereWithTheBrush) {
  window.run("review.edit");
  EXPECT_EQ(view().tool, LabelTool::brush);
  EXPECT_EQ(labels().review.at(0).decision, ReviewDecision::edit);
  EXPECT_TRUE(state().view.camera.has_value());
}

TEST_F(LabelReview, DecisionsSurviveARestart) {
  while (queue().undecided() > 0) window.run("review.keep");
  const std::size_t notes = labels().review.size();
  window.run("review.done");
  EXPECT_EQ(labels().review_state, "reviewed");
  window.run("label.mode");
  LabelWindow again(copy_of_labels());
  again.run("review.start");
  EXPECT_EQ(again.state().results.label.review->undecided(), 0u);
  EXPECT_EQ(again.labels().review.size(), notes);
  EXPECT_EQ(again.labels().review_state, "reviewed");
}

TEST_F(LabelReview, ListsSliversLastAndDecidesThemTogether) {
  for (const LabelPlane& plane : FrameLabels(labels()).planes) {  // borders that differ slightly
    if (!window.refusal("label.smooth", std::to_string(plane.id)).empty()) continue;
    window.run("label.accept");
  }
  window.run("review.start");
  window.run("review.smallest", "0");
  const auto is_last = [&] {
    bool seen = false;
    for (const labels::Disagreement& item : queue().items) {
      if (item.note) break;
      if (seen && !is_sliver(item)) return false;
      seen |= is_sliver(item);
    }
    return seen;
  };
  ASSERT_TRUE(is_last());
  const int slivers = slivers_of(queue()).count;
  ASSERT_GT(slivers, 1);
  EXPECT_TRUE(window.shows("review.slivers"));
  const std::size_t undecided = queue().undecided();
  window.run("review.slivers", "keep");
  EXPECT_EQ(slivers_of(queue()).count, 0);
  EXPECT_EQ(queue().undecided(), undecided - static_cast<std::size_t>(slivers));
  window.run("label.undo");
  EXPECT_EQ(slivers_of(queue()).count, slivers) << "one step";
}

TEST_F(LabelReview, IsNotDoneWhileRegionsAreOpen) {
  EXPECT_NE(window.refusal("review.done").find("undecided"), std::string::npos);
  EXPECT_NE(labels().review_state, "reviewed");
}

TEST_F(LabelReview, OfTwoAnnotatorsReportsTheirAgreement) {
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

TEST_F(LabelReview, RejectsLabelsOfAnotherFrame) {
  FrameLabels strange = labels();
  strange.depth_sha256[0] = strange.depth_sha256[0] == '0' ? '1' : '0';
  labels::write_frame_labels(dir / "other", 0, strange);
  EXPECT_NE(window.refusal("review.against", (dir / "other").string()), "");
  EXPECT_NE(window.refusal("review.against", (dir / "none").string()).find("no labels"),
            std::string::npos);
  EXPECT_EQ(view().compare_with, "");
}

TEST_F(LabelReview, IsUpdatedWhenLabelsChange) {
  const std::size_t before = queue().items.size();
  window.run("label.undo");
  EXPECT_LT(queue().items.size(), before);
}

TEST_F(LabelReview, DrawingDoesNotMoveTheViews) {
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

TEST_F(LabelReview, ChecksOpenTheirLocations) {
  window.run("label.class.v", "1");  // a floor
  window.run("check.next");
  ASSERT_NE(state().results.label.audit, nullptr);
  const std::vector<labels::Finding>& findings = state().results.label.audit->findings;
  const auto contradicts =
      std::ranges::find(findings, labels::FindingKind::class_normal, &labels::Finding::kind);
  ASSERT_NE(contradicts, findings.end());
  EXPECT_EQ(view().tab, "checks");
  EXPECT_EQ(view().finding, 0);
  const auto index = std::to_string(contradicts - findings.begin());
  play(R"({"click": "checks.)" + index + R"("})");
  EXPECT_EQ(view().plane, contradicts->plane);
  EXPECT_EQ(std::to_string(view().finding), index);
}

TEST_F(LabelReview, StatisticsShowTimeAndGestures) {
  window.run("tab.label", "statistics");
  EXPECT_TRUE(window.shows("statistics.frame"));
  EXPECT_TRUE(window.shows("statistics.history"));
  ASSERT_EQ(state().results.label.work.size(), 1u);
  EXPECT_EQ(state().results.label.work[0].gestures, 2u);
}

}  // namespace
}  // namespace planescope::desktop
