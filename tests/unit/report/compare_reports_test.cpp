// Tests of matching and comparing the planes and frames of two reports.

#include "core/report/compare/compare_reports.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/empty_report.hpp"

namespace planescope::report {
namespace {

/// A strip of measurements with a plane for each tenth, which are floors at the given heights.
ReportFrame strip(const std::vector<int>& plane_of_tenths, const std::vector<double>& heights_m) {
  ReportFrame result;
  std::vector<int> plane_of;
  for (int i = 0; i < 100; ++i) plane_of.push_back(plane_of_tenths[i / 10]);
  result.regions = {1, 100, 1, runs_of(plane_of)};
  for (std::size_t k = 0; k < heights_m.size(); ++k) {
    const int id = static_cast<int>(k) + 1;
    result.planes.push_back(level_plane(id, heights_m[k]));
    result.planes.back().summary.centroid.x() = 0.1 * id;
  }
  return result;
}

const ReportFrame& three_floors() {
  static const ReportFrame floors = strip({1, 1, 1, 1, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.4});
  return floors;
}

TEST(ComparePlanes, OfTheSameRunAreUnchanged) {
  const auto found = compare_planes(three_floors(), three_floors());
  ASSERT_EQ(found.size(), 3u);
  for (int k = 1; k <= 3; ++k) {
    const PlaneComparison& plane = found[static_cast<std::size_t>(k) - 1];
    EXPECT_EQ(plane.fate, PlaneFate::same);
    EXPECT_EQ(plane.baseline, k);
    EXPECT_EQ(plane.now, k);
    EXPECT_EQ(plane.iou, 1);
    EXPECT_EQ(plane.offset_m, 0);
  }
}

TEST(ComparePlanes, IdsDoNotMatterButPositionsDo) {
  const ReportFrame renumbered = strip({3, 3, 3, 3, 0, 1, 1, 1, 2, 2}, {0.2, 0.4, 0});
  const auto found = compare_planes(three_floors(), renumbered);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].now, 3);
  EXPECT_EQ(found[1].now, 1);
  EXPECT_EQ(found[2].now, 2);
}

TEST(ComparePlanes, LostAndGainedPlanesAreListed) {
  const auto found =
      compare_planes(three_floors(), strip({1, 1, 1, 1, 3, 2, 2, 2, 0, 0}, {0, 0.2, 0.9}));
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[2].fate, PlaneFate::lost);
  EXPECT_EQ(found[2].baseline, 3);
  EXPECT_EQ(found[3].fate, PlaneFate::gained);
  EXPECT_EQ(found[3].baseline, 0);
  EXPECT_EQ(found[3].now, 3);
}

TEST(ComparePlanes, FiveMillimetersOrOneDegreeAreAMove) {
  EXPECT_EQ(
      compare_planes(three_floors(), strip({1, 1, 1, 1, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.404}))[2]
          .fate,
      PlaneFate::same);
  const auto higher =
      compare_planes(three_floors(), strip({1, 1, 1, 1, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.406}));
  EXPECT_EQ(higher[2].fate, PlaneFate::moved);
  EXPECT_NEAR(higher[2].offset_m, 0.006, 1e-12);

  ReportFrame tilted = three_floors();
  const double angle = 1.5 * M_PI / 180;
  tilted.planes[1].summary.normal = {std::sin(angle), 0, std::cos(angle)};
  tilted.planes[1].summary.offset_m =
      tilted.planes[1].summary.normal.dot(tilted.planes[1].summary.centroid);
  const auto found = compare_planes(three_floors(), tilted);
  EXPECT_EQ(found[1].fate, PlaneFate::moved);
  EXPECT_NEAR(found[1].angle_deg, 1.5, 1e-9);
}

TEST(ComparePlanes, AreaShowsGrowthAndShrinkage) {
  ReportFrame shrunk = strip({1, 1, 1, 0, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.4});
  shrunk.planes[0].summary.area_m2 = 0.75;
  const auto found = compare_planes(three_floors(), shrunk);
  EXPECT_EQ(found[0].fate, PlaneFate::resized);
  EXPECT_EQ(found[0].area_ratio, 0.75);
  EXPECT_EQ(found[0].iou, 0.75);
}

TEST(ComparePlanes, ASplitListsItsPartsAndAMergeItsSources) {
  const ReportFrame split = strip({1, 1, 4, 4, 0, 2, 2, 2, 3, 3}, {0, 0.2, 0.4, 0});
  const auto apart = compare_planes(three_floors(), split);
  ASSERT_EQ(apart.size(), 3u) << "parts are not gained";
  EXPECT_EQ(apart[0].fate, PlaneFate::split);
  EXPECT_EQ(apart[0].now, 1);
  EXPECT_EQ(apart[0].others, std::vector<int>{4});

  const auto together = compare_planes(split, three_floors());
  ASSERT_EQ(together.size(), 4u);
  EXPECT_EQ(together[0].fate, PlaneFate::merged);
  EXPECT_EQ(together[3].fate, PlaneFate::merged);
  EXPECT_EQ(together[0].now, 1);
  EXPECT_EQ(together[0].others, std::vector<int>{4});
  EXPECT_EQ(together[1].fate, PlaneFate::same);
}

TEST(ComparePlanes, WithoutSamplesPlanesAreMatchedByPositionAndDirection) {
  const ReportFrame before = strip({1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, {0, 0.2});
  ReportFrame after = before;
  after.planes[1].summary.centroid.z() = after.planes[1].summary.offset_m = 0.203;
  EXPECT_EQ(compare_planes(before, after)[1].fate, PlaneFate::same);
  after.planes[1].summary.label = Label::v;
  const auto found = compare_planes(before, after);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[1].fate, PlaneFate::lost);
  EXPECT_EQ(found[2].fate, PlaneFate::gained);
}

TEST(ComparePlanes, AReportWithoutSamplesIsComparedByPositionAndDirection) {
  ReportFrame before = three_floors();
  before.regions = {};
  ReportFrame after = three_floors();
  after.planes[2].summary.centroid.z() = after.planes[2].summary.offset_m = 0.42;
  const auto found = compare_planes(before, after);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].fate, PlaneFate::same);
  EXPECT_EQ(found[2].fate, PlaneFate::moved);
}

TEST(ComparePlanes, EmptyFramesCanBeCompared) {
  const ReportFrame none = strip(std::vector<int>(10, 0), {});
  EXPECT_TRUE(compare_planes(none, none).empty());
  EXPECT_EQ(compare_planes(none, three_floors()).size(), 3u);
  EXPECT_EQ(compare_planes(three_floors(), none)[0].fate, PlaneFate::lost);
}

TEST(ComparePlanes, SamplesOfOtherPixelsAreIgnored) {
  ReportFrame other = three_floors();
  other.regions = {1, 7, 1, {{1, 7}}};
  for (const PlaneComparison& plane : compare_planes(three_floors(), other)) {
    EXPECT_EQ(plane.fate, PlaneFate::same);
    EXPECT_EQ(plane.iou, 0);
  }
}

ReportFrame frame_with_floor(int index, double height_m) {
  ReportFrame frame;
  frame.index = index;
  frame.sha256 = "hash " + std::to_string(index);
  frame.planes = {level_plane(1, height_m)};
  frame.regions = {1, 2, 1, {{1, 2}}};
  return frame;
}

ReportOption option(const std::string& name, const std::string& value) {
  ReportOption result;
  result.name = name;
  result.value = value;
  return result;
}

Report report_of(const std::vector<std::pair<std::string, std::vector<ReportFrame>>>& recordings) {
  Report report = report_of_frames(recordings);
  report.classifier = "gcn";
  report.weights = planes::WeightsRecord{"", "w1", "", ""};
  report.options = {option("voxel_size_m", "0.02"), option("threads", "1")};
  return report;
}

TEST(CompareReports, FramesAreFoundByRecordingAndNumber) {
  const Report baseline = report_of(
      {{"a", {frame_with_floor(0, 0), frame_with_floor(2, 0)}}, {"b", {frame_with_floor(0, 1)}}});
  const Report now = report_of({{"b", {frame_with_floor(0, 1.02)}},
                                {"a", {frame_with_floor(2, 0), frame_with_floor(3, 0)}}});
  const ReportComparison found = compare_reports(baseline, now);
  ASSERT_EQ(found.frames.size(), 4u);
  EXPECT_EQ(found.frames[0].recording, "b");
  EXPECT_EQ(found.frames[0].count(PlaneFate::moved), 1);
  EXPECT_EQ(found.frames[1].fate, FrameFate::compared);
  EXPECT_EQ(found.frames[1].index, 2);
  EXPECT_EQ(found.frames[1].count(PlaneFate::same), 1);
  EXPECT_EQ(found.frames[2].fate, FrameFate::added);
  EXPECT_EQ(found.frames[3].fate, FrameFate::missing);
  EXPECT_EQ(found.frames[3].recording, "a");
  EXPECT_EQ(found.frames[3].index, 0);
}

TEST(CompareReports, RecordingsWithTheSameNameAreMatchedInOrder) {
  const Report both = report_of(
      {{"000000.png", {frame_with_floor(0, 0)}}, {"000000.png", {frame_with_floor(0, 1)}}});
  const ReportComparison found = compare_reports(both, both);
  ASSERT_EQ(found.frames.size(), 2u);
  for (const FrameComparison& frame : found.frames) {
    EXPECT_EQ(frame.fate, FrameFate::compared);
    EXPECT_EQ(frame.count(PlaneFate::same), 1);
  }
}

TEST(CompareReports, ARemovedFrameIsMissingAndTheOthersKeepTheirPartners) {
  const auto frames = [](std::vector<int> which) {
    std::vector<ReportFrame> result;
    for (const int k : which) {
      result.push_back(frame_with_floor(k, 0));
      result.back().name = "00000" + std::to_string(k);
      result.back().index = static_cast<int>(result.size()) - 1;
    }
    return result;
  };
  const Report baseline = report_of({{"walk", frames({0, 1, 2, 3, 4})}});
  Report now = report_of({{"walk", frames({0, 1, 3, 4})}});
  now.recordings[0].frame_count = now.recordings[0].frames_asked = 4;
  const ReportComparison found = compare_reports(baseline, now);
  ASSERT_EQ(found.frames.size(), 5u);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(found.frames[k].fate, FrameFate::compared) << k;
  EXPECT_EQ(found.frames[4].fate, FrameFate::missing);
  EXPECT_EQ(found.frames[4].name, "000002");
  EXPECT_EQ(found.frames[4].index, 2);

  for (ReportFrame& frame : now.recordings[0].frames) frame.sha256 += " other pixels";
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(compare_reports(baseline, now).frames[k].fate, FrameFate::other_input) << "by name";
  for (ReportFrame& frame : now.recordings[0].frames) frame.name.clear();
  EXPECT_EQ(compare_reports(baseline, now).frames[4].index, 4) << "without names by number";
}

TEST(CompareReports, UnselectedFramesAreSkippedAndNotMissing) {
  const Report baseline = report_of(
      {{"a", {frame_with_floor(0, 0), frame_with_floor(1, 0)}}, {"b", {frame_with_floor(2, 0)}}});
  Report now = report_of({{"a", {frame_with_floor(0, 0)}}});
  now.recordings[0].frame_count = 2;
  now.recordings[0].frames_asked = 1;
  const ReportComparison part = compare_reports(baseline, now);
  EXPECT_EQ(part.frames.size(), 1u);
  EXPECT_EQ(part.left_out, (std::vector<std::string>{"a: 1 of 2 frames", "b"}));
}

TEST(CompareReports, AnotherInputIsNotComparedAndFailuresAreReported) {
  ReportFrame other = frame_with_floor(0, 0), refused = frame_with_floor(1, 0);
  other.sha256 = "another";
  refused.refused = "no gravity";
  const Report good = report_of({{"a", {frame_with_floor(0, 0), frame_with_floor(1, 0)}}});
  const Report bad = report_of({{"a", {other, refused}}});
  const ReportComparison worse = compare_reports(good, bad), better = compare_reports(bad, good);
  EXPECT_EQ(worse.frames[0].fate, FrameFate::other_input);
  EXPECT_TRUE(worse.frames[0].planes.empty());
  EXPECT_EQ(worse.frames[1].fate, FrameFate::refused);
  EXPECT_EQ(better.frames[1].fate, FrameFate::mended);
  EXPECT_EQ(compare_reports(bad, bad).frames[1].fate, FrameFate::both_refused);
}

TEST(CompareReports, ChangedOptionsAreListedExceptThreads) {
  const Report baseline = report_of({});
  Report now = baseline;
  now.weights->sha256 = "w2";
  now.options = {option("voxel_size_m", "0.04"), option("threads", "2"), option("new_option", "1")};
  EXPECT_EQ(compare_reports(baseline, now).differences,
            (std::vector<std::string>{"weights: w1 -> w2", "option voxel_size_m: 0.02 -> 0.04",
                                      "option new_option: none -> 1"}));
  EXPECT_TRUE(compare_reports(baseline, baseline).differences.empty());
}

}  // namespace
}  // namespace planescope::report
