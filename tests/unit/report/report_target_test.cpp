#include "core/report/data/report_target.hpp"

#include <gtest/gtest.h>

#include "support/refusal.hpp"

namespace planescope::report {
namespace {

TEST(ReportTarget, NamesAFrameOrAPlaneOfAReport) {
  const ReportTarget file = parse_report_target("out/report.json");
  EXPECT_EQ(file.file, "out/report.json");
  EXPECT_EQ(file.recording, 1);
  EXPECT_EQ(file.frame, -1);
  EXPECT_EQ(file.plane, 0);

  const ReportTarget frame = parse_report_target("out/report.json#f012");
  EXPECT_EQ(frame.file, "out/report.json");
  EXPECT_EQ(frame.frame, 12);
  EXPECT_EQ(frame.plane, 0);

  const ReportTarget plane = parse_report_target("a#b/report.json#r2/f0/p3");
  EXPECT_EQ(plane.file, "a#b/report.json") << "the last # counts";
  EXPECT_EQ(plane.recording, 2);
  EXPECT_EQ(plane.frame, 0);
  EXPECT_EQ(plane.plane, 3);
  EXPECT_FALSE(plane.of_baseline);

  const ReportTarget lost = parse_report_target("report.json#f7/was14");
  EXPECT_EQ(lost.plane, 14);
  EXPECT_TRUE(lost.of_baseline);
}

TEST(ReportTarget, WhatIsNoneIsRefusedWithWhatWasFound) {
  for (const char* place :
       {"",      "/",     "f",       "f-1",    "fx",           "12",   "f1/",
        "f1/p",  "f1/p0", "f1/was0", "f1/q3",  "f1/p3/p4",     "f1p3", "r1",
        "r0/f1", "r/f1",  "r1/p3",   "f1/p3 ", "f99999999999", "F1",   "f1/r1"}) {
    const std::string text =
        message_of([&] { parse_report_target(std::string("a.json#") + place); });
    EXPECT_TRUE(text.starts_with(std::string("a.json: '") + place + "' is no place")) << text;
    EXPECT_NE(text.find("expected f<frame>"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace planescope::report
