// Tests of plane summaries, undecided planes and value histograms in reports.

#include "core/report/data/report_data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/model/random.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/report/data/segment_files.hpp"
#include "support/has.hpp"

namespace planescope::report {
namespace {

using planes::FramePlanes;
using planes::PlaneSummary;

// A horizontal and a vertical square of 1 m, sampled every centimeter, and a point without a plane.
planes::FrameResult two_squares(const Vec3d& origin) {
  planes::FrameResult result;
  result.cloud.origin = origin;
  Moments moments[2];
  const auto add = [&](const Vec3d& p, int id) {
    result.cloud.points.push_back(p.cast<float>());
    result.plane_of.push_back(id);
    if (id > 0) moments[id - 1].add(p);
  };
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      const double a = 0.005 + 0.01 * i, b = 0.005 + 0.01 * j;
      add(Vec3d(a, b, 0), 1);
      add(Vec3d(a, 2, b), 2);
    }
  }
  add(Vec3d(0.5, 1.5, 0.7), 0);
  result.segmentation.planes = {{1, Label::h, fit_plane(moments[0]), 1000},
                                {2, Label::v, fit_plane(moments[1]), 900}};
  return result;
}

TEST(PlaneSummary, SizeTiltAndOffsetMatchTheSurface) {
  const auto summaries = summarize_planes(two_squares(Vec3d(100, 200, 5)), 0.02);
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries[0].points, 10000u);
  EXPECT_EQ(summaries[0].voxels, 1000u);
  EXPECT_NEAR(summaries[0].area_m2, 1, 0.05);
  EXPECT_NEAR(summaries[0].tilt_deg, 0, 1e-3);
  EXPECT_NEAR(summaries[0].offset_m, 5, 1e-6);
  EXPECT_NEAR(summaries[1].tilt_deg, 90, 1e-3);
  EXPECT_NEAR(summaries[1].offset_m, 202, 1e-5);
}

/// The two squares, the vertical one undecided, with everything that files contain about them.
struct TwoSquares {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  FramePlanes found;

  TwoSquares() {
    result.cloud.kept.assign(result.cloud.points.size(), 0);  // points are not from an image
    result.segmentation.planes[1].undecided = true;
    result.segmentation.planes[1].margin = 0.03125;
    found.summaries = summarize_planes(result, 0.02);
    found.outlines.resize(2);
    found.footholds.resize(2);
    found.stairs.height_m.assign(2, std::nan(""));
  }
};

TEST(Undecided, IsInEveryFileWithAFiniteMargin) {
  const TwoSquares squares;
  const auto planes =
      nlohmann::json::parse(planes_json(Frame{}, squares.result, squares.found, {}))["planes"];
  EXPECT_EQ(planes[0]["undecided"], false);
  EXPECT_TRUE(planes[0]["margin"].is_null());
  EXPECT_EQ(planes[1]["undecided"], true);
  EXPECT_EQ(planes[1]["margin"], 0.03125);

  const ReportFrame frame = make_report_frame(Frame{}, squares.result, squares.found, {});
  EXPECT_EQ(frame.planes_undecided, 1);
  EXPECT_FALSE(frame.planes[0].summary.undecided);
  EXPECT_EQ(frame.planes[1].summary.margin, 0.03125);

  const auto message =
      nlohmann::json::parse(ros_json(Frame{}, squares.result, squares.found))["planes"];
  EXPECT_EQ(message[0]["has_margin"], false) << "ROS has no infinity";
  EXPECT_EQ(message[0]["margin"], 0.0);
  EXPECT_EQ(message[1]["undecided"], true);
  EXPECT_EQ(message[1]["margin"], 0.03125);

  const auto csv = std::ranges::find(plane_formats(), std::string("csv"), &PlaneFormat::name);
  const std::string text = csv->text(squares.found);
  for (const char* part : {",margin,undecided\n", ",,false\n", ",0.03125,true\n"})
    EXPECT_TRUE(has(text, part));
}

TEST(PlaneSummary, WithoutGravityNothingIsTilted) {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  result.gravity.source = GravitySource::none;
  EXPECT_TRUE(std::isnan(summarize_planes(result, 0.02)[0].tilt_deg));
}

TEST(PlaneSummary, AreaExcludesUnmeasuredParts) {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)  // an L, with one quarter missing
    if (result.cloud.points[i].x() > 0.5F && result.cloud.points[i].y() > 0.5F &&
        result.plane_of[i] == 1)
      result.plane_of[i] = 0;
  EXPECT_NEAR(summarize_planes(result, 0.02)[0].area_m2, 0.75, 0.05);
}

// Only points near the rim are used for the hull; it must equal the hull of all points.
TEST(PlaneSummary, HullIsThatOfAllPoints) {
  Random random(5);
  const auto disc = [&](const Vec2d& middle, double radius) {
    Vec2d p;
    do p = {random.uniform(-1, 1), random.uniform(-1, 1)};
    while (p.norm() > 1);
    return Vec2d(middle + radius * p);
  };
  const std::vector<std::pair<const char*, std::function<Vec2d()>>> shapes = {
      {"disc",
       [&] {
         return disc({0.3, -0.2}, 0.7);
       }},
      {"diagonal strip",
       [&] {
         const double along = random.uniform(-1, 1), across = random.uniform(-0.01, 0.01);
         return Vec2d(along + across, along - across);
       }},
      {"turned square",
       [&] {
         const double a = random.uniform(0, 1), b = random.uniform(0, 1);
         return Vec2d(0.8 * a - 0.6 * b, 0.6 * a + 0.8 * b);
       }},
      {"ring",
       [&] {
         const double angle = random.uniform(0, 2 * std::numbers::pi);
         return Vec2d(random.uniform(0.9, 1) * Vec2d(std::cos(angle), std::sin(angle)));
       }},
      {"two far apart",
       [&] {
         return disc({random.uniform(0, 1) < 0.5 ? 0.0 : 900.0, 0}, 0.1);
       }},
      {"one point", [] { return Vec2d(0.25, 0.5); }},
  };
  for (const auto& [name, draw] : shapes)
    for (const int count : {1, 4, 40, 5000}) {
      planes::FrameResult result;
      PlaneFit level;
      level.count = count;
      std::vector<Vec2d> all;
      const PlaneBasis basis = plane_basis(level.normal);
      for (int i = 0; i < count; ++i) {
        const Vec2d p = draw();
        result.cloud.points.push_back(Vec3d(p.x(), p.y(), 0).cast<float>());
        result.plane_of.push_back(1);
        const Vec3d at = result.cloud.points.back().cast<double>();
        all.emplace_back(basis.u.dot(at), basis.v.dot(at));
      }
      result.segmentation.planes = {{1, Label::h, level, 1}};
      const std::vector<Vec2d> hull = convex_hull(all);
      const std::vector<Vec3d> found = summarize_planes(result, 0.02)[0].hull;
      ASSERT_EQ(found.size(), hull.size()) << name << ", " << count << " points";
      for (std::size_t i = 0; i < hull.size(); ++i)
        EXPECT_EQ(found[i], Vec3d(hull[i].x() * basis.u + hull[i].y() * basis.v)) << name;
    }
}

TEST(PlaneSummary, HullIsInThePlaneAndCounterClockwiseAboutTheNormal) {
  for (const PlaneSummary& plane : summarize_planes(two_squares(Vec3d::Zero()), 0.02)) {
    ASSERT_EQ(plane.hull.size(), 4u);
    Vec3d twice_area = Vec3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(plane.normal.dot(plane.hull[i]), plane.offset_m, 1e-9);
      twice_area += plane.hull[i].cross(plane.hull[(i + 1) % 4]);
    }
    EXPECT_NEAR(twice_area.dot(plane.normal) / 2, 0.99 * 0.99, 1e-3);
  }
}

TEST(PlaneSummary, APlaneThatLostAllItsPointsHasNoArea) {
  planes::FrameResult result = two_squares(Vec3d::Zero());
  for (auto& id : result.plane_of)
    if (id == 2) id = 0;
  const auto summaries = summarize_planes(result, 0.02);
  EXPECT_EQ(summaries[1].points, 0u);
  EXPECT_EQ(summaries[1].area_m2, 0);
  EXPECT_TRUE(summaries[1].hull.empty());
}

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
    return decision_histograms(segmentation, trace.limit_ratios, options);
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

TEST_P(ValueHistogramOf, CountsEveryNodeByDecision) {
  const Decided decided(GetParam());
  const std::vector<ValueHistogram> histograms = decided.histograms();
  ASSERT_EQ(histograms.size(), 4u);
  const planes::SegmentCounts& counts = decided.segmentation.counts;
  EXPECT_EQ(histograms[0].name, "n_out");
  EXPECT_EQ(histograms[0].total(), counts.nodes_visited);
  // Pure nodes are within the threshold; nodes of case I are above it or have too many outliers.
  EXPECT_GE(within_threshold(histograms[0]), counts.nodes_visited - counts.nodes_per_case[1]);
  EXPECT_EQ(histograms[1].name, "planarity");
  EXPECT_GE(within_threshold(histograms[1]), counts.nodes_per_case[4]);
  EXPECT_GE(histograms[1].total() - within_threshold(histograms[1]), counts.nodes_per_case[3]);
}

TEST_P(ValueHistogramOf, ContainsAPairPerCandidateWithAPlaneToJoin) {
  if (GetParam() == planes::Profile::refined) return;  // only the paper profile tests Criterion 4
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
  add_to(sum, {"n_out", 4, 1, {9, 9, 9}});  // of another frame
  EXPECT_EQ(sum.counts, (std::vector<std::uint32_t>{4, 1, 2}));
  EXPECT_EQ(sum.total(), 7u);
}

TEST(ValueHistogram, IsMissingWithoutAnOctree) {
  EXPECT_TRUE(decision_histograms({}, {}, {}).empty());
}

}  // namespace
}  // namespace planescope::report
