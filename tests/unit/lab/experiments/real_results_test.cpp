#include "core/lab/experiments/real_results.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/lab/experiments/paper_plan.hpp"
#include "support/refusal.hpp"

namespace planescope::lab {
namespace {

planes::Metrics scored(double iou, int noise) {
  planes::Metrics m;
  m.planes_truth = 4;
  m.planes_found = 5;
  m.correct = m.detected_iou80 = 3;
  m.mean_iou = iou;
  m.noise = noise;
  return m;
}

SetScores of_seed(const std::string& set, std::uint64_t seed, double iou, int noise) {
  return {depth_of(set, seed, "d435"),
          {{with_ours({}, "refined", "gcn"), {scored(iou, noise), scored(iou, noise)}}}};
}

TEST(RealResults, ASetIsSummedUpOverItsSeedsAndAllSetsAsOne) {
  const std::vector<SetSummary> summaries =
      set_summaries({of_seed("depth_boxes", 1, 90, 1), of_seed("depth_slopes", 1, 80, 3),
                     of_seed("depth_boxes", 2, 94, 5), of_seed("depth_slopes", 2, 84, 3)});
  ASSERT_EQ(summaries.size(), 3u);
  const OverSeeds& boxes = summaries[0].figures[0];
  EXPECT_EQ(summaries[0].set, "depth_boxes");
  EXPECT_EQ(summaries[0].seeds, 2);
  EXPECT_DOUBLE_EQ(boxes.spread.mean, 92);
  EXPECT_DOUBLE_EQ(boxes.spread.deviation, std::sqrt(8.0));
  EXPECT_DOUBLE_EQ(boxes.worst, 90);
  EXPECT_EQ(summaries[2].set, "");
  EXPECT_EQ(summaries[2].frames, 4);
  EXPECT_DOUBLE_EQ(summaries[2].figures[0].spread.mean, 87);
  EXPECT_DOUBLE_EQ(summaries[2].figures[0].worst, 85);
  EXPECT_STREQ(seed_figures()[3].name, "noise_per_frame");
  EXPECT_DOUBLE_EQ(summaries[0].figures[3].worst, 5) << "the most noise is the worst";
}

LabelledScores labelled() {
  return {{{"a", Half::tuning, "rec", 0}, {"b", Half::tuning, "rec", 4}},
          {{with_ours({}, "refined", "gcn"), {scored(70, 1), scored(90, 2)}},
           {with_rival({}, "ransac"), {scored(75, 0), scored(60, 0)}}}};
}

TEST(RealResults, AHalfIsSummedUpOverItsFramesAndOneWithoutFramesIsLeftOut) {
  const std::vector<HalfSummary> summaries = half_summaries(labelled());
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_DOUBLE_EQ(summaries[0].mean_iou.mean, 80);
  EXPECT_EQ(summaries[0].metrics.noise, 3);
  EXPECT_EQ(planes::plane_precision(summaries[0].metrics), 60);
  EXPECT_EQ(planes::plane_recall(summaries[0].metrics), 75);
}

TEST(RealResults, TheTablesShowHowFarOursIsFromTheBestOther) {
  RealResults results;
  results.labelled = labelled();
  const std::vector<Table> tables = real_tables(results);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(tables[1].rows[0].back().substr(0, 4), "-5.0");
  EXPECT_EQ(tables[1].rows[1].back().substr(0, 5), "+30.0");
  const std::string json = real_json(results);
  EXPECT_NE(json.find("\"halves\": [\n  {\"half\":\"tuning\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"sets\": [\n ]"), std::string::npos) << json;
}

TEST(RealResults, AHalfHasOneOfTwoNames) {
  EXPECT_EQ(parse_half("printed"), Half::printed);
  expect_refused([] { parse_half("prnted"); }, "'prnted' is not a half");
}

}  // namespace
}  // namespace planescope::lab
