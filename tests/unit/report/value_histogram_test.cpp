#include "core/report/page/value_histogram.hpp"

#include <gtest/gtest.h>

#include "core/model/random.hpp"

namespace planescope::report {
namespace {

/// A floor, a shelf and a wall, with noise.
struct Decided {
  planes::SegmentOptions options;
  planes::Trace trace;
  planes::Segmentation segmentation;

  explicit Decided(planes::Profile profile) : options(planes::profile_options(profile)) {
    std::vector<Vec3f> points;
    std::vector<Label> labels;
    Random random(3);
    for (int i = 0; i < 3000; ++i) {
      const auto u = static_cast<float>(random.uniform()), v = static_cast<float>(random.uniform());
      const auto noise = static_cast<float>(0.002 * random.uniform());
      const bool is_wall = i % 3 == 0;
      const float height = i % 3 == 1 ? 0 : 0.6F;
      points.push_back(is_wall ? Vec3f(noise, u, v) : Vec3f(u, v, height + noise));
      labels.push_back(is_wall ? Label::v : Label::h);
    }
    const planes::Cube cube = {Vec3d(-0.5, -0.5, -0.5), 2, 6};
    segmentation = planes::segment(points, labels, cube, Vec3d(1, 1, 1), options, &trace);
  }
  std::vector<ValueHistogram> histograms() const {
    return decision_histograms(segmentation, trace.strains, options);
  }
};

std::uint64_t within_threshold(const ValueHistogram& histogram) {
  std::uint64_t count = 0;
  for (std::size_t bin = 0; bin + 1 < histogram.counts.size(); ++bin)
    if (histogram.edge(bin) <= histogram.threshold + 1e-9) count += histogram.counts[bin];
  return count;
}

class ValueHistogramOf : public testing::TestWithParam<planes::Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles,
                         ValueHistogramOf,
                         testing::Values(planes::Profile::paper,
                                         planes::Profile::paper_closest,
                                         planes::Profile::refined));

TEST_P(ValueHistogramOf, CountsEveryNodeAndWhatWasDecidedOfIt) {
  const Decided decided(GetParam());
  const std::vector<ValueHistogram> histograms = decided.histograms();
  ASSERT_EQ(histograms.size(), 4u);
  const planes::SegmentCounts& counts = decided.segmentation.counts;
  EXPECT_EQ(histograms[0].name, "n_out");
  EXPECT_EQ(histograms[0].total(), counts.nodes_visited);
  // Pure nodes are within the threshold, all of case I above it or of too large a share.
  EXPECT_GE(within_threshold(histograms[0]), counts.nodes_visited - counts.nodes_per_case[1]);
  EXPECT_EQ(histograms[1].name, "planarity");
  EXPECT_GE(within_threshold(histograms[1]), counts.nodes_per_case[4]);
  EXPECT_GE(histograms[1].total() - within_threshold(histograms[1]), counts.nodes_per_case[3]);
}

TEST_P(ValueHistogramOf, HoldsAPairPerCandidateThatHadAPlaneToJoin) {
  const Decided decided(GetParam());
  const std::vector<ValueHistogram> histograms = decided.histograms();
  for (const std::size_t k : {2u, 3u}) {
    EXPECT_GT(histograms[k].total(), 0u);
    EXPECT_LT(histograms[k].total(), decided.segmentation.counts.candidates);
    EXPECT_GE(within_threshold(histograms[k]), histograms[k].total() / 2);
  }
}

TEST(ValueHistogram, AddsUpOverFrames) {
  ValueHistogram sum{"planarity", 4, 1, {1, 0, 2}};
  add_to(sum, {"planarity", 4, 1, {3, 1, 0}});
  add_to(sum, {"n_out", 4, 1, {9, 9, 9}});  // of something else
  EXPECT_EQ(sum.counts, (std::vector<std::uint32_t>{4, 1, 2}));
  EXPECT_EQ(sum.total(), 7u);
}

TEST(ValueHistogram, IsNotThereWithoutAnOctree) {
  EXPECT_TRUE(decision_histograms({}, {}, {}).empty());
}

}  // namespace
}  // namespace planescope::report
