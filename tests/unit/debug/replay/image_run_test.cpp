// Runs on the pixels of a depth image: points follow their planes, and decisions name their
// criterion.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/debug/filter/filter.hpp"
#include "core/debug/replay/run.hpp"
#include "core/debug/replay/steps.hpp"
#include "support/box_scene.hpp"

namespace planescope::debug {
namespace {

using planes::EventType;
using planes::Stage;

bool is_growth(const Run& run, std::int32_t step) {
  return step > 0 && step <= run.steps() && run.event_at(step)->stage == Stage::grow;
}

/// Steps from the first to the last, except those within a round of growth, whose events are
/// written plane by plane.
std::vector<std::int32_t> some_steps(const Run& run) {
  std::set<std::int32_t> steps = {0, run.steps()};
  for (std::int32_t k = 1; k < 20; ++k) {
    std::int32_t step = run.steps() * k / 20;
    while (is_growth(run, step + 1)) ++step;
    steps.insert(step);
  }
  for (std::int32_t step = 1; step < run.steps(); ++step)
    if (is_growth(run, step) && !is_growth(run, step + 1)) steps.insert(step);
  return {steps.begin(), steps.end()};
}

std::vector<std::int32_t> steps_matching(const Run& run, const std::string& text) {
  FilterProblem problem;
  const auto filter = Filter::parse(text, problem);
  EXPECT_TRUE(filter) << problem.message;
  return filter ? filter->matching(run) : std::vector<std::int32_t>();
}

TEST(ImageRun, HasEveryStage) {
  const auto& run = *test::box_run();
  ASSERT_TRUE(run.is_on_image());
  EXPECT_GE(run.segmentation.planes.size(), 5u);
  std::set<Stage> seen;
  for (const planes::TraceEvent& event : run.trace.events) seen.insert(event.stage);
  for (const Stage stage : {Stage::criteria, Stage::join, Stage::grow, Stage::hidden, Stage::list})
    EXPECT_TRUE(seen.contains(stage)) << planes::to_string(stage);
}

TEST(ImageRun, TracingDoesNotChangeTheResult) {
  const auto& run = *test::box_run();
  const auto untraced =
      planes::find_regions(run.subject->frame, run.subject->prepared, run.options);
  EXPECT_EQ(run.segmentation.plane_of, untraced.segmentation.plane_of);
  EXPECT_EQ(run.segmentation.planes.size(), untraced.segmentation.planes.size());
}

TEST(ImageRun, APointFollowsItsPlaneThroughJoins) {
  const auto& run = *test::box_run();
  const Timeline& timeline = run.timeline;
  const auto points = static_cast<std::int32_t>(run.subject->voxel_count());
  for (const std::int32_t step : some_steps(run)) {
    std::map<std::int32_t, double> count;
    for (std::int32_t p = 0; p < points; ++p)
      if (const std::int32_t plane = timeline.point_at(p, step).plane; plane >= 0) ++count[plane];
    for (std::int32_t plane = 0; plane < timeline.plane_count(); ++plane) {
      const planes::PlaneChange* now = timeline.plane_at(plane, step);
      const double expected = now && now->alive ? now->moments.count : 0;
      ASSERT_EQ(count.contains(plane) ? count[plane] : 0, expected) << plane << " at " << step;
    }
  }
  for (std::int32_t p = 0; p < points; ++p) {
    const std::int32_t plane = timeline.point_at(p, run.steps()).plane;
    ASSERT_EQ(plane >= 0 ? timeline.result_of_plane(plane) : 0, run.segmentation.plane_of[p]) << p;
  }
}

TEST(ImageRun, TheChangesOfAPointAreItsStatesFromTheirStepsOn) {
  const auto& run = *test::box_run();
  bool joins = false;
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(run.subject->voxel_count()); p += 501) {
    const auto changes = run.timeline.changes_of_point(p);
    ASSERT_FALSE(changes.empty());
    for (std::size_t k = 0; k < changes.size(); ++k) {
      if (k > 0) {
        ASSERT_LT(changes[k - 1].step, changes[k].step);
      }
      const planes::PointChange now = run.timeline.point_at(p, changes[k].step);
      EXPECT_EQ(now.step, changes[k].step);
      EXPECT_EQ(now.plane, changes[k].plane);
      joins = joins || run.event_at(changes[k].step)->stage == Stage::join;
    }
    EXPECT_EQ(run.timeline.point_at(p, run.steps()).plane, changes.back().plane);
  }
  EXPECT_TRUE(joins);
}

TEST(ImageRun, AStateHasThePointsOfTheTimeline) {
  const auto& run = *test::box_run();
  StateWalk walk(run);
  for (const std::int32_t step : some_steps(run)) {
    const planes::SegmentState& state = walk.advance_to(step);
    for (std::size_t i = 0; i < run.octree().order.size(); i += 97)
      ASSERT_EQ(
          state.plane_of[i],
          run.timeline.point_at(static_cast<std::int32_t>(run.octree().order[i]), step).plane);
  }
}

TEST(ImageRun, ADecisionReportsValueAndLimitOfItsCriterion) {
  const auto& run = *test::box_run();
  const planes::ObjectiveOptions& options = run.options.segment.objective;
  const std::string limit = fmt::format("{:.3g} times the expected", options.flat);
  std::map<planes::Case, int> seen;
  for (std::size_t n = 0; n < run.octree().nodes.size(); ++n) {
    const NodeFacts& facts = run.facts[n];
    const std::string text = decision_text(run, static_cast<std::int32_t>(n));
    const planes::Case decided = run.octree().nodes[n].decided;
    ++seen[decided];
    switch (decided) {
      case planes::Case::I:
        EXPECT_GT(facts.e_n, options.two_planes * options.merge_cost);
        EXPECT_TRUE(text == "case I, part of it is not flat" ||
                    (text.starts_with("case I, two planes cost ") && text.ends_with(" > 3")))
            << text;
        break;
      case planes::Case::II:
        EXPECT_TRUE(text.starts_with("case II, ") && text.ends_with(" % filled < 40 %")) << text;
        break;
      case planes::Case::III:
        EXPECT_GT(facts.e_n, options.flat);
        EXPECT_TRUE(text.starts_with("case III, variance ") && text.ends_with(" > " + limit))
            << text;
        break;
      default:
        EXPECT_LE(facts.e_n, options.flat);
        EXPECT_TRUE(text.starts_with("case IV, variance ") && text.ends_with(" ≤ " + limit))
            << text;
    }
    EXPECT_EQ(facts.fit.count, run.octree().nodes[n].size());
  }
  EXPECT_EQ(seen.size(), 4u) << "every case";
}

TEST(ImageRun, AnEndingRegionIsNotReportedAsChanged) {
  const auto& run = *test::box_run();
  bool ends = false;
  for (std::int32_t step = 1; step <= run.steps(); ++step) {
    const planes::TraceEvent& event = *run.event_at(step);
    if (event.stage != Stage::grow || run.timeline.plane_at(event.plane, step)->alive) continue;
    ends = true;
    EXPECT_NE(describe_event(run, step).find("too few to grow"), std::string::npos);
    EXPECT_GE(event.value, 0);
  }
  EXPECT_TRUE(ends);
}

TEST(ImageRun, ATruePlaneThatIsNotListedIsWrong) {
  const auto& run = *test::box_run();
  const auto voxel = static_cast<std::int32_t>(run.subject->voxel_of_source(test::kSmallBoxPixel));
  const std::int32_t step = run.timeline.point_at(voxel, run.steps()).step;
  ASSERT_EQ(run.event_at(step)->stage, Stage::list);
  EXPECT_TRUE(run.wrong[static_cast<std::size_t>(step - 1)]);
}

TEST(ImageRun, AJoinOfTwoTruePlanesIsWrong) {
  planes::PipelineOptions options = test::image_options();
  options.segment.objective.merge_cost = 1e5;
  options.segment.objective.two_planes = 3e-5;  // so that the cells do not change
  const auto run = make_run(test::box_run()->subject, options);
  EXPECT_FALSE(steps_matching(*run, "stage==join && truth.wrong").empty());
}

TEST(ImageRun, FiltersKnowItsStagesAndValues) {
  const auto& run = *test::box_run();
  EXPECT_FALSE(steps_matching(run, "stage==list").empty());
  EXPECT_EQ(steps_matching(run, "stage==list && value<worth_px"),
            steps_matching(run, "stage==list && refine"));
  EXPECT_EQ(steps_matching(run, "merge"), steps_matching(run, "stage==join || stage==hidden"));
  EXPECT_EQ(steps_matching(run, "stage==join && value<merge_cost"),
            steps_matching(run, "stage==join"));
  EXPECT_EQ(steps_matching(run, "case==IV && value<=flat"), steps_matching(run, "case==IV"));
  EXPECT_EQ(steps_matching(run, "case==II && value<filled"), steps_matching(run, "case==II"));
  for (const char* word : {"n_in", "n_out", "r_out", "n_h", "n_v", "mse", "theta_mse"})
    EXPECT_TRUE(steps_matching(run, std::string(word) + ">=0").empty()) << word;
  EXPECT_TRUE(steps_matching(run, "decide && (label==h || label==v)").empty());
}

}  // namespace
}  // namespace planescope::debug
