#include "core/debug/filter/filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "replay_subject.hpp"

namespace planescope::debug {
namespace {

std::shared_ptr<const Run> run_of(planes::Profile profile, double noise_m = 0.003) {
  return make_run(test::stair_subject(noise_m), test::options_of(profile));
}

std::vector<std::int32_t> steps_of(const Run& run, const std::string& text) {
  FilterProblem problem;
  const auto filter = Filter::parse(text, problem);
  EXPECT_TRUE(filter.has_value()) << text << ": " << problem.message;
  if (!filter) return {};
  const std::vector<std::int32_t> steps = filter->matching(run);
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    EXPECT_EQ(filter->matches(run, step), std::binary_search(steps.begin(), steps.end(), step));
  return steps;
}

/// The steps whose event has the property.
std::vector<std::int32_t> steps_where(const Run& run,
                                      const std::function<bool(const planes::TraceEvent&)>& has) {
  std::vector<std::int32_t> steps;
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    if (has(*run.event_at(step))) steps.push_back(step);
  return steps;
}

TEST(Filter, AnEmptyTextMatchesEveryEvent) {
  const auto run = run_of(planes::Profile::paper);
  EXPECT_EQ(steps_of(*run, " ").size(), run->trace.events.size());
}

TEST(Filter, KindsOfEventsPartTheTrace) {
  const auto run = run_of(planes::Profile::refined);
  std::size_t sum = 0;
  for (const char* kind :
       {"visit", "decide", "found", "merge", "assign", "drop", "refine", "wait", "leave"})
    sum += steps_of(*run, kind).size();
  EXPECT_EQ(sum, run->trace.events.size());
}

TEST(Filter, FindsCasesByDepthAndError) {
  const auto run = run_of(planes::Profile::paper);
  const auto expected = steps_where(*run, [&](const planes::TraceEvent& e) {
    return e.type == planes::EventType::decide && e.node_case == 4 &&
           run->octree().nodes[e.node].depth >= 4 &&
           run->facts[e.node].fit.eigenvalues[0] > 0.1 * 0.005;
  });
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(steps_of(*run, "case==IV && depth>=4 && mse>0.1*theta_mse"), expected);
  EXPECT_EQ(steps_of(*run, "!(case!=IV || 4>depth || mse<=theta_e_n_m2/10) && decide && case==IV"),
            expected);
}

TEST(Filter, TheErrorIsKnownOnlyWhereCriterion3Asked) {
  const auto run = run_of(planes::Profile::paper);
  EXPECT_TRUE(steps_of(*run, "mse>=0 && (case==I || case==II)").empty());
  EXPECT_EQ(steps_of(*run, "mse>=0"), steps_of(*run, "case==III || case==IV"));
}

TEST(Filter, AnEventWithoutTheFieldMakesEveryComparisonFalse) {
  const auto run = run_of(planes::Profile::paper);
  EXPECT_EQ(steps_of(*run, "offset==0 || offset!=0"), steps_of(*run, "merge"));
  EXPECT_TRUE(steps_of(*run, "visit && n_out>=0").empty());
}

TEST(Filter, APlaneIsFoundInBothItsPlaces) {
  const auto run = run_of(planes::Profile::refined);
  const auto expected =
      steps_where(*run, [](const planes::TraceEvent& e) { return e.plane == 0 || e.other == 0; });
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(steps_of(*run, "plane==1"), expected);
  EXPECT_EQ(steps_of(*run, "P1==plane"), expected);
  const auto others =
      steps_where(*run, [](const planes::TraceEvent& e) { return e.plane > 0 && e.other != 0; });
  EXPECT_EQ(steps_of(*run, "plane!=P1"), others);
}

TEST(Filter, APointIsFoundInItsNodesAndInWhatChangesItsPlane) {
  const auto run = run_of(planes::Profile::refined);
  for (const std::int32_t point : {0, 500, 1500}) {
    const auto steps = steps_of(*run, "point==" + std::to_string(point));
    for (const planes::PointChange& change : run->timeline.changes_of_point(point))
      EXPECT_TRUE(std::binary_search(steps.begin(), steps.end(), change.step));
    for (const std::int32_t node : run->timeline.path_of_point(point))
      EXPECT_TRUE(std::binary_search(steps.begin(), steps.end(), run->timeline.visited_at()[node]));
    EXPECT_LT(steps.size(), run->trace.events.size());
  }
  EXPECT_TRUE(steps_of(*run, "point==1e9").empty());
  EXPECT_TRUE(steps_of(*run, "point==0.5").empty());
}

TEST(Filter, ThresholdsAreThoseOfTheRun) {
  auto subject = test::stair_subject(0.003);
  planes::PipelineOptions options = test::options_of(planes::Profile::paper);
  options.segment.theta_n_in = 17;
  const auto run = make_run(subject, options);
  EXPECT_EQ(steps_of(*run, "decide && n_in<theta_n_in && n_out==0"),
            steps_of(*run, "decide && n_in<17 && n_out==0"));
}

TEST(Filter, TruthFindsTheMergeThatFusesTwoSteps) {
  // The paper's Criterion 4 looks at directions only.
  auto subject = test::stair_subject(0.003);
  planes::PipelineOptions options = test::options_of(planes::Profile::paper);
  options.segment.theta_coplane = 0.5;
  const auto run = make_run(subject, options);
  const auto steps = steps_of(*run, "merge && truth.wrong");
  ASSERT_FALSE(steps.empty());
  const planes::TraceEvent& first = *run->event_at(steps.front());
  EXPECT_GT(first.value, 0.02f) << describe_event(*run, steps.front());
  const auto founded = steps_of(*run, "found && plane==" + plane_name(first.plane));
  ASSERT_EQ(founded.size(), 1u);
  const std::int32_t founder = run->event_at(founded[0])->node;
  EXPECT_NE(run->facts[first.node].truth_plane, run->facts[founder].truth_plane);
  EXPECT_TRUE(steps_of(*run_of(planes::Profile::refined, 0), "merge && truth.wrong").empty());
}

TEST(Filter, WithoutTruthNothingIsWrong) {
  auto subject = test::stair_subject(0.003);
  subject->voxel_truth = {};
  const auto run = make_run(subject, test::options_of(planes::Profile::paper));
  EXPECT_TRUE(steps_of(*run, "truth.wrong || truth.mixed || truth.plane>=0").empty());
}

TEST(Filter, ThePlaceIsInTheWorld) {
  const auto run = run_of(planes::Profile::paper);
  const auto expected = steps_where(*run, [&](const planes::TraceEvent& e) {
    if (e.type != planes::EventType::assign && e.type != planes::EventType::drop) return false;
    return run->subject->prepared.voxels.points[e.point].z() > 0.2f;
  });
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(steps_of(*run, "(assign || drop) && z>0.2"), expected);
}

}  // namespace
}  // namespace planescope::debug
