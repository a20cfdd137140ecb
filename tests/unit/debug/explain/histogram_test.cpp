#include "core/debug/explain/histogram.hpp"

#include <gtest/gtest.h>

#include "runs.hpp"

namespace planescope::debug {
namespace {

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

TEST(Histograms, EachNodeStandsWhereItsCriterionWasAsked) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const std::vector<Histogram> histograms = histograms_of(*run);
  const planes::SegmentCounts& counts = run->segmentation.counts;
  EXPECT_EQ(total(named(histograms, "N_out")), counts.nodes_visited);
  EXPECT_EQ(total(named(histograms, "N_in")), counts.nodes_visited - counts.nodes_per_case[1]);
  EXPECT_EQ(total(named(histograms, "e_n")), counts.nodes_per_case[3] + counts.nodes_per_case[4]);
  EXPECT_EQ(total(named(histograms, "leftover's distance")), counts.leftovers);
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

TEST(Histograms, WithoutTruthNothingIsRightOrWrong) {
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
