#include "core/debug/replay/run.hpp"

#include <gtest/gtest.h>

#include "replay_subject.hpp"

namespace planescope::debug {
namespace {

TEST(Run, FactsAgreeWithWhatWasDecided) {
  for (const planes::Profile profile :
       {planes::Profile::paper, planes::Profile::paper_closest, planes::Profile::refined}) {
    const auto run = make_run(test::stair_subject(0.003), test::options_of(profile));
    for (const planes::TraceEvent& event : run->trace.events) {
      if (event.type != planes::EventType::decide) continue;
      const NodeFacts& facts = run->facts[event.node];
      const auto decided = static_cast<planes::Case>(event.node_case);
      EXPECT_EQ(planes::is_pure(facts.purity, run->segment_options), decided != planes::Case::I);
      if (decided == planes::Case::III || decided == planes::Case::IV) {
        EXPECT_EQ(facts.e_n <= facts.theta_e_n, decided == planes::Case::IV);
      }
    }
  }
}

TEST(Run, FactsCountTheTruePlanesOfEachNode) {
  const auto run = make_run(test::stair_subject(), test::options_of(planes::Profile::paper));
  const NodeFacts& root = run->facts[0];
  EXPECT_EQ(root.truth_planes, 5u);
  EXPECT_EQ(root.truth_plane, 1);
  EXPECT_EQ(root.truth_points, 600u);
  EXPECT_EQ(root.truth_known, run->segmentation.plane_of.size());
}

TEST(Run, EveryEventHasASentenceOfItsOwn) {
  planes::PipelineOptions options = test::options_of(planes::Profile::refined);
  options.segment.split_disconnected.rule = planes::SplitRule::on;
  options.segment.split_disconnected.gap_m = 0.025;
  const auto run = make_run(test::subject_of(test::random_cloud(4)), options);
  for (std::int32_t step = 0; step <= run->steps(); ++step) {
    const std::string text = describe_event(*run, step);
    EXPECT_GT(text.size(), 10u);
    EXPECT_EQ(text.find('?'), std::string::npos) << text;
    EXPECT_EQ(text.find("P0"), std::string::npos) << text;
    EXPECT_EQ(text.find("-1"), std::string::npos) << text;
  }
  EXPECT_EQ(describe_event(*run, 1).substr(0, 16), "node 0 (depth 0)");
}

TEST(Run, ASceneWithoutPointsHasNoSteps) {
  auto subject = std::make_shared<Subject>();
  const auto run = make_run(subject, test::options_of(planes::Profile::refined));
  EXPECT_EQ(run->steps(), 0);
  EXPECT_EQ(run->timeline.plane_count(), 0);
}

}  // namespace
}  // namespace planescope::debug
