// Tests of the paper's experiments: cells, oracle and polygon distances.

#include "core/lab/experiments/measure_paper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/lab/bench/result_lines.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {
namespace {

CellTools tools() {
  CellTools tools;
  planes::PipelineOptions options;
  tools.gcn =
      planes::make_classifier(options, PLANESCOPE_SOURCE_DIR "/assets/classifier.safetensors")
          .classifier;
  tools.pca = planes::make_pca_classifier();
  return tools;
}

std::vector<CellKey> contestants(const CellKey& frames) {
  return {with_ours(frames, "refined", "truth"), with_ours(frames, "refined", "gcn"),
          with_ours(frames, "refined", "pca"), with_ours(frames, "refined", "none"),
          with_rival(frames, "oracle")};
}

TEST(MeasureCells, IsTheSameForEveryThreadCount) {
  const std::vector<CellKey> keys = contestants(clouds_of("stairs", 1001, 2048, 0.2));
  CellTools one = tools(), many = tools();
  many.threads = 3;
  const std::vector<Cell> a = measure_cells(keys, 3, one), b = measure_cells(keys, 3, many);
  for (std::size_t i = 0; i < keys.size(); ++i)
    EXPECT_EQ(with_metrics({}, a[i].metrics).dump(), with_metrics({}, b[i].metrics).dump());
}

TEST(MeasureCells, TheOracleIsRarelyBeatenAndTrueLabelsAreNotWorse) {
  for (const CellKey& frames :
       {clouds_of("stairs", 1001, 2048, 0.1), depth_of("depth_boxes", 1001, "d435")}) {
    const std::vector<Cell> cells = measure_cells(contestants(frames), 2, tools());
    const auto iou = [&](std::size_t i) { return cells[i].metrics.mean_iou; };
    EXPECT_GT(iou(4), 80) << frames.set;
    for (const std::size_t without_truth : {1u, 2u, 3u})
      EXPECT_LE(iou(without_truth), iou(4) + 0.5) << contestant_name(cells[without_truth].key);
    EXPECT_GE(iou(0), iou(1) - 1) << frames.set;
  }
}

TEST(MeasureCells, TheOracleIsCorrectWithoutNoise) {
  const std::vector<Cell> cells =
      measure_cells({{with_rival(clouds_of("stairs", 1001, 2048, 0), "oracle")}}, 1, tools());
  EXPECT_GT(cells[0].metrics.point_accuracy, 99);
  EXPECT_EQ(cells[0].metrics.r_m, 0);
  EXPECT_LT(cells[0].metrics.alpha_deg, 0.05);
}

TEST(PaperPlan, HasEveryCellOnceIncludingThoseOfAQuickRun) {
  const std::vector<CellKey> all = planned_cells({});
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ(std::ranges::find(all, all[i]) - all.begin(), static_cast<std::ptrdiff_t>(i));
  PaperPlan quick;
  quick.quick = true;
  const std::vector<CellKey> fewer = planned_cells(quick);
  EXPECT_LT(fewer.size(), all.size());
  for (const CellKey& key : fewer) EXPECT_NE(std::ranges::find(all, key), all.end());
}

TEST(PaperPlan, TurnsOffOneRefinementAtATime) {
  for (const bool of_depth : {false, true})
    for (const CellKey& key : ablations(clouds_of("stairs", 1, 8192, 0.3), of_depth)) {
      const std::string term = key.setting.substr(key.setting.find(' ') + 1);
      EXPECT_EQ(planes::find_option(term).get(cell_options(key)), "0");
    }
}

const TruePolygon kTriangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1};

TEST(Oracle, DistanceIsToThePolygonIncludingItsEdgesAndCorners) {
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {0.2, 0.2, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {0.2, 0.2, -0.5}), 0.5);
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {0.5, -0.3, 0.4}), 0.5);  // beside an edge
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {1.3, 0, 0.4}), 0.5);     // beyond a corner
  EXPECT_DOUBLE_EQ(distance_m(kTriangle, {1, 1, 0}), std::sqrt(0.5));
}

TEST(Oracle, TheOrientationOfThePolygonDoesNotMatter) {
  const TruePolygon reversed{{{0, 1, 0}, {1, 0, 0}, {0, 0, 0}}, 1};
  for (const Vec3d& p : {Vec3d(0.2, 0.2, 0.5), Vec3d(1, 1, 0), Vec3d(-1, 2, 3)})
    EXPECT_DOUBLE_EQ(distance_m(reversed, p), distance_m(kTriangle, p));
}

TEST(Oracle, PlanesEndWhereTheirPolygonsEnd) {
  // Two tables of the same height, and the floor between them.
  const std::vector<TruePolygon> tables = {
      {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, 1},
      {{{2, 0, 1}, {3, 0, 1}, {3, 1, 1}, {2, 1, 1}}, 2},
      {{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}}, 3},
  };
  const std::vector<Vec3f> points = {
      {0.5f, 0.5f, 0.9f}, {2.5f, 0.5f, 1.1f}, {1.4f, 0.5f, 1}, {1.6f, 0.5f, 1}, {1.5f, 0.5f, 0.2f}};
  EXPECT_EQ(oracle_planes(points, tables), (std::vector<std::int32_t>{1, 2, 1, 2, 3}));
}

TEST(Oracle, PrefersTheFirstOfEqualPlanesAndNoneIfACurvedPartIsNearest) {
  std::vector<TruePolygon> polygons = {
      kTriangle, kTriangle, {{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, 0}};
  polygons[1].plane = 2;
  const std::vector<Vec3f> points = {{0.2f, 0.2f, 0.1f}, {0.2f, 0.2f, 0.9f}};
  EXPECT_EQ(oracle_planes(points, polygons), (std::vector<std::int32_t>{1, 0}));
}

}  // namespace

}  // namespace planescope::lab
