#include "core/debug/explain/explain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "runs.hpp"

namespace planescope {
namespace {

constexpr int kScenes = 12;

struct NamedOptions {
  const char* name;
  SegmentOptions options;
};

SegmentOptions with(Profile profile, void (*change)(SegmentOptions&)) {
  SegmentOptions options = profile_options(profile);
  change(options);
  return options;
}

class Explained : public testing::TestWithParam<NamedOptions> {
 protected:
  template <typename Check>
  void on_every_event(Check check) {
    for (int scene = 0; scene < kScenes; ++scene) {
      const auto run = scene % 2 == 0 ? test::run_of_cloud(scene, GetParam().options)
                                      : test::run_of_stairs(GetParam().options, 0.004, scene);
      for (std::int32_t step = 1; step <= run->steps(); ++step) {
        SCOPED_TRACE(testing::Message() << "scene " << scene << ", step " << step << ": "
                                        << describe_event(*run, step));
        check(*run, step, *run->event_at(step));
        if (HasFatalFailure()) return;
      }
    }
  }
};

bool all(const std::vector<Check>& checks, const char* criterion, Verdict verdict) {
  return std::all_of(checks.begin(), checks.end(), [&](const Check& check) {
    return check.criterion != criterion || check.verdict == verdict;
  });
}

TEST_P(Explained, NodesFailWhereTheirCaseSaysSo) {
  on_every_event([](const planescope::Run& run, std::int32_t, const TraceEvent& event) {
    if (event.type != EventType::decide) return;
    const NodeReport report = explain_node(run, event.node);
    const auto decided = static_cast<Case>(event.node_case);
    ASSERT_EQ(all(report.checks, "Criterion 1", Verdict::pass), decided != Case::I);
    ASSERT_EQ(all(report.checks, "Criterion 2", Verdict::pass), decided > Case::II);
    ASSERT_EQ(all(report.checks, "Criterion 2", Verdict::not_asked), decided == Case::I);
    ASSERT_EQ(all(report.checks, "Criterion 3", Verdict::pass), decided == Case::IV);
    ASSERT_EQ(all(report.checks, "Criterion 3", Verdict::not_asked), decided < Case::III);
    for (const Check& check : report.checks) {
      ASSERT_EQ(check.verdict == Verdict::not_asked, std::isnan(check.value)) << check.quantity;
      ASSERT_EQ(check.margin < 0, check.verdict == Verdict::fail) << check.quantity;
    }
    ASSERT_NE(report.outcome.find(to_string(decided)), std::string::npos) << report.outcome;
  });
}

TEST_P(Explained, RefinementFourHoldsExactlyWhereItWasUsed) {
  on_every_event([](const planescope::Run& run, std::int32_t, const TraceEvent& event) {
    if (event.type != EventType::decide) return;
    const std::vector<Check> checks = explain_node(run, event.node).checks;
    const bool asked = std::any_of(checks.begin(), checks.end(),
                                   [](const Check& check) { return check.criterion == "R4"; });
    ASSERT_EQ(asked && all(checks, "R4", Verdict::pass), run.octree().nodes[event.node].impure_fit);
  });
}

TEST_P(Explained, TheChosenPartnerIsTheOneOfTheRun) {
  on_every_event([](const planescope::Run& run, std::int32_t step, const TraceEvent& event) {
    const MergeReport report = explain_merge(run, step);
    std::int32_t chosen = -1;
    for (const PartnerReport& partner : report.partners) {
      if (partner.chosen) chosen = partner.plane;
      if (partner.never_asked) continue;
      // What is coplanar passes every check that is shown, and nothing else does.
      ASSERT_EQ(partner.coplanar,
                std::all_of(partner.checks.begin(), partner.checks.end(),
                            [](const Check& check) { return check.verdict == Verdict::pass; }));
    }
    std::int32_t expected = -1;
    if (event.type == EventType::merge) expected = event.plane;
    if (event.type == EventType::refine && event.stage == Stage::r7_second_merge)
      expected = event.other;
    ASSERT_EQ(chosen, expected);
    ASSERT_TRUE(chosen < 0 || report.partners.front().chosen);
    ASSERT_EQ(report.outcome.empty(), report.label == Label::unknown);
  });
}

TEST_P(Explained, ALeftoverGoesWhereTheRunPutIt) {
  on_every_event([](const planescope::Run& run, std::int32_t step, const TraceEvent& event) {
    const LeftoverReport report = explain_leftover(run, step);
    if (event.type != EventType::assign && event.type != EventType::drop) {
      ASSERT_TRUE(report.planes.empty());
      return;
    }
    ASSERT_EQ(report.point, event.point);
    std::int32_t chosen = -1;
    for (const LeftoverPlane& plane : report.planes) {
      ASSERT_EQ(plane.chosen, plane.why_not.empty());
      if (!plane.chosen) continue;
      chosen = plane.plane;
      ASSERT_FLOAT_EQ(static_cast<float>(plane.distance_m), event.value);
    }
    ASSERT_EQ(chosen, event.plane);
  });
}

INSTANTIATE_TEST_SUITE_P(
    Profiles,
    Explained,
    testing::Values(NamedOptions{"paper", profile_options(Profile::paper)},
                    NamedOptions{"paper_closest", profile_options(Profile::paper_closest)},
                    NamedOptions{"refined", profile_options(Profile::refined)},
                    NamedOptions{"paper_best_partner", with(Profile::paper,
                                                            [](SegmentOptions& o) {
                                                              o.merge_partner = MergePartner::best;
                                                              o.leftover_rule =
                                                                  LeftoverRule::nearest;
                                                            })},
                    NamedOptions{"paper_mean_without_labels", with(Profile::paper,
                                                                   [](SegmentOptions& o) {
                                                                     o.mse_normalization =
                                                                         MseNormalization::mean;
                                                                     o.use_labels = false;
                                                                   })},
                    NamedOptions{"refined_first_partner", with(Profile::refined,
                                                               [](SegmentOptions& o) {
                                                                 o.merge_partner =
                                                                     MergePartner::first;
                                                               })},
                    NamedOptions{"refined_split", with(Profile::refined,
                                                       [](SegmentOptions& o) {
                                                         o.split_disconnected.rule = SplitRule::on;
                                                       })}),
    [](const auto& param) { return param.param.name; });

TEST(Explain, AStopIsSaidInWords) {
  const auto run = test::run_of_stairs(profile_options(Profile::paper), 0.003);
  const NodeReport root = explain_node(*run, 0);
  EXPECT_EQ(root.stopped, "stopped at Criterion 1: no PCA was made");
  EXPECT_NE(root.outcome.find("divided into"), std::string::npos) << root.outcome;
  EXPECT_TRUE(explain_merge(*run, 1).partners.empty()) << "a visit is no merge";
  EXPECT_TRUE(explain_merge(*run, 0).outcome.empty());
}

}  // namespace
}  // namespace planescope
