// Tests of explanations of decisions, and of the histograms of their values.

#include "core/debug/explain/explain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/debug/explain/histogram.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

constexpr int kScenes = 12;

struct NamedOptions {
  const char* name;
  planes::SegmentOptions options;
};

planes::SegmentOptions with(planes::Profile profile, void (*change)(planes::SegmentOptions&)) {
  planes::SegmentOptions options = planes::profile_options(profile);
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

TEST_P(Explained, NodesFailTheCriterionOfTheirCase) {
  on_every_event([](const planescope::debug::Run& run, std::int32_t,
                    const planes::TraceEvent& event) {
    if (event.type != planes::EventType::decide) return;
    const NodeReport report = explain_node(run, event.node);
    const auto decided = static_cast<planes::Case>(event.node_case);
    ASSERT_EQ(all(report.checks, "Criterion 1", Verdict::pass), decided != planes::Case::I);
    ASSERT_EQ(all(report.checks, "Criterion 2", Verdict::pass), decided > planes::Case::II);
    ASSERT_EQ(all(report.checks, "Criterion 2", Verdict::not_evaluated),
              decided == planes::Case::I);
    ASSERT_EQ(all(report.checks, "Criterion 3", Verdict::pass), decided == planes::Case::IV);
    ASSERT_EQ(all(report.checks, "Criterion 3", Verdict::not_evaluated),
              decided < planes::Case::III);
    for (const Check& check : report.checks) {
      ASSERT_EQ(check.verdict == Verdict::not_evaluated, std::isnan(check.value)) << check.quantity;
      ASSERT_EQ(check.margin < 0, check.verdict == Verdict::fail) << check.quantity;
    }
    ASSERT_NE(report.outcome.find(planes::to_string(decided)), std::string::npos) << report.outcome;
  });
}

TEST_P(Explained, LabelsAreFittedExactlyIfTheRunFittedThem) {
  on_every_event(
      [](const planescope::debug::Run& run, std::int32_t, const planes::TraceEvent& event) {
        if (event.type != planes::EventType::decide) return;
        const std::vector<Check> checks = explain_node(run, event.node).checks;
        const bool asked = std::any_of(checks.begin(), checks.end(), [](const Check& check) {
          return check.criterion == "By label";
        });
        ASSERT_EQ(asked && all(checks, "By label", Verdict::pass),
                  run.octree().nodes[event.node].by_label);
      });
}

TEST_P(Explained, TheSelectedPartnerIsThatOfTheRun) {
  on_every_event(
      [](const planescope::debug::Run& run, std::int32_t step, const planes::TraceEvent& event) {
        const MergeReport report = explain_merge(run, step);
        std::int32_t chosen = -1;
        for (const PartnerReport& partner : report.partners) {
          if (partner.chosen) chosen = partner.plane;
          if (partner.not_evaluated) continue;
          // Exactly the coplanar partners pass all checks shown.
          ASSERT_EQ(partner.coplanar,
                    std::all_of(partner.checks.begin(), partner.checks.end(),
                                [](const Check& check) { return check.verdict == Verdict::pass; }));
        }
        std::int32_t expected = -1;
        if (event.type == planes::EventType::merge) expected = event.plane;
        if (event.type == planes::EventType::refine && event.stage == planes::Stage::join)
          expected = event.other;
        ASSERT_EQ(chosen, expected);
        ASSERT_TRUE(chosen < 0 || report.partners.front().chosen);
        ASSERT_EQ(report.outcome.empty(), report.label == Label::unknown);
      });
}

TEST_P(Explained, ALeftoverIsAssignedAsInTheRun) {
  on_every_event(
      [](const planescope::debug::Run& run, std::int32_t step, const planes::TraceEvent& event) {
        const LeftoverReport report = explain_leftover(run, step);
        if (event.type != planes::EventType::assign && event.type != planes::EventType::drop) {
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
    testing::Values(
        NamedOptions{"paper", planes::profile_options(planes::Profile::paper)},
        NamedOptions{"paper_closest", planes::profile_options(planes::Profile::paper_closest)},
        NamedOptions{"refined", planes::profile_options(planes::Profile::refined)},
        NamedOptions{"paper_best_partner", with(planes::Profile::paper,
                                                [](planes::SegmentOptions& o) {
                                                  o.merge_partner = planes::MergePartner::best;
                                                })},
        NamedOptions{"paper_mean_without_labels", with(planes::Profile::paper,
                                                       [](planes::SegmentOptions& o) {
                                                         o.mse_normalization =
                                                             planes::MseNormalization::mean;
                                                         o.use_labels = false;
                                                       })}),
    [](const auto& param) { return param.param.name; });

TEST(Explain, StopsAreDescribedInWords) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const NodeReport root = explain_node(*run, 0);
  EXPECT_EQ(root.stopped, "Stopped at Criterion 1: PCA was not computed");
  EXPECT_NE(root.outcome.find("divided into"), std::string::npos) << root.outcome;
  EXPECT_TRUE(explain_merge(*run, 1).partners.empty()) << "a visit is no merge";
  EXPECT_TRUE(explain_merge(*run, 0).outcome.empty());
}

const Histogram& named(const std::vector<Histogram>& histograms, const std::string& title) {
  for (const Histogram& h : histograms)
    if (h.title == title) return h;
  throw std::runtime_error("no histogram " + title);
}

std::uint32_t total(const Histogram& histogram) {
  std::uint32_t sum = 0;
  for (const HistogramBin& bin : histogram.bins) sum += bin.right + bin.wrong + bin.unknown;
  return sum;
}

TEST(Histograms, ContainTheNodesThatTheCriterionTested) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const std::vector<Histogram> histograms = histograms_of(*run);
  const planes::SegmentCounts& counts = run->segmentation.counts;
  EXPECT_EQ(total(named(histograms, "N_out")), counts.nodes_visited);
  EXPECT_EQ(total(named(histograms, "N_in")), counts.nodes_visited - counts.nodes_per_case[1]);
  EXPECT_EQ(total(named(histograms, "e_n")), counts.nodes_per_case[3] + counts.nodes_per_case[4]);
  EXPECT_EQ(total(named(histograms, "distance of unassigned points")), counts.leftovers);
  EXPECT_EQ(named(histograms, "e_n").threshold, 0.005);
}

TEST(Histograms, BinsAreOrderedAndFew) {
  for (const planes::Profile profile :
       {planes::Profile::paper, planes::Profile::paper_closest, planes::Profile::refined})
    for (const Histogram& h :
         histograms_of(*test::run_of_stairs(planes::profile_options(profile), 0.003))) {
      SCOPED_TRACE(h.title);
      ASSERT_FALSE(h.bins.empty());
      EXPECT_LE(h.bins.size(), 26u);
      for (std::size_t i = 0; i < h.bins.size(); ++i) {
        EXPECT_LT(h.bins[i].low, h.bins[i].high);
        if (i > 0) {
          EXPECT_EQ(h.bins[i].low, h.bins[i - 1].high);
        }
      }
    }
}

TEST(Histograms, WithoutTruthNothingIsCorrectOrWrong) {
  for (const Histogram& h :
       histograms_of(*test::run_of_cloud(3, planes::profile_options(planes::Profile::refined))))
    for (const HistogramBin& bin : h.bins) EXPECT_EQ(bin.right + bin.wrong, 0u) << h.title;
}

TEST(Histograms, NoisyStairsShowWrongMerges) {
  const auto histograms =
      histograms_of(*test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003));
  std::uint32_t wrong = 0;
  for (const HistogramBin& bin : named(histograms, "offset").bins) wrong += bin.wrong;
  EXPECT_GT(wrong, 0u);
}

}  // namespace
}  // namespace planescope::debug
