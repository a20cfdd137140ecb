#include "core/debug/explain/provenance.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/planes/pipeline/options_table.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

planes::SegmentOptions split_options() {
  planes::SegmentOptions options = planes::profile_options(planes::Profile::refined);
  options.split_disconnected.rule = planes::SplitRule::on;
  options.split_disconnected.gap_m = 0.025;
  return options;
}

/// Every point of a few clouds under every profile.
template <typename Check>
void on_every_point(Check check) {
  for (const planes::SegmentOptions& options :
       {planes::profile_options(planes::Profile::paper),
        planes::profile_options(planes::Profile::paper_closest),
        planes::profile_options(planes::Profile::refined), split_options()})
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const auto run = test::run_of_cloud(seed, options);
      for (std::size_t i = 0; i < run->subject->voxel_count(); i += 5) check(*run, i);
    }
}

TEST(Provenance, ALifeIsInOrderAndEndsWithTheResult) {
  on_every_point([](const planescope::debug::Run& run, std::size_t i) {
    const std::vector<LifeEvent> life = life_of(run, i);
    ASSERT_GE(life.size(), 5u);
    EXPECT_EQ(life.front().stage, "pixel");
    EXPECT_EQ(life.back().stage, "result");
    EXPECT_EQ(life.back().text.rfind("in no plane", 0) == 0, run.segmentation.plane_of[i] == 0);
    std::int32_t step = 0;
    for (const LifeEvent& event : life) {
      EXPECT_FALSE(event.text.empty());
      if (event.step < 0) continue;
      EXPECT_GT(event.step, step);
      step = event.step;
    }
  });
}

TEST(Provenance, OneDecisionIsToBlameAndStandsInTheLife) {
  on_every_point([](const planescope::debug::Run& run, std::size_t i) {
    const WhyNot why = why_not(run, i);
    ASSERT_GT(why.step, 0) << why.answer;
    const std::vector<LifeEvent> life = life_of(run, i);
    EXPECT_EQ(std::count_if(life.begin(), life.end(),
                            [](const LifeEvent& event) { return event.decisive; }),
              1)
        << why.answer;
    EXPECT_EQ(why.answer.rfind("Lost", 0) == 0, run.segmentation.plane_of[i] == 0) << why.answer;
    planes::PipelineOptions options = run.options;
    if (!why.remedy.option.empty()) {
      EXPECT_NO_THROW(planes::set_option(options, why.remedy.option, why.remedy.value));
    }
  });
}

TEST(Provenance, WhatWasCroppedOrNeverMeasuredSaysSo) {
  const auto subject = test::stairs_subject(0, 0);
  subject->point_of_source[3] = planes::kNoVoxel;
  subject->prepared.voxels.voxel_of[4] = planes::kNoVoxel;
  const auto run = make_run(subject, {});
  EXPECT_NE(why_not(*run, 3).answer.find("nothing was measured"), std::string::npos);
  EXPECT_NE(why_not(*run, 4).answer.find("cropped"), std::string::npos);
  EXPECT_NE(why_not(*run, 1u << 30).answer.find("no such point"), std::string::npos);
  EXPECT_EQ(why_not(*run, 3).step, -1);
  EXPECT_LE(life_of(*run, 3).size(), 2u);
}

TEST(Provenance, ARemedyKeepsWhatItPromises) {
  // A node too small for a plane: with the smaller threshold it is asked.
  const auto run =
      test::run_of_stairs(planes::profile_options(planes::Profile::paper_closest), 0.003);
  int tried = 0;
  for (std::size_t i = 0; i < run->subject->voxel_count() && tried < 5; ++i) {
    const WhyNot why = why_not(*run, i);
    if (why.remedy.option != "theta_n_in") continue;
    planes::PipelineOptions options = run->options;
    planes::set_option(options, why.remedy.option, why.remedy.value);
    const auto changed = make_run(run->subject, options);
    EXPECT_NE(changed->octree().nodes[why.node].decided, planes::Case::II) << why.remedy.text;
    ++tried;
  }
  EXPECT_GT(tried, 0);
}

TEST(Provenance, APointInTheWrongPlaneNamesTheMergeThatFusedTheTwo) {
  planes::SegmentOptions options = planes::profile_options(planes::Profile::paper);
  options.theta_coplane = 0.3;  // steps fuse
  const auto run = test::run_of_stairs(options, 0.003);
  const VoxelTruth& truth = run->subject->voxel_truth;
  int fused = 0;
  for (std::size_t i = 0; i < truth.plane.size(); i += 10) {
    const WhyNot why = why_not(*run, i);
    if (why.answer.find("were fused") == std::string::npos) continue;
    ASSERT_NE(run->event_at(why.step), nullptr);
    EXPECT_EQ(run->event_at(why.step)->type, planes::EventType::merge);
    EXPECT_EQ(why.remedy.option, "merge_offset_m");
    ++fused;
  }
  EXPECT_GT(fused, 0);
}

}  // namespace
}  // namespace planescope::debug
