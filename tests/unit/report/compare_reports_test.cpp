#include "core/report/compare/compare_reports.hpp"

#include <gtest/gtest.h>

namespace planescope::report {
namespace {

RecordedFrame frame_with_floor(int index, double height_m) {
  RecordedFrame frame;
  frame.index = index;
  frame.sha256 = "hash " + std::to_string(index);
  PlaneSummary floor;
  floor.id = 1;
  floor.label = Label::h;
  floor.centroid.z() = floor.offset_m = height_m;
  floor.area_m2 = 1;
  frame.planes = {floor};
  frame.regions = {1, 2, 1, {{1, 2}}};
  return frame;
}

RecordedReport report_of(std::vector<RecordedRecording> recordings) {
  RecordedReport report;
  report.method = "ours";
  report.classifier = "gcn";
  report.weights_sha256 = "w1";
  report.options = {{"voxel_size_m", "0.02"}, {"threads", "1"}};
  report.recordings = std::move(recordings);
  return report;
}

TEST(CompareReports, FramesAreFoundByRecordingAndNumber) {
  const RecordedReport baseline = report_of(
      {{"a", {frame_with_floor(0, 0), frame_with_floor(2, 0)}}, {"b", {frame_with_floor(0, 1)}}});
  const RecordedReport now = report_of({{"b", {frame_with_floor(0, 1.02)}},
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

TEST(CompareReports, RecordingsOfOneNameGoByTheirOrder) {
  const RecordedReport both = report_of(
      {{"000000.png", {frame_with_floor(0, 0)}}, {"000000.png", {frame_with_floor(0, 1)}}});
  const ReportComparison found = compare_reports(both, both);
  ASSERT_EQ(found.frames.size(), 2u);
  for (const FrameComparison& frame : found.frames) {
    EXPECT_EQ(frame.fate, FrameFate::compared);
    EXPECT_EQ(frame.count(PlaneFate::same), 1);
  }
}

TEST(CompareReports, AnotherInputIsNotComparedAndARefusalIsTold) {
  RecordedFrame other = frame_with_floor(0, 0), refused = frame_with_floor(1, 0);
  other.sha256 = "another";
  refused.refused = "no gravity";
  const RecordedReport good = report_of({{"a", {frame_with_floor(0, 0), frame_with_floor(1, 0)}}});
  const RecordedReport bad = report_of({{"a", {other, refused}}});
  const ReportComparison worse = compare_reports(good, bad), better = compare_reports(bad, good);
  EXPECT_EQ(worse.frames[0].fate, FrameFate::other_input);
  EXPECT_TRUE(worse.frames[0].planes.empty());
  EXPECT_EQ(worse.frames[1].fate, FrameFate::refused);
  EXPECT_EQ(better.frames[1].fate, FrameFate::mended);
  EXPECT_EQ(compare_reports(bad, bad).frames[1].fate, FrameFate::both_refused);
}

TEST(CompareReports, WhatIsSetOtherwiseIsNamedButNotTheThreads) {
  const RecordedReport baseline = report_of({});
  RecordedReport now = baseline;
  now.weights_sha256 = "w2";
  now.options = {{"voxel_size_m", "0.04"}, {"threads", "2"}, {"new_option", "1"}};
  EXPECT_EQ(compare_reports(baseline, now).differences,
            (std::vector<std::string>{"weights: w1 -> w2", "option voxel_size_m: 0.02 -> 0.04",
                                      "option new_option: none -> 1"}));
  EXPECT_TRUE(compare_reports(baseline, baseline).differences.empty());
}

}  // namespace
}  // namespace planescope::report
