// Explanations of a depth image's nodes, regions and pixels.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/debug/explain/explain.hpp"
#include "core/debug/explain/histogram.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/debug/explain/score.hpp"
#include "core/debug/explain/trace_text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "support/box_scene.hpp"

namespace planescope::debug {
namespace {

std::shared_ptr<const Run> with_option(const Run& run, const Remedy& remedy) {
  planes::PipelineOptions options = run.options;
  planes::find_option(remedy.option).set(options, remedy.value);
  return make_run(run.subject, options);
}

TEST(ImageExplain, ANodeFailsTheCriterionOfItsCase) {
  const auto& run = *test::box_run();
  for (std::size_t n = 0; n < run.octree().nodes.size(); n += 7) {
    const NodeReport report = explain_node(run, static_cast<std::int32_t>(n));
    const char* failed = "";
    for (const Check& check : report.checks)
      if (check.verdict == Verdict::fail)
        failed = check.option == "filled" ? "II" : check.option == "two_planes" ? "I" : "III";
    const planes::Case decided = run.octree().nodes[n].decided;
    EXPECT_STREQ(failed, decided == planes::Case::IV ? "" : planes::to_string(decided)) << n;
    EXPECT_TRUE(report.outcome.starts_with(std::string("case ") + planes::to_string(decided)));
  }
}

TEST(ImageExplain, AJoinComparesItsCostWithThatOfAPlane) {
  const auto& run = *test::box_run();
  int joins = 0;
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    if (!is_join(*run.event_at(step))) continue;
    ++joins;
    const MergeReport report = explain_merge(run, step);
    ASSERT_EQ(report.partners.size(), 1u);
    EXPECT_EQ(report.partners[0].plane, run.event_at(step)->other);
    EXPECT_TRUE(all_pass(report.partners[0].checks));
    EXPECT_EQ(report.points, run.timeline.plane_at(run.event_at(step)->plane, step)->moments.count);
  }
  EXPECT_GT(joins, 0);
}

TEST(ImageExplain, APlaneThatIsNotListedIsListedWithTheProposedWorth) {
  const auto& run = *test::box_run();
  const WhyNot why = why_not(run, test::kSmallBoxPixel);
  EXPECT_NE(why.answer.find(" px are worth "), std::string::npos) << why.answer;
  ASSERT_EQ(why.remedy.option, "worth_px");
  const auto listed = with_option(run, why.remedy);
  EXPECT_GT(listed->segmentation.plane_of[listed->subject->voxel_of_source(test::kSmallBoxPixel)],
            0);
}

TEST(ImageExplain, AFusedPixelReportsTheJoinAndTheCostThatPreventsIt) {
  int named = 0;
  // some of these values join two true planes
  for (const double merge_cost : {3e3, 1e4, 3e4, 1e5}) {
    planes::PipelineOptions options = test::image_options();
    options.segment.objective.merge_cost = merge_cost;
    options.segment.objective.two_planes = 3 / merge_cost;  // so that the cells do not change
    const auto run = make_run(test::box_run()->subject, options);
    for (std::size_t source = 0; source < run->subject->point_of_source.size(); source += 3001) {
      const WhyNot why = why_not(*run, source);
      if (why.answer.find("they were merged") == std::string::npos) continue;
      ++named;
      EXPECT_TRUE(is_join(*run->event_at(why.step)));
      EXPECT_TRUE(why.remedy.option == "merge_cost" || why.remedy.option == "hidden_share");
      EXPECT_LE(std::stod(why.remedy.value), run->event_at(why.step)->value);
    }
  }
  EXPECT_GT(named, 0);
}

TEST(ImageExplain, EveryPixelHasAHistoryAndUnassignedOnesACause) {
  const auto& run = *test::box_run();
  for (std::size_t source = 0; source < run.subject->point_of_source.size(); source += 1501) {
    EXPECT_GE(history_of(run, source).size(), 4u);
    const auto voxel = run.subject->voxel_of_source(source);
    if (voxel == planes::kNoVoxel || run.segmentation.plane_of[voxel] > 0) continue;
    const WhyNot why = why_not(run, source);
    EXPECT_TRUE(why.answer.starts_with("Lost at step ")) << why.answer;
  }
}

TEST(ImageExplain, ASummaryHasAReasonForEachPointOnNoPlane) {
  const auto& run = *test::box_run();
  const FrameSummary summary = summary_of(run);
  EXPECT_EQ(summary.measured, run.subject->point_of_source.size());
  EXPECT_EQ(summary.planes, static_cast<int>(run.segmentation.planes.size()));
  std::size_t points = summary.on_planes;
  const Lost* box = nullptr;
  for (const Lost& lost : summary.lost) {
    points += lost.sources;
    EXPECT_EQ(lost.voxels.size(), lost.sources) << "a pixel is a voxel";
    for (const std::uint32_t voxel : lost.voxels) EXPECT_EQ(run.segmentation.plane_of[voxel], 0);
    EXPECT_TRUE(std::ranges::binary_search(lost.voxels, static_cast<std::uint32_t>(lost.middle)));
    if (std::ranges::binary_search(lost.voxels, run.subject->voxel_of_source(test::kSmallBoxPixel)))
      box = &lost;
  }
  EXPECT_EQ(points, summary.measured);
  ASSERT_TRUE(box);
  EXPECT_EQ(box->reason, "dropped planes: fewer than 14000 px");
  // With a shorter range, pixels beyond it have no voxel.
  Frame frame = run.subject->frame;
  planes::PipelineOptions near = run.options;
  near.cloud.max_range_m = 1;
  const FrameSummary cropped =
      summary_of(*make_run(make_subject(std::move(frame), {}, near, nullptr), near));
  const auto beyond = std::ranges::find(cropped.lost, "out of range", &Lost::reason);
  ASSERT_NE(beyond, cropped.lost.end());
  EXPECT_GT(cropped.share(beyond->sources), 0.1);
  EXPECT_EQ(beyond->middle, -1);
}

TEST(ImageExplain, HistogramsShowItsOwnCriteria) {
  const auto histograms = histograms_of(*test::box_run());
  ASSERT_EQ(histograms.size(), 5u);
  for (const Histogram& histogram : histograms)
    EXPECT_FALSE(histogram.bins.empty()) << histogram.title;
}

TEST(ImageExplain, TheTraceHasATextWithEveryStep) {
  const auto& run = *test::box_run();
  const std::string text = trace_text(run, &run);
  EXPECT_NE(text.find("step " + std::to_string(run.steps()) + ": "), std::string::npos);
  EXPECT_NE(text.find("by list"), std::string::npos);
}

}  // namespace
}  // namespace planescope::debug
