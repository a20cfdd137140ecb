#include "core/report/data/recorded_options.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/planes/pipeline/options_table.hpp"
#include "core/report/data/report_files.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::report {
namespace {

namespace fs = std::filesystem;

RecordedReport through_a_file(const Report& report) {
  const fs::path file = temp_dir() / "planescope_recorded_options.json";
  std::ofstream(file) << report_json(report);
  return read_report(file);
}

/// Another value than the option has.
void change(planes::PipelineOptions& options, const planes::OptionInfo& info) {
  const std::string before = info.get(options);
  if (info.kind == planes::OptionKind::on_off) {
    info.set(options, before == "on" ? "off" : "on");
  } else if (info.kind == planes::OptionKind::choice) {
    info.set(options, info.choices[0] == before ? info.choices.back() : info.choices[0]);
  } else if (info.is_number()) {
    info.set(options, planes::number_text(info, planes::number_of(info, options) + 1));
    if (info.get(options) == before)
      info.set(options, planes::number_text(info, info.range.min + 1.0 / 3));
    if (info.kind == planes::OptionKind::number && info.range.max > 3)
      info.set(options, planes::number_text(info, 2 + 1.0 / 3));
  } else if (info.name == "gravity") {
    info.set(options, "0.1,0.9000000000000001,-0.33333333333333331");
  } else if (info.name == "classifier") {
    info.set(options, "my/weights.safetensors");
  }
}

TEST(RecordedOptions, AreThoseTheReportWasMadeWithToTheLastDigit) {
  for (const planes::Method method : planes::built_methods()) {
    planes::PipelineOptions options;
    options.method = method;
    options.segment = planes::profile_options(planes::Profile::paper);
    for (const planes::OptionInfo& info : planes::option_table())
      if (info.name != "profile" && info.name != "method") change(options, info);
    Report report;
    report.method = method;
    report.options = make_report_options(options);
    std::vector<std::string> unknown;
    const planes::PipelineOptions again = options_of(through_a_file(report), unknown);
    EXPECT_TRUE(unknown.empty());
    for (const planes::OptionInfo& info : planes::option_table()) {
      if (!info.matters(options)) continue;
      EXPECT_EQ(info.get(again), info.get(options))
          << planes::to_string(method) << " " << info.name;
    }
    EXPECT_EQ(again.gravity.direction, options.gravity.direction);
  }
}

TEST(RecordedOptions, OfAnotherVersionAreTakenAsFarAsTheyAreKnown) {
  RecordedReport report;
  report.options = {{"theta_of_old", "3"}, {"theta_n_in", "9"}, {"profile", "paper"}};
  std::vector<std::string> unknown;
  const planes::PipelineOptions options = options_of(report, unknown);
  EXPECT_EQ(unknown, std::vector<std::string>{"theta_of_old"});
  EXPECT_EQ(options.segment.theta_n_in, 9) << "the profile must not undo it";
  EXPECT_EQ(options.segment.profile, planes::Profile::paper);
  report.options = {{"theta_n_in", "many"}};
  expect_refused([&] { options_of(report, unknown); }, "theta_n_in");
}

TEST(RecordedOptions, WhatTheCommandLineSaidOfTheCameraIsKnownFromTheRecording) {
  Report report;
  ReportRecording& typed = report.recordings.emplace_back();
  typed.info.path = "dir/rec";
  typed.info.width = 640;
  typed.info.intrinsics.fx = 601.12345678901234;
  typed.info.intrinsics.fy = 602;
  typed.info.intrinsics_source = "option --intrinsics";
  typed.info.depth_unit_m = 0.0005;
  typed.info.depth_unit_source = "option --depth-unit";
  ReportRecording& own = report.recordings.emplace_back(typed);
  own.info.intrinsics_source = "camera.json";
  own.info.depth_unit_source = "assumed";
  const RecordedReport written = recorded(report);
  const RecordedReport read = through_a_file(report);
  for (const RecordedReport* one : {&written, &read}) {
    EXPECT_EQ(one->recordings[0].path, "dir/rec");
    ASSERT_TRUE(one->recordings[0].options.intrinsics);
    EXPECT_EQ((*one->recordings[0].options.intrinsics)[0], 601.12345678901234);
    EXPECT_EQ(one->recordings[0].options.depth_unit_m, 0.0005);
    EXPECT_FALSE(one->recordings[1].options.intrinsics);
    EXPECT_FALSE(one->recordings[1].options.depth_unit_m);
  }
}

}  // namespace
}  // namespace planescope::report
