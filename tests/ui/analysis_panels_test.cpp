// The panels of point, histograms, A/B and fixes, by scripted clicks.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "app/desktop/debugger/histogram_axis.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct AnalysisPanels : OpenDesktop {
  const debug::Histogram& histogram(const std::string& quantity) const {
    for (const debug::Histogram& h : state().results.current->histograms)
      if (h.quantity == quantity) return h;
    throw std::runtime_error("no histogram of " + quantity);
  }
};

TEST_F(AnalysisPanels, ALineOfALifeLeadsToItsStepAndTheLifeStays) {
  play(R"({"do": "select.pixel", "with": "320,300"}, "point.life")");
  const std::size_t source = 300 * 640 + 320;
  const std::vector<debug::LifeEvent> life = debug::life_of(*state().run(), source);
  ASSERT_EQ(life[3].stage, "node");
  play(R"({"click": "point.life.3"})");
  EXPECT_EQ(state().view.step, life[3].step);
  play(R"({"click": "point.life.4"})");
  EXPECT_EQ(state().view.step, life[4].step);
}

TEST_F(AnalysisPanels, TheRemedyOfALostPointIsSetWhereItStands) {
  const planescope::debug::Run& run = *state().run();
  for (std::uint32_t voxel = 0; voxel < run.subject->voxel_count(); ++voxel) {
    if (run.segmentation.plane_of[voxel] > 0) continue;
    const debug::Remedy remedy =
        debug::why_not(run, debug::source_of_voxel(*run.subject, voxel)).remedy;
    if (remedy.option.empty()) continue;
    shell.perform({"select.voxel", std::to_string(voxel)});
    play(R"("point.life", {"click": "point.remedy"})");
    EXPECT_EQ(planes::find_option(remedy.option).get(state().document.options), remedy.value);
    EXPECT_EQ(state().undo.size(), 1u);
    return;
  }
  FAIL() << "no lost point with a remedy";
}

TEST_F(AnalysisPanels, ADragOverBarsMakesAFilter) {
  play(R"({"do": "tab.tool", "with": "histograms"},
          {"drag": "histograms.n_out", "from": [0.5, 0.5], "to": [0.9, 0.5]})");
  EXPECT_EQ(state().view.search.text.rfind("n_out>=", 0), 0u) << state().view.search.text;
  EXPECT_TRUE(state().view.search.filter);
  EXPECT_FALSE(state().view.search.matches.empty());
  EXPECT_TRUE(state().undo.empty());
}

TEST_F(AnalysisPanels, ADraggedThresholdStaysUnderTheMouse) {
  const debug::Histogram before = histogram("n_in");
  const HistogramAxis axis(before);
  const double from = axis.share(before.threshold);
  play(R"({"do": "tab.tool", "with": "histograms"})");
  play(fmt::format(R"({{"drag": "histograms.n_in", "from": [{}, 0.5], "to": [0.5, 0.5]}})", from));
  EXPECT_EQ(state().document.options.segment.theta_n_in, std::lround(axis.value(0.5)));
  EXPECT_EQ(state().undo.size(), 1u) << "one gesture";
}

TEST_F(AnalysisPanels, APinnedRunIsComparedWithTheNext) {
  play(R"({"do": "tab.tool", "with": "compare"}, {"click": "compare.pin"},
          {"do": "option.set", "with": "theta_n_in=8"}, {"click": "compare.diverging"})");
  ASSERT_TRUE(state().results.comparison);
  const debug::Comparison& comparison = *state().results.comparison;
  EXPECT_EQ(state().view.step, comparison.diverging_step_b);
  play(R"({"click": "compare.flash"})");
  EXPECT_TRUE(state().view.flash);
  EXPECT_EQ(state().run(), state().results.pinned->run.get());
  play(R"({"click": "compare.restore"})");
  EXPECT_EQ(state().document.options.segment.theta_n_in, 5);
}

TEST_F(AnalysisPanels, AFixIsFoundAndApplied) {
  shell.perform({"tab.tool", "fix"});
  settle(shell, stage, {});
  std::vector<debug::TruthMatch> matches = state().results.current->score->planes;
  std::sort(matches.begin(), matches.end(),
            [](const debug::TruthMatch& a, const debug::TruthMatch& b) { return a.iou < b.iou; });
  for (const debug::TruthMatch& match : matches) {
    ASSERT_LT(match.iou, 0.8) << "no lost plane that one change recovers";
    play(fmt::format(R"({{"do": "fix.plane", "with": "{}"}})", match.truth));
    ASSERT_TRUE(state().results.fix.finished);
    if (state().results.fix.fixes.empty()) continue;
    const debug::Fix fix = state().results.fix.fixes.front();
    play(R"({"click": "fix.check.0"})");
    EXPECT_EQ(state().results.fix.effects.size(), 3u) << "labelled frames of the sample";
    play(R"({"click": "fix.apply.0"})");
    EXPECT_EQ(planes::find_option(fix.option).get(state().document.options), fix.after);
    EXPECT_EQ(state().results.current->score->detected, fix.score.detected);
    return;
  }
}

TEST(HistogramAxis, SharesAndValuesAreEachOthersInverse) {
  debug::Histogram histogram;
  histogram.quantity = "mse";
  histogram.logarithmic = true;
  histogram.bins = {{0.001, 0.01}, {0.01, 0.1}, {0.1, 7}};
  const HistogramAxis axis(histogram);
  for (double share = 0; share < 1; share += 0.05)
    EXPECT_NEAR(axis.share(axis.value(share)), share, 1e-9);
  EXPECT_EQ(axis.share(0), 0);
  EXPECT_EQ(axis.share(100), 1);
  EXPECT_EQ(filter_between(histogram, 2.0 / 3, 1.0 / 3), "mse>=0.01 && mse<0.1");
}

}  // namespace
}  // namespace planescope::desktop
